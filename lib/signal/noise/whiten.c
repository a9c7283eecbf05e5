/* whiten.c - see whiten.h */
#include "signal/noise/whiten.h"
#include "num/dot.h"
#include "num/periodogram.h"
#include "signal/filter/fir.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double least_power = 2.5e-5; /* (1/200)^2 */

/* Ratio of measured powers two frequencies apart, from the first on, below which the
 * slope is too steep to be known; the lower frequencies are then lost. */
static const double steep = 0.18;

/* Gain at frequency f, from 0 at the edge lost to 1 at the edge whole. */
static double taper(double f, double lost, double whole)
{
	double u = (f - lost) / (whole - lost);

	return u <= 0 ? 0 : u >= 1 ? 1 : 0.5 - 0.5 * cos(M_PI * u);
}

/* The bins around the strongest one in which the power is at least the least one. */
static void find_band(const double *power, size_t n, size_t *first, size_t *last)
{
	size_t peak = 0;

	for (size_t k = 1; k < n; k++)
		if (power[k] > power[peak])
			peak = k;
	for (*first = peak; *first > 0; --*first)
		if (power[*first - 1] < least_power * power[peak])
			break;
	for (*last = peak; *last + 1 < n; ++*last)
		if (power[*last + 1] < least_power * power[peak])
			break;
}

/* Symmetric taps -half..half of the gain at n frequencies, tapered towards the ends; gain
 * is overwritten. */
static enum num_status taps_of_gain(double *gain, size_t n, int half, double *tap)
{
	enum num_status status = fft_even(gain, n);

	for (int k = -half; k <= half; k++)
		tap[k + half] = gain[abs(k)] / (double)(2 * (n - 1)) *
				taper(half + 1 - abs(k), 0, 0.25 * half + 1);
	return status;
}

/* Gain at n frequencies of symmetric taps -half..half. */
static enum num_status gain_of_taps(const double *tap, int half, size_t n, double *gain)
{
	for (size_t k = 0; k < n; k++)
		gain[k] = k <= (size_t)half ? tap[half + (int)k] : 0;
	return fft_even(gain, n);
}

/* Drops negligible taps at both ends. */
static void trim(double *tap, int *half)
{
	double most = 0;
	int keep = *half;

	for (int k = 0; k <= 2 * *half; k++)
		most = fmax(most, fabs(tap[k]));
	while (keep > 0 && fabs(tap[*half + keep]) < 2e-4 * most)
		keep--;
	memmove(tap, tap + (*half - keep), (2 * (size_t)keep + 1) * sizeof *tap);
	*half = keep;
}

/* Gains that whiten the noise, with smooth edges where frequencies are lost, and the
 * gains of a pulse, without its baseline, through them and the filter. */
static void whitening_gains(struct whitening *w, const double *power, size_t n,
	double unit, double *gain, double *seen)
{
	double step = 0.5 / (double)(n - 1);
	size_t first, last;

	find_band(power, n, &first, &last);
	w->low = first ? fmin(1.25 * (double)first,
				 (double)first + 0.2 * (double)(last - first)) *
				 step
		       : 0;
	w->high = last + 1 < n ? 0.8 * (double)last * step : 0.5;
	for (size_t k = 0; k < n; k++) {
		double f = (double)k * step, keep = 1;

		seen[k] = 1;
		if (first)
			keep *= taper(f, (double)first * step, w->low);
		if (last + 1 < n)
			keep *= seen[k] = taper(f, (double)last * step, w->high);
		gain[k] = keep > 0 ? keep * sqrt(unit / power[k]) : 0;
	}
}

/* Computes what the taps leave of a pulse and of the noise. */
static enum num_status look_through(struct whitening *w, const double *power, double unit,
	size_t n, enum whiten_kind kind, double *gain, double *seen)
{
	size_t lowest = (size_t)ceil(w->low * 2 * (double)(n - 1));

	if (gain_of_taps(w->tap, w->half, n, gain))
		return NUM_MEMORY;
	for (size_t k = 0; k < n; k++)
		w->band += gain[k] * gain[k] * power[k] / unit *
			   (k == 0 || k == n - 1 ? 0.5 : 1) / (double)(n - 1);
	if (kind == WHITEN_COLOURED) /* the baseline is fitted, so it is kept */
		for (size_t k = 0; k < n; k++)
			seen[k] = gain[k < lowest ? lowest : k];
	if (taps_of_gain(seen, n, w->half, w->seen))
		return NUM_MEMORY;
	trim(w->seen, &w->seen_half);
	return NUM_OK;
}

static int edge_of_taps(const double *tap, int half)
{
	double all = 0, beyond = 0;
	int edge = half;

	for (int k = 0; k <= 2 * half; k++)
		all += tap[k] * tap[k];
	while (edge > 0 && beyond < 0.01 * all) {
		beyond += 2 * tap[half + edge] * tap[half + edge];
		edge--;
	}
	return edge;
}

/* power[k] of the noise at frequency k / (2 (n - 1)), k < n; unit: that of the white
 * noise to be made of it; half < n: length of the taps.  NUM_DOMAIN unless unit > 0 and
 * there is power at some frequency. */
