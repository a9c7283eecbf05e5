/* Undoing a filter: gains, noise and pulses before and after; the spectrum of noise */
#include "signal/noise/whiten.h"
#include "num/normals.h"
#include "signal/filter/fir.h"
#include "signal/fit/joint.h"
#include "signal/noise/colour.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { N = 1 << 17, SEGMENT = 1024, PULSE = 8192 };

static double y[2][N];

static void make_noise(double *x, size_t n, double deviation, unsigned stream)
{
	struct normals *normals = normals_new(5, stream, RNG_NOISE);

	normals_pairs(normals, 0, n / 2, x);
	normals_free(normals);
	for (size_t i = 0; i < n; i++)
		x[i] *= deviation;
}

/* Filters x[0..n) without delay, zeros before and behind. */
static void pass_filter(const double *h, size_t taps, double *x, size_t n)
{
	struct fir *fir = fir_new(h, taps, 1, n + taps / 2);
	double *out = calloc(n + taps / 2, sizeof *out);

	memcpy(out, x, n * sizeof *out);
	fir_run(fir, out, n + taps / 2);
	memcpy(x, out + taps / 2, n * sizeof *out);
	free(out);
	fir_free(fir);
}

static double gain_at(const double *h, size_t taps, double f)
{
	double re, im;

	fir_response(h, taps, f, (double)(taps / 2), &re, &im);
	return re;
}

/* Filter and inverse in a row. */
static void test_gain(const struct whitening *w, const double *h, size_t taps)
{
	double inside = 0, outside = 0;

	for (int k = 0; k <= 400; k++) {
		double f = 0.5 * k / 400, loss = fabs(gain_at(h, taps, f));
		double gain = loss * gain_at(w->tap, 2 * (size_t)w->half + 1, f);

		/* Edges are at most 0.2 of low and 0.25 of high wide. */
		if (f >= 1.3 * w->low && f <= w->high)
			inside = tap_max(inside, fabs(gain - 1));
		else if (f < 0.75 * w->low || f > 1.3 * w->high)
			outside = tap_max(outside, fabs(gain));
	}
	ok(inside < 1e-3, "the gain is 1 from %.4f to %.4f (error %.1e)", w->low, w->high,
		inside);
	/* Side lobes of the filter, below 1/200, and what cut taps let through. */
	ok(outside < 1e-4, "the gain is zero elsewhere (%.1e)", outside);
}

/* White noise through filter and inverse. */
static void test_noise(const struct whitening *w, const double *h, size_t taps)
{
	enum { BINS = SEGMENT / 2 + 1 };
	double power[2][BINS], sum = 0, squares = 0, noise[2], error;
	size_t skip = taps + (size_t)w->half, n = N - 2 * skip;
	int segments, bins = 0;

	for (unsigned c = 0; c < 2; c++) {
		make_noise(y[c], N, 1, c);
		pass_filter(h, taps, y[c], N);
		whitening_apply(w, y[c], N);
	}
	colour_spectrum(
		y[0] + skip, y[1] + skip, n, 0, SEGMENT, power[0], power[1], &segments);
	for (int k = 0; k < BINS; k++)
		/* A Hann window leaks two bins far. */
		if (k >= w->low * SEGMENT + 2 && k <= w->high * SEGMENT - 2) {
			sum += power[0][k] + power[1][k];
			bins += 2;
		}
	/* Half-overlapping Hann windows: 1.056 for the neighbouring segments, 1.94 for
	 * the neighbouring bins. */
	error = sqrt(1.056 * 1.94 / ((double)segments * bins));
	near(sum / bins, 1, 4 * error, "whitened noise is white and of variance 1");
	colour_level(y[0] + skip, y[1] + skip, n, w, noise);
	/* A median of half the bins each, and those at the edges are less. */
	near(hypot(noise[0], noise[1]) / sqrt(2), 1, 4 * error,
		"colour_level() gives the whitened noise a level of 1");
	for (size_t i = skip; i < skip + n; i++)
		squares += y[0][i] * y[0][i] + y[1][i] * y[1][i];
	/* The squares of noise in a band have 2 band n degrees of freedom per two
	 * channels. */
	near(squares / (2 * (double)n) / w->band, 1, 4 / sqrt(w->band * (double)n),
		"the variance of the noise is that of the band");
}

