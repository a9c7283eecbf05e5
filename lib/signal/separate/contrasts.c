/* contrasts.c - see contrasts.h */
#include "signal/separate/contrasts.h"
#include <math.h>
#include <stdlib.h>

/* Contrast k of x: the mean of the first k + 1 values less the next one, normalised
 * (Helmert). */
static double helmert(const double *x, int k)
{
	double sum = 0;

	for (int i = 0; i <= k; i++)
		sum += x[i];
	return (sum - (k + 1) * x[k + 1]) / sqrt((k + 1.0) * (k + 2));
}

/* One Jacobi rotation of the n by n matrix a that makes a[p][q] zero; y is rotated with
 * it. */
static void rotate(double *a, int n, int p, int q, double *y)
{
	double apq = a[p * n + q], theta, t, c, s, yp = y[p];

	if (apq == 0)
		return;
	theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
	t = copysign(1, theta) / (fabs(theta) + hypot(theta, 1));
	c = 1 / sqrt(t * t + 1);
	s = t * c;
	a[p * n + p] -= t * apq;
	a[q * n + q] += t * apq;
	a[p * n + q] = a[q * n + p] = 0;
	for (int k = 0; k < n; k++) {
		double kp = a[k * n + p], kq = a[k * n + q];

		if (k == p || k == q)
			continue;
		a[k * n + p] = a[p * n + k] = c * kp - s * kq;
		a[k * n + q] = a[q * n + k] = s * kp + c * kq;
	}
	y[p] = c * yp - s * y[q];
	y[q] = s * yp + c * y[q];
}

enum num_status contrasts_of(int m, const double *d, const double *cov, int stride,
	double *square, double *var)
{
	enum { SWEEPS = 10 }; /* convergence is quadratic: enough for full precision */
	int n = m - 1;
	double *half = malloc(sizeof *half * (size_t)(n * m + n * n));
	double *a;

	if (!half)
		return NUM_MEMORY;
	a = half + n * m;
	for (int k = 0; k < n; k++)
		for (int i = 0; i < m; i++)
			half[k * m + i] = helmert(cov + i * stride, k);
	for (int k = 0; k < n; k++)
		for (int l = 0; l < n; l++)
			a[k * n + l] = helmert(half + k * m, l);
	for (int k = 0; k < n; k++)
		square[k] = helmert(d, k);
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (int p = 0; p < n; p++)
			for (int q = p + 1; q < n; q++)
				rotate(a, n, p, q, square);
	for (int k = 0; k < n; k++) {
		square[k] *= square[k];
		var[k] = a[k * n + k];
	}
	free(half);
	return NUM_OK;
}
