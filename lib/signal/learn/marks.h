/* marks.h - where the pulses of a channel are, before anything is known of the instrument
 *
 * Maxima of the products with sine pulses, over arrival and duration, none within a
 * larger one.
 */
#ifndef SIGNAL_MARKS_H
#define SIGNAL_MARKS_H

#include "num/status.h"
#include <math.h>
#include <stddef.h>

/* Step of the logarithm of the durations that are compared. */
#define MARKS_STEP 0.115

struct mark {
	double t, T;  /* middle and duration, samples */
	double value; /* product with the pulse of energy 1, in units of the noise */
};

/* By size, the largest first. */
struct marks {
	struct mark *mark;
	size_t count, room;
	double noise; /* standard deviation */
};

/* Pulses of x[0 .. n), whose baseline is a random walk of this standard deviation a
 * sample. work holds 2 n values.  Free *m with marks_clear(), also on NUM_MEMORY. */
enum num_status marks_find(
	const double *x, size_t n, double step, double *work, struct marks *m);

/* Lobes of one sign, of durations from least to most, of x without its median. */
enum num_status marks_find_lobes(const double *x, size_t n, double least, double most,
	double *work, struct marks *m);
/* Level of such a lobe at s durations from its middle, where it is 1. */
static inline double marks_lobe(double s)
{
	return fabs(s) < 0.5 ? 0.5 + 0.5 * cos(2 * M_PI * s) : 0;
}

void marks_clear(struct marks *m);

#endif
