#include "cli/upstream.h"
#include "cli/msg.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Where the number of the realisation stands: that of roughgen, which alone has a --count
 * to go with it.  NULL where there is none. */
static const char *find_number(const char *cmd)
{
	const char *word = " --first ", *at = strstr(cmd, word),
		   *pipe = strstr(cmd, " | ");
	size_t digits;

	if (strncmp(cmd, "roughgen ", 9) || !at || (pipe && pipe < at))
		return NULL;
	at += strlen(word);
	digits = strspn(at, "0123456789");
	return digits > 0 && digits < 18 && (!at[digits] || at[digits] == ' ') &&
			       strncmp(at + digits, " --count ", 9)
		       ? at
		       : NULL;
}

static char *copy(const char *text, size_t length)
{
	return xprintf("%.*s", (int)length, text);
}

void upstream_add(struct upstream *u, const char *cmd)
{
	const char *number = find_number(cmd);
	struct upstream_run *last = u->n ? &u->run[u->n - 1] : NULL;
	struct upstream_run run = { .count = 1 };
	char *after = NULL;

	if (number)
		run.first = strtoll(number, &after, 10);
	if (number && last && last->after && !strcmp(last->after, after) &&
		last->first + last->count == run.first &&
		strlen(last->before) == (size_t)(number - cmd) &&
		!strncmp(last->before, cmd, (size_t)(number - cmd))) {
		last->count++;
		return;
	}
	run.before = copy(cmd, number ? (size_t)(number - cmd) : strlen(cmd));
	run.after = number ? xstrdup(after) : NULL;
	if (u->n == u->room) {
		u->room = 2 * u->room + 1;
		u->run = xrealloc(u->run, (size_t)u->room, sizeof *u->run);
	}
	u->run[u->n++] = run;
}

static char *one(const struct upstream_run *run)
{
	if (!run->after)
		return xstrdup(run->before);
	if (run->count == 1)
		return xprintf("%s%lld%s", run->before, run->first, run->after);
	return xprintf(
		"%s%lld --count %lld%s", run->before, run->first, run->count, run->after);
}

const char *upstream_cmd(struct upstream *u)
{
	size_t length = 0, room = 16;

	free(u->cmd);
	u->cmd = NULL;
	if (u->n <= 1)
		return u->cmd = u->n ? one(u->run) : NULL;
	for (int i = 0; i < u->n; i++)
		room += strlen(u->run[i].before) + 64 +
			(u->run[i].after ? strlen(u->run[i].after) : 0);
	u->cmd = xcalloc(room, 1);
	for (int i = 0; i < u->n; i++) {
		char *text = one(&u->run[i]);

		length += (size_t)snprintf(
			u->cmd + length, room - length, "%s %s;", i ? "" : "{", text);
		free(text);
	}
	strcpy(u->cmd + length, " }");
	return u->cmd;
}

void upstream_free(struct upstream *u)
{
	for (int i = 0; i < u->n; i++) {
		free(u->run[i].before);
		free(u->run[i].after);
	}
	free(u->run);
	free(u->cmd);
}
