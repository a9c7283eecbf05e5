/* cholesky.c - see cholesky.h */
#include "num/cholesky.h"
#include "num/dot.h"
#include <math.h>

/* Three rows at once, whose sums do not wait for each other, to the same bits. */
enum num_status cholesky_factor(double *a, size_t n, size_t stride, double least)
{
	for (size_t first = 0, end; first < n; first = end) {
		double *row = a + first * stride, pivot, part[3];
		size_t together = first + 3 <= n ? first : 0;

		end = first + (first + 3 <= n ? 3 : 1);
		for (size_t k = 0; k < together; k++) {
			const double *rows[] = { row, row + stride, row + 2 * stride };

			dot3(a + k * stride, rows, k, part);
			for (size_t u = 0; u < 3; u++)
				row[u * stride + k] = (row[u * stride + k] - part[u]) /
						      a[k * stride + k];
		}
		for (size_t i = first; i < end; i++, row += stride) {
			for (size_t k = together; k < i; k++)
				row[k] = (row[k] - dot(row, a + k * stride, k)) /
					 a[k * stride + k];
			pivot = row[i] - dot(row, row, i);
			if (!(pivot > least * row[i]))
				return NUM_DOMAIN;
			row[i] = sqrt(pivot);
		}
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