/* A pulse through filter and inverse; T = 100 has its peak at 0.01. */
static void test_pulse(const struct whitening *w, const double *h, size_t taps)
{
	static double x[PULSE], want[PULSE];
	struct shape *gauss = shape_new(PULSE_GAUSS);
	struct shape *seen = shape_filter(gauss, 100, w->seen, w->seen_half);
	double worst = 0, peak = 0;

	shape_sample(gauss, 4096.3, 100, 0, PULSE, x, NULL, NULL);
	pass_filter(h, taps, x, PULSE);
	whitening_apply(w, x, PULSE);
	shape_sample(seen, 4096.3, 100, 0, PULSE, want, NULL, NULL);
	for (int i = 0; i < PULSE; i++) {
		worst = tap_max(worst, fabs(x[i] - want[i]));
		peak = tap_max(peak, fabs(want[i]));
	}
	/* The shape is cut at 2e-3, its taps at 2e-4. */
	ok(worst < 2.2e-3 * peak,
		"a whitened pulse is what shape_filter() makes of it (%.1e)",
		worst / peak);
	shape_free(gauss);
	shape_free(seen);
}

/* Two sensors behind a filter that takes low frequencies. */
static void test_baseline(const struct whitening *w, const double *h, size_t taps)
{
	enum { LENGTH = 2400 };
	static double x[2][PULSE];
	const size_t begin = (PULSE - LENGTH) / 2;
	struct shape *gauss = shape_new(PULSE_GAUSS);
	struct shape *seen = shape_filter(gauss, 100, w->seen, w->seen_half);
	struct joint_pulse truth = { .t = PULSE / 2.0 + 0.3, .delta = 3.1, .a = 1000 };
	struct joint_pulse found = { .t = LENGTH / 2.0, .delta = 2, .a = 800 };
	struct joint_scene s = { .shape = gauss,
		.duration = 100,
		.transit = INFINITY,
		.gain = 0.9,
		.width = 1,
		.delta_max = 7,
		.max_pulses = 1,
		.tone_variance = INFINITY };
	struct joint *j = joint_new();
	struct joint_result r;

	memset(x, 0, sizeof x);
	joint_add(&s, &truth, 1, x[0], x[1], PULSE);
	for (int c = 0; c < 2; c++) {
		pass_filter(h, taps, x[c], PULSE);
		whitening_apply(w, x[c], PULSE);
	}
	s.shape = seen;
	s.low = w->low;
	joint_refine(j, &s, x[0] + begin, x[1] + begin, LENGTH, &found, 1, &r);
	/* What the cut at 2e-3 of the peak leaves is even about the pulse and the same on
	 * both channels: it hardly moves the pulse, but its amplitude a little. */
	near(found.t + (double)begin, truth.t, 1e-5,
		"a pulse minus its baseline has the right time");
	near(found.delta, truth.delta, 1e-4,
		"a pulse minus its baseline has the right delay");
	near(found.a / truth.a, 1, 3e-4,
		"a pulse minus its baseline has the right amplitude");
	ok(r.chi2 < 1e-5 * truth.a * truth.a * 100, "the fit leaves no residual (%.1e)",
		r.chi2 / (truth.a * truth.a * 100));
	s.low = 0;
	joint_refine(j, &s, x[0] + begin, x[1] + begin, LENGTH, &found, 1, &r);
	ok(r.chi2 > 1e-3 * truth.a * truth.a * 100,
		"without the baseline in the model the fit leaves a residual");
	joint_free(j);
	shape_free(gauss);
	shape_free(seen);
}

static void test_filter(const struct fir_band *band, const char *name)
{
	size_t taps = (size_t)band->order + 1;
	double *h = malloc(taps * sizeof *h);
	struct whitening w;

	fir_design(band, h);
	if (ok(whitening_of_filter(&w, h, taps) == NUM_OK,
		    "%s: the filter has an inverse", name)) {
		test_gain(&w, h, taps);
		test_noise(&w, h, taps);
		if (w.low > 0)
			test_baseline(&w, h, taps);
		else
			test_pulse(&w, h, taps);
	}
	whitening_clear(&w);
	free(h);
}

