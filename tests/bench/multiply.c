/* multiply - one application of the half-space, timed: Fourier and multi-level
 *
 * usage: multiply N FILL: pressure on a disc that fills that part of the grid.  Rows:
 * n fill method order reach error seconds setup_seconds; the error is the largest
 * difference to the Fourier convolution over the largest displacement.
 */
#include "contact/kernel.h"
#include "contact/mlms.h"
#include "num/convolve.h"
#include "num/fft.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double love(const void *context, size_t ix, size_t iy)
{
	(void)context;
	return kernel_patch(1, 1, (double)ix, (double)iy);
}

static double now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fill_disc(double *x, int n, double fill)
{
	double radius2 = fill * n * n / M_PI;

	for (int i = 0; i < n * n; i++) {
		double dx = i % n - n / 2, dy = (double)(i / n) - (double)(n / 2);

		x[i] = sqrt(fmax(1 - (dx * dx + dy * dy) / radius2, 0));
	}
}

/* The fastest of several calls of the Fourier convolution. */
static double *by_fourier(int n, double fill, const double *x)
{
	double start = now(), setup, best = INFINITY;
	struct convolve *c = convolve_new((size_t)n, (size_t)n, CONVOLVE_PADDED, NULL);
	double *kernel = convolve_alloc(c), *y = fft_alloc((size_t)n * (size_t)n);

	convolve_kernel(c, kernel, love, NULL);
	setup = now() - start;
	for (int k = 0; k < 5; k++) {
		start = now();
		convolve_apply(c, kernel, x, y);
		best = fmin(best, now() - start);
	}
	printf("%d\t%g\tfft\t-\t-\t1e-16\t%.5f\t%.5f\n", n, fill, best, setup);
	convolve_free(c);
	fft_free(kernel);
	return y;
}

static void by_levels(
	int n, double fill, int order, int reach, const double *x, const double *want)
{
	size_t cells = (size_t)n * (size_t)n;
	double start = now(), setup, best = INFINITY, error = 0, size = 0;
	struct mlms *m = mlms_new((size_t)n, (size_t)n, 1, order, reach, love, NULL, NULL);
	double *y = fft_alloc(cells);

	setup = now() - start;
	for (int k = 0; k < 3; k++) {
		start = now();
		mlms_apply(m, x, y);
		best = fmin(best, now() - start);
	}
	for (size_t i = 0; i < cells; i++) {
		error = fmax(error, fabs(y[i] - want[i]));
		size = fmax(size, fabs(want[i]));
	}
	printf("%d\t%g\tmlms\t%d\t%d\t%.2e\t%.5f\t%.5f\n", n, fill, order, reach,
		error / size, best, setup);
	mlms_free(m);
	fft_free(y);
}

int main(int argc, char **argv)
{
	int n = argc > 2 ? atoi(argv[1]) : 0;
	double fill = argc > 2 ? atof(argv[2]) : 0, *x, *want;

	if (n < 1 || fill <= 0) {
		fprintf(stderr, "usage: multiply N FILL\n");
		return 2;
	}
	x = fft_alloc((size_t)n * (size_t)n);
	fill_disc(x, n, fill);
	want = by_fourier(n, fill, x);
	for (int order = 2; order <= 12; order += 2)
		by_levels(n, fill, order, 2 * order + 2, x, want);
	fft_free(x);
	fft_free(want);
	return 0;
}
