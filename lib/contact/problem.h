/* problem.h - what a contact problem is given by, and what its solution says of itself
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
	const struct contact_kernel *kernel; /* another body than its half-space, or NULL;
					      * what it points at must stay */
	double hardness;                     /* largest pressure, Pa; 0: none */
	enum contact_boundary boundary;
	enum contact_solver solver;
	enum contact_multiply multiply;
	double tolerance; /* certificate to reach */
	long max_iterations;
	struct pool *pool; /* borrowed; NULL: one thread */
};

enum contact_status {
	CONTACT_OK,
	CONTACT_NOCONV,   /* the fields hold the last iterate, of its certificate */
	CONTACT_OVERLOAD, /* mean pressure not below the hardness: nothing done */
	CONTACT_TOO_DEEP, /* periodic: approach beyond full contact: nothing done */
	CONTACT_NUMBERS   /* input not finite or over the range of doubles */
};

/* About the last solution. */
struct contact_result {
	double pressure;    /* mean, Pa */
	double load;        /* N */
	double approach;    /* m */
	double indentation; /* approach from first touch, m */
	double area;        /* cells with p > 0 over all cells */
	double plastic;     /* cells at the hardness over all cells */
	double energy;      /* elastic, J */
	/* sum p (g - min g) / sum p (u - u0), u0 the least displacement below zero or
	 * else 0: the relative duality gap, which needs no reference.  With C for it and
	 * W = sum p (u - u0), the energy sum p u / 2 - sum p h exceeds that of the
	 * solution p* by at most C W, and sum (p - p*) K (p - p*) is at most 2 C W,
	 * whatever the method; W is twice the elastic energy on a free boundary and a
	 * little more on a periodic one.  Nothing out of contact enters.  With a hardness
	 * it is the gap of the capped problem if that is less; for a given approach that
	 * of the approach less the deepest overlap, which is at most C W / sum p. */
	double certificate;
	long iterations; /* on the given grid */
	long transforms; /* Fourier transforms on the given grid, padded or not */
	double work;     /* the same with those of coarser grids, by size: in units of
			  * the half-space's, which on a free boundary are padded */
};

#endif
