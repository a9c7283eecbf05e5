/* problem.h - parameters of a contact problem, and the scalar results of its solution
 *
 * Units and signs as in solver.h.
 */
#ifndef CONTACT_PROBLEM_H
#define CONTACT_PROBLEM_H

#include "contact/kernel.h"
#include "num/pool.h"

enum contact_boundary { CONTACT_FREE, CONTACT_PERIODIC };

enum contact_solver {
	CONTACT_BCCG, /* preconditioned bound-constrained conjugate gradients */
	CONTACT_PK    /* Polonsky and Keer's single loop */
};

/* How the half-space is applied. */
enum contact_multiply {
	CONTACT_FFT, /* Fourier transforms: exact to rounding */
	CONTACT_MLMS /* multi-level multi-summation, free boundary: to some 5e-8 */
};

enum contact_control {
	CONTACT_PRESSURE, /* target is the mean pressure over the grid, Pa */
	CONTACT_APPROACH  /* target is the approach, m */
};

struct contact_par {
	int nx, ny;    /* cells, >= 1 each */
	double dx, dy; /* cell size, m */
	double estar;  /* contact modulus E*, Pa; see kernel_modulus() */
	const struct contact_kernel *kernel; /* in place of the half-space, or NULL;
					      * must outlive the solver */
	double hardness;                     /* largest pressure, Pa; 0: none */
	enum contact_boundary boundary;
	enum contact_solver solver;
	enum contact_multiply multiply;
	double tolerance; /* relative duality gap at which the iteration stops */
	long max_iterations;
	struct pool *pool; /* borrowed; NULL: one thread */
	/* Called in each iteration with an estimate of the share that is done; or NULL.
	 */
	void (*progress)(void *context, double share);
	void *context;
};

enum contact_status {
	CONTACT_OK,
	CONTACT_NOCONV,   /* not converged: the fields hold the last iterate */
	CONTACT_OVERLOAD, /* mean pressure not below the hardness: nothing done */
	CONTACT_TOO_DEEP, /* periodic: approach beyond full contact: nothing done */
	CONTACT_NUMBERS   /* input not finite or over the range of doubles */
};

/* About the last solution. */
struct contact_result {
	double pressure;    /* mean, Pa */
	double load;        /* N */
	double approach;    /* m */
	double indentation; /* approach from first contact, m */
	double area;        /* cells with p > 0 over all cells */
	double plastic;     /* cells at the hardness over all cells */
	double energy;      /* elastic, J */
	/* C = sum p (g - min g) / sum p (u - u0), where u0 is the least displacement or
	 * 0, whichever is less: the relative duality gap, a bound of the error that is
	 * computed from the pressure alone.  With W = sum p (u - u0), e = p - p* the
	 * error of the pressure, and any solver, the energy sum p u / 2 - sum p h exceeds
	 * its minimum by at most C W, and sum e K e is at most 2 C W.  W is twice the
	 * elastic energy on a free boundary and slightly more on a periodic one.  Cells
	 * out of contact do not contribute.  With a hardness it is the gap of the problem
	 * with bounded pressure if that is smaller; for a given approach it applies to
	 * the approach minus the deepest overlap, which is at most C W / sum p. */
	double optimality_gap;
	long iterations; /* on the given grid */
	long transforms; /* Fourier transforms on the given grid, padded or not */
	double work; /* transforms on all grids, weighted by size, in units of those of
		      * the half-space on the given grid (padded on a free boundary) */
};

#endif
