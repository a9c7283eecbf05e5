/* align.h - by how much the second sensor lags behind the first
 *
 * The lag at which the cross-correlation of the two channels is largest is the transit
 * time of the mean particle, weighted by the energy of its pulse.
 */
#ifndef SIGNAL_ALIGN_H
#define SIGNAL_ALIGN_H

#include <stddef.h>

/* Lag in [0, max_lag] of y2 behind y1 (n samples each), with a parabola through the
 * largest value and its neighbours.  *peak receives the correlation there as a share of
 * what two equal signals would have, in [-1, 1].  Returns -1 when out of memory, -2
 * where either channel is zero throughout. */
double align_lag(
	const double *y1, const double *y2, size_t n, size_t max_lag, double *peak);

/* Autocorrelation summed over both channels at lags 0 .. max_lag < n, for the length of
 * pulses.  Returns 0 when out of memory. */
int align_autocorrelation(
	const double *y1, const double *y2, size_t n, size_t max_lag, double *r);

#endif
