/* align.h - the lag of the second sensor behind the first
 *
 * The lag at which the cross-correlation of the two channels is largest is the transit
 * time of the mean particle, weighted by the energy of its pulse.
 */
#ifndef SIGNAL_ALIGN_H
#define SIGNAL_ALIGN_H

#include "num/status.h"
#include <stddef.h>

/* *lag in [0, max_lag]: of y2 behind y1 (n samples each), by a parabola through the
 * largest value and its neighbours.  *peak: the correlation coefficient there, in
 * [-1, 1].  NUM_DOMAIN if either channel is zero throughout. */
enum num_status align_lag(const double *y1, const double *y2, size_t n, size_t max_lag,
	double *lag, double *peak);

struct align_range {
	double more, most;
};

/* peak[i]: the largest absolute correlation coefficient at lags in [0, max_lag] that
 * differ from lag by more than range[i].more and at most range[i].most; 0 if there are
 * none.  Errors as above. */
enum num_status align_elsewhere(const double *y1, const double *y2, size_t n,
	size_t max_lag, double lag, int ranges, const struct align_range *range,
	double *peak);

/* Autocorrelation summed over both channels at lags 0 .. max_lag < n, for the length of
 * pulses. */
enum num_status align_autocorrelation(
	const double *y1, const double *y2, size_t n, size_t max_lag, double *r);

/* Lag at which an autocorrelation is lowest, before it rises clearly; 0 where there is
 * none up to max_lag. */
double lowest_lag(const double *r, size_t max_lag);

/* *width: of the pulses in y2 over that of those in y1, as that of their autocorrelations
 * up to lag most, which superposition of many hardly changes; 1 if there is none. */
enum num_status align_width(
	const double *y1, const double *y2, size_t n, double most, double *width);

#endif
