/* campbell.h - number and size of the particles of a record too dense to be separated
 *
 * Pulses that arrive at random, rate of them per sample, are shot noise whose cumulants
 * are (Campbell's theorem, Rice 1944)
 *
 *	k2 = rate E[a^2] T integral p^2 ds,    k4 = rate E[a^4] T integral p^4 ds
 *
 * Gaussian noise adds to k2 its variance, 1 here, and to k4 nothing.  The two give
 *
 *	equal number    (rate E[a^2])^2 / (rate E[a^4])
 *	equal amplitude (E[a^4] / E[a^2])^1/2
 *
 * the rate and amplitude of equal particles with these cumulants.  By Cauchy and Schwarz
 * the true rate is not below the equal one, whatever the distribution of the amplitudes;
 * with that distribution known, rate = equal number E[a^4] / E[a^2]^2.
 */
#ifndef SIGNAL_CAMPBELL_H
#define SIGNAL_CAMPBELL_H

#include "signal/pulse/shape.h"
#include <stddef.h>

struct campbell {
	double square, square_se; /* rate E[a^2], per sample */
	double fourth, fourth_se; /* rate E[a^4] */
	double rate, rate_se; /* equal number, per sample; NAN where k4 is not above 0 */
	double amplitude, amplitude_se; /* equal amplitude; NAN likewise */
	double unlike;                  /* of campbell_compare(), or 0 */
};

/* From y1, y2[0 .. n), in units of the noise of y1 (gain: of channel 2 over 1 in these
 * units).  Standard errors are those of a jackknife over stretches longer than the
 * pulse; INFINITY if n is shorter than 32 durations. */
void campbell_estimate(const double *y1, const double *y2, size_t n,
	const struct shape *shape, double duration, double gain, struct campbell *c);

/* Compares the spectrum of these samples with that of the pulse and white noise: by
 * Carson's theorem pulses that arrive at random have the spectrum of one of them, so that
 * a difference shows another shape, duration or noise.  c->unlike is its root mean square
 * over bands of equal power of the pulse, which are the narrower the longer the stretch,
 * relative, without what chance leaves; INFINITY if n is shorter than 32 durations, or no
 * memory.  The standard errors grow by as much. */
void campbell_compare(const double *y1, const double *y2, size_t n,
	const struct shape *shape, double duration, double gain, struct campbell *c);

/* Upper limit of the sum of a^2 of the pulses in y[0 .. n), in units of its noise, for
 * any number of pulses and any other signal: the energy of the samples and three standard
 * errors, divided by 1 - c.  Two pulses of one sign cancel at most the share c of their
 * energy, as far as the autocorrelation of the pulse falls below 0; that more pulses or
 * other signals cancel more is unlikely.  Below 0 if the noise is less than 1. */
double campbell_most(
	const double *y, size_t n, const struct shape *shape, double duration);

/* The same for amplitudes and rates in other units. */
void campbell_scale(struct campbell *c, double unit, double rate);

#endif