/* White noise, with pulses of 50 standard deviations in burst of every spacing samples.
 */
static void test_pulses(int spacing, int burst, const char *what)
{
	enum { SHORT = 256, BINS = SHORT / 2 + 1 };
	double power[2][BINS], sum[2] = { 0 }, error;
	int segments;

	make_noise(y[0], N, 0.3, 2);
	make_noise(y[1], N, 2, 3);
	for (int i = 0; spacing && i < N; i++)
		if (i % spacing < burst)
			for (int c = 0; c < 2; c++)
				y[c][i] += (c ? 100 : 15) *
					   sin(2 * acos(-1) * (i % 100) / 100.0);
	colour_spectrum(y[0], y[1], N, 0, SHORT, power[0], power[1], &segments);
	for (int k = 1; k < BINS; k++)
		for (int c = 0; c < 2; c++)
			sum[c] += power[c][k] / (BINS - 1);
	error = sqrt(1.056 * 1.94 / ((double)segments * (BINS - 1)));
	near(sum[0] / 0.09, 1, 4 * error, what);
	near(sum[1] / 4, 1, 4 * error, "the power of the other channel is right too");
	ok(power[0][0] == power[0][1],
		"the power at frequency 0 is that of its neighbour");
}

/* y(i) = a y(i - 1) + x(i) with power (1 - a^2) / (1 - 2 a cos w + a^2). */
static void colour(double *x, size_t n, double a)
{
	double last = 0;

	for (size_t i = 0; i < n; i++)
		last = x[i] = a * last + sqrt(1 - a * a) * x[i];
}

static void test_colour(void)
{
	enum { LITTLE = 20480, TIMES = 100 };
	struct colour noise;
	const double *power = noise.power;
	double a = 0.7, worst = 0, squares = 0;
	double mean = 0, most = 0, scatter;
	size_t skip;
	struct whitening w;
	int white = 0, none = 0;

	/* 39 segments: sums of 32 bins, 22 of them independent, scatter by 2.4 %, and 1.3
	 * is nine times that from end to end. */
	for (unsigned k = 0; k < TIMES; k++) {
		make_noise(y[0], LITTLE, 1, 2 * k);
		make_noise(y[1], LITTLE, 1, 2 * k + 1);
		white += colour_power(y[0], y[1], LITTLE, &noise) == NUM_OK &&
			 colour_is_white(&noise, 0);
		none += noise.drift == 0;
	}
	ok(white == TIMES, "the whiteness test accepts white noise: %d of %d", white,
		TIMES);
	ok(none == TIMES, "white noise does not drift: %d of %d", none, TIMES);
	for (unsigned c = 0; c < 2; c++) {
		make_noise(y[c], N, 1, c);
		colour(y[c], N, a);
	}
	ok(colour_power(y[0], y[1], N, &noise) == NUM_OK && !colour_is_white(&noise, 0),
		"the whiteness test rejects low-passed noise");
	for (int k = 0; k < COLOUR_BINS; k++) {
		double want = (1 - a * a) / (1 - 2 * a * cos(acos(-1) * k / 512) + a * a);
		double off = power[k] / want - 1;

		mean += off / COLOUR_BINS;
		squares += off * off / COLOUR_BINS;
		worst = tap_max(worst, fabs(off));
		most = tap_max(most, power[k]);
	}
	/* Autocorrelations are whole up to lag 256 and fade to lag 512, of 2 N samples:
	 * 2 (256 + 3/8 256) / (2 N).  513 bins of which two in three are independent: the
	 * scatter is known to 4 %, and none is five times as far off. */
	scatter = sqrt(352.0 / N);
	near(sqrt(squares) / scatter, 1, 0.16,
		"the measured power of filtered noise is |H|^2 within its scatter");
	ok(worst < 5 * scatter, "the measured power is right at every frequency (%.2f)",
		worst / scatter);
	/* The mean is that of 2 N samples with 1 degree of freedom each. */
	near(mean, 0, 4 / sqrt(N), "the measured power is right in the mean");
	ok(whitening_of_noise(&w, power, 0, COLOUR_BINS, WHITEN_COLOURED) == NUM_OK,
		"the noise spectrum has an inverse");
	ok(w.low == 0 && w.high == 0.5, "no frequency is lost");
	near(w.band, 1, 1e-3, "the band is the whole spectrum");
	skip = (size_t)w.half;
	for (unsigned c = 0; c < 2; c++)
		whitening_apply(&w, y[c], N);
	ok(colour_power(y[0] + skip, y[1] + skip, N - 2 * skip, &noise) == NUM_OK &&
			colour_is_white(&noise, 0),
		"the inverse makes the noise white");
	mean = 0;
	for (int k = 0; k < COLOUR_BINS; k++)
		mean += power[k] / COLOUR_BINS;
	/* The inverse was learned from this very noise: its scatter is gone. */
	near(mean / most, 1, 4 / sqrt(N),
		"the whitened noise has the mean power of the largest line");
	test_pulse(&w, &(double){ 1 }, 1);
	whitening_clear(&w);
}

