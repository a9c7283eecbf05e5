/* matched.h - statistics of a whole record after the matched filter of its pulse
 *
 * y1, y2 hold n aligned samples in units of the noise, work n more.
 */
#ifndef SIGNAL_MATCHED_H
#define SIGNAL_MATCHED_H

#include "num/status.h"
#include "signal/learn/calibration.h"
#include <stddef.h>

/* *coherence: correlation of the filtered channels over the quietest tenth of the record:
 * 0 for noise, large for pulses without pauses.  *level is the root mean square
 * there, 1 for white noise. */
enum num_status matched_coherence(const struct calibration *c, const double *y1,
	const double *y2, size_t n, double *work, double *coherence, double *level);

/* *noise: standard deviation of white noise that would have the same effect on the
 * matched filter as the noise there is; for records that have been filtered before. */
enum num_status matched_noise(const struct calibration *c, const double *y, size_t n,
	double *work, double *noise);

#endif
