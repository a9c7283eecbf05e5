#include "io/reasons.h"
#include "cli/msg.h"
#include "io/input.h"
#include <stdlib.h>

/* All that one record has, and some lines of a terminal where each of many realisations
 * has one of its own. */
enum { QUOTED = 8 };

static int most(void)
{
	return (int)input_limit("keys", KEYS_MOST);
}

void reasons_add(struct reasons *r, const char *why)
{
	if (why && r->all.n < most())
		keys_set(&r->all, why, "");
}

const char *reasons_text(struct reasons *r)
{
	int n = r->all.n;

	if (n == 0)
		return NULL;
	free(r->text);
	r->text = xstrdup(r->all.key[0]);
	for (int i = 1; i < n && i < QUOTED; i++)
		r->text = xappend(r->text, "; %s", r->all.key[i]);
	if (n > QUOTED)
		r->text = xappend(r->text, "; and %s%d more reasons",
			n < most() ? "" : "at least ", n - QUOTED);
	return r->text;
}

const char *reasons_tell(const char *name, const char *why)
{
	if (why)
		warn("%s: doubtful by its own account: %s", name, why);
	return why;
}

const char *reasons_warn(struct reasons *r, const char *name)
{
	return reasons_tell(name, reasons_text(r));
}

void reasons_free(struct reasons *r)
{
	keys_free(&r->all);
	free(r->text);
}
