/* mlms.h - multi-level multi-summation: sums of a kernel over all cells without Fourier
 *
 * y_i = sum over j of K(i - j) x_j on a grid, K even, singular only at its centre and
 * ever smoother away from it.  Far from the centre K is interpolated from every second
 * cell, so sources are gathered on, and sums spread from, a grid half as fine, and so on
 * down to a few cells, which are summed directly; near the centre, within reach cells,
 * what interpolation misses is added on each level.  The work is one pass over the
 * sources that are not zero, (2 reach + 1)^2 additions for each, and a few over the
 * cells.  The error falls with order (of the interpolation) and reach.
 *
 * Brandt, Lubrecht, J. Comput. Phys. 90 (1990) 348-370; Polonsky, Keer, Wear 231 (1999)
 * 206-219.
 *
 *	struct mlms *m = mlms_new(nx, ny, 6, 6, value, context, NULL);
 *	mlms_apply(m, x, y);
 */
#ifndef CONTACT_MLMS_H
#define CONTACT_MLMS_H

#include "num/pool.h"
#include <stddef.h>

struct mlms;

/* order 2..12, even; reach >= 1 cells; value is K at an offset in cells of the finest
 * grid, which may be larger than the grid.  pool is borrowed.  NULL when out of memory.
 */
struct mlms *mlms_new(size_t nx, size_t ny, int order, int reach,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context,
	struct pool *pool);
void mlms_free(struct mlms *m);

/* y = K * x; the same bytes for any number of threads.  y is not x. */
void mlms_apply(struct mlms *m, const double *x, double *y);

#endif
