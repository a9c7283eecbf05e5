/* free_sum.h - stress below a loaded part of an otherwise free half-space
 *
 * Multilevel summation.  The stress at depth z is smooth on a length of about z, so it is
 * summed on points as far apart as the depth allows: loads are distributed onto them, and
 * the stress is interpolated at the nodes.  The influence is split by smooth windows
 * whose radius doubles from level to level: the part inside a window is summed at short
 * range on the points, the rest on points twice as far apart.  Near the surface the
 * innermost window is summed on the cells.  Work and memory are proportional to the
 * number of cells.  The error is below 5e-6 of the largest pressure
 * (tests/unit/stress.c).
 *
 * The full sum over all cells is for small grids, for elongated cells, and for
 * verification.
 */
#ifndef STRESS_FREE_SUM_H
#define STRESS_FREE_SUM_H

#include "num/pool.h"
#include "num/status.h"
#include "stress/influence.h"
#include "stress/span.h"

struct free_sum;

struct sum_work {
	double transforms;    /* Fourier transforms of any size */
	double kernel_cells;  /* influence coefficients evaluated */
	double full_layers;   /* summed on all cells */
	double coarse_layers; /* summed only on coarser points */
	double split_layers; /* summed on coarser points and, at short range, on the cells
			      */
};

/* full: the full sum at any size.  pool is borrowed.  NULL when out of memory. */
struct free_sum *free_sum_new(
	const struct influence_par *par, int nx, int ny, int full, struct pool *pool);
void free_sum_free(struct free_sum *s);

/* Sets the pressure and the runs of its cells that are loaded, row by row, both borrowed
 * until the next call; the loads are scale times it, and none is outside the box. */
void free_sum_load(struct free_sum *s, const double *pressure, double scale,
	const struct stress_span *loads, size_t count, const struct stress_box *box);
/* Stress at depth z. */
enum num_status free_sum_at(struct free_sum *s, double z, const struct stress_want *want);

struct sum_work free_sum_work(const struct free_sum *s);

#endif