/* Low-passed noise with a pulse in each half of a segment: the spectrum is that between
 * the pulses. */
static void test_crowded_colour(void)
{
	enum { APART = 400, LONG = 57 };
	struct colour noise;
	double a = 0.7, most = 0, least = INFINITY;

	for (unsigned c = 0; c < 2; c++) {
		make_noise(y[c], N, 1, c);
		colour(y[c], N, a);
		for (int i = 0; i < N; i++) {
			double place = (double)((i + 100 * (int)c) % APART) / LONG;

			y[c][i] += place < 1 ? 30 * sin(acos(-1) * place) : 0;
		}
	}
	ok(colour_power(y[0], y[1], N, &noise) == NUM_OK,
		"noise is measured between frequent pulses");
	for (int k = 0; k < COLOUR_BINS; k++) {
		double want = (1 - a * a) / (1 - 2 * a * cos(acos(-1) * k / 512) + a * a);

		most = tap_max(most, noise.power[k] / want);
		least = fmin(least, noise.power[k] / want);
	}
	/* Where only the end of a pulse is within a segment, its power adds to that of
	 * the noise, by less than would tell; the scatter is 4 %.  With the spectrum of
	 * the pulses the ratio is up to 700. */
	ok(most < 1.5 && least > 0.8,
		"its power is not that of the pulses (%.2f to %.2f of the noise)", least,
		most);
}

/* Adds a random walk to x, in steps of standard deviation step. */
static void add_walk(double *x, size_t n, double step, unsigned seed)
{
	static double steps[N];
	double at = 0;

	make_noise(steps, n, step, seed);
	for (size_t i = 0; i < n; i++)
		x[i] += at += steps[i];
}

/* Noise behind a low-pass at this share of the rate is no walk: its power rises no more
 * below. */
static void test_no_drift(double corner)
{
	enum { LITTLE = 65536, TIMES = 40 };
	struct colour noise;
	int none = 0;

	for (unsigned k = 0; k < TIMES; k++) {
		for (unsigned c = 0; c < 2; c++) {
			make_noise(y[c], LITTLE, 1, 2 * k + c);
			colour(y[c], LITTLE, exp(-2 * acos(-1) * corner));
		}
		none += colour_power(y[0], y[1], LITTLE, &noise) == NUM_OK &&
			noise.drift == 0;
	}
	ok(none >= TIMES - 1, "noise low-passed at %.3f does not drift: %d of %d", corner,
		none, TIMES);
}

/* Pulses every 500 samples leave no longer segment than 256 samples to noise. */
static void test_drift_between_pulses(void)
{
	const double step = 0.05;
	struct colour noise;

	for (unsigned c = 0; c < 2; c++) {
		make_noise(y[c], N, 1, c);
		add_walk(y[c], N, step, 2 + c);
		for (size_t i = 0; i + 60 < N; i += 500)
			for (size_t k = 0; k < 60; k++)
				y[c][i + k] +=
					100 * sin(2 * M_PI * ((double)k + 0.5) / 60);
	}
	/* Half of N is in such segments: twice the scatter of the test below, and bins
	 * that are four times as wide. */
	ok(colour_power(y[0], y[1], N, &noise) == NUM_OK,
		"the noise between pulses has a spectrum");
	near(noise.drift / (step * step), 1, 0.25, "its drift is measured");
}

