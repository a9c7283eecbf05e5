/* robust.c - see robust.h */
#include "signal/noise/robust.h"
#include "num/robust.h"
#include <math.h>
#include <string.h>

/* Differences below this share of the largest value, as of 20 bits, are rounding. */
static const double ROUNDING = 0x1p-20;

/* Step of the converter that x is from: the smallest difference of successive values. */
static double step_of(const double *x, size_t n)
{
	double largest = 0, least = INFINITY;

	for (size_t i = 0; i < n; i++)
		largest = fmax(largest, fabs(x[i]));
	for (size_t i = 1; i < n; i++) {
		double step = fabs(x[i] - x[i - 1]);

		if (step > ROUNDING * largest && step < least)
			least = step;
	}
	return isinf(least) ? 0 : least;
}

/* Noise by the root mean square of the differences of each block, that of the middle
 * block: it does not jump as their median does where values are coarse. */
static double noise_of_blocks(
	const double *x, const unsigned char *hidden, size_t n, double *work)
{
	enum { BLOCK = 64 };
	size_t blocks = 0;

	for (size_t from = 0; from + 4 < n; from += BLOCK) {
		double sum = 0, count = 0;

		for (size_t i = from; i < from + BLOCK && i + 4 < n; i++)
			if (!(hidden && memchr(hidden + i, 1, 5))) {
				sum += pow(fourth_difference(x + i), 2);
				count++;
			}
		if (count > 0)
			work[blocks++] = sqrt(sum / count);
	}
	return robust_median(work, blocks);
}

double robust_noise(const double *x, const unsigned char *hidden, size_t n, double *work)
{
	size_t left = n < 20 ? 0 : n - 4, count = 0;
	double scale, step;

	for (size_t i = 0; i < left; i++)
		if (!(hidden && memchr(hidden + i, 1, 5)))
			work[count++] = fourth_difference(x + i);
	if (!count)
		return 0;
	scale = robust_scale(work, count);
	step = step_of(x, n);
	return scale < step ? hypot(noise_of_blocks(x, hidden, n, work), step / sqrt(12))
			    : scale;
}
