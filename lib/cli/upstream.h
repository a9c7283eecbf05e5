/* upstream.h - the pipelines that made the parts of a table, written as one
 *
 *	struct upstream u = { 0 };
 *	upstream_add(&u, "a --first 0 --count 1 | b");
 *	upstream_add(&u, "a --first 1 --count 1 | b");
 *	upstream_cmd(&u);       "a --first 0 --count 2 | b"
 *
 * A program that makes realisations records which ones as --first and --count side by
 * side; parts whose realisations follow one another become one.  Pipelines that differ
 * in anything else form a group, "{ a; b; }", whose output is that of cat.
 */
#ifndef CLI_UPSTREAM_H
#define CLI_UPSTREAM_H

/* Pipelines that differ in the realisations alone. */
struct upstream_run {
	char *before, *after; /* of the numbers; after is NULL if there are none */
	long long first, count;
};

struct upstream {
	int n, room;
	struct upstream_run *run;
	char *cmd; /* of upstream_cmd() */
};

void upstream_add(struct upstream *u, const char *cmd);
/* Valid until the next call with u; NULL without any. */
const char *upstream_cmd(struct upstream *u);
void upstream_free(struct upstream *u);

#endif
