/* solver.h - frictionless contact of a rough surface with a flat on a half-space
 *
 * Two elastic half-spaces with combined height h meet; per cell, with pressure p,
 * elastic displacement u = K p and gap g,
 *
 *	g = u - h - approach;   g >= 0, p >= 0, p g = 0      (2-5)
 *
 * With a hardness H the pressure stops at p = H, where g <= 0 is the depth of plastic
 * flow.  K is the half-space of Love's uniformly loaded cells on an otherwise free
 * surface, or the exact periodic kernel 2 / (E* |q|) with mean displacement zero.
 *
 * Units are SI.  Fields are row-major, field[iy * nx + ix]; heights grow towards the
 * other body; pressure is positive in compression; displacement is positive where
 * the surface is pushed in; approach is how far the flat has moved past the plane
 * height = 0 (from first touch it is approach + max h).
 *
 * The result is a function of the arguments alone: the same bytes for any number of
 * threads and whatever was solved before with the same struct contact.  Plans,
 * kernels and memory are kept over calls, so use one struct for an ensemble.
 *
 *	struct contact_par par = { .nx = 512, .ny = 512, .dx = 1e-6, .dy = 1e-6,
 *		.estar = 115e9, .tolerance = 1e-8, .max_iterations = 1000 };
 *	struct contact *c = contact_new(&par);
 *	memset(p, 0, n * sizeof(*p));
 *	if (contact_solve(c, h, CONTACT_PRESSURE, 21e6, p, NULL) == CONTACT_OK)
 *		printf("%g\n", contact_result(c)->area);
 *	contact_free(c);
 *
 * Polonsky, Keer, Wear 231 (1999) 206-219; Vollebregt, JOTA 2014 (bound-constrained
 * conjugate gradients); Stanley, Kato, J. Tribol. 119 (1997) 481-485 (periodic).
 */
#ifndef CONTACT_SOLVER_H
#define CONTACT_SOLVER_H

#include "contact/kernel.h"
#include "num/pool.h"

struct contact;

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

/* NULL if a parameter is out of range (errno EDOM) or memory is short (ENOMEM). */
struct contact *contact_new(const struct contact_par *par);
void contact_free(struct contact *c);

/* Solves for pressure and gap (may be NULL), nx * ny each.  On entry pressure is
 * the first guess, of any scale; all zeros for none.  A good guess saves time and
 * changes the result within the tolerance only. */
enum contact_status contact_solve(struct contact *c, const double *height,
	enum contact_control control, double target, double *pressure, double *gap);

/* Elastic displacement under a pressure. */
void contact_displacement(
	struct contact *c, const double *pressure, double *displacement);

const struct contact_result *contact_result(const struct contact *c);

#endif
