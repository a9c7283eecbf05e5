/* search.h - the best positions of a given number of coils
 *
 * The standard error of the velocity is smallest if the sum of squares of the positions
 * is largest, with half of the coils at either end; matching requires short distances
 * between coils (match.h).
 *
 *	struct layout_par par = { .bound = { ... }, .traffic = { ... } };
 *	layout_evaluate(&par, coil, 2, &evaluated);
 *	layout_search(&par, 3, 0.5, 0.9, 32, coil, &evaluated);
 */
#ifndef LAYOUT_SEARCH_H
#define LAYOUT_SEARCH_H

#include "layout/match.h"
#include "num/status.h"

struct layout {
	struct bound bound; /* closed form */
	double unique;      /* probability of an unambiguous match */
	double by_width;    /* the same if the width of the first pulse is used */
	long evaluated;     /* number of layouts evaluated */
};

/* Positions ascend from the first; at most LAYOUT_COILS. */
void layout_evaluate(
	const struct layout_par *par, const double *coil, int coils, struct layout *out);

/* The best of coils >= 2 within extent, the first at 0, whose by_width is not below
 * least: first over all layouts on a grid of this many steps, then by repeatedly moving
 * coils by half the step.  NUM_DOMAIN where no layout of the grid is good enough. */
enum num_status layout_search(const struct layout_par *par, int coils, double extent,
	double least, int steps, double *coil, struct layout *out);

#endif
