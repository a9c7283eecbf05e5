/* classify.h - ferrous or not, by the phase of a pulse
 *
 * A sphere of a material (polarisability.h) with a pulse as high as that of a ferrous
 * sphere of a given size has one diameter and one phase.  With a normal error of the
 * phase, and shares of the materials among pulses of this height,
 *
 *	P(ferrous | phase) = F / (F + N)
 *
 * by Bayes' rule, F and N the sums of share exp(-(phase - theirs)^2 / (2 se^2)) over the
 * ferrous materials and over the others.
 */
#ifndef SIGNAL_CLASSIFY_H
#define SIGNAL_CLASSIFY_H

#include "signal/pulse/polarisability.h"

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
