/* robust.c - see robust.h */
#include "num/robust.h"
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

int robust_median_at_most(const double *x, size_t n, double value)
{
	size_t count = 0;

	for (size_t i = 0; i < n; i++)
		count += x[i] <= value;
	return 2 * count > n;
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
