/* edge.h - shares of a load or volume on the edge of a free grid: how many, and the worst
 *
 * A contact that reaches the edge of its grid is cut off there.
 */
#ifndef COMMON_EDGE_H
#define COMMON_EDGE_H

struct edge {
	long steps, realisation, step;
	double most;
};

/* Counts a share above the limit. */
void edge_note(struct edge *e, double share, double limit, long realisation, long step);

/* The same for the share of the load on the outermost cells; 1 where these carry most of
 * it: the result is doubtful. */
int edge_load_note(struct edge *e, double share, long realisation, long step);

/* Warns once of what was noted; name: of the input. */
void edge_load_warn(const struct edge *e, const char *name);

#endif
