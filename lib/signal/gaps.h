/* gaps.h - samples of a channel that say nothing: clipped, or not sampled at all
 *
 * Samples of a channel with noise seldom equal their neighbours.  A run of equal ones
 * that chance would not give is a gap: an amplifier at its rail, or a sampler that holds
 * or has lost its signal.  Where runs are at the highest or lowest value of the record,
 * that value is a rail, and every sample at it is clipped.
 */
#ifndef SIGNAL_GAPS_H
#define SIGNAL_GAPS_H

#include <stddef.h>

enum { GAPS_HELD = 1, GAPS_CLIPPED = 2 };

struct gaps {
	size_t run;       /* equal samples that are a gap; 0: none is looked for */
	double low, high; /* rails; -INFINITY, INFINITY where there is none */
};

/* What a gap is in x[0 .. n).  A run is one that chance gives to a record of that length
 * with probability 1e-3, by the share of neighbours that are equal in it; where that is
 * more than half, the record is coarser than its noise and has none. */
void gaps_learn(struct gaps *g, const double *x, size_t n);

/* Marks x[from .. n) in bad (as long as x), looking back as far as it must; returns the
 * number of clipped samples. */
size_t gaps_mark(
	const struct gaps *g, const double *x, size_t from, size_t n, unsigned char *bad);

#endif
