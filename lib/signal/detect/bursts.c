/* bursts.c - see bursts.h */
#include "signal/detect/bursts.h"
#include "num/robust.h"
#include "num/sigmas.h"
#include <math.h>
#include <string.h>

/* Differences from which the level of the noise is estimated: 256 give it with a standard
 * error of 7 %. */
enum { AROUND = 256 };

/* Differences in an octave that two records may differ in by SIGMAS_NEVER: fewer than 49
 * scatter too much for even one mean square of 0. */
enum { FEWEST = 64 };

/* Standard deviations, estimated from so few differences, that Gaussian noise reaches in
 * 1.2e-11 of them (7: in 1e-9; 10^5 drawn estimates), of which there are two for each
 * sample of a record from which nothing is learned: once in a thousand hours at 10 kHz.
 */
static const double LIMIT = 8;

/* 1 if one of the n differences d exceeds the limit. */
static int exceeds(const double *d, size_t n)
{
	double sorted[AROUND], level;
	size_t count = 0;

	for (size_t i = 0; i < n; i++)
		if (d[i] != 0) /* not where a converter stands still */
			sorted[count++] = d[i];
	level = robust_scale(sorted, count);
	for (size_t i = 0; i < n; i++)
		if (fabs(d[i]) > LIMIT * level)
			return 1;
	return 0;
}

/* Samples in the shortest means. */
enum { FIRST = 4 };

static size_t sum_pairs(double *x, size_t n)
{
	for (size_t i = 0; 2 * i + 1 < n; i++)
		x[i] = x[2 * i] + x[2 * i + 1];
	return n / 2;
}

/* Sums of the n samples in fours, to x, which are as good as means; their number. */
static size_t sum_fours(const double *y, size_t n, double *x)
{
	memcpy(x, y, n * sizeof *x);
	return sum_pairs(x, sum_pairs(x, n));
}

static double second_difference(const double *x)
{
	return x[0] - 2 * x[1] + x[2];
}

int bursts_found(const double *y, size_t n, size_t longest, double *work)
{
	size_t count = sum_fours(y, n, work);

	for (size_t length = FIRST; count >= AROUND + 2 && length <= longest;
		length *= 2, count = sum_pairs(work, count)) {
		double d[AROUND];

		for (size_t from = 0; from + 2 < count; from += AROUND) {
			size_t at = from + AROUND + 2 < count ? from : count - AROUND - 2;

			for (size_t i = 0; i < AROUND; i++)
				d[i] = second_difference(work + at + i);
			if (exceeds(d, AROUND))
				return 1;
		}
	}
	return 0;
}

void bursts_measure(const double *y, size_t n, double *work, struct bursts_power *power)
{
	size_t count = sum_fours(y, n, work);

	for (power->octaves = 0; count >= FEWEST + 2 && power->octaves < BURSTS_OCTAVES;
		count = sum_pairs(work, count)) {
		int k = power->octaves++;

		power->count[k] = (double)(count - 2);
		power->square[k] = 0;
		for (size_t i = 0; i + 2 < count; i++) {
			double d = second_difference(work + i);

			power->square[k] += d * d / power->count[k];
		}
	}
}

int bursts_alike(const struct bursts_power *a, const struct bursts_power *b)
{
	if (a->octaves == 0 || a->octaves != b->octaves)
		return 0;
	for (int k = 0; k < a->octaves; k++) {
		/* Neighbours correlate by -2/3, the next by 1/6: the sum of the squares
		 * of all is 35 / 18. */
		double sum = a->square[k] + b->square[k],
		       var = 2 * 35. / 18 * (1 / a->count[k] + 1 / b->count[k]);

		if (fabs(a->square[k] - b->square[k]) >
			SIGMAS_NEVER * sqrt(var) * 0.5 * sum)
			return 0;
	}
	return 1;
}
