/* solver.h - frictionless contact of a rough surface with a flat on a half-space
 *
 * Contact of two elastic half-spaces with combined height h: in each cell, with pressure
 * p, elastic displacement u = K p and gap g,
 *
 *	g = u - h - approach;   g >= 0, p >= 0, p g = 0      (2-5)
 *
 * With a hardness H the pressure is limited to p = H, where g <= 0 is the plastic depth.
 * K is the half-space of Love's uniformly loaded cells on an otherwise free surface, or
 * the exact periodic kernel 2 / (E* |q|) with mean displacement zero.
 *
 * Units are SI.  Fields are row-major, field[iy * nx + ix]; heights are positive
 * towards the other body, pressure in compression, displacement into the body;
 * approach is the displacement of the flat past the plane height = 0 (measured from
 * first contact it is approach + max h).
 *
 * The result depends on the arguments alone: it is byte-identical for any number of
 * threads and after any previous calls with the same struct contact.  Plans, kernels
 * and memory are kept between calls, so use one struct for an ensemble.
 *
 *	struct contact_par par = { .nx = 512, .ny = 512, .dx = 1e-6, .dy = 1e-6,
 *		.estar = 115e9, .tolerance = 1e-8, .max_iterations = 1000 };
 *	struct contact *c = contact_new(&par);
 *	memset(p, 0, n * sizeof *p);
 *	if (contact_solve(c, h, CONTACT_PRESSURE, 21e6, p, NULL) == CONTACT_OK)
 *		printf("%g\n", contact_result(c)->area);
 *	contact_free(c);
 *
 * Polonsky, Keer, Wear 231 (1999) 206-219; Vollebregt, J. Optim. Theory Appl. 162
 * (2014) 931-953 (bound-constrained conjugate gradients); Stanley, Kato, J. Tribol. 119
 * (1997) 481-485 (periodic).
 */
#ifndef CONTACT_SOLVER_H
#define CONTACT_SOLVER_H

#include "contact/problem.h"

/* Largest useful tolerance: worn volumes of 24 rough surfaces are off by 0.05, 0.5, 2 and
 * 29 % in root mean square or less for tolerances of 1e-3, 1e-2, 0.1 and 0.5. */
#define CONTACT_LOOSEST 0.1

struct contact;

/* NULL if a parameter is out of range (errno EDOM) or memory is short (ENOMEM). */
struct contact *contact_new(const struct contact_par *par);
void contact_free(struct contact *c);

/* Solves for pressure and gap (may be NULL), nx * ny each.  On entry pressure is
 * the initial guess, of any scale, or all zeros.  The guess affects the run time, and
 * the result only within the tolerance. */
enum contact_status contact_solve(struct contact *c, const double *height,
	enum contact_control control, double target, double *pressure, double *gap);

/* Computes the elastic displacement under a pressure. */
void contact_displacement(
	struct contact *c, const double *pressure, double *displacement);

const struct contact_result *contact_result(const struct contact *c);

#endif
