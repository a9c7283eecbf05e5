/* cholesky.c - see cholesky.h */
#include "num/cholesky.h"
#include "num/dot.h"
#include <math.h>

enum num_status cholesky_factor(double *a, size_t n, size_t stride, double least)
{
	for (size_t i = 0; i < n; i++) {
		double *row = a + i * stride, pivot;

		for (size_t k = 0; k < i; k++)
			row[k] = (row[k] - dot(row, a + k * stride, k)) /
				 a[k * stride + k];
		pivot = row[i] - dot(row, row, i);
		if (!(pivot > least * row[i]))
			return NUM_DOMAIN;
		row[i] = sqrt(pivot);
	}
	return NUM_OK;
}

void cholesky_solve(const double *a, size_t n, size_t stride, double *x)
{
	for (size_t i = 0; i < n; i++)
		x[i] = (x[i] - dot(a + i * stride, x, i)) / a[i * stride + i];
	for (size_t i = n; i-- > 0;) {
		x[i] /= a[i * stride + i];
		for (size_t k = 0; k < i; k++)
			x[k] -= a[i * stride + k] * x[i];
	}
}
