/* colour.h - the noise of a record: how much where it was made white, and its spectrum
 * where it is not
 */
#ifndef SIGNAL_COLOUR_H
#define SIGNAL_COLOUR_H

#include "num/status.h"
#include "signal/noise/whiten.h"
#include <stddef.h>

enum { COLOUR_BINS = 513 };

/* Spectrum of the noise from 0 to half the rate, with the power of a random walk, drift /
 * (2 sin(pi f))^2 at f cycles per sample, as a factor of it beside 1. */
struct colour {
	double power[COLOUR_BINS];
	double drift;
};

/* Standard deviations that the noise of y1, y2[0 .. n), whitened by w, would have if its
 * band were the whole spectrum; too large if hardly any stretch is without pulses. */
enum num_status colour_level(const double *y1, const double *y2, size_t n,
	const struct whitening *w, double noise[2]);

/* power1, power2[k], 0 < k <= segment / 2: of the noise of y1, y2[0 .. n) or, with steps,
 * of the differences of successive samples, at frequency k / segment, v for white noise
 * of variance v; those at 0 are those at 1.  segment: even.
 *
 * The record is cut into half-overlapping segments under a Hann window.  A first spectrum
 * is the lower quartile of each frequency over all segments, which pulses in up to half
 * of them change little; then, repeated a few times, the mean of the segments whose power
 * nowhere exceeds the last spectrum significantly.  *found: number of these; 0: the
 * spectra are unknown. */
enum num_status colour_spectrum(const double *y1, const double *y2, size_t n, int steps,
	size_t segment, double *power1, double *power2, int *found);

/* Spectrum of the noise at COLOUR_BINS frequencies from 0 to half the rate, the mean of
 * both channels, smoothed.  NUM_DOMAIN if fewer than 16 segments hold only noise. */
enum num_status colour_power(
	const double *y1, const double *y2, size_t n, struct colour *colour);
/* Removes from such a spectrum the contribution of lags at which the noise is not
 * correlated.  It would roughen the spectrum, and a filter made from it would ring. */
enum num_status colour_smooth(struct colour *colour);
/* 1 if this is the spectrum of white noise, within its scatter, above the frequency from
 * (per sample). */
int colour_is_white(const struct colour *colour, double from);

#endif
