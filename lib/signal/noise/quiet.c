/* quiet.c - see quiet.h */
#include "signal/noise/quiet.h"
#include "num/periodogram.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { GROUP = 8, PASSES = 4 };

/* Power of GROUP neighbouring bins of both channels, relative to that of the noise, which
 * noise exceeds about once in 1e6. */
static const double loud = 2.8;

/* Periodograms of count half-overlapping segments, each of bins + 1 values. */
static enum num_status transform(
	const double *y, size_t segment, size_t count, double *power)
{
	size_t bins = segment / 2;
	struct periodogram *p = periodogram_new(segment);

	for (size_t i = 0; p && i < count; i++, power += bins + 1) {
		for (size_t k = 0; k < segment; k++) {
			double angle = 2 * M_PI * ((double)k + 0.5) / (double)segment;

			p->x[k] = y[i * bins + k] * (0.5 - 0.5 * cos(angle));
		}
		periodogram_add(p, 8 / (3 * (double)segment), power, bins + 1);
	}
	periodogram_free(p);
	return p ? NUM_OK : NUM_MEMORY;
}

/* Lower quartile of each bin, scaled to the mean of the exponential distribution. */
static void quartile_spectrum(
	const double *power, size_t bins, size_t count, double *work, double *spectrum)
{
	for (size_t k = 1; k <= bins; k++) {
		for (size_t i = 0; i < count; i++)
			work[i] = power[i * (bins + 1) + k];
		spectrum[k] = robust_quantile(work, count, 0.25) / log(4.0 / 3);
	}
}

static void mean_spectrum(const double *power, size_t bins, size_t count,
	const char *quiet, int quiets, double *spectrum)
{
	memset(spectrum, 0, (bins + 1) * sizeof *spectrum);
	for (size_t i = 0; i < count; i++, power += bins + 1)
		for (size_t k = 1; quiet[i] && k <= bins; k++)
			spectrum[k] += power[k] / quiets;
}

/* 1 if no group of bins of this segment, whose channels are apart, exceeds the spectra
 * significantly. */
static int is_quiet(
	const double *power, size_t apart, double *const spectrum[2], size_t bins)
{
	double sum = 0;

	for (size_t k = 1; k <= bins; k++) {
		for (int c = 0; c < 2; c++)
			if (spectrum[c][k] > 0)
				sum += power[(size_t)c * apart + k] / spectrum[c][k];
		if (k % GROUP)
			continue;
		if (sum > loud * 2 * GROUP)
			return 0;
		sum = 0;
	}
	return 1;
}

enum num_status quiet_spectrum(const double *y1, const double *y2, size_t n,
	size_t segment, double *power1, double *power2, int *quiets)
{
	size_t bins = segment / 2, count = n / bins > 1 ? n / bins - 1 : 0;
	size_t all = count * (bins + 1);
	double *power = calloc(2 * all + count + 1, sizeof *power);
	double *const spectrum[2] = { power1, power2 };
	char *quiet = malloc(count + 1);
	enum num_status status =
		power && quiet ? transform(y1, segment, count, power) : NUM_MEMORY;

	*quiets = 0;
	if (status == NUM_OK)
		status = transform(y2, segment, count, power + all);
	for (int c = 0; c < 2 && status == NUM_OK; c++)
		quartile_spectrum(power + (size_t)c * all, bins, count, power + 2 * all,
			spectrum[c]);
	for (int pass = 0; pass < PASSES && status == NUM_OK; pass++) {
		*quiets = 0;
		for (size_t i = 0; i < count; i++) {
			quiet[i] = (char)is_quiet(
				power + i * (bins + 1), all, spectrum, bins);
			*quiets += quiet[i];
		}
		for (int c = 0; c < 2 && *quiets > 0; c++)
			mean_spectrum(power + (size_t)c * all, bins, count, quiet,
				*quiets, spectrum[c]);
		for (int c = 0; c < 2; c++)
			spectrum[c][0] = spectrum[c][1];
	}
	free(power);
	free(quiet);
	return status;
}
