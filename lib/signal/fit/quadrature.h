/* quadrature.h - the second component of a demodulated record and the phases of its
 * pulses
 *
 * A demodulator with two outputs gives each sensor a complex signal; its two components,
 * turned by a phase, are x, and v, in quadrature with it.  In x nearly all pulses are
 * positive, and the joint fit (joint.h) finds them there; in v pulse k has any amplitude
 * b_k, the same arrivals and the same length.  From the result of the joint fit
 * Gauss-Newton steps on all four channels lead to the least-squares estimates of
 * arrivals, a_k and b_k together, with their inverse Fisher matrix.
 *
 * The noise of x and v of a sensor may differ in size and may be correlated.
 */
#ifndef SIGNAL_QUADRATURE_H
#define SIGNAL_QUADRATURE_H

#include "num/status.h"
#include "signal/fit/joint.h"

/* Of each sensor: noise of v over that of x, and their correlation. */
struct quadrature {
	double noise[2], correlation[2];
};

/* One pulse: its complex amplitude is a + i b, in units of the noise of x. */
struct quadrature_pulse {
	double t, delta, a, b;
	double cov[4][4]; /* of t, t + delta, a, b */
};

/* From n samples of x and v. */
enum num_status quadrature_measure(struct quadrature *q, const double *const x[2],
	const double *const v[2], size_t n);

/* After a joint fit of the m pulses to x, or of others to the same samples, with chi2 per
 * degree of freedom: fits them to x and v, either in units of its noise, and leaves no
 * fit in joint.  *doubt: 1 if the residual of v exceeds that of x and of noise.
 * NUM_DOMAIN: the pulses cannot be separated; out is undefined then. */
enum num_status quadrature_fit(const struct quadrature *q, struct joint *joint,
	const struct joint_scene *scene, const double *const x[2],
	const double *const v[2], const struct joint_pulse *pulse, int m, double chi2,
	struct quadrature_pulse *out, int *doubt);

#endif
