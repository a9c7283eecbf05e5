/* stress.h - stress below a surface loaded by pressure and friction, layer by layer
 *
 * Sums the influence of every loaded cell (2-6) at the nodes below the cell centres, at
 * depth z = (layer + offset) dz: directly where few cells or few nodes are concerned, by
 * Fourier transform otherwise.  The surface carries pressure p and the shear mu p along
 * +x or +y.  Kernels are combined for both and kept from call to call, as far as the
 * memory allowed for them reaches.
 *
 * On a free surface the grid is all that is loaded; on a periodic one the pressure is the
 * Fourier series through the cell centres, repeated for ever, and the mean lateral strain
 * is zero.
 *
 * Units are SI, fields row-major [iy * nx + ix], tension positive; see stress_kernel.h.
 * Results depend on the arguments alone, not on what was computed before or on threads.
 *
 *	struct stress_par par = { .nx = 128, .ny = 128, .ax = 8e-6, .ay = 8e-6,
 *		.dz = 8e-6, .nu = 0.3, .mu = 0.3, .memory = 1 << 28 };
 *	struct stress *s = stress_new(&par);
 *	struct stress_span span[128];
 *	stress_load(s, p);
 *	n = stress_reach(s, 0, yield, span);
 *	stress_mises(s, 0, span, n, mises);
 */
#ifndef CONTACT_STRESS_H
#define CONTACT_STRESS_H

#include "num/pool.h"

#include <stddef.h>

struct stress;

/* How a layer is summed; the faster way is chosen from the numbers of loads and nodes. */
enum stress_method { STRESS_FASTER, STRESS_DIRECT, STRESS_FOURIER };

struct stress_par {
	int nx, ny;        /* cells */
	double ax, ay;     /* cell size, m */
	double dz, offset; /* depth of a layer is (layer + offset) dz, m */
	double nu, mu;     /* Poisson's ratio, friction coefficient */
	int axis;          /* shear along x (0) or y (1) */
	int periodic;      /* then always by transform */
	enum stress_method method;
	size_t memory;     /* bytes that kept kernels may take; 0: none is kept */
	struct pool *pool; /* borrowed; NULL: one thread */
};

/* Nodes [begin, end) of row y. */
struct stress_span {
	int y, begin, end;
};

/* Work done since stress_new(). */
struct stress_work {
	double transforms;     /* Fourier transforms of the padded grid */
	double kernel_cells;   /* influence coefficients evaluated, per component set */
	double direct_layers;  /* layers summed directly */
	double fourier_layers; /* layers by transform */
	double nodes;          /* nodes at which a stress was found */
};

/* NULL with errno EDOM (a parameter out of range) or ENOMEM. */
struct stress *stress_new(const struct stress_par *par);
void stress_free(struct stress *s);

/* Takes a pressure (nx * ny, finite; kept until the next call). */
int stress_load(struct stress *s, const double *pressure);

/* Spans of nodes whose von Mises stress at this layer may exceed limit; all others are
 * below it for certain, and remain so at every deeper layer.  span has room for
 * stress_spans_max().  The bound adds up the von Mises stress of loads block by block, or
 * of waves (a norm, so the triangle inequality holds). */
size_t stress_reach(struct stress *s, long layer, double limit, struct stress_span *span);
size_t stress_spans_max(const struct stress *s);

/* von Mises stress in the middle below the load as it would be at a layer many times
 * deeper than the grid is long: of a point load, or of the mean load if periodic. */
double stress_deep(const struct stress *s, long layer);

/* von Mises stress at the nodes of the spans (at least there); -1 when out of memory. */
int stress_mises(struct stress *s, long layer, const struct stress_span *span,
	size_t count, double *mises);

/* The whole tensor on the whole grid: six fields xx yy zz xy xz yz of nx * ny each, one
 * after another. */
int stress_tensor(struct stress *s, long layer, double *tensor);

struct stress_work stress_work(const struct stress *s);

#endif
