/* bursts.c - see bursts.h */
#include "signal/detect/bursts.h"
#include "signal/noise/robust.h"
#include <math.h>

/* Differences from which the level of the noise is estimated: 256 give it with a standard
 * error of 7 %. */
enum { AROUND = 256 };

/* Standard deviations that Gaussian noise, whose level may be underestimated by three of
 * those standard errors, reaches in one of 30 million differences. */
static const double LIMIT = 7;

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

int bursts_found(const double *y, size_t n, double *work)
{
	enum { FIRST = 4 };
	size_t count = n / FIRST;

	for (size_t i = 0; i < count; i++) {
		work[i] = 0;
		for (size_t k = 0; k < FIRST; k++)
			work[i] += y[i * FIRST + k];
	}
	/* Sums are as good as means. */
	for (; count >= AROUND + 2; count /= 2) {
		double d[AROUND];

		for (size_t from = 0; from + 2 < count; from += AROUND) {
			size_t at = from + AROUND + 2 < count ? from : count - AROUND - 2;

			for (size_t i = 0; i < AROUND; i++)
				d[i] = work[at + i] - 2 * work[at + i + 1] +
				       work[at + i + 2];
			if (exceeds(d, AROUND))
				return 1;
		}
		for (size_t i = 0; 2 * i + 1 < count; i++)
			work[i] = work[2 * i] + work[2 * i + 1];
	}
	return 0;
}
