/* stress.h - stress below a surface loaded by pressure and friction, depth by depth
 *
 * Sums the influence of every loaded cell (2-6) at the nodes below the cell centres.  The
 * surface carries pressure p, interpolated between the cell centres, and the shear mu p
 * along +x or +y.
 *
 * On a free surface the grid is all that is loaded; on a periodic one the pressure is the
 * Fourier series through the cell centres, repeated for ever, and the mean lateral strain
 * is zero.
 *
 * Units are SI, fields row-major [iy * nx + ix], tension positive; see stress_kernel.h.
 * Results depend on the arguments alone, not on what was computed before or on threads.
 *
 *	struct stress_par par = { .nx = 128, .ny = 128, .ax = 8e-6, .ay = 8e-6,
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
#include "stress/criterion.h"
#include "stress/span.h"

#include <stddef.h>

struct stress;

/* Sums on points as coarse as the depth allows (free_sum.h, wave_sum.h: within 3e-4 of
 * the largest pressure), or on all cells, which is to compare with. */
enum stress_method { STRESS_COARSE, STRESS_FULL };

struct stress_par {
	int nx, ny;    /* cells */
	double ax, ay; /* cell size, m */
	double nu, mu; /* Poisson's ratio, shear over pressure (either sign) */
	int axis;      /* shear along x (0) or y (1) */
	int periodic;
	enum stress_method method;
	const struct stress_criterion *criterion; /* NULL: von Mises */
	struct pool *pool;                        /* borrowed; NULL: one thread */
};

/* Work done since stress_new(). */
struct stress_work {
	double transforms;    /* Fourier transforms of any size */
	double kernel_cells;  /* influence coefficients evaluated */
	double full_layers;   /* summed on all cells */
	double split_layers;  /* on coarser points, and nearby on the cells */
	double coarse_layers; /* on coarser points alone */
	double nodes;         /* at which a stress was wanted */
};

/* NULL with errno EDOM (a parameter out of range) or ENOMEM. */
struct stress *stress_new(const struct stress_par *par);
void stress_free(struct stress *s);

/* Takes a pressure (nx * ny, finite; kept until the next call); -1 if it is not finite.
 */
int stress_load(struct stress *s, const double *pressure);

/* Spans of nodes whose equivalent stress at depth z may exceed limit; all others are
 * below it for certain, and remain so at every greater depth.  span has room for
 * stress_spans_max().  The bound adds up the equivalent stress of loads block by block,
 * or of waves (criterion.h). */
size_t stress_reach(struct stress *s, double z, double limit, struct stress_span *span);
size_t stress_spans_max(const struct stress *s);

/* Equivalent stress in the middle below the load as it would be many times deeper than
 * the grid is long: of a point load, or of the mean load if periodic. */
double stress_deep(const struct stress *s, double z);

/* Equivalent stress at depth z at the nodes of the spans: value[iy * nx + ix].  -1 when
 * out of memory. */
int stress_at(struct stress *s, double z, const struct stress_span *span, size_t count,
	double *value);

/* The whole tensor on the whole grid: six fields xx yy zz xy xz yz of nx * ny each, one
 * after another.  -1 when out of memory. */
int stress_tensor(struct stress *s, double z, double *tensor);

struct stress_work stress_work(const struct stress *s);

#endif
