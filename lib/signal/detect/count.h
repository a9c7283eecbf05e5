/* count.h - plain counting of pulses by their peaks, one channel at a time
 *
 * A peak is the highest sample between two crossings of half its height, and at least
 * level high.  Overlapping pulses count as one: that is what the other methods are for.
 */
#ifndef SIGNAL_COUNT_H
#define SIGNAL_COUNT_H

#include <stddef.h>

struct peak {
	double t, height; /* samples from the first; by the parabola through three samples
			   */
};

/* A level that noise rarely reaches: five robust deviations of every stride-th sample of
 * x, n of them, from their median; work holds n values. */
double count_level(const double *x, size_t n, size_t stride, double *work);

struct count;
struct count *count_new(double level); /* level > 0; NULL: no memory */
void count_free(struct count *count);

/* Takes one more sample; 1 if a peak is now certain. */
int count_sample(struct count *count, double x, struct peak *peak);
/* Ends the record; 1 if a last peak was being followed. */
int count_end(struct count *count, struct peak *peak);

#endif
