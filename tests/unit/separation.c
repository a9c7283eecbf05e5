/* Parts of the separation: table of the pulse, STFT, masks, tones, lag, peaks, noise */
#include "num/philox.h"
#include "num/robust.h"
#include "signal/detect/align.h"
#include "signal/detect/count.h"
#include "signal/detect/sections.h"
#include "signal/learn/calibration.h"
#include "signal/mixture/masks.h"
#include "signal/noise/robust.h"
#include "signal/noise/tones.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { N = 4096 };

static double normal(uint64_t i)
{
	double z[2];

	philox_normal2(11, 0, RNG_NOISE, i, z);
	return z[0];
}

static void test_shape(enum pulse_shape pulse, const char *name)
{
	struct shape *s = shape_new(pulse);
	double p[300], by_t[300], by_T[300], up[300], worst = 0, worst_t = 0, worst_T = 0;
	double t0 = 150.3, T = 60, h = 1e-5;
	double end = shape_reach(s) * T - 1;

	shape_sample(s, t0, T, 0, 300, p, by_t, by_T);
	for (int i = 0; i < 300; i++)
		if (fabs(i - t0) < end)
			worst = tap_max(
				worst, fabs(p[i] - pulse_value(pulse, (i - t0) / T)));
	near(worst, 0, 2e-7, name);
	shape_sample(s, t0 + h, T, 0, 300, up, NULL, NULL);
	for (int i = 0; i < 300; i++)
		if (fabs(i - t0) < end)
			worst_t = tap_max(worst_t, fabs((up[i] - p[i]) / h - by_t[i]));
	shape_sample(s, t0, T + h, 0, 300, up, NULL, NULL);
	for (int i = 0; i < 300; i++)
		if (fabs(i - t0) < end)
			worst_T = tap_max(worst_T, fabs((up[i] - p[i]) / h - by_T[i]));
	/* Difference quotients: curvature h / 2 (2 pi / T)^2 and rounding 1e-16 / h. */
	near(worst_t, 0, 2e-6, "the derivative of a pulse by its arrival is right");
	near(worst_T, 0, 2e-6, "the derivative of a pulse by its duration is right");
	shape_free(s);
}

/* Two pulses apart, delays 2.121 and 4.545 as in section a1: two sources, masks that
 * part them, delays that are not those of the bin's middle (1.2 and 2.6). */
static void test_masks(void)
{
	struct shape *shape = shape_new(PULSE_SINE);
	struct masks_par par = { .window = 64,
		.hop = 32,
		.duration = 100,
		.delta_min = -10,
		.delta_max = 10,
		.gain_max = 2,
		.peak_share = 0.3,
		.shape = shape };
	struct masks *m = masks_new(&par);
	struct masks_source source[MASKS_SOURCES_MAX];
	double y1[600], y2[600], p[600], x[600], left = 0, energy = 0;
	int first, sources;

	memset(y1, 0, sizeof y1);
	memset(y2, 0, sizeof y2);
	for (int k = 0; k < 2; k++) {
		double t0 = k ? 420 : 160, delta = k ? 4.545 : 2.121;

		shape_sample(shape, t0, 100, 0, 600, p, NULL, NULL);
		for (int i = 0; i < 600; i++)
			y1[i] += p[i];
		shape_sample(shape, t0 + delta, 100, 0, 600, p, NULL, NULL);
		for (int i = 0; i < 600; i++)
			y2[i] += 0.909 * p[i];
	}
	ok(masks_find(m, y1, y2, 600, source, &sources) == NUM_OK && sources == 2,
		"the histogram has two peaks");
	first = source[0].delta < source[1].delta ? 0 : 1;
	near(source[first].delta, 2.121, 0.35, "the delay of the first peak is right");
	near(source[1 - first].delta, 4.545, 0.35,
		"the delay of the second peak is right");
	near(source[0].attenuation, 0.909, 0.03, "the attenuation is right");
	masks_separate(m, first, x);
	for (int i = 0; i < 600; i++) {
		left += i < 290 ? (x[i] - y1[i]) * (x[i] - y1[i]) : x[i] * x[i];
		energy += i < 290 ? y1[i] * y1[i] : 0;
	}
	ok(left < 0.1 * energy,
		"the mask of the first peak keeps the first pulse and drops the second (%.1f dB)",
		10 * log10(energy / left));
	for (int i = 0; i < 600; i++)
		y2[i] = 0.909 * y1[i];
	ok(masks_find(m, y1, y2, 600, source, &sources) == NUM_OK && sources == 1,
		"a record and its copy are one source");
	masks_separate(m, 0, x);
	left = 0;
	for (int i = 0; i < 600; i++)
		left = tap_max(left, fabs(x[i] - y1[i]));
	near(left, 0, 1e-13, "the STFT and its inverse give the signal back");
	masks_free(m);
	shape_free(shape);
}

