/* tally.h - sums over the cells of a body, and what they tell of its size and place
 *
 * A body is made of runs, cells [begin, end) of a row, and of bodies added to it.  Its
 * frame may lie whole periods off the grid; only first[] is on it.
 */
#ifndef CONTACT_TALLY_H
#define CONTACT_TALLY_H

#include "debris/particles.h"

/* The sums are of coordinates from the low corner, so that a body has the same ones
 * wherever it lies; they are exact as long as they are below 2^53. */
struct tally {
	double nodes, sum[3];
	double square[6];    /* sums of xx yy zz xy xz yz */
	double faces[3];     /* exposed, across x, y, z */
	int low[3], high[3]; /* cells, inclusive */
	int first[3];        /* address on the grid */
	int winds[2];        /* goes round the periodic grid along x, y: without end */
};

struct tally tally_run(int begin, int end, int y, int z);
void tally_shift(struct tally *t, int dx, int dy);
/* other lies in the frame of t; faces between the two are the caller's to take away. */
void tally_add(struct tally *t, const struct tally *other);

/* Whether address a comes before b: by layer, row and place in it. */
int tally_precedes(const int a[3], const int b[3]);

/* All of a particle but what its convex hull tells: length, width, aspect, convexity. */
void tally_measure(
	const struct tally *t, const struct particles_par *grid, struct particle *p);

#endif
