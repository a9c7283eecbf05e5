/* detectable.h - the probability that a joint fit finds a pulse
 *
 * Fitting arrivals and amplitude of a pulse of amplitude a reduces chi-square by a
 * noncentral chi-square variable of three degrees of freedom and parameter a^2 E, with E
 * the energy of a pulse of amplitude 1 on both channels over the variance of the noise;
 * the pulse is found if the reduction exceeds the threshold of joint.h.  Beside another
 * pulse a share of E is lost to the amplitude and arrivals of that pulse, and the
 * reduction must also exceed the misfit of that pulse.  Losses to lines and baselines are
 * neglected.  Simulated particles are found
 * with this probability or up to 0.1 more.
 *
 * Amplitudes are in units of the noise of channel 1.
 */
#ifndef SIGNAL_DETECTABLE_H
#define SIGNAL_DETECTABLE_H

#include "signal/fit/joint.h"

/* An isolated pulse. */
double detectable_alone(const struct joint_scene *scene, double a);

/* Shares of the energy of a pulse that remain beside another one, at DETECTABLE_PLACES
 * distances up to a duration. */
enum { DETECTABLE_PLACES = 20 };
void detectable_shares(const struct shape *shape, double share[DETECTABLE_PLACES]);
/* A pulse that arrives at any time within a duration of one of amplitude large, at the
 * same velocity. */
double detectable_beside(const struct joint_scene *scene, double a, double large,
	const double share[DETECTABLE_PLACES]);

#endif
