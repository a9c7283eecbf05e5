/* patches.h - separate patches of a contact: area, perimeter, load, pressure quantiles
 *
 * Cells under pressure belong to one patch if they share a side, also across the edge of
 * a periodic grid.
 *
 * A grid overestimates the contact area, because cells along the boundary of a patch
 * count in full.  The true area is approximately the counted one minus (pi - 1 + ln 2) /
 * 24 cells per cell side along the perimeter (Yastrebov, Anciaux, Molinari, Tribol. Int.
 * 114 (2017) 161-171).
 */
#ifndef CONTACT_PATCHES_H
#define CONTACT_PATCHES_H

#include "num/status.h"
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

/* Finds the patches of a pressure, in the order of their first cells: *list is a new
 * array for free(), NULL if there are none. */
enum num_status contact_patches(const struct patch_grid *grid, const double *pressure,
	struct contact_patch **list, size_t *n);

/* The corrected area for this counted area and perimeter; not below 0. */
double contact_corrected_area(
	const struct patch_grid *grid, double area, double perimeter);

/* From this share of the load on the outermost cells on, the contact is mostly with what
 * the grid has cut off. */
#define CONTACT_EDGE_MOST 0.5

/* Share of the load on the outermost cells; 0 on a periodic grid, which has no edge. */
double contact_edge_load(const struct patch_grid *grid, const double *pressure);

/* Quantiles of the pressure of the cells in contact at the levels part, interpolated.
 * nan without contact. */
enum num_status contact_quantiles(const double *pressure, size_t cells,
	const double *part, double *quantile, int n);

#endif
