/* stress.h - stress below a surface loaded by pressure and friction, depth by depth
 *
 * Sums the influence of every loaded cell (2-6) at the nodes below the cell centres.  The
 * surface carries pressure p, interpolated between the cell centres, and the shear mu p
 * along +x or +y.
 *
 * On a free surface there is no load outside the grid; on a periodic one the pressure is
 * the Fourier series through the cell centres, and the mean lateral strain is zero.
 *
 * Units are SI, fields row-major [iy * nx + ix], tension positive; see stress_kernel.h.
 * Results depend on the arguments alone, not on previous calls or the number of threads.
 *
 *	struct stress_par par = { .nx = 128, .ny = 128, .dx = 8e-6, .dy = 8e-6,
 *		.nu = 0.3, .mu = 0.3 };
 *	struct stress *s = stress_new(&par);
 *	struct stress_span *span = malloc(stress_spans_max(s) * sizeof *span);
 *	stress_load(s, p);
 *	n = stress_reach(s, 0, yield, span);
 *	stress_at(s, 0, span, n, equivalent);
 */
#ifndef STRESS_STRESS_H
#define STRESS_STRESS_H

#include "num/pool.h"
#include "num/status.h"
#include "stress/criterion.h"
#include "stress/span.h"

#include <stddef.h>

struct stress;

/* Sums on points as coarse as the depth allows (free_sum.h, wave_sum.h: within 5e-6 of
 * the largest pressure), or on all cells, for verification. */
enum stress_method { STRESS_COARSE, STRESS_FULL };

struct stress_par {
	int nx, ny;    /* cells */
	double dx, dy; /* cell size, m */
	double nu, mu; /* Poisson's ratio, shear over pressure (either sign) */
	int axis;      /* shear along x (0) or y (1) */
	int periodic;
	enum stress_method method;
	const struct stress_criterion *criterion; /* NULL: von Mises */
	struct pool *pool;                        /* borrowed; NULL: one thread */
};

/* Work done since stress_new(). */
struct stress_work {
	double transforms;   /* Fourier transforms of any size */
	double kernel_cells; /* influence coefficients evaluated */
	double full_layers;  /* summed on all cells */
	double split_layers; /* summed on coarser points and, at short range, on the cells
			      */
	double coarse_layers; /* summed only on coarser points */
	double nodes;         /* at which stress was requested */
};

/* NULL with errno EDOM (a parameter out of range) or ENOMEM. */
struct stress *stress_new(const struct stress_par *par);
void stress_free(struct stress *s);

/* Sets the pressure (nx * ny, finite; borrowed until the next call); NUM_DOMAIN if it is
 * not finite. */
enum num_status stress_load(struct stress *s, const double *pressure);

/* Runs of cells of that pressure that is not zero, row by row; valid until the next
 * call. */
const struct stress_span *stress_loads(const struct stress *s, size_t *count);

/* Finds spans of nodes whose equivalent stress at depth z may exceed limit; all other
 * nodes are below the limit at this and every greater depth.  span has room for
 * stress_spans_max().  The bound is a sum of the equivalent stresses of blocks of loads,
 * or of waves (criterion.h). */
size_t stress_reach(struct stress *s, double z, double limit, struct stress_span *span);
size_t stress_spans_max(const struct stress *s);
/* The same on the surface alone, where the bound is lower: below it other nodes may
 * exceed the limit. */
size_t stress_reach_surface(struct stress *s, double limit, struct stress_span *span);

/* Asymptotic equivalent stress below the centre of the load at depths of many grid
 * lengths: that of a point load, or of the mean load if periodic. */
double stress_deep(const struct stress *s, double z);

/* Equivalent stress at depth z at the nodes of the spans: value[iy * nx + ix]. */
enum num_status stress_at(struct stress *s, double z, const struct stress_span *span,
	size_t count, double *value);

/* The nodes of the spans where it exceeds limit on the surface, in any order; node has
 * room for all that the spans hold. */
struct stress_node {
	int ix, iy;
	double value;
};
enum num_status stress_above(struct stress *s, double limit,
	const struct stress_span *span, size_t count, struct stress_node *node,
	size_t *found);

/* The whole tensor on the whole grid: six fields xx yy zz xy xz yz of nx * ny each, one
 * after another. */
enum num_status stress_tensor(struct stress *s, double z, double *tensor);

struct stress_work stress_work(const struct stress *s);

#endif
