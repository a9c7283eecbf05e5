/* groove.h - grooves along x cut into heights on a grid
 *
 * Heights along the groove are lowered by the mean depth of the groove over each cell,
 * so that the removed volume does not depend on the grid.  A part of it may be displaced
 * into two ridges, each half as wide as the groove. The grid is periodic: a groove that
 * leaves it continues on the opposite side.
 *
 *	struct groove g = { .x = 0, .y = 5e-5, .length = 1e-3, .diameter = 1e-5,
 *		.depth = 1e-6, .cut = 0.5 };
 *	groove_cut(nx, ny, dx, dy, z, &g);
 */
#ifndef ABRASION_GROOVE_H
#define ABRASION_GROOVE_H

struct groove {
	double x, y;     /* where it begins, m from the corner of the first cell */
	double length;   /* along x, m */
	double diameter; /* of the sphere, m */
	double depth;    /* at most diameter / 2, m */
	double cut;      /* share of its volume that leaves the surface, [0, 1] */
};

/* Returns the number of heights changed. */
double groove_cut(
	int nx, int ny, double dx, double dy, double *z, const struct groove *g);

#endif
