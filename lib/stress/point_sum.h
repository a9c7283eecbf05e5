/* point_sum.h - equivalent stress at single points below a loaded part of a free surface
 *
 * For a few points a direct sum over the loaded cells is cheaper than a layer
 * (free_sum.h). Cells nearby are summed as elements, others as point loads, and blocks of
 * 8 x 8 cells that are farther away than three of their sides as one load at its
 * centroid: within 3 % of the largest pressure at the surface, within 1 % of the stress
 * deeper than one cell.
 */
#ifndef STRESS_POINT_SUM_H
#define STRESS_POINT_SUM_H

#include "stress/stress.h"

struct point_sum;

struct point_sum *point_sum_new(const struct stress_par *par); /* NULL: no memory */
void point_sum_free(struct point_sum *s);
/* Takes a pressure, borrowed until the next one. */
void point_sum_load(struct point_sum *s, const double *pressure);
/* Below the centre of a cell (y * nx + x), at depth z > 0. */
double point_sum_at(const struct point_sum *s, size_t cell, double z);

#endif
