/* point_sum.h - equivalent stress at single points below a loaded part of a free surface
 *
 * For a few points a direct sum over the loaded cells is cheaper than a layer
 * (free_sum.h).  Cells nearby are summed as elements, others as point loads, and squares
 * of 4 x 4, 8 x 8, ... cells that are farther away than some of their sides as one load
 * at its centroid.  Below contacts of one to five cells radius this is within 1 % of the
 * largest pressure.  The depths form a geometric sequence, so that each element is
 * computed once for all points.  Points of one tile of 16 x 16 cells share the list of
 * what is far from it; calls in the order of rows make each list about once.
 */
#ifndef STRESS_POINT_SUM_H
#define STRESS_POINT_SUM_H

#include "num/status.h"
#include "stress/stress.h"

struct point_sum;

struct point_sum *point_sum_new(const struct stress_par *par); /* NULL: no memory */
void point_sum_free(struct point_sum *s);
/* Takes a pressure, borrowed until the next one, and the runs of its loaded cells, row by
 * row. */
enum num_status point_sum_load(struct point_sum *s, const double *pressure,
	const struct stress_span *loads, size_t count);
/* The depths, k = 0, 1, ...; above the first one is the surface, k = -1. */
double point_sum_depth(const struct point_sum *s, int k);
/* The last depth that is not below z; 0 where none is. */
int point_sum_above(const struct point_sum *s, double z);
/* Below the centre of a cell, at the depth k >= 0.  What depths have in common is found
 * once for calls that follow each other. */
double point_sum_at(struct point_sum *s, int ix, int iy, int k);
/* From now on, or no longer: sums with a tenth of the error, for tests of the others. */
void point_sum_take_care(struct point_sum *s, int careful);

#endif
