/* foreign.h - what an event is that is no particle
 *
 * A particle passes sensor 1 and then sensor 2.  What both see at once is common to them:
 * a shock, or interference.  What a few samples hold is an impulse.  What both see one
 * after the other, though not as a particle, moves with the oil: a bubble, or a particle
 * that sticks to another.  All else is a transient.
 */
#ifndef SIGNAL_FOREIGN_H
#define SIGNAL_FOREIGN_H

#include <stddef.h>

enum foreign_kind {
	FOREIGN_NOTHING, /* it was seen on channel 1 when it was there */
	FOREIGN_CLIPPED,
	FOREIGN_COMMON,
	FOREIGN_IMPULSE,
	FOREIGN_MOVING,
	FOREIGN_TRANSIENT
};

struct foreign {
	enum foreign_kind kind;
	double at;   /* sample of its largest value, in channel 1's time */
	double peak; /* that value, of channel 1 or else 2 */
};

/* Looks at samples [from, to) of channel 1 and [from + shift, to + shift) of channel 2;
 * y[c][i - begin[c]] is sample i, n[c] of them, noise of variance 1. */
void foreign_look(const double *const y[2], const unsigned char *const bad[2],
	const long long begin[2], const size_t n[2], long long from, long long to,
	long shift, double duration, struct foreign *f);

#endif
