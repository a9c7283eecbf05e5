/* dot.h - inner products of arrays */
#ifndef NUM_DOT_H
#define NUM_DOT_H

#include "num/lanes.h"
#include <stddef.h>

/* Four partial sums in fixed order: fast, and the same bits everywhere. */
static inline double dot(const double *x, const double *y, size_t n)
{
	lanes a = { 0 }, b = { 0 };
	size_t fours = n - n % 4;

	for (size_t i = 0; i < fours; i += 4) {
		a += lanes_load(x + i, 2) * lanes_load(y + i, 2);
		b += lanes_load(x + i + 2, 2) * lanes_load(y + i + 2, 2);
	}
	for (size_t i = fours; i < n; i++)
		a[0] += x[i] * y[i];
	return (a[0] + a[1]) + (b[0] + b[1]);
}

/* The inner product of p with what y[0 .. n) has from index at on; zero outside. */
static inline double dot_within(
	const double *p, size_t len, const double *y, size_t n, long long at)
{
	long long from = at < 0 ? -at : 0, end = (long long)n - at;

	end = end < (long long)len ? end : (long long)len;
	return end > from ? dot(p + from, y + (at + from), (size_t)(end - from)) : 0;
}

/* The inner products of x with three others, to the same bits, in little more than the
 * time of one: sums of several do not wait for each other. */
void dot3(const double *x, const double *const y[3], size_t n, double out[3]);

/* Those of three with three others. */
void dot9(const double *const x[3], const double *const y[3], size_t n, double out[3][3]);

/* y += factor x */
void add_scaled(double *y, double factor, const double *x, size_t n);

static inline void negate(double *x, size_t n)
{
	for (size_t i = 0; i < n; i++)
		x[i] = -x[i];
}

static inline double mean_of(const double *x, size_t n)
{
	double mean = 0;

	for (size_t i = 0; i < n; i++)
		mean += x[i] / (double)n;
	return mean;
}

/* The largest of n numbers and 0. */
static inline double largest_of(const double *x, size_t n)
{
	double most = 0;

	for (size_t i = 0; i < n; i++)
		most = x[i] > most ? x[i] : most;
	return most;
}

#endif
