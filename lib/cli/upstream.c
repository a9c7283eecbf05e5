#include "cli/upstream.h"
#include "cli/msg.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The realisations that a pipeline generates. */
struct numbers {
	const char *at; /* " --first A --count B" in the command; NULL if there is none */
	const char *after;      /* the rest of the command */
	long long first, count; /* A and B */
};

/* An integer of at most 17 digits after word, with which cmd begins; NULL for none.
 */
static const char *read_number(const char *cmd, const char *word, long long *number)
{
	size_t n = strlen(word), digits;

	if (strncmp(cmd, word, n) != 0)
		return NULL;
	digits = strspn(cmd + n, "0123456789");
	*number = strtoll(cmd + n, NULL, 10);
	return digits > 0 && digits < 18 ? cmd + n + digits : NULL;
}

/* The realisations of the first command of the pipeline, which generates the input of the
 * others. */
static struct numbers find_numbers(const char *cmd)
{
	const char *pipe = strstr(cmd, " | ");
	struct numbers none = { 0 }, found;

	for (const char *at = cmd; (at = strstr(at, " --first ")); at++) {
		const char *after;

		if (pipe && pipe < at)
			break;
		found.at = at;
		after = read_number(at, " --first ", &found.first);
		if (after)
			after = read_number(after, " --count ", &found.count);
		found.after = after;
		if (after && (!*after || *after == ' '))
			return found;
	}
	return none;
}

static char *copy(const char *text, size_t length)
{
	return xprintf("%.*s", (int)length, text);
}

void upstream_add(struct upstream *u, const char *cmd)
{
	struct numbers found = find_numbers(cmd);
	struct upstream_run *last = u->n ? &u->run[u->n - 1] : NULL, run = { 0 };
	size_t before = found.at ? (size_t)(found.at - cmd) : strlen(cmd);

	if (found.at && last && last->after && !strcmp(last->after, found.after) &&
		last->first + last->count == found.first &&
		strlen(last->before) == before && !strncmp(last->before, cmd, before)) {
		last->count += found.count;
		return;
	}
	run.before = copy(cmd, before);
	if (found.at) {
		run.after = xstrdup(found.after);
		run.first = found.first;
		run.count = found.count;
	}
	if (u->n == u->room) {
		u->room = 2 * u->room + 1;
		u->run = xrealloc(u->run, (size_t)u->room, sizeof *u->run);
	}
	u->run[u->n++] = run;
}

static char *one(const struct upstream_run *run)
{
	return run->after ? xprintf("%s --first %lld --count %lld%s", run->before,
				    run->first, run->count, run->after)
			  : xstrdup(run->before);
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