static void test_tones(void)
{
	static double y1[N], y2[N], x[N];
	double omega[TONES_MAX], c[2 * TONES_MAX + 1], worst = 0;
	int tones;
	double w[2] = { 2 * acos(-1) * 0.00503, 2 * acos(-1) * 0.2 };

	for (int i = 0; i < N; i++) {
		y1[i] = 0.3 + 0.5 * cos(w[0] * i + 1) + 0.2 * sin(w[1] * i) +
			0.05 * normal((uint64_t)i);
		y2[i] = 0.1 * sin(w[0] * i) + 0.05 * normal(N + (uint64_t)i);
	}
	ok(tones_find(y1, y2, N, TONES_SIDE, 3, TONES_MAX, omega, &tones) == NUM_OK &&
			tones == 2,
		"two tones are found");
	/* Resolution 1 / N; a tenth of it is easily reached at this level. */
	near(omega[0], w[0], 0.1 * 2 * acos(-1) / N, "the first frequency is right");
	near(omega[1], w[1], 0.1 * 2 * acos(-1) / N, "the second frequency is right");
	for (int i = 0; i < N; i++)
		x[i] = y1[i] = 0.3 + 0.5 * cos(w[0] * i + 1) + 0.2 * sin(w[1] * i);
	for (int i = 1000; i < 1400; i++) /* a tenth of the record is something else */
		x[i] += 3;
	ok(tones_fit(x, N, 0, 2, w, c, NULL, NULL) == NUM_OK, "the tones are fitted");
	tones_remove(x, N, 0, 2, w, 0, c, N, c);
	for (int i = 0; i < N; i++)
		worst = tap_max(worst, fabs(x[i] - (i >= 1000 && i < 1400 ? 3 : 0)));
	near(worst, 0, 1e-9, "a robust fit does not see outliers");
	for (int i = 0; i < N; i++) /* a pulse every 250 samples: lines without a tone */
		y1[i] = (i % 250 < 50 ? sin(2 * acos(-1) * (i % 250) / 50) : 0) +
			0.05 * normal((uint64_t)i);
	ok(tones_find(y1, y1, N, TONES_SIDE, 3, TONES_MAX, omega, &tones) == NUM_OK &&
			tones > 2,
		"a train of pulses has lines");
	ok(tones_confirm(y1, y1, N, 1, &tones, omega) == NUM_OK && tones == 0,
		"a train of pulses has no tones");
}

/* A line that turns by 0.1 rad from knot to knot: its frequency is followed from the
 * second knot on; before, straight lines between coefficients, and before the first one,
 * leave errors of second order. */
static void test_track(void)
{
	enum { HOP = 500, PIECE = 700 };
	static double x[N], y[N];
	struct tones_track t, pieces;
	double omega = 2 * acos(-1) * 0.01, turn = 0.1, early = 0, late = 0;

	for (int i = 0; i < N; i++)
		x[i] = y[i] = cos((omega + turn / HOP) * i + 0.5);
	tones_track_start(&t, 1, &omega, 0, HOP);
	ok(tones_track_run(&t, x, 0, N, 1) == NUM_OK && t.flat == N,
		"a line is followed to the end");
	for (int i = 0; i < N; i++)
		*(i < 2 * HOP ? &early : &late) =
			tap_max(i < 2 * HOP ? early : late, fabs(x[i]));
	near(early, 0, 2 * turn * turn, "what is left of it at first is of second order");
	/* The error of the frequency is of second order, too, and so is the next turn. */
	near(late, 0, 5 * pow(turn, 4), "what is left later is of fourth order");
	near(t.omega[0], omega + turn / HOP, 1e-3 * turn / HOP,
		"the frequency becomes that of the line");
	/* Only the first step is a turn, and three quarters as long as a hop, since the
	 * first knot has half a hop less. */
	near(tones_track_change(&t), pow(0.75 * turn, 2) / 2 / (t.knots - 1),
		0.05 * pow(0.75 * turn, 2) / 2 / (t.knots - 1), "it changes by one turn");
	tones_track_start(&pieces, 1, &omega, 0, HOP);
	for (int end = PIECE; end < N + PIECE; end += PIECE)
		tones_track_run(&pieces, y, 0, end < N ? end : N, end >= N);
	ok(memcmp(x, y, sizeof x) == 0, "the pieces in which it arrives do not matter");
}

