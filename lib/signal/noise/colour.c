/* colour.c - see colour.h */
#include "signal/noise/colour.h"
#include "num/fft.h"
#include "num/sigmas.h"
#include "signal/noise/quiet.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <stdlib.h>

enum { LONGEST = 2 * (COLOUR_BINS - 1), QUIETS = 16 };

/* Power of the whitened noise relative to white noise. */
static double level(const struct whitening *w, double *power, size_t segment)
{
	size_t from = (size_t)(w->low * (double)segment) + 1,
	       to = (size_t)(w->high * (double)segment);

	if (to < from)
		from = to = (size_t)(0.5 * (w->low + w->high) * (double)segment + 0.5);
	return robust_median(power + from, to - from + 1);
}

enum num_status colour_level(const double *y1, const double *y2, size_t n,
	const struct whitening *w, double noise[2])
{
	double least = 4 / (w->high - w->low);
	double *power = malloc((LONGEST + 2) * sizeof *power);
	enum num_status status = power ? NUM_OK : NUM_MEMORY;
	int quiets = 0;

	for (size_t segment = LONGEST; status == NUM_OK && quiets < QUIETS;
		segment /= 2) {
		double *other = power + segment / 2 + 1;

		if (segment < 64 || (segment < LONGEST && (double)segment < least))
			break;
		status = quiet_spectrum(y1, y2, n, segment, power, other, &quiets);
		if (status != NUM_OK)
			break;
		noise[0] = sqrt(level(w, power, segment));
		noise[1] = sqrt(level(w, other, segment));
	}
	free(power);
	return status;
}

/* Autocorrelation of a Hann window of n points, or of its square, at this lag, 1 at lag
 * 0. */
static double window_autocorrelation(size_t n, size_t lag, int squared)
{
	double sum = 0, all = 0, turn = 2 * M_PI / (double)n;

	for (size_t i = 0; i < n; i++) {
		double here = 0.5 - 0.5 * cos(turn * ((double)i + 0.5));
		double there = 0.5 - 0.5 * cos(turn * ((double)(i + lag) + 0.5));

		all += squared ? here * here * here * here : here * here;
		if (i + lag < n)
			sum += squared ? here * here * there * there : here * there;
	}
	return sum / all;
}

/* The power of which r is the autocorrelation, in its place. */
static enum num_status positive_spectrum(double *r, size_t bins)
{
	enum num_status status = fft_even(r, bins);

	for (size_t k = 0; k < bins; k++)
		r[k] = fmax(r[k], 0);
	return status;
}

/* Removes the effect of the window from a mean periodogram: the autocorrelation is
 * divided by that of the window, and truncated smoothly at half its length. */
static enum num_status sharpen(double *power, size_t bins)
{
	size_t last = bins - 1, points = 2 * last;
	enum num_status status = fft_even(power, bins);

	for (size_t k = 0; k <= last; k++) {
		double u = 2 * (double)k / (double)last - 1;
		double keep = u <= 0 ? 1 : 0.5 + 0.5 * cos(M_PI * u);

		power[k] *= keep / window_autocorrelation(points, k, 0) / (double)points;
	}
	return status == NUM_OK ? positive_spectrum(power, bins) : status;
}

enum num_status colour_power(const double *y1, const double *y2, size_t n,
	const double noise[2], double power[COLOUR_BINS])
{
	double *part = malloc(2 * COLOUR_BINS * sizeof *part);
	int quiets = 0;
	enum num_status status = part ? quiet_spectrum(y1, y2, n, LONGEST, part,
						part + COLOUR_BINS, &quiets)
				      : NUM_MEMORY;

	for (int k = 0; quiets > 0 && k < COLOUR_BINS; k++)
		power[k] = 0.5 * (part[k] / (noise[0] * noise[0]) +
					 part[COLOUR_BINS + k] / (noise[1] * noise[1]));
	free(part);
	if (status != NUM_OK)
		return status;
	return quiets >= QUIETS ? sharpen(power, COLOUR_BINS) : NUM_DOMAIN;
}

/* Twice the last of the first whole lags at which an autocorrelation exceeds its scatter,
 * which is estimated from the later half of them: its variance is proportional to the
 * overlap of the squared window over the square of that of the window. */
static size_t last_lag(const double *r, size_t points, size_t whole)
{
	double square = 0;
	size_t k = whole;

	for (size_t i = whole / 2; i < whole; i++) {
		double v = r[i] * window_autocorrelation(points, i, 0);

		square += 2 * v * v /
			  (window_autocorrelation(points, i, 1) * (double)whole);
	}
	for (; k > 8; k--) {
		double v = r[k] * window_autocorrelation(points, k, 0);

		if (v * v > SIGMAS_RARELY * SIGMAS_RARELY * square *
				    window_autocorrelation(points, k, 1))
			break;
	}
	return 2 * k;
}

enum num_status colour_smooth(double power[COLOUR_BINS])
{
	size_t points = LONGEST, half = points / 2, last;

	if (fft_even(power, COLOUR_BINS) != NUM_OK)
		return NUM_MEMORY;
	last = last_lag(power, points, half / 2);
	for (size_t k = 0; k <= half; k++) {
		double u = 2 * (double)k / (double)last - 1;

		power[k] *= (u <= 0         ? 1
				    : u < 1 ? 0.5 + 0.5 * cos(M_PI * u)
					    : 0) /
			    (double)points;
	}
	return positive_spectrum(power, COLOUR_BINS);
}

int colour_is_white(const double power[COLOUR_BINS], double from)
{
	enum { GROUP = 32 };
	double least = INFINITY, most = 0;
	int first = (int)fmin(from * LONGEST, LONGEST) + 1;

	for (int k = first; k + GROUP <= COLOUR_BINS; k += GROUP) {
		double sum = 0;

		for (int i = k; i < k + GROUP; i++)
			sum += power[i];
		least = fmin(least, sum);
		most = fmax(most, sum);
	}
	return most < 1.3 * least;
}
