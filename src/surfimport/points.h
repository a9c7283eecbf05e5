/* points.h - rows of x, y and z as points of a grid, in any order */
#ifndef POINTS_H
#define POINTS_H

#include <stddef.h>

enum points {
	POINTS_NONE, /* heights rather than positions, or scattered points */
	POINTS_FEW,  /* each of a grid, as so few heights may be by chance */
	POINTS_PART, /* half or more of a grid, but not all */
	POINTS_FULL  /* each of a grid, once */
};

struct grid {
	size_t nx, ny;
	double dx, dy; /* in units of the positions */
	size_t *at;    /* iy * nx + ix of each row; to be freed */
};

/* Of n rows, whose first two numbers may be equally spaced positions: to a fiftieth of a
 * step, as they may be rounded. */
enum points points_find(const double *row, size_t n, size_t columns, struct grid *grid);

#endif