static enum num_status whitening_make(struct whitening *w, const double *power, size_t n,
	double unit, int half, enum whiten_kind kind)
{
	double *gain = malloc(2 * n * sizeof *gain);
	enum num_status status;

	memset(w, 0, sizeof *w);
	w->half = w->seen_half = half;
	w->tap = malloc((2 * (size_t)half + 1) * sizeof *w->tap);
	w->seen = malloc((2 * (size_t)half + 1) * sizeof *w->seen);
	status = !gain || !w->tap || !w->seen           ? NUM_MEMORY
		 : unit > 0 && largest_of(power, n) > 0 ? NUM_OK
							: NUM_DOMAIN;
	if (!status) {
		whitening_gains(w, power, n, unit, gain, gain + n);
		status = taps_of_gain(gain, n, half, w->tap);
	}
	if (!status) {
		status = look_through(w, power, unit, n, kind, gain, gain + n);
		w->edge = edge_of_taps(w->tap, half);
	}
	free(gain);
	if (status)
		whitening_clear(w);
	return status;
}

enum num_status whitening_of_noise(struct whitening *w, const double *power, double drift,
	size_t n, enum whiten_kind kind)
{
	enum { FINER = 8 };
	size_t fine = FINER * (n - 1) + 1, first = 0;
	double *between = malloc(fine * sizeof *between), weakest = INFINITY;
	const double most = largest_of(power, n);
	enum num_status status;

	memset(w, 0, sizeof *w);
	if (!between)
		return NUM_MEMORY;
	if (n > 3 && power[1] < steep * power[3])
		first = 2;
	for (size_t k = 0; k < fine; k++) {
		size_t from = k / FINER, to = from + 1 < n ? from + 1 : from;
		double part = (double)(k % FINER) / FINER;
		double least = 1e-12 * most;

		if (from < first || power[from] < least_power * most)
			between[k] = 0;
		else
			between[k] = pow(power[from], 1 - part) *
				     pow(fmax(power[to], least), part);
		if (between[k] > 0)
			weakest = fmin(weakest, between[k]);
	}
	/* The power of a walk has no limit: it must not make others too weak. */
	for (size_t k = 0; k < fine && drift > 0; k++) {
		double sine =
			2 * sin(0.5 * M_PI * fmax((double)k, 0.5) / (double)(fine - 1));

		between[k] = fmin(between[k] * (1 + drift / (sine * sine)),
			fmax(between[k], weakest / least_power));
	}
	status = whitening_make(
		w, between, fine, largest_of(between, fine), (int)(2 * n), kind);
	free(between);
	return status;
}

enum num_status whitening_of_filter(struct whitening *w, const double *tap, size_t taps)
{
	/* An inverse is longer than the filter, because the gain is steep near the edges.
	 */
	size_t points = fft_good_size(24 * taps + 64), n;
	double *power;
	struct periodogram *p;
	enum num_status status;

	points += points % 2;
	n = points / 2 + 1;
	power = calloc(n, sizeof *power);
	p = periodogram_new(points);
	status = power && p ? NUM_OK : NUM_MEMORY;
	memset(w, 0, sizeof *w);
	if (status == NUM_OK) {
		memcpy(p->x, tap, taps * sizeof *tap);
		periodogram_add(p, 1, power, n);
		status = whitening_make(w, power, n, 1, (int)(6 * taps), WHITEN_FILTERED);
	}
	free(power);
	periodogram_free(p);
	return status;
}

void whitening_clear(struct whitening *w)
{
	free(w->tap);
	free(w->seen);
	w->tap = w->seen = NULL;
}

int whitening_removes_mean(const struct whitening *w)
{
	/* Of the gain at 0 over that of white noise: 0.007 to 0.03 where the noise drifts
	 * (five records), 0.09 to 0.4 where it is low-passed at 0.02 to 0.1 of the rate.
	 */
	const double small = 0.05;
	double sum = 0, all = 0;

	for (int k = 0; k <= 2 * w->half; k++) {
		sum += w->tap[k];
		all += w->tap[k] * w->tap[k];
	}
	return fabs(sum) < small * sqrt(all);
}

enum num_status whitening_apply(const struct whitening *w, double *x, size_t n)
{
	struct fir *fir = fir_new(w->tap, 2 * (size_t)w->half + 1, 1, 0);
	size_t block = fir ? fir_block(fir) : 0, delay = (size_t)w->half;
	double *piece = malloc((block + 1) * sizeof *piece);
	const int hold = whitening_removes_mean(w) && n > 0;
	const double first = hold ? x[0] : 0, last = hold ? x[n - 1] : 0;

	/* Output lags behind input. */
	for (size_t at = 0; fir && piece && at < n + delay; at += block) {
		for (size_t i = 0; i < block; i++)
			piece[i] = (at + i < n ? x[at + i] : last) - first;
		fir_run(fir, piece, block);
		for (size_t i = 0; i < block; i++)
			if (at + i >= delay && at + i < n + delay)
				x[at + i - delay] = piece[i];
	}
	block = fir && piece;
	fir_free(fir);
	free(piece);
	return block ? NUM_OK : NUM_MEMORY;
}
