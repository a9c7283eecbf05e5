/* robust.c - see robust.h */
#include "signal/noise/robust.h"
#include "num/select.h"
#include <math.h>

double robust_quantile(double *x, size_t n, double share)
{
	size_t rank = (size_t)(share * (double)n);

	if (n == 0)
		return 0;
	if (rank > n - 1)
		rank = n - 1;
	select_ranks(x, n, &rank, 1);
	return x[rank];
}

double robust_median(double *x, size_t n)
{
	return robust_quantile(x, n, 0.5);
}

double robust_scale(double *x, size_t n)
{
	for (size_t i = 0; i < n; i++)
		x[i] = fabs(x[i]);
	return 1.482602218505602 * robust_median(x, n);
}

double robust_spread(double *x, size_t n)
{
	double middle = robust_median(x, n);

	for (size_t i = 0; i < n; i++)
		x[i] -= middle;
	return robust_scale(x, n);
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
	/* The difference of order p of unit white noise has variance (2p)! / p!^2. */
	for (int k = 1; k <= order; k++)
		variance *= (double)(order + k) / k;
	return robust_scale(work, left) / sqrt(variance);
}
