/* polarisability.h - magnetic moment of a conducting sphere in an alternating field
 *
 * A sphere of radius a, relative permeability mu and conductivity sigma in a uniform
 * field H0 exp(i w t) has the moment m = 2 pi a^3 beta H0,
 *
 *	beta = (2 (mu - 1) + u) / (mu + 2 - u)
 *
 *	u = x^2 / (5 - x^2 / (7 - x^2 / (9 - ...)))
 *
 *	x = (1 - i) a / delta,   delta = (pi f mu0 mu sigma)^(-1/2)
 *
 * (Wait, J. R.: A conducting sphere in a time varying magnetic field, Geophysics 16,
 * 1951, with x cot x as a continued fraction, in which nothing cancels).  delta is the
 * skin depth.
 *
 *	slow or no currents   2 (mu - 1) / (mu + 2): at most 2, in phase
 *	mu = 1, slow          -(2 i / 15) s - (8 / 315) s^2,  s = (a / delta)^2
 *	fast                  -1
 *
 * The pulse of a ferrous particle is proportional to its volume; that of a non-ferrous
 * one smaller than the skin depth is proportional to f sigma d^5 and late by a quarter of
 * a turn.  The error is below 1e-13 of |beta|, that of the imaginary part below 1e-13 of
 * itself, for a / delta from 1e-8 to 1e8.  SI units.
 */
#ifndef SIGNAL_POLARISABILITY_H
#define SIGNAL_POLARISABILITY_H

struct polarisability {
	double re, im;
};

/* radius > 0, frequency >= 0, mu >= 1, sigma >= 0. */
struct polarisability sphere_polarisability(
	double radius, double frequency, double mu, double sigma);

/* Materials by name; NULL where there is none of this name, or no i-th one. */
struct material {
	const char *name;
	double mu;    /* relative permeability at small fields; INFINITY: the limit */
	double sigma; /* S/m at 20 C */
};

const struct material *material_find(const char *name);
const struct material *material_at(int i);

/* beta / 2 of a sphere of this diameter: its pulse over that of a sphere of the limit
 * mu = INFINITY, sigma = 0. */
struct polarisability material_response(
	const struct material *material, double diameter, double frequency);

#endif
