/* foreign.h - events in a stretch of a two-sensor record that are no particles
 *
 *	impulse    a few samples, see spikes.h
 *	shock      the same waveform at both sensors at once
 *	bubble     one lobe of either sign that passes both sensors with the oil;
 *	           a particle has two lobes
 *	transient  a waveform at one sensor only
 *
 * The waveform is free otherwise, the level at either sensor too.  An event is named if
 * its residual is no more than noise, and if this is certain: the residual of a group of
 * particles would be at least a tenth of the energy.
 */
#ifndef SIGNAL_FOREIGN_H
#define SIGNAL_FOREIGN_H

#include "num/status.h"
#include "signal/fit/verdict.h"
#include <stddef.h>

/* Samples of noise of variance 1, y[1] later by shift than y[0]. */
struct foreign_stretch {
	const double *y[2];
	const unsigned char *hidden[2]; /* 1: the sample is not known; NULL: all are */
	size_t n;
	size_t shift;
	double lost;     /* share of the variance of the noise that a filter removed */
	double duration; /* of a particle's pulse */
};

struct foreign {
	enum separate_verdict verdict; /* SEPARATE_MISFIT: none of them */
	double t[2];      /* of the largest deflection, from y[c][0]; NAN: not there */
	double amplitude; /* there, at sensor 1 or the only sensor */
	double chi2;      /* of what it leaves, per degree of freedom */
};

/* delta_min to delta_max: range of the delay of y[1] of what passes with the oil, beyond
 * shift; empty if bubbles cannot be told from what does.  NUM_MEMORY. */
enum num_status foreign_find(const struct foreign_stretch *s, double delta_min,
	double delta_max, struct foreign *out);

/* The same for two channels of one time: SEPARATE_SHOCK or SEPARATE_MISFIT. */
void foreign_at_once(const struct foreign_stretch *s, struct foreign *out);

#endif
