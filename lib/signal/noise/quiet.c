/* quiet.c - see quiet.h */
#include "signal/noise/quiet.h"
#include "num/fft.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP = 8, PASSES = 4 };

/* Power of GROUP neighbouring bins of both channels, relative to that of the noise, which
 * noise exceeds about once in 1e6. */
static const double loud = 2.8;

/* Periodograms of count half-overlapping segments: power[i * bins + k - 1] of bin k. */
static enum num_status transform(
	const double *y, size_t segment, size_t count, double *power)
{
	size_t bins = segment / 2;
	struct fft *fft = fft_new(segment, 1);
	double complex *spectrum = fft_alloc_complex(bins + 1);
	double *x = fft_alloc(segment), scale = 8 / (3 * (double)segment);
	enum num_status status = fft && spectrum && x ? NUM_OK : NUM_MEMORY;

	for (size_t i = 0; !status && i < count; i++) {
		for (size_t k = 0; k < segment; k++) {
			double angle = 2 * M_PI * ((double)k + 0.5) / (double)segment;

			x[k] = y[i * bins + k] * (0.5 - 0.5 * cos(angle));
		}
		fft_forward(fft, x, spectrum);
		for (size_t k = 1; k <= bins; k++) {
			double re = creal(spectrum[k]), im = cimag(spectrum[k]);

			power[i * bins + k - 1] = scale * (re * re + im * im);
		}
	}
	fft_done(fft);
	fft_free(spectrum);
	fft_free(x);
	return status;
}

/* Lower quartile of each bin, scaled to the mean of the exponential distribution. */
static void quartile_spectrum(
	const double *power, size_t bins, size_t count, double *work, double *spectrum)
{
	for (size_t k = 0; k < bins; k++) {
		for (size_t i = 0; i < count; i++)
			work[i] = power[i * bins + k];
		spectrum[k] = robust_quantile(work, count, 0.25) / log(4.0 / 3);
	}
}

static void mean_spectrum(const double *power, size_t bins, size_t count,
	const char *quiet, int quiets, double *spectrum)
{
	memset(spectrum, 0, bins * sizeof *spectrum);
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; quiet[i] && k < bins; k++)
			spectrum[k] += power[i * bins + k] / quiets;
}

/* 1 if no group of bins of this segment exceeds the spectra significantly. */
static int is_quiet(const double *power[2], double *const spectrum[2], size_t bins)
{
	double sum = 0;
	size_t have = 0;

	for (size_t k = 0; k < bins; k++) {
		for (int c = 0; c < 2; c++)
			if (spectrum[c][k] > 0)
				sum += power[c][k] / spectrum[c][k];
		if (++have < GROUP)
			continue;
		if (sum > loud * 2 * GROUP)
			return 0;
		sum = 0;
		have = 0;
	}
	return 1;
}

enum num_status quiet_spectrum(const double *y1, const double *y2, size_t n,
	size_t segment, double *power1, double *power2, int *quiets)
{
	size_t bins = segment / 2, count = n / bins > 1 ? n / bins - 1 : 0;
	double *power = malloc((2 * count * bins + count + 1) * sizeof *power);
	double *part[2], *spectrum[2] = { power1 + 1, power2 + 1 };
	char *quiet = malloc(count + 1);
	enum num_status status = power && quiet ? NUM_OK : NUM_MEMORY;

	*quiets = 0;
	if (status != NUM_OK || count == 0)
		goto done;
	part[0] = power;
	part[1] = power + count * bins;
	status = transform(y1, segment, count, part[0]);
	if (!status)
		status = transform(y2, segment, count, part[1]);
	if (status)
		goto done;
	for (int c = 0; c < 2; c++)
		quartile_spectrum(
			part[c], bins, count, power + 2 * count * bins, spectrum[c]);
	for (int pass = 0; pass < PASSES; pass++) {
		*quiets = 0;
		for (size_t i = 0; i < count; i++) {
			const double *here[2] = { part[0] + i * bins,
				part[1] + i * bins };

			quiet[i] = (char)is_quiet(here, spectrum, bins);
			*quiets += quiet[i];
		}
		if (*quiets == 0)
			break;
		for (int c = 0; c < 2; c++)
			mean_spectrum(part[c], bins, count, quiet, *quiets, spectrum[c]);
	}
	power1[0] = power1[1];
	power2[0] = power2[1];
done:
	free(power);
	free(quiet);
	return status;
}
