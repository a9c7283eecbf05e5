/* material.h - pulses of spheres of a material: magnetic moment of a conducting sphere in
 * an alternating field, and ferrous or not by the phase of a pulse
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
#ifndef SIGNAL_MATERIAL_H
#define SIGNAL_MATERIAL_H

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

/* Ferrous or not: a sphere of a material with a pulse as high as that of a ferrous
 * sphere of a given size has one diameter and one phase.  With a normal error of the
 * phase, and shares of the materials among pulses of this height,
 *
 *	P(ferrous | phase) = F / (F + N)
 *
 * by Bayes' rule, F and N the sums of share exp(-(phase - theirs)^2 / (2 se^2)) over the
 * ferrous materials and over the others.
 */

/* Permeability high enough for half the pulse of the limit, or more. */
int classify_is_ferrous(const struct material *material);

/* Diameter of the ferrous sphere whose pulse is as high as that of a sphere of this
 * material and diameter, and its inverse, by bisection: the height grows with the
 * diameter.  m, Hz. */
double classify_equivalent(const struct material *m, double diameter, double frequency);
double classify_diameter(const struct material *m, double equivalent, double frequency);

/* Probability that a pulse is of a ferrous one of n materials.  size: of the ferrous
 * sphere with a pulse as high, m; phase in rad, 0: of ferrous spheres without currents;
 * frequency in Hz.  NAN where the phase is farther than four standard errors from that of
 * any material, or where size, phase or standard error is not a positive or finite
 * number. */
double classify_ferrous(const struct material *const *material, const double *share,
	int n, double size, double phase, double phase_se, double frequency);

#endif
