/* colour.h - the noise of a record: how much where it was made white, and its spectrum
 * where it is not
 */
#ifndef SIGNAL_COLOUR_H
#define SIGNAL_COLOUR_H

#include "signal/whiten.h"
#include <stddef.h>

enum { COLOUR_BINS = 513 };

/* Standard deviations that the noise of y1, y2[0 .. n), whitened by w, would have at all
 * frequencies; too much where hardly anything is quiet.  Returns 0 when out of memory. */
int colour_level(const double *y1, const double *y2, size_t n, const struct whitening *w,
	double noise[2]);

/* Spectrum of the noise at COLOUR_BINS frequencies from 0 to half the rate, the mean of
 * both channels in units of noise^2, smoothed.  Returns 1, 0 where hardly anything is
 * quiet, -1 when out of memory. */
int colour_power(const double *y1, const double *y2, size_t n, const double noise[2],
	double power[COLOUR_BINS]);
/* Is it that of white noise but for its scatter, from this frequency (per sample) on? */
int colour_is_white(const double power[COLOUR_BINS], double from);

#endif
