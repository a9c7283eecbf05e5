/* filter - FIR filters: rounding error against time, over taps and block
 *
 * Prints rows "scene taps block points error seconds": error is the largest difference to
 * the same sum in long double on samples of rms 1, over the rms of the output; seconds of
 * processor time are for 1e6 samples of one channel, the median of five. */
#include "signal/filter/fir.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CHECKED = 2000, SAMPLES = 400000 };

static double cpu(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_value(const void *x, const void *y)
{
	const double *a = x, *b = y;

	return *a > *b ? 1 : *a < *b ? -1 : 0;
}

/* Largest difference on the last CHECKED samples of n, over the rms there. */
static double error_of(
	const double *h, size_t taps, const double *x, const double *y, size_t n)
{
	double worst = 0, sum = 0;

	for (size_t i = n - CHECKED; i < n; i++) {
		long double exact = 0;

		for (size_t k = 0; k < taps; k++)
			exact += (long double)h[k] * x[i - k];
		worst = fmax(worst, fabs((double)(exact - y[i])));
		sum += y[i] * y[i];
	}
	return worst / sqrt(sum / CHECKED);
}

static void run(size_t taps, size_t block)
{
	struct fir_band band = { (int)taps - 1, 0.007, 0.013, FIR_HAMMING, 0, 1 };
	size_t n = SAMPLES > 8 * taps ? SAMPLES : 8 * taps;
	double *h = malloc(taps * sizeof *h), *x = malloc(n * sizeof *x);
	double *y = malloc(n * sizeof *y), seconds[5];
	struct fir *fir;
	unsigned state = 1;

	fir_design(&band, h);
	for (size_t i = 0; i < n; i++) {
		state = state * 1664525u + 1013904223u;
		x[i] = sqrt(12) * ((double)state / 4294967296.0 - 0.5);
	}
	for (int rep = 0; rep < 5; rep++) {
		double start;

		fir = fir_new(h, taps, 1, block);
		memcpy(y, x, n * sizeof *x);
		start = cpu();
		for (size_t i = 0, m; i < n; i += m) {
			m = fir_block(fir) < n - i ? fir_block(fir) : n - i;
			fir_run(fir, y + i, m);
		}
		seconds[rep] = (cpu() - start) * 1e6 / (double)n;
		if (rep == 4)
			printf("%s\t%zu\t%zu\t%zu\t", block ? "block" : "chosen", taps,
				fir_block(fir), fir_transform(fir));
		fir_free(fir);
	}
	qsort(seconds, 5, sizeof *seconds, by_value);
	printf("%.2e\t%.3e\n", error_of(h, taps, x, y, n), seconds[2]);
	free(h);
	free(x);
	free(y);
}

int main(void)
{
	static const size_t taps[] = { 3, 11, 21, 51, 101, 201, 801, 3201, 12801 };
	static const size_t block[] = { 1, 8, 64, 256, 824, 1848, 3896, 16184 };

	for (size_t i = 0; i < sizeof taps / sizeof *taps; i++)
		run(taps[i], 0);
	for (size_t i = 0; i < sizeof block / sizeof *block; i++)
		run(201, block[i]);
	return 0;
}
