#include "common/simulated.h"
#include <stdlib.h>
#include <string.h>

/* A realisation that occurs again, with another step, is not higher than those before. */
static void take_realisation(struct simulated *s, long n)
{
	s->lowest = s->count == 0 || n < s->lowest ? n : s->lowest;
	if (s->count > 0 && n <= s->highest)
		return;
	s->highest = n;
	s->count++;
}

void simulated_comment(void *to, const char *key, const char *value)
{
	struct simulated *s = to;
	char *end;
	long n = strtol(value, &end, 10);

	if (end == value || *end || n < 0)
		return;
	if (strcmp(key, "realisation") == 0 && (double)n <= 1e15)
		take_realisation(s, n);
	else if (strcmp(key, "last_step") == 0 && n <= 1000000)
		s->last_step = n > s->last_step ? n : s->last_step;
}