/* A sweep that changes its frequency by b per sample.  Between two knots its phase leaves
 * that of either by b u^2 / 2 at most, u < HOP, and with weights p and 1 - p by b HOP^2 p
 * (1 - p) / 2; a fit to two hops shrinks and shifts it by parts of b HOP^2 / 2 as well.
 */
static void test_sweep(void)
{
	enum { HOP = 100 };
	static double x[N];
	struct tones_track t;
	double omega = 2 * acos(-1) * 0.01, b = omega / N, worst = 0, end;

	for (int i = 0; i < N; i++)
		x[i] = cos((omega + 0.5 * b * i) * i + 0.5);
	tones_track_start(&t, 1, &omega, 0, HOP);
	ok(tones_track_run(&t, x, 0, N, 1) == NUM_OK, "a sweep is followed to the end");
	for (int i = 0; i < N; i++)
		worst = tap_max(worst, fabs(x[i]));
	near(worst, 0, b * HOP * HOP, "what is left of a sweep is of second order");
	end = omega + b * N;
	near(t.omega[0], end, 2 * b * HOP, "its frequency is that of the last knots");
}

static void test_small(void)
{
	static double x[N], work[N], r[101], silence[3000];
	struct peak peak;
	struct count *count = count_new(0.5);
	struct sections *s;
	struct section section;
	struct shape *shape = shape_new(PULSE_SINE);
	double lag;
	int peaks = 0;

	for (int i = 0; i < N; i++)
		x[i] = 2 * normal((uint64_t)i) + 50 * sin(0.01 * i);
	/* N normal numbers: the median scatters by 1.2 / sqrt N. */
	near(robust_noise(x, NULL, N, work), 2, 0.15,
		"the noise under a slow signal is right");
	/* Differences of noise below a third of the step do not show the error of
	 * rounding, those of noise of half a step do: the estimate adds its variance,
	 * step^2 / 12, to what they show, and is 1.12 times the noise at half a step. */
	for (int k = 0; k < 4; k++) {
		static const double step[] = { 2, 3, 5, 100 };

		for (int i = 0; i < N; i++)
			x[i] = step[k] * round(normal((uint64_t)i) / step[k]);
		near(robust_noise(x, NULL, N, work),
			k < 3 ? hypot(1, step[k] / sqrt(12)) : 0,
			k < 3 ? 0.15 * hypot(1, step[k] / sqrt(12)) : 0,
			"the noise in steps includes the error of rounding");
	}
	for (int i = 0; i < N; i++)
		x[i] = i % 2 ? 3 + 0.1 * normal((uint64_t)i) : 1e3;
	near(count_level(x + 1, N / 2, 2, work), 0.5, 0.05,
		"the level to count from is five deviations of one channel, whatever its mean");
	for (int i = 0; i < 7; i++)
		work[i] = "4361725"[i];
	near(robust_median(work, 7), '4', 0, "the median is right");
	memset(x, 0, sizeof x);
	shape_sample(shape, 1000.25, 100, 900, 200, x + 900, NULL, NULL);
	shape_sample(shape, 1037.5, 100, 900, 250, work, NULL, NULL);
	memset(work + 250, 0, sizeof work - 250 * sizeof *work);
	ok(align_lag(x + 900, work, 3000, 500, &lag, r) == NUM_OK,
		"two records of one pulse have a lag");
	near(lag, 37.25, 0.01, "cross-correlation gives the lag between samples");
	ok(align_lag(x + 900, silence, 3000, 500, &lag, r) == NUM_DOMAIN,
		"a silent channel has no lag");
	align_autocorrelation(x, x, N, 100, r);
	ok(r[50] < r[48] && r[50] < r[52],
		"a sine pulse is least like itself half its length on");
	for (int i = 0; i < N; i++)
		if (count_sample(count, 2 * x[i], &peak))
			peaks++;
	ok(peaks == 1 && count_end(count, &peak) == 0, "one pulse has one peak");
	near(peak.t, 975.25, 0.01, "the place of the peak is right");
	near(peak.height, 2, 1e-4, "the height of the peak is right");
	s = sections_new(shape, 100, 3, 0);
	sections_scan(s, (const double *const[]){ x, x }, 2, 0, N, N);
	sections_end(s);
	ok(sections_first(s, &section) && section.begin < 950 && section.end > 1050 &&
			section.end < 1300,
		"one section contains the pulse");
	sections_take(s, section.end);
	ok(!sections_first(s, &section), "there is no other section");
	/* Gaussian field: at 1e-9 per sample the threshold is near 33, and falls with
	 * rate. */
	near(calibrate_threshold(1e-9, shape, 100, 1, 20), 33, 3,
		"the threshold of a false alarm rate is right");
	ok(calibrate_threshold(1e-6, shape, 100, 1, 20) <
			calibrate_threshold(1e-9, shape, 100, 1, 20),
		"more false alarms give a lower threshold");
	sections_free(s);
	count_free(count);
	shape_free(shape);
}

