/* lattice.h - coarse points among cells: loads spread onto them, fields taken from them
 *
 * Along each axis a point lies every spacing cells.  A field on the points is
 * interpolated at a cell centre by polynomials of degree 7 through the eight points
 * around it; loads are spread by the same weights.  The cells may be those of a surface,
 * whose loads are averaged over their elements, or the points of a finer lattice.
 */
#ifndef STRESS_LATTICE_H
#define STRESS_LATTICE_H

#include "num/pool.h"
#include "stress/span.h"

struct lattice;

/* Points along an axis of so many cells; wrap: the axis is periodic and its points are
 * spread evenly.  The points lie alike seen from either end. */
struct lattice_axis {
	int cells, points;
	double spacing; /* of points, in cells */
	int wrap;
};

/* For cells of a free axis, a point every spacing of them. */
struct lattice_axis lattice_free(int cells, int spacing);
struct lattice_axis lattice_periodic(int cells, int points);
/* Of the first point, in cells from the centre of the first cell. */
double lattice_origin(const struct lattice_axis *axis);

/* NULL when out of memory. */
struct lattice *lattice_new(
	const struct lattice_axis *x, const struct lattice_axis *y, struct pool *pool);
void lattice_done(struct lattice *l);

/* Adds the loads of the cells, rows of stride, to load[points of y][points of x];
 * element: they are those of elements. */
void lattice_spread(const struct lattice *l, const double *cell, size_t stride,
	int element, double *load);

/* Adds a field on the points to one on all cells[cells of y][cells of x].  -1 when out of
 * memory. */
int lattice_refine(const struct lattice *l, const double *field, double *cell);

/* Fields field[c][points of y][points of x] at the nodes wanted, whose coordinates count
 * from (x0, y0), plus more[c] (NULL: nothing) on the cells themselves, rows of stride
 * from cell (x0, y0) on. */
int lattice_gather(const struct lattice *l, double *const *field, double *const *more,
	size_t stride, int x0, int y0, const struct stress_want *want);

#endif