/* Steps of 0.05 double the power of the noise at 0.8 % of the rate. */
static void test_drift(void)
{
	const double step = 0.05;
	struct colour noise;
	struct whitening w;
	double low = 0;

	for (unsigned c = 0; c < 2; c++) {
		make_noise(y[c], N, 1, c);
		add_walk(y[c], N, step, 2 + c);
	}
	ok(colour_power(y[0], y[1], N, &noise) == NUM_OK && !colour_is_white(&noise, 0),
		"the whiteness test rejects noise that drifts");
	/* Some six bins of 255 segments of two channels tell it: 1 / sqrt(6 255) is 2.6
	 * %, and half-overlapping segments are not quite independent. */
	near(noise.drift / (step * step), 1, 0.15, "the drift of the noise is measured");
	ok(colour_smooth(&noise) == NUM_OK &&
			whitening_of_noise(&w, noise.power, noise.drift, COLOUR_BINS,
				WHITEN_COLOURED) == NUM_OK,
		"noise that drifts has an inverse");
	ok(w.low == 0 && w.high == 0.5, "no frequency is lost to drift");
	ok(whitening_removes_mean(&w), "the inverse of drift removes a constant");
	for (unsigned c = 0; c < 2; c++) {
		for (size_t i = 0; i < N; i++)
			y[c][i] += 1e3;
		whitening_apply(&w, y[c], N);
	}
	ok(colour_power(y[0], y[1], N, &noise) == NUM_OK && noise.drift == 0 &&
			colour_is_white(&noise, 0),
		"the inverse makes noise that drifts white, to its ends");
	/* Taps of finite length leave some of what is slower than they are, which is
	 * fitted with the pulses: it is smaller than the noise of a sample. */
	for (size_t i = 0; i < N; i += SEGMENT) {
		double sum = 0;

		for (size_t k = 0; k < SEGMENT; k++)
			sum += y[0][i + k] / SEGMENT;
		low += sum * sum * SEGMENT / N;
	}
	ok(low < 0.1 * noise.power[COLOUR_BINS / 2],
		"little drift is left below the lowest frequency measured: %.3f",
		low / noise.power[COLOUR_BINS / 2]);
	whitening_clear(&w);
}

int main(void)
{
	static const double silence[9];
	struct whitening w;
	int segments;

	test_filter(&(struct fir_band){ 200, 0.007, 0.013, FIR_HAMMING, 0, 1 },
		"70-130 Hz of 10 kHz, 201 taps");
	test_filter(&(struct fir_band){ 800, 0.007, 0.013, FIR_HAMMING, 0, 1 },
		"70-130 Hz, 801 taps");
	test_filter(&(struct fir_band){ 2000, 0.002, 0.15, FIR_HAMMING, 0, 1 },
		"20-1500 Hz, 2001 taps");
	test_filter(&(struct fir_band){ 200, 0, 0.05, FIR_HANN, 0, 1 },
		"below 500 Hz, 201 taps");
	test_pulses(0, 0, "the power of white noise is its variance at all frequencies");
	test_pulses(10000, 3000,
		"the power of the noise is right with bursts of pulses in 30 % of the record");
	test_pulses(1000, 300,
		"the power of the noise is right with pulses spread over 30 % of the record");
	ok(colour_spectrum(y[0], y[1], 255, 0, 256, y[0] + 1000, y[1] + 1000,
		   &segments) == NUM_OK &&
			segments == 0,
		"a record shorter than a segment gives no spectrum");
	test_colour();
	test_crowded_colour();
	test_no_drift(0.01);
	test_no_drift(0.02);
	test_no_drift(0.05);
	test_no_drift(0.15);
	test_drift();
	test_drift_between_pulses();
	ok(whitening_of_noise(&w, silence, 0, 9, WHITEN_COLOURED) == NUM_DOMAIN,
		"a noise without power cannot be made white");
	return tap_done();
}