/* A pulse with tails reaches as far as it stands out of the noise; a strong one takes a
 * weak one before it into its section. */
static void test_sections(void)
{
	static double x[N];
	struct shape *shape = shape_new(PULSE_LORENTZ);
	struct sections *s = sections_new(shape, 100, 5, 0);
	struct section first, second;
	const double strong[2] = { 10, 2000 };

	near(shape_reach_above(shape, 0.01), 1.07, 0.01,
		"a pulse falls to a hundredth where stated");
	near(shape_reach_above(shape, 0), shape_reach(shape), 1e-9,
		"a pulse ends where stated");
	for (int k = 0; k < 2; k++) {
		struct joint_scene scene = { .shape = shape,
			.duration = 100,
			.transit = 200,
			.gain = 1,
			.width = 1 };
		struct joint_pulse weak = { .t = 1000, .a = 5 },
				   other = { .t = 1450, .a = strong[k] };

		memset(x, 0, sizeof x);
		joint_add(&scene, &weak, 1, x, NULL, N);
		joint_add(&scene, &other, 1, x, NULL, N);
		sections_free(s);
		s = sections_new(shape, 100, 5, 0);
		for (long long upto = 0; upto < N; upto += 100)
			sections_scan(s, (const double *const[]){ x, x }, 2, 0, N, upto);
		sections_end(s);
		ok(sections_first(s, &first) && first.begin < 900 && !first.open,
			"a section begins with the weak pulse");
		sections_take(s, first.end);
		if (k == 0)
			ok(first.end < 1200 && sections_first(s, &second) &&
					second.begin > first.end && second.end > 1550,
				"another weak pulse has a section");
		else
			ok(first.end > 1900 && !sections_first(s, &second),
				"the section contains the strong pulse");
	}
	sections_free(s);
	shape_free(shape);
}

/* Nine pulses, six of which overlap, in noise of a twentieth: those of the second
 * channel 1.25 times as long, half as high and of the other sign. */
static void test_width(void)
{
	static double y[2][N];
	static const double at[] = { 250, 900, 960, 1500, 1585, 2100, 2700, 3300, 3330 };
	double width, silent;

	for (int equal = 0; equal < 2; equal++) {
		for (int c = 0; c < 2; c++)
			for (int i = 0; i < N; i++) {
				y[c][i] = 0.05 * normal((uint64_t)(N * c + i));
				for (int k = 0; k < 9; k++) {
					double T = c && !equal ? 125 : 100;
					double u = (i - at[k] - 200 * c) / T;

					if (fabs(u) < 0.5)
						y[c][i] -= (c ? -0.5 : 1) *
							   sin(2 * acos(-1) * u);
				}
			}
		ok(align_width(y[0], y[1], N, 125, &width) == NUM_OK, "a width is found");
		/* The distances of pulses that overlap are not longer, which six of nine
		 * make 3 % of; fits correct up to 12 %. */
		near(width, equal ? 1 : 1.25, equal ? 0.01 : 0.06,
			equal ? "pulses of one width are found to be so"
			      : "longer pulses are found to be so");
	}
	for (int i = 0; i < N; i++)
		y[1][i] = 0;
	ok(align_width(y[0], y[1], N, 125, &silent) == NUM_OK && silent == 1,
		"the width of a silent channel is 1");
}

int main(void)
{
	test_shape(PULSE_SINE, "the table of the sine pulse gives the pulse");
	test_shape(PULSE_GAUSS, "the table of the Gaussian pulse gives the pulse");
	test_shape(PULSE_LORENTZ, "the table of the Lorentzian pulse gives the pulse");
	test_masks();
	test_tones();
	test_track();
	test_sweep();
	test_small();
	test_sections();
	test_width();
	return tap_done();
}
