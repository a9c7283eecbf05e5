/* start.h - how long pulses last and by how much sensor 2 lags, before anything is known
 *
 * Sine pulses of either sign and of many durations are looked for by their matched
 * filter; the duration under which the clear ones gather most energy is taken.  The lag
 * is that at which most of them are followed by one on the other channel, each counting
 * no more than a pulse of LIMIT deviations, so that a few loud ones do not decide.
 */
#ifndef SIGNAL_START_H
#define SIGNAL_START_H

#include <stddef.h>

struct start {
	double duration; /* samples; 0: no pulse */
	long lag;        /* of channel 2, samples; negative: it leads */
	int sign;        /* -1: pulses on channel 2 are reversed */
	double score;    /* of the lag: its peak over the rms of the others */
	int together;    /* 1: the only lag that stands out is 0 */
};

/* Of y1, y2[0 .. n), white noise of variance 1 and pulses.  duration, lag: NAN, or known.
 * crowded: pulses everywhere, and the duration is rather that whose sine pulse is least
 * like itself where the record is: superposition does not change that. Returns 0 when out
 * of memory. */
int start_find(const double *y1, const double *y2, size_t n, double duration, double lag,
	int crowded, struct start *s);

#endif
