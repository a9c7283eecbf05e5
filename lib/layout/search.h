/* search.h - the best positions of a given number of coils
 *
 * The standard error of the velocity is smallest if the sum of squares of the positions
 * is largest, with half of the coils at either end; matching requires short distances
 * between coils.  A pulse is matched from each position to the next: at the second coil
 * within the window of the traffic, narrowed by the duration of the first pulse; at
 * later coils within the prediction of the coils so far.  A window extends three standard
 * errors to either side: two particles of equal velocity whose arrivals differ by less
 * cannot be told apart.
 *
 *	struct layout_par par = { .bound = { ... }, .traffic = { ... } };
 *	layout_evaluate(&par, coil, 2, &evaluated);
 *	layout_search(&par, 3, 0.5, 0.9, 32, coil, &evaluated);
 */
#ifndef LAYOUT_SEARCH_H
#define LAYOUT_SEARCH_H

#include "layout/bound.h"
#include "layout/traffic.h"
#include "num/status.h"

struct layout_par {
	struct bound_par bound;
	struct traffic traffic;
};

struct layout {
	struct bound bound; /* closed form */
	/* Bounds of the probability of an unambiguous match, equal for two positions. */
	double unique, unique_high;
	/* The same if the width of the first pulse is used. */
	double by_width, by_width_high;
	long evaluated; /* number of layouts evaluated */
};

enum { LAYOUT_COILS = 16 };

/* Positions ascend from the first; at most LAYOUT_COILS. */
void layout_evaluate(
	const struct layout_par *par, const double *coil, int coils, struct layout *out);

/* The best of coils >= 2 within extent, the first at 0, whose by_width is not below
 * least: first over all layouts on a grid of this many steps, then by repeatedly moving
 * coils by half the step.  NUM_DOMAIN where no layout of the grid is good enough. */
enum num_status layout_search(const struct layout_par *par, int coils, double extent,
	double least, int steps, double *coil, struct layout *out);

#endif
