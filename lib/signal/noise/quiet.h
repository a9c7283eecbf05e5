/* quiet.h - power spectrum of the noise of a record, from its quiet stretches
 *
 * The record is cut into half-overlapping segments under a Hann window.  A first
 * spectrum is the lower quartile of each frequency over all segments, which pulses in up
 * to half of them change little; then, repeated a few times, the mean of the segments
 * whose power nowhere exceeds the last spectrum significantly.
 */
#ifndef SIGNAL_QUIET_H
#define SIGNAL_QUIET_H

#include "num/status.h"
#include <stddef.h>

/* power1, power2[k], 0 < k <= segment / 2: of y1, y2[0 .. n) at frequency k / segment,
 * v for white noise of variance v; those at 0 are those at 1.  segment: even.
 * *quiets: number of quiet segments; 0: the spectra are unknown. */
enum num_status quiet_spectrum(const double *y1, const double *y2, size_t n,
	size_t segment, double *power1, double *power2, int *quiets);

#endif
