/* mlms.h - multi-level multi-summation: sums of a kernel over all cells without
 * transforms
 *
 * y_i = sum over j of K(i - j) x_j on a grid, where K is even, singular only at its
 * centre and smoother with distance from it.  Far from the centre K is interpolated from
 * every second cell.  Sources are therefore gathered on a grid of half as many cells in
 * each direction, and sums interpolated from it, recursively down to a few cells, which
 * are summed directly.  Within reach times the longest spacing from which it is
 * interpolated the error is corrected on each level, in either direction.  Long cells are
 * first halved along their short sides alone.  The work is one pass over the non-zero
 * sources, with (2 reach + 1)^2 additions for each, and a few passes over the cells.  The
 * error decreases with order (of the interpolation) and reach.
 *
 * Brandt, Lubrecht, J. Comput. Phys. 90 (1990) 348-370; Polonsky, Keer, Wear 231 (1999)
 * 206-219.
 *
 *	struct mlms *m = mlms_new(nx, ny, dy / dx, 6, 6, value, context, NULL);
 *	mlms_apply(m, x, y);
 */
#ifndef CONTACT_MLMS_H
#define CONTACT_MLMS_H

#include "num/pool.h"
#include <stddef.h>

struct mlms;

/* aspect: dy / dx; order 2..12, even; reach >= 1 cells; value is K at an offset in cells
 * of the finest grid, which may be larger than the grid.  pool is borrowed.  NULL when
 * out of memory.
 */
struct mlms *mlms_new(size_t nx, size_t ny, double aspect, int order, int reach,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context,
	struct pool *pool);
void mlms_free(struct mlms *m);

/* y = K * x; byte-identical for any number of threads.  y must not be x. */
void mlms_apply(struct mlms *m, const double *x, double *y);

#endif
