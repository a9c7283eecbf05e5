/* slip.h - partial slip: a tangential load below friction, after the normal one
 *
 * Bodies in contact under a normal load N that then bear a tangential load T < mu N
 * stick in one part of the contact and slip in the other, where the shear is mu p; at
 * T = mu N, but for rounding, all of it slips.  For normal displacements that shear does
 * not disturb (Dundurs' beta = 0, as for equal materials) and a tangential compliance in
 * proportion to the normal one,
 *
 *	q = mu (p - p'),   T = mu (N - N')
 *
 * with p' the normal pressure under N': what is in contact under N' sticks.  Jaeger,
 * J. Tribol. 120 (1998) 677-684; Ciavarella, J. Appl. Mech. 65 (1998) 998-1003.
 * Exact in plane strain and for Poisson's ratio 0; otherwise shear also displaces across
 * its direction, which is neglected as Cattaneo and Mindlin do.  A wave of shear at the
 * angle t to its direction displaces (1 - nu cos^2 t) / (1 - nu) times as much as one of
 * pressure; cos^2 t is averaged over the energy.
 *
 * Units are SI; fields as in solver.h.
 */
#ifndef CONTACT_SLIP_H
#define CONTACT_SLIP_H

#include "contact/solver.h"
#include "num/status.h"

/* The two bodies: Young's moduli, Pa, and Poisson's ratios. */
struct slip_bodies {
	double young[2], poisson[2];
};

/* 1 if shear does not change the gap: (1 - 2 nu) / G is the same for both. */
int slip_uncoupled(const struct slip_bodies *b);
/* Tangential over normal compliance, where along is the mean of cos^2 t: E* / 2 times the
 * sum of (1 - along nu) / G.  For circles along is 1/2, and equal materials have
 * (2 - nu) / (2 (1 - nu)) (Johnson, Contact Mechanics, 7.42). */
double slip_compliance(const struct slip_bodies *b, double along);

struct slip_result {
	double load;         /* tangential, N */
	double displacement; /* mu (d - d') of the indentations, m: slip_compliance()
			      * times this is that of the bodies far away */
	double stick;        /* cells that stick over all cells */
};

/* Shear under the mean shear stress (T over the grid, Pa, at most mu times the mean
 * pressure) on top of a pressure that was solved for on this height, without a hardness;
 * normal: what was found then.  Leaves contact_result() of the pressure p'.
 * CONTACT_OVERLOAD: the tangential load exceeds friction, nothing done. */
enum contact_status contact_slip(struct contact *c, const double *height,
	const double *pressure, const struct contact_result *normal, double mu,
	double mean_shear, double *shear, struct slip_result *result);

/* The mean of cos^2 t of a shear, 1/2 if it is 0; for a half-space. */
enum num_status slip_along(struct contact *c, const double *shear, double *along);

#endif
