/* lattice.h - a coarse lattice of points over cells: distribution of loads, interpolation
 *
 * Along each axis there is a point every spacing cells.  A field on the points is
 * interpolated at a cell centre by polynomials of degree 7 through the eight points
 * around it; loads are distributed with the same weights.  The cells are those of a
 * surface, whose loads are averaged over their elements, or the points of a finer
 * lattice.
 */
#ifndef STRESS_LATTICE_H
#define STRESS_LATTICE_H

#include "num/pool.h"
#include "num/status.h"
#include "stress/span.h"

struct lattice;

/* Points along an axis of cells; wrap: the axis is periodic and its points are equally
 * spaced.  The positions are symmetric about the centre of the axis. */
struct lattice_axis {
	int cells, points;
	double spacing; /* of points, in cells */
	int wrap;
};

/* A free axis with a point every spacing cells. */
struct lattice_axis lattice_free(int cells, int spacing);
struct lattice_axis lattice_periodic(int cells, int points);
/* Position of the first point, in cells from the centre of the first cell. */
double lattice_origin(const struct lattice_axis *axis);

/* NULL when out of memory. */
struct lattice *lattice_new(
	const struct lattice_axis *x, const struct lattice_axis *y, struct pool *pool);
void lattice_done(struct lattice *l);

/* Adds scale times the cells, rows of stride, to load[points of y][points of x]; element:
 * they are loads of elements. */
enum num_status lattice_spread(const struct lattice *l, const double *cell, size_t stride,
	double scale, int element, double *load);

/* The points from which the nodes of spans are interpolated, coordinates of both from
 * (x0, y0); a free lattice.  *points is to be freed. */
enum num_status lattice_points(const struct lattice *l, const struct stress_span *span,
	size_t count, int x0, int y0, struct stress_span **points, size_t *number);

/* Interpolates field[c][points of y][points of x] at the requested nodes, whose
 * coordinates are relative to (x0, y0).  Only the points of lattice_points() are read. */
enum num_status lattice_gather(const struct lattice *l, double *const *field, int x0,
	int y0, const struct stress_want *want);

/* The same for the nodes of a part at a time, whose sums are added.  The parts cover the
 * cells and may be taken by several threads at once. */
struct lattice_gather;
struct lattice_gather *lattice_gather_new(const struct lattice *l, double *const *field,
	int x0, int y0, const struct stress_want *want,
	const struct stress_want *points); /* NULL: no memory */
void lattice_gather_part(
	const struct lattice_gather *g, const struct stress_part *part, int worker);
/* The largest equivalent stress that is interpolated at the cells [x0, x1) of the rows
 * [y0, y1), for a request with a limit. */
double lattice_most(const struct lattice_gather *g, int x0, int x1, int y0, int y1);
void lattice_gather_free(struct lattice_gather *g);

#endif
