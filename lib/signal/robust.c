/* robust.c - see robust.h */
#include "signal/robust.h"
#include <math.h>

/* Hoare's selection. */
double robust_quantile(double *x, size_t n, double share)
{
	size_t lo = 0, hi = n ? n - 1 : 0, middle = (size_t)(share * (double)n);

	if (n == 0)
		return 0;
	if (middle > hi)
		middle = hi;
	while (lo < hi) {
		double pivot = x[lo + (hi - lo) / 2];
		size_t i = lo, k = hi;

		for (;;) {
			double swap;

			while (x[i] < pivot)
				i++;
			while (x[k] > pivot)
				k--;
			if (i >= k)
				break;
			swap = x[i];
			x[i++] = x[k];
			x[k--] = swap;
		}
		/* x[lo .. k] <= pivot <= x[k + 1 .. hi] */
		if (middle <= k)
			hi = k;
		else
			lo = k + 1;
	}
	return x[middle];
}

double robust_median(double *x, size_t n)
{
	return robust_quantile(x, n, 0.5);
}

double robust_noise(const double *x, size_t n, int order, double *work)
{
	double variance = 1;
	size_t left = n;

	if (order < 1 || order > 16 || n < 16 + (size_t)order)
		return 0;
	for (size_t i = 0; i < n; i++)
		work[i] = x[i];
	for (int k = 0; k < order; k++, left--)
		for (size_t i = 0; i + 1 < left; i++)
			work[i] = work[i + 1] - work[i];
	for (size_t i = 0; i < left; i++)
		work[i] = fabs(work[i]);
	/* The difference of order p of unit white noise has variance (2p)! / p!^2. */
	for (int k = 1; k <= order; k++)
		variance *= (double)(order + k) / k;
	return 1.482602218505602 * robust_median(work, left) / sqrt(variance);
}
