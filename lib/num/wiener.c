/* wiener.c - see wiener.h */
#include "num/wiener.h"
#include "num/fft.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Multiplies the spectrum by the share of its power above noise.  sum: bins + 1. */
static void keep_signal(
	double complex *spectrum, size_t bins, size_t side, double noise, double *sum)
{
	sum[0] = 0;
	for (size_t k = 0; k < bins; k++) {
		double re = creal(spectrum[k]), im = cimag(spectrum[k]);

		sum[k + 1] = sum[k] + re * re + im * im;
	}
	for (size_t k = 0; k < bins; k++) {
		size_t from = k > side ? k - side : 0;
		size_t to = k + side < bins ? k + side + 1 : bins;
		double power = (sum[to] - sum[from]) / (double)(to - from);

		spectrum[k] *= power > noise ? 1 - noise / power : 0;
	}
}

enum num_status wiener_filter(double *x, size_t n, double variance, double width)
{
	/* Zeros behind the sequence keep its end from its beginning. */
	size_t size = fft_good_size(2 * n), bins = size / 2 + 1;
	double *padded = fft_alloc(size), *sum = malloc((bins + 1) * sizeof *sum);
	double complex *spectrum = fft_alloc_complex(bins);
	struct fft *fft = fft_new(size, 1);
	int have = padded && sum && spectrum && fft;

	if (have) {
		memcpy(padded, x, n * sizeof *x);
		fft_forward(fft, padded, spectrum);
		keep_signal(spectrum, bins, (size_t)ceil(0.5 * (double)size / width),
			variance * (double)n, sum);
		fft_inverse(fft, spectrum, padded);
		for (size_t i = 0; i < n; i++)
			x[i] = padded[i] / (double)size;
	}
	fft_done(fft);
	fft_free(padded);
	fft_free(spectrum);
	free(sum);
	return have ? NUM_OK : NUM_MEMORY;
}
