/* crosstalk.h - the share of each channel in the other
 *
 * A pulse of one sensor leaves its copy in the other channel at the same time.  Large
 * pulses show it before anything else is learned, and in a record with crosstalk each
 * pulse would look like two otherwise.
 */
#ifndef SIGNAL_CROSSTALK_H
#define SIGNAL_CROSSTALK_H

#include "signal/learn/marks.h"

/* The most of it: more is a shock, which reaches both sensors at once. */
#define CROSSTALK_MOST 0.3

/* The crosstalk of these shares, each of a pulse or some pulses, which it reorders; 0 if
 * it is not significant.  The median is not moved by events that happen to be in the
 * other channel at the time of a pulse.  energy: sum of the squares of all pulses, in
 * units of the noise of the other channel. */
double crosstalk_median(double *share, size_t count, double energy);

/* share[c]: of the other channel in channel c, from the pulses m of both channels
 * x[c][0 .. n), without those with samples that are hidden (flags or NULL).
 * NUM_MEMORY. */
enum num_status crosstalk_find(const double *const x[2],
	const unsigned char *const hidden[2], size_t n, const struct marks m[2],
	double share[2]);

#endif
