/* upstream.h - the pipelines that made the parts of a table, written as one
 *
 *	struct upstream u = { 0 };
 *	upstream_add(&u, "roughgen --points 64 --first 0 | bemcontact");
 *	upstream_add(&u, "roughgen --points 64 --first 1 | bemcontact");
 *	upstream_cmd(&u);       "roughgen --points 64 --first 0 --count 2 | bemcontact"
 *
 * What follows in the numbers of the realisations is counted; pipelines that differ in
 * anything else stand in a group, "{ a; b; }", whose output is the parts as cat joins
 *them.
 */
#ifndef SHELL_UPSTREAM_H
#define SHELL_UPSTREAM_H

/* Pipelines that differ in the number of the realisation alone. */
struct upstream_run {
	char *before, *after;   /* of the number; after is NULL where there is none */
	long long first, count; /* numbers */
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
