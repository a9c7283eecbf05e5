/* wander.h - a pair of slow random processes
 *
 * Two independent Ornstein-Uhlenbeck processes of variance 1 and correlation exp(-t /
 * time), exact at knots and linear between them.  Times must not decrease.
 */
#ifndef SIGNAL_WANDER_H
#define SIGNAL_WANDER_H

#include "num/normals.h"

struct wander {
	const struct normals *normals;
	uint64_t place;     /* of its numbers in their stream */
	double step;        /* from knot to knot, s */
	uint64_t knot;      /* to the left of the present time */
	double part;        /* of the way to the next one */
	double value[2][2]; /* [left, right][process] */
};

/* Begins at time 0, with a correlation time above 0. */
void wander_start(
	struct wander *w, const struct normals *normals, uint64_t place, double time);
/* Moves to time t >= 0, s. */
void wander_move(struct wander *w, double t);
double wander_value(const struct wander *w, int process);

#endif
