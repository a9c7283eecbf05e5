/* grid_error.h - how far the volume of a step depends on the grid: the step on coarser
 * ones
 */
#ifndef GRID_ERROR_H
#define GRID_ERROR_H

#include "contact/solver.h"
#include "debris/debris.h"
#include "outputs.h"

/* Presses and wears c on grids of twice and four times the spacing, whose heights are
 * means over their cells, and extrapolates the volume that was lost on its own grid.  0
 * where a contact did not converge. */
int grid_error_find(const struct worn_surface *c, const struct contact_par *pressing,
	const struct debris_par *wear, enum contact_control control, double target,
	double volume, struct grid_error *found);

#endif
