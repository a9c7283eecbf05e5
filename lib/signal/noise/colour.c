/* colour.c - see colour.h */
#include "signal/noise/colour.h"
#include "num/cholesky.h"
#include "num/dot.h"
#include "num/lesser.h"
#include "num/periodogram.h"
#include "num/robust.h"
#include "num/sigmas.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Samples of a segment, and fewest of them whose mean spectrum is used. */
enum { LONGEST = 2 * (COLOUR_BINS - 1), FEWEST = 16 };

/* Power of eight neighbouring bins of both channels, relative to that of the noise, which
 * noise exceeds about once in 1e6. */
static const double loud = 2.8;

/* Periodograms of count half-overlapping segments of the samples or, with steps, of their
 * differences, each of bins + 1 values. */
static enum num_status transform(
	const double *y, int steps, size_t segment, size_t count, double *power)
{
	size_t bins = segment / 2;
	struct periodogram *p = periodogram_new(segment);

	for (size_t i = 0; p && i < count; i++, power += bins + 1) {
		const double *x = y + i * bins;

		for (size_t k = 0; k < segment; k++) {
			double angle = 2 * M_PI * ((double)k + 0.5) / (double)segment;

			p->x[k] = (steps ? x[k + 1] - x[k] : x[k]) *
				  (0.5 - 0.5 * cos(angle));
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
	const char *noise, int segments, double *spectrum)
{
	memset(spectrum, 0, (bins + 1) * sizeof *spectrum);
	for (size_t i = 0; i < count; i++, power += bins + 1)
		for (size_t k = 1; noise[i] && k <= bins; k++)
			spectrum[k] += power[k] / segments;
}

/* 1 if no group of bins of this segment, whose channels are apart, exceeds the spectra
 * significantly. */
static int is_noise(
	const double *power, size_t apart, double *const spectrum[2], size_t bins)
{
	enum { GROUP = 8 };
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

enum num_status colour_spectrum(const double *y1, const double *y2, size_t n, int steps,
	size_t segment, double *power1, double *power2, int *found)
{
	enum { PASSES = 4 };
	size_t bins = segment / 2, halves = (steps && n > 0 ? n - 1 : n) / bins;
	size_t count = halves > 1 ? halves - 1 : 0;
	size_t all = count * (bins + 1);
	double *power = calloc(2 * all + count + 1, sizeof *power);
	double *const spectrum[2] = { power1, power2 };
	char *noise = malloc(count + 1);
	enum num_status status =
		power && noise ? transform(y1, steps, segment, count, power) : NUM_MEMORY;

	*found = 0;
	if (status == NUM_OK)
		status = transform(y2, steps, segment, count, power + all);
	for (int c = 0; c < 2 && status == NUM_OK; c++)
		quartile_spectrum(power + (size_t)c * all, bins, count, power + 2 * all,
			spectrum[c]);
	for (int pass = 0; pass < PASSES && status == NUM_OK; pass++) {
		*found = 0;
		for (size_t i = 0; i < count; i++) {
			noise[i] = (char)is_noise(
				power + i * (bins + 1), all, spectrum, bins);
			*found += noise[i];
		}
		for (int c = 0; c < 2 && *found > 0; c++)
			mean_spectrum(power + (size_t)c * all, bins, count, noise, *found,
				spectrum[c]);
		for (int c = 0; c < 2; c++)
			spectrum[c][0] = spectrum[c][1];
	}
	free(power);
	free(noise);
	return status;
}

/* Power of the whitened noise relative to white noise. */
static double level(const struct whitening *w, double *power, size_t segment)
{
	size_t from = (size_t)(w->low * (double)segment) + 1,
	       to = (size_t)(w->high * (double)segment);

	if (to < from)
		from = to = (size_t)(0.5 * (w->low + w->high) * (double)segment + 0.5);
	return robust_median(power + from, to - from + 1);
}

/* Noise of both channels as segments of one length show it. */
struct quiet {
	size_t segment;
	double power[2][COLOUR_BINS];
	int found; /* segments that hold only noise */
};

/* Ratio of the power of longer segments to that of shorter ones from which on pulses are
 * in the longer ones.  It scatters by at most 18 %, where FEWEST of the longest are
 * compared with those of half of their length, and has 256 values: about one in a hundred
 * such spectra has one above 2 by chance, to which shorter segments are as good. */
static const double FULLER = 2;

/* 1 if hardly any of the longer segments was without pulses, so that these were taken for
 * noise: shorter ones then hold less at some frequency. */
static int holds_pulses(const struct quiet *longer, const struct quiet *shorter)
{
	const size_t ratio = longer->segment / shorter->segment;

	for (size_t k = 1; k <= shorter->segment / 2; k++) {
		size_t from = k * ratio - ratio / 2;
		size_t to = lesser(k * ratio + ratio / 2, longer->segment / 2);
		double sum = 0;

		for (int c = 0; c < 2; c++)
			sum += mean_of(longer->power[c] + from, to - from + 1) /
			       shorter->power[c][k];
		if (sum > 2 * FULLER)
			return 1;
	}
	return 0;
}

/* 1 if the segments have as many samples as FEWEST of LONGEST. */
static int is_enough(const struct quiet *quiet)
{
	return (size_t)quiet->found * quiet->segment >= (size_t)FEWEST * LONGEST;
}

/* The noise in the longest segments, of at least so many samples, of which FEWEST hold
 * only noise, and not pulses instead, as enough shorter ones show. */
static enum num_status find_quiet(const double *y1, const double *y2, size_t n, int steps,
	double least, struct quiet *quiet)
{
	enum { SHORTEST = 64 };
	enum num_status status = NUM_OK;

	*quiet = (struct quiet){ .segment = LONGEST };
	for (size_t segment = LONGEST; status == NUM_OK && segment >= SHORTEST &&
				       (segment == LONGEST || (double)segment >= least);
		segment /= 2) {
		struct quiet now = { .segment = segment };

		status = colour_spectrum(y1, y2, n, steps, segment, now.power[0],
			now.power[1], &now.found);
		if (status == NUM_OK &&
			(quiet->found < FEWEST ||
				(is_enough(&now) && holds_pulses(quiet, &now))))
			*quiet = now;
	}
	return status;
}

enum num_status colour_level(const double *y1, const double *y2, size_t n,
	const struct whitening *w, double noise[2])
{
	struct quiet quiet;
	enum num_status status = find_quiet(y1, y2, n, 0, 4 / (w->high - w->low), &quiet);

	for (int c = 0; c < 2 && status == NUM_OK; c++)
		noise[c] = sqrt(level(w, quiet.power[c], quiet.segment));
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

/* Factor of lag k by which an autocorrelation is truncated smoothly from last / 2 on. */
static double keep_lag(size_t k, size_t last)
{
	double u = 2 * (double)k / (double)last - 1;

	return u <= 0 ? 1 : u < 1 ? 0.5 + 0.5 * cos(M_PI * u) : 0;
}

/* The power of which r is the autocorrelation, in its place. */
static enum num_status positive_spectrum(double *r, size_t bins)
{
	enum num_status status = fft_even(r, bins);

	for (size_t k = 0; k < bins; k++)
		r[k] = fmax(r[k], 0);
	return status;
}

/* Removes the effect of the window from a mean periodogram of the first bins, and makes
 * it one of COLOUR_BINS: the autocorrelation is divided by that of the window, and
 * truncated smoothly at half its length. */
static enum num_status sharpen(double *power, size_t bins)
{
	size_t last = bins - 1, points = 2 * last;
	enum num_status status = fft_even(power, bins);

	for (size_t k = 0; k < COLOUR_BINS; k++) {
		double keep = keep_lag(k, last);

		power[k] *= keep > 0 ? keep / window_autocorrelation(points, k, 0) /
					       (double)points
				     : 0;
	}
	return status == NUM_OK ? positive_spectrum(power, COLOUR_BINS) : status;
}

/* Bins of segments of the steps of a record of which drift is estimated: from
 * DRIFT_FIRST, as low ones show the tails of pulses, to DRIFT_END of the longest
 * segments, and at least to DRIFT_FEWEST, twice as many as there are unknown powers. With
 * 1, 2 and 3 as the first, drift is found in 27, 24 and 20 of 36 records that drift, and
 * in 19, 3 and 2 of 108 that do not; an end at 16, 32 and 64 finds 12, 24 and 26, the
 * fewest of 5, 8 and 12 find 24, 24 and 25. */
enum { DRIFT_FIRST = 2, DRIFT_END = 32, DRIFT_FEWEST = 6 };

/* Power of the differences of successive samples, the mean of both channels, and that of
 * white noise, as periodograms under a Hann window have them.  The window spreads the
 * power of a walk from its lowest frequencies over others, but not that of its steps,
 * which is white. */
struct steps {
	size_t segment;
	int found;
	double power[COLOUR_BINS], white[COLOUR_BINS];
};

static void mean_power(const struct quiet *quiet, double *power)
{
	for (int k = 0; k < COLOUR_BINS; k++)
		power[k] = 0.5 * (quiet->power[0][k] + quiet->power[1][k]);
}

static void set_steps(const struct quiet *quiet, struct steps *s)
{
	const double next = window_autocorrelation(quiet->segment, 1, 0);

	s->segment = quiet->segment;
	s->found = quiet->found;
	mean_power(quiet, s->power);
	for (int k = 0; k < COLOUR_BINS; k++)
		s->white[k] = 2 - 2 * next * cos(2 * M_PI * k / (double)s->segment);
}

/* Powers of white noise, unless corner is 0 of noise behind a low-pass of this corner, in
 * bins, and with a walk of a random walk, at the lowest frequencies of the steps of a
 * record, from bin first on: weighted least squares, the weights those of exponential
 * variates of the mean fitted.  *drift: as in struct colour.  Returns the deviance of
 * these means; INFINITY: there is no solution. */
static double fit_steps(
	const struct steps *steps, int first, double corner, int walk, double *drift)
{
	enum { ROUNDS = 8, MOST = 3 };
	const int most = DRIFT_END * (int)steps->segment / LONGEST;
	const int end = most > DRIFT_FEWEST ? most : DRIFT_FEWEST;
	const int terms = 1 + (corner > 0) + walk;
	double x[MOST] = { 0 }, a[MOST * MOST], deviance = 0, level;

	for (int round = 0; round < ROUNDS; round++) {
		double y[MOST] = { 0 };

		memset(a, 0, sizeof a);
		deviance = 0;
		for (int k = first; k <= end; k++) {
			double white = steps->white[k], power = steps->power[k];
			double passed = white / (1 + pow(k / corner, 2));
			double term[MOST] = { white, corner > 0 ? passed : 1, 1 };
			double mean =
				round ? fmax(dot(x, term, MOST), 0.1 * power) : power;
			double weight = 2 * steps->found / (mean * mean);

			deviance += 4 * steps->found * (log(mean) + power / mean);
			for (int i = 0; i < terms; i++) {
				y[i] += weight * term[i] * power;
				for (int j = 0; j <= i; j++)
					a[i * MOST + j] += weight * term[i] * term[j];
			}
		}
		if (cholesky_factor(a, (size_t)terms, MOST, 0) != NUM_OK)
			return INFINITY;
		cholesky_solve(a, (size_t)terms, MOST, y);
		memcpy(x, y, sizeof x);
	}
	level = x[0] + (corner > 0 ? x[1] : 0);
	*drift = walk ? fmax(x[terms - 1] / level, 0) : 0;
	return level > 0 ? deviance : INFINITY;
}

/* Variance of the steps of a random walk over the power of the other noise at the lowest
 * frequencies; 0 unless it explains them clearly better than noise behind a low-pass, or
 * both together clearly better than either: the tails of pulses look like both.  first:
 * as above. */
static double find_drift(const struct steps *steps, int first)
{
	const double clear = SIGMAS_RARELY * SIGMAS_RARELY;
	double drift, both = 0, low_pass = INFINITY, beside = INFINITY;
	double walk = fit_steps(steps, first, 0, 1, &drift);

	/* A low-pass of a lower corner cannot be told from drift, and one of a higher
	 * corner is white. */
	for (double corner = 2 * DRIFT_FIRST; corner <= 2 * DRIFT_END; corner *= 1.25) {
		double found, deviance;

		low_pass = fmin(low_pass, fit_steps(steps, first, corner, 0, &found));
		deviance = fit_steps(steps, first, corner, 1, &found);
		if (deviance < beside) {
			beside = deviance;
			both = found;
		}
	}
	if (beside + clear < fmin(walk, low_pass - clear))
		return both;
	return walk + clear < low_pass ? drift : 0;
}

enum num_status colour_power(
	const double *y1, const double *y2, size_t n, struct colour *colour)
{
	struct quiet quiet;
	struct steps steps;
	double *power = colour->power;
	enum num_status status = find_quiet(y1, y2, n, 1, 0, &quiet);

	colour->drift = 0;
	if (status != NUM_OK)
		return status;
	set_steps(&quiet, &steps);
	/* What is left of lines has little power at the lowest frequency, where a walk
	 * has most. */
	if (is_enough(&quiet) && find_drift(&steps, 1) > 0)
		colour->drift = find_drift(&steps, DRIFT_FIRST);
	if (colour->drift > 0) {
		for (int k = 1; k < COLOUR_BINS; k++)
			power[k] = steps.power[k] / (steps.white[k] + colour->drift);
		power[0] = power[1];
	} else {
		status = find_quiet(y1, y2, n, 0, 0, &quiet);
		mean_power(&quiet, power);
		if (status == NUM_OK && !is_enough(&quiet))
			status = NUM_DOMAIN;
	}
	return status == NUM_OK ? sharpen(power, quiet.segment / 2 + 1) : status;
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

enum num_status colour_smooth(struct colour *colour)
{
	double *power = colour->power;
	size_t points = LONGEST, half = points / 2, last;

	if (fft_even(power, COLOUR_BINS) != NUM_OK)
		return NUM_MEMORY;
	last = last_lag(power, points, half / 2);
	for (size_t k = 0; k <= half; k++)
		power[k] *= keep_lag(k, last) / (double)points;
	return positive_spectrum(power, COLOUR_BINS);
}

/* Power at frequency k / LONGEST of the sum of independent steps of variance 1. */
static double walk(double k)
{
	double s = 2 * sin(M_PI * k / LONGEST);

	return 1 / (s * s);
}

int colour_is_white(const struct colour *colour, double from)
{
	enum { GROUP = 32 };
	double least = INFINITY, most = 0;
	int first = (int)fmin(from * LONGEST, LONGEST) + 1;

	for (int k = first; k + GROUP <= COLOUR_BINS; k += GROUP) {
		double sum = 0;

		for (int i = k; i < k + GROUP; i++)
			sum += colour->power[i] * (1 + colour->drift * walk(i));
		least = fmin(least, sum);
		most = fmax(most, sum);
	}
	return most < 1.3 * least;
}
