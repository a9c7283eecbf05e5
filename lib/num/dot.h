/* dot.h - inner product of two arrays */
#ifndef NUM_DOT_H
#define NUM_DOT_H

#include <stddef.h>

/* Four partial sums in fixed order: fast, and the same bits everywhere. */
static inline double dot(const double *x, const double *y, size_t n)
{
	double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
	size_t fours = n - n % 4;

	for (size_t i = 0; i < fours; i += 4) {
		s0 += x[i] * y[i];
		s1 += x[i + 1] * y[i + 1];
		s2 += x[i + 2] * y[i + 2];
		s3 += x[i + 3] * y[i + 3];
	}
	for (size_t i = fours; i < n; i++)
		s0 += x[i] * y[i];
	return (s0 + s1) + (s2 + s3);
}

#endif
