/* noise.h - the spectrum of the noise of a record, and what makes it white
 *
 * Either channel's spectrum is taken from the stretches of it where nothing happens
 * (quiet.h), which are most of a residual and some of a record.  Where there are hardly
 * any, pulses stand everywhere: the noise is then taken for white, and its level from
 * the upper half of the frequencies, where pulses have nothing.
 */
#ifndef SIGNAL_NOISE_H
#define SIGNAL_NOISE_H

#include "signal/whiten.h"
#include <stddef.h>

enum { NOISE_BINS = 513 };

struct noise {
	double power[2][NOISE_BINS]; /* at frequency k / (2 (NOISE_BINS - 1)) */
	int white[2];                /* 1: no lag of the autocorrelation says otherwise */
	int quiets;                  /* segments it is the mean of; 0: taken for white */
};

/* Of y1, y2[0 .. n).  Returns 0 when out of memory. */
int noise_measure(struct noise *noise, const double *y1, const double *y2, size_t n);

/* Standard deviation that white noise of its median power would have. */
double noise_level(const struct noise *noise, int c);
/* Taps that make channel c white, with that standard deviation.  Returns 0 when out of
 * memory. */
int noise_whitening(const struct noise *noise, int c, struct whitening *w);

#endif
