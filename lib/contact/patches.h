/* patches.h - the separate patches of a contact and what is read off them
 *
 * Cells under pressure belong to one patch where they share a side, across the edge of
 * the grid where it is periodic.
 *
 * A grid shows too much contact: cells along the rim count whole.  The true area is about
 * the counted one less (pi - 1 + ln 2) / 24 times the perimeter in sides of cells times
 * the cell (Yastrebov, Anciaux, Molinari, Tribol. Int. 114 (2017) 161-171).
 */
#ifndef CONTACT_PATCHES_H
#define CONTACT_PATCHES_H

#include <stddef.h>

struct patch_grid {
	int nx, ny;
	double dx, dy; /* m */
	int periodic;
};

struct contact_patch {
	double cells;
	double area;      /* m2, as counted */
	double perimeter; /* m, along the sides of cells */
	double load;      /* N */
	double peak;      /* largest pressure, Pa */
	double x, y;      /* centre of the load from the grid's corner, m */
};

/* Finds the patches of a pressure, in the order of their first cells.  Returns their
 * number and a new array for free(); NULL and 0 where there are none, with errno ENOMEM
 * when out of memory, 0 otherwise. */
struct contact_patch *contact_patches(
	const struct patch_grid *grid, const double *pressure, size_t *n);

/* The area of cells of this size, less what their rim counts too much; not below 0. */
double contact_corrected_area(
	const struct patch_grid *grid, double area, double perimeter);

/* Pressures below which the given parts of the cells in contact lie, interpolated;
 * returns 0, or -1 when out of memory.  nan without contact. */
int contact_quantiles(const double *pressure, size_t cells, const double *part,
	double *quantile, int n);

#endif
