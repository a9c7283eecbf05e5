/* Joint fit of pulses: exact without noise, at the Cramer-Rao bound with noise */
#include "signal/fit/joint.h"
#include "num/philox.h"
#include "num/sigmas.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum { N = 700, SCENES = 120 };

static struct joint_scene make_scene(const struct shape *shape)
{
	return (struct joint_scene){ .shape = shape,
		.duration = 100,
		.transit = 196.35,
		.gain = 0.909,
		.width = 1,
		.delta_min = 0,
		.delta_max = 7,
		.threshold = 33,
		.threshold_near = 25,
		.max_pulses = 20,
		.tone_variance = INFINITY };
}

static void add_noise(double *y, unsigned scene, unsigned channel)
{
	double z[2];

	for (unsigned i = 0; i < N; i++) {
		philox_normal2(7, scene * 2 + channel, RNG_NOISE, i, z);
		y[i] += z[0];
	}
}

/* Chi-square of the pulses refined in a scene of another duration and gain. */
static double chi2_of(struct joint *j, const struct joint_scene *scene, double duration,
	double gain, double y[2][N], const struct joint_pulse pulse[2])
{
	struct joint_scene s = *scene;
	struct joint_pulse found[20];
	double chi2;

	s.duration *= exp(duration);
	s.gain *= exp(gain);
	memcpy(found, pulse, 2 * sizeof *found);
	joint_adjust(j, &s, y[0], y[1], N, found, 2, &chi2);
	return chi2;
}

/* The slopes are those of chi-square with the pulses refined, at a scene that is slightly
 * wrong, with overlapping pulses, tones and samples that are not known.  Steps of 1e-2
 * are so long that what the refined pulses leave of chi-square, up to 0.2, does not
 * count; the errors of third order stay below 5 %. */
static void test_slopes(struct joint *j, const struct joint_scene *tied)
{
	static double y[2][N];
	static unsigned char hidden[2][N];
	static const double step = 1e-2;
	const struct joint_pulse truth[2] = { { .t = 180.3, .delta = 2.121, .a = 40 },
		{ .t = 240.7, .delta = 4.545, .a = 60 } };
	struct joint_scene s = *tied;
	struct joint_slopes slopes = { .gradient = { 0 } };
	double middle, by[2], bend[2], cross;

	memset(y, 0, sizeof y);
	for (unsigned i = 0; i < 2; i++) {
		joint_add(&s, &truth[i], 1, y[0], y[1], N);
		add_noise(y[i], 700, i);
		for (int k = 0; k < N; k++)
			y[i][k] += 5 * sin(0.11 * k + i);
		memset(hidden[i] + 190, 1, 12);
		s.hidden[i] = hidden[i];
	}
	s.tones = 1;
	s.omega[0] = 0.11;
	s.duration *= 0.995;
	s.gain *= 1.005;
	middle = chi2_of(j, &s, 0, 0, y, truth);
	ok(joint_add_slopes(j, &slopes) == 1, "the slopes of a fit of two pulses exist");
	for (int k = 0; k < 2; k++) {
		double up = chi2_of(j, &s, k ? 0 : step, k ? step : 0, y, truth);
		double down = chi2_of(j, &s, k ? 0 : -step, k ? -step : 0, y, truth);

		by[k] = -0.5 * (up - down) / (2 * step);
		bend[k] = 0.5 * (up - 2 * middle + down) / (step * step);
		near(slopes.gradient[k], by[k], 0.05 * fabs(by[k]),
			k ? "half of chi-square falls with the gain by its gradient"
			  : "half of chi-square falls with the duration by its gradient");
		near(slopes.curvature[k][k], bend[k], 0.05 * bend[k],
			"and bends by its curvature");
	}
	cross = 0.5 *
		(chi2_of(j, &s, step, step, y, truth) -
			chi2_of(j, &s, step, -step, y, truth) -
			chi2_of(j, &s, -step, step, y, truth) +
			chi2_of(j, &s, -step, -step, y, truth)) /
		(4 * step * step);
	near(slopes.curvature[1][0], cross, 0.05 * sqrt(bend[0] * bend[1]),
		"also with both together");
}

/* In laminar flow, one particle is half as fast and one three times as fast as those of
 * delta 0: either is one pulse, and the errors are those stated. */
static void test_laminar(struct joint *j, const struct joint_scene *tied)
{
	static double y[2][N];
	const struct joint_pulse truth[2] = { { .t = 160.3, .delta = 188.7, .a = 12 },
		{ .t = 560.7, .delta = -137.2, .a = 25 } };
	struct joint_scene s = *tied;
	int right = 0, covered = 0;

	s.delta_min = -150;
	s.delta_max = 220;
	for (unsigned k = 0; k < SCENES; k++) {
		struct joint_pulse found[20];
		struct joint_result r;
		int m = 0;

		memset(y, 0, sizeof y);
		for (unsigned i = 0; i < 2; i++) {
			joint_add(&s, &truth[i], 1, y[0], y[1], N);
			add_noise(y[i], 9000 + k, i);
		}
		joint_fit(j, &s, y[0], y[1], N, found, &m, &r);
		if (m != 2)
			continue;
		right++;
		for (int i = 0; i < 2; i++)
			covered += pow(found[i].delta - truth[i].delta, 2) <
				   joint_delay_variance(&found[i]);
	}
	ok(right == SCENES, "%d of %d times a slow and a fast particle are two pulses",
		right, SCENES);
	/* 68 % of 2 SCENES, and three times its standard error. */
	near(covered / (2.0 * right), 0.683, 0.09,
		"errors of their delays are within one standard error");
}

/* Three pulses, two of them a fifth of their duration apart, nearly without noise. */
static void test_clean(struct joint *j, const struct joint_scene *s)
{
	static double y[2][N];
	struct joint_pulse truth[3] = { { .t = 180.3, .delta = 2.121, .a = 900 },
		{ .t = 200.7, .delta = 4.545, .a = 1300 },
		{ .t = 420.25, .delta = 3.3, .a = 500 } };
	struct joint_pulse found[20];
	struct joint_result r;
	double worst_t = 0, worst_delta = 0, worst_a = 0;
	int m = 0;

	memset(y, 0, sizeof y);
	for (int i = 0; i < 3; i++)
		joint_add(s, &truth[i], 1, y[0], y[1], N);
	ok(joint_fit(j, s, y[0], y[1], N, found, &m, &r) == JOINT_OK,
		"a scene without noise is fitted");
	if (!ok(m == 3, "three pulses are found"))
		return;
	for (int i = 0; i < 3; i++) {
		worst_t = tap_max(worst_t, fabs(found[i].t - truth[i].t));
		worst_delta = tap_max(worst_delta, fabs(found[i].delta - truth[i].delta));
		worst_a = tap_max(worst_a, fabs(found[i].a / truth[i].a - 1));
	}
	/* Chi-square stops falling at 1e-4 of sigma^2: a hundredth of the bounds. */
	near(worst_t, 0, 1e-4, "the arrivals are exact");
	near(worst_delta, 0, 1e-4, "the delays are exact");
	near(worst_a, 0, 1e-5, "the amplitudes are exact");
	ok(r.chi2 < 1e-3, "the residual is zero");
	for (int i = 0; i < 3; i++)
		joint_add(s, &truth[i], -1, y[0], y[1], N);
	worst_t = 0;
	for (int i = 0; i < N; i++)
		worst_t = tap_max(worst_t, fabs(y[0][i]) + fabs(y[1][i]));
	near(worst_t, 0, 1e-12 * 1300, "joint_add subtracts what it added");
}

/* A coil that is wider by a fifth: the pulse of sensor 2 is that of sensor 1 drawn out,
 * and one pulse describes both, as exactly as without. */
static void test_wide(struct joint *j, const struct joint_scene *s)
{
	static double y[2][N], alike[2][N];
	struct joint_scene wide = *s;
	struct joint_pulse p = { .t = 300.4, .delta = 3, .a = 900 }, found[20];
	struct joint_result r;
	double worst = 0;
	int m = 0;

	wide.width = 1.2;
	memset(y, 0, sizeof y);
	memset(alike, 0, sizeof alike);
	joint_add(&wide, &p, 1, y[0], y[1], N);
	joint_add(s, &p, 1, alike[0], alike[1], N);
	/* the arrival is between two samples: 5 samples of one are 6 of the other */
	for (int k = -7; k <= 7; k++) {
		double at = 303.4 + 6 * k, u = at - floor(at);
		double v = (1 - u) * y[1][(int)at] + u * y[1][(int)at + 1];
		double to = 303.4 + 5 * k, w = to - floor(to);
		double x = (1 - w) * alike[1][(int)to] + w * alike[1][(int)to + 1];

		worst = tap_max(worst, fabs(v - x));
	}
	/* linear interpolation errs by 1/8 of the curvature, (2 pi / T)^2 of the peak */
	near(worst, 0, 900 * 4e-3 / 8,
		"the pulse of a wider coil is that of the other drawn out");
	ok(joint_fit(j, &wide, y[0], y[1], N, found, &m, &r) == JOINT_OK && m == 1,
		"one pulse describes it");
	near(fabs(found[0].t - p.t) + fabs(found[0].delta - p.delta), 0, 2e-4,
		"arrival and delay are exact");
	m = 0;
	ok(joint_fit(j, s, y[0], y[1], N, found, &m, &r) == JOINT_OK && m > 1,
		"equal coils need several pulses for it");
}

/* The inverse of the normal matrix of one pulse against the closed form for the sine:
 * sd(t2 - t1) = sqrt(T / 2) / pi / a sqrt(1 + 1 / g^2) where T is not tied. */
static void test_bound(struct joint *j, const struct joint_scene *tied)
{
	static double y[2][N];
	struct joint_scene s = *tied;
	struct joint_pulse p = { .t = 300.4, .delta = 3, .a = 31.62 }, found = p;
	struct joint_result r;
	double var;

	s.transit = INFINITY;
	memset(y, 0, sizeof y);
	joint_add(&s, &p, 1, y[0], y[1], N);
	joint_refine(j, &s, y[0], y[1], N, &found, 1, &r);
	var = found.cov[0] - 2 * found.cov[1] + found.cov[2];
	near(sqrt(var), sqrt(50.0) / acos(-1) / p.a * sqrt(1 + 1 / (0.909 * 0.909)),
		2e-3 * 0.1, "the standard error of the delay is the Cramer-Rao bound");
	near(sqrt(found.cov[5]) / p.a, sqrt(2.0 / 100 / (1 + 0.909 * 0.909)) / p.a, 1e-6,
		"the standard error of the amplitude is the Cramer-Rao bound");
}

/* A fit without the errors of the pulses. */
static void test_adjust(struct joint *j, const struct joint_scene *wide)
{
	static double y[2][N];
	struct joint_pulse p[] = { { .t = 200.3, .delta = 1, .a = 20 },
		{ .t = 420.7, .delta = 6, .a = 30 } };
	struct joint_pulse found[JOINT_PULSES_MAX], again[2];
	struct joint_result r;
	double chi2 = 0;
	int m = 0;

	memset(y, 0, sizeof y);
	for (int i = 0; i < 2; i++)
		joint_add(wide, &p[i], 1, y[0], y[1], N);
	joint_fit(j, wide, y[0], y[1], N, found, &m, &r);
	ok(m == 2, "two pulses are found (%d)", m);
	for (int i = 0; i < 2; i++)
		near(found[i].delta, p[i].delta, 1e-3, "and their delays");
	for (int i = 0; i < 2; i++) {
		found[i].t += 0.3;
		again[i] = found[i];
	}
	joint_refine(j, wide, y[0], y[1], N, found, 2, &r);
	joint_adjust(j, wide, y[0], y[1], N, again, 2, &chi2);
	ok(chi2 == r.chi2 && again[0].t == found[0].t && again[1].a == found[1].a,
		"without errors the pulses are the same");
}

/* What is left of a line whose cosine and sine are known at knots with an error of
 * standard deviation sd, with linear interpolation between. */
static void add_left(
	double *y, const struct joint_scene *s, int c, int l, unsigned scene, double sd)
{
	double hop = s->tone_hop, from = s->tone_knot[c] - 4 * hop, z[2];

	for (unsigned k = 0; from + k * hop < N + hop; k++) {
		philox_normal2(11, scene * 8 + (unsigned)(2 * l + c), RNG_NOISE, k, z);
		for (int i = 0; i < N; i++) {
			double hat = fmax(1 - fabs(i - from - k * hop) / hop, 0);

			y[i] += sd * hat *
				(z[0] * cos(s->omega[l] * i) +
					z[1] * sin(s->omega[l] * i));
		}
	}
}

/* Random scenes of m pulses at 30 dB, at least 10 samples apart.  With left the lines
 * were removed but for errors of this standard deviation. */
static void test_noisy(
	struct joint *j, const struct joint_scene *s, int m, int tones, double left)
{
	static double y[2][N];
	struct joint_scene scene = *s;
	double squares = 0, bound = 0, size = 0;
	int right = 0, inside = 0, all = 0;

	scene.tones = tones;
	for (int k = 0; k < tones; k++)
		scene.omega[k] = 2 * acos(-1) * (k ? 0.015 : 0.005);
	if (left > 0) {
		scene.tone_variance = left * left;
		scene.tone_hop = 200;
		scene.tone_knot[0] = 330;
		scene.tone_knot[1] = 270;
	}
	for (unsigned k = 0; k < SCENES; k++) {
		struct joint_pulse truth[6] = { 0 }, found[20];
		struct joint_result r;
		int n = 0;
		uint64_t at = 0;

		memset(y, 0, sizeof y);
		for (int i = 0; i < m; i++) {
			double u = philox_uniform(3, k, RNG_PARTICLE, at++);

			truth[i].t = (i ? truth[i - 1].t + 10 : 150) + u * 300 / m;
			truth[i].delta = 2 + 3 * philox_uniform(3, k, RNG_PARTICLE, at++);
			truth[i].a =
				(0.5 + philox_uniform(3, k, RNG_PARTICLE, at++)) * 31.62;
			joint_add(&scene, &truth[i], 1, y[0], y[1], N);
		}
		for (int c = 0; c < 2; c++) {
			for (int i = 0; i < N; i++)
				for (int l = 0; l < tones && !(left > 0); l++)
					y[c][i] += 15 * cos(scene.omega[l] * i + c + l);
			for (int l = 0; l < tones && left > 0; l++)
				add_left(y[c], &scene, c, l, k, left);
			add_noise(y[c], k, (unsigned)c);
		}
		joint_fit(j, &scene, y[0], y[1], N, found, &n, &r);
		right += n == m;
		for (int i = 0; n == m && i < m; i++) {
			double e = found[i].delta - truth[i].delta;
			double var =
				found[i].cov[0] - 2 * found[i].cov[1] + found[i].cov[2];
			double z = cbrt(found[i].a / truth[i].a) - 1;

			squares += e * e;
			bound += var;
			size += z * z;
			inside += e * e < var;
			all++;
		}
	}
	ok(right >= SCENES - 2,
		"%d pulses and %d tones%s: the count is right in %d of %d", m, tones,
		left > 0 ? ", errors of which are left" : "", right, SCENES);
	/* The ratio of m * SCENES errors scatters by 1 / sqrt(2 m SCENES). */
	ok(squares < bound * pow(1.1 + 2.5 / sqrt(2.0 * all), 2),
		"the error of the delay over the bound is %.3f", sqrt(squares / bound));
	ok(inside > 0.6 * all && inside < 0.76 * all,
		"%.0f %% of the delays are within one standard error",
		100.0 * inside / all);
	ok(sqrt(size / all) < 0.006, "the error of the size is %.2f %%",
		100 * sqrt(size / all));
}

static void test_misuse(struct joint *j, const struct joint_scene *good)
{
	static double y[N];
	struct joint_scene s = *good;
	struct joint_pulse p[20] = { { 0 } };
	struct joint_result r;
	int m = 0;

	s.gain = -1;
	ok(joint_fit(j, &s, y, y, N, p, &m, &r) == JOINT_DOMAIN,
		"negative gain is refused");
	s = *good;
	s.delta_min = -300;
	ok(joint_fit(j, &s, y, y, N, p, &m, &r) == JOINT_DOMAIN,
		"a delay range that precedes the particle is refused");
	s = *good;
	s.scatter[JOINT_WIDTH] = 44;
	ok(joint_fit(j, &s, y, y, N, p, &m, &r) == JOINT_DOMAIN,
		"widths that scatter without limit are refused");
	s = *good;
	ok(joint_fit(j, &s, y, y, 0, p, &m, &r) == JOINT_DOMAIN,
		"a scene without samples is refused");
	ok(joint_fit(j, &s, y, y, N, p, &m, &r) == JOINT_OK && m == 0 && r.chi2 == 0,
		"a scene of zeros contains no pulses");
}

enum { VARIANTS = 10 };

/* Scene number i of those whose tones and baselines differ in one respect each. */
static struct joint_scene scene_with_basis(const struct joint_scene *plain, int i)
{
	struct joint_scene s = *plain;

	if (i == 0)
		return s;
	s.tones = i == 1 ? 1 : 2;
	s.omega[0] = i == 2 ? 0.02 : 0.03;
	s.omega[1] = 0.05;
	if (i > 3) {
		s.tone_variance = i == 4 ? 0.02 : 0.01;
		s.tone_hop = i == 5 ? 150 : 200;
		s.tone_knot[0] = i == 6 ? 70 : 30;
		s.tone_knot[1] = i == 7 ? 90 : 20;
		s.low = i == 8 ? 0.002 : 0;
	}
	return s;
}

/* Fits in turn, more of them than bases are kept, and again, are those of new fits. */
static void test_bases(struct joint *j, const struct joint_scene *plain)
{
	enum { LENGTHS = 5, BASES = LENGTHS * VARIANTS };
	static double y[2][N];
	const struct joint_pulse truth = { .t = 300, .delta = 3, .a = 20 };
	int differ = 0, failed = 0;

	memset(y, 0, sizeof y);
	joint_add(plain, &truth, 1, y[0], y[1], N);
	for (unsigned c = 0; c < 2; c++)
		add_noise(y[c], 5000, c);
	for (int k = 0; k < 3 * BASES; k++) {
		size_t n = N - (size_t)(k / VARIANTS % LENGTHS);
		struct joint_scene s = scene_with_basis(plain, k % VARIANTS);
		struct joint *fresh = joint_new();
		struct joint_pulse p[2][20] = { { truth }, { truth } };
		struct joint_result r[2];

		failed += joint_refine(j, &s, y[0], y[1], n, p[0], 1, &r[0]) != JOINT_OK;
		failed += joint_refine(fresh, &s, y[0], y[1], n, p[1], 1, &r[1]) !=
			  JOINT_OK;
		differ += r[0].chi2 != r[1].chi2 || r[0].dof != r[1].dof ||
			  p[0][0].t != p[1][0].t;
		joint_free(fresh);
	}
	ok(failed == 0 && differ == 0,
		"of %d fits to other tones and baselines in turn %d differ from new ones",
		3 * BASES, differ);
}

/* A pulse of either sign, one of which is saturated: what is hidden does not bias it, and
 * its errors are those of the samples left. */
static void test_hidden(struct joint *j, const struct joint_scene *plain)
{
	static double y[2][N];
	static unsigned char hidden[2][N];
	struct joint_scene s = *plain;
	struct joint_pulse truth[2] = { { .t = 200.3, .delta = 2.1, .a = 60 },
		{ .t = 480.7, .delta = 4.5, .a = -50 } };
	struct joint_pulse found[20], whole[20];
	struct joint_result r;
	int m = 0, lost = 0;
	double off = 0;

	memset(y, 0, sizeof y);
	for (int i = 0; i < 2; i++)
		joint_add(&s, &truth[i], 1, y[0], y[1], N);
	s.signs = 1;
	ok(joint_fit(j, &s, y[0], y[1], N, whole, &m, &r) == JOINT_OK && m == 2 &&
			whole[0].a > 0 && whole[1].a < 0,
		"two pulses of different signs are found");
	for (int c = 0; c < 2; c++)
		for (int i = 0; i < N; i++) {
			hidden[c][i] = fabs(y[c][i]) > 45;
			lost += hidden[c][i];
			if (hidden[c][i])
				y[c][i] = 1000;
		}
	for (int c = 0; c < 2; c++)
		s.hidden[c] = hidden[c];
	m = 0;
	ok(joint_fit(j, &s, y[0], y[1], N, found, &m, &r) == JOINT_OK && m == 2,
		"they are found with %d samples hidden, whatever these are", lost);
	for (int i = 0; i < 2 && m == 2; i++)
		off = tap_max(off, fabs(found[i].t - truth[i].t) +
					   fabs(found[i].delta - truth[i].delta) +
					   fabs(found[i].a / truth[i].a - 1));
	near(off, 0, 2e-3, "what is hidden does not move them");
	ok(found[0].cov[5] > 1.2 * whole[0].cov[5],
		"the amplitude of a saturated pulse has a larger error");
	ok(r.dof == 2 * N - lost - 6 - 2,
		"hidden samples are no degrees of freedom; pulses and offsets take theirs");
}

/* In a section that begins and ends quietly no pulse is put beyond its ends. */
static void test_quiet(struct joint *j, const struct joint_scene *plain)
{
	static double y[2][N];
	struct joint_scene s = *plain;
	struct joint_pulse truth = { .t = 20, .delta = 3, .a = 40 }, found[20];
	struct joint_result r;
	int m = 0;

	memset(y, 0, sizeof y);
	joint_add(&s, &truth, 1, y[0], y[1], N);
	ok(joint_fit(j, &s, y[0], y[1], N, found, &m, &r) == JOINT_OK && m == 1,
		"a pulse that is cut by the beginning is found");
	s.quiet[0] = 50;
	m = 0;
	ok(joint_fit(j, &s, y[0], y[1], N, found, &m, &r) == JOINT_OK &&
			(m == 0 || found[0].t >= 50) && r.chi2 > 1000,
		"no pulse is put into what is quiet");
}

/* What pulses cannot describe, here a rectangle of three durations, ends the search when
 * a few have shown that it is hopeless; a record of as many pulses as are allowed does
 * not.
 */
static void test_hopeless(struct joint *j, const struct joint_scene *plain)
{
	static double y[2][N];
	struct joint_scene s = *plain;
	struct joint_pulse found[20];
	struct joint_result r;
	int m = 0;

	s.hopeless = 1;
	memset(y, 0, sizeof y);
	for (int i = 200; i < 500; i++)
		y[0][i] = y[1][i] = 1000;
	ok(joint_fit(j, &s, y[0], y[1], N, found, &m, &r) == JOINT_OK && !r.full &&
			r.chi2 > 2 * (double)r.dof,
		"a rectangle is not described");
	ok(m >= 3 && m < s.max_pulses, "the search ends after %d of %d pulses", m,
		s.max_pulses);
	memset(y, 0, sizeof y);
	s.max_pulses = 6;
	for (int i = 0; i < 6; i++)
		joint_add(&s,
			&(struct joint_pulse){
				.t = 100 + 90 * i, .delta = 3, .a = 10 << i },
			1, y[0], y[1], N);
	m = 0;
	ok(joint_fit(j, &s, y[0], y[1], N, found, &m, &r) == JOINT_OK && m == 6 &&
			r.chi2 < 1e-3,
		"six pulses are found where six are allowed, the last thirty times smaller");
}

/* The probability of being a pair is right on the average: of pulses that are two in one
 * scene of two, by a gap of up to a tenth of their duration, those fitted as one are as
 * many as their probabilities add up to, beside lines as well. */
static void test_pairs(struct joint *j, const struct joint_scene *plain, int tones)
{
	enum { PAIRS = 400 };
	static double y[2][N];
	struct joint_scene s = *plain;
	struct joint_pulse truth[2], found[20];
	struct joint_result r;
	double sum = 0, var = 0, of_pairs = 0, of_lone = 0, scatter = 2, z[2];
	int two = 0, one = 0;

	s.delta_min = -10;
	s.delta_max = 15;
	s.tones = tones;
	for (int k = 0; k < tones; k++)
		s.omega[k] = 0.03 + 0.01 * k;
	for (unsigned k = 0; k < PAIRS; k++) {
		int pair = k % 2, m = 0;
		double u[4], odds[JOINT_SHARES], p = 0;

		for (unsigned i = 0; i < 4; i++)
			u[i] = philox_uniform(3, k, RNG_PARTICLE, i);
		philox_normal2(3, k, RNG_PARTICLE, 9, z);
		truth[0] = (struct joint_pulse){
			.t = 300 + u[0], .delta = 2 + scatter * z[0] / M_SQRT2, .a = 20
		};
		truth[1] = (struct joint_pulse){ .t = truth[0].t + 20 * (u[1] - 0.5),
			.delta = 2 + scatter * z[1] / M_SQRT2,
			.a = 20 };
		if (pair) {
			truth[0].a = 20 * (0.25 + 0.25 * u[2]);
			truth[1].a = 20 - truth[0].a;
		}
		memset(y, 0, sizeof y);
		for (int i = 0; i <= pair; i++)
			joint_add(&s, &truth[i], 1, y[0], y[1], N);
		for (unsigned c = 0; c < 2; c++)
			add_noise(y[c], 5000 + k, c);
		if (joint_fit(j, &s, y[0], y[1], N, found, &m, &r) != JOINT_OK || m != 1)
			continue;
		joint_pair_odds(j, 0, scatter, odds);
		/* One other per 0.2 durations, of any share. */
		for (int w = 0; w < JOINT_SHARES; w++)
			p += odds[w] / JOINT_SHARES / 0.2;
		p /= 1 + p;
		sum += p;
		var += p * (1 - p);
		two += pair;
		one += !pair;
		of_pairs += pair ? p : 0;
		of_lone += pair ? 0 : p;
	}
	ok(one == PAIRS / 2 && two > PAIRS / 20,
		"with %d lines, of %d pairs %d are fitted as one pulse", tones, PAIRS / 2,
		two);
	near(sum, two, 3.5 * sqrt(var), "their probabilities add up to their number");
	ok(of_pairs / two > of_lone / one + 0.1, "a pair is more probable than a pulse");
}

/* Of two pulses nearly as high, as near as half their delays vary, that whose arrivals
 * at sensor 2 were taken for those of the other are as many as their probabilities add
 * up to. */
static void test_exchange(struct joint *j, const struct joint_scene *plain)
{
	enum { PAIRS = 400 };
	static double y[2][N];
	const double scatter = 10;
	struct joint_scene s = *plain;
	struct joint_pulse truth[2], found[20];
	struct joint_result r;
	double sum = 0, var = 0;
	int fitted = 0, exchanged = 0, silent = 0;

	s.transit = INFINITY; /* all of one duration */
	s.delta_min = -40;
	s.delta_max = 40;
	for (unsigned k = 0; k < PAIRS; k++) {
		double z[2], u[2], odds, p;
		int m = 0;

		for (unsigned i = 0; i < 2; i++)
			u[i] = philox_uniform(4, k, RNG_PARTICLE, i);
		philox_normal2(4, k, RNG_PARTICLE, 9, z);
		memset(y, 0, sizeof y);
		for (int i = 0; i < 2; i++) {
			truth[i] = (struct joint_pulse){ .t = 300 + i * (8 + 20 * u[0]),
				.delta = scatter * z[i],
				.a = 30 + 4 * i * u[1] };
			joint_add(&s, &truth[i], 1, y[0], y[1], N);
		}
		for (unsigned c = 0; c < 2; c++)
			add_noise(y[c], 7000 + k, c);
		if (joint_fit(j, &s, y[0], y[1], N, found, &m, &r) != JOINT_OK || m != 2)
			continue;
		odds = found[0].exchange *
		       exp(-0.5 * found[0].more_square / (scatter * scatter));
		p = odds / (1 + odds);
		fitted++;
		sum += p;
		var += p * (1 - p);
		if (fabs(found[0].delta - truth[0].delta) <
			fabs(found[0].delta + found[0].t - truth[1].t - truth[1].delta))
			continue;
		exchanged++;
		silent += p < 0.01;
	}
	ok(fitted > PAIRS / 2 && exchanged > PAIRS / 50,
		"of %d pairs %d exchange their arrivals", fitted, exchanged);
	near(sum, exchanged, 3.5 * sqrt(var),
		"their probabilities add up to their number");
	ok(silent <= exchanged / 10, "%d of them are thought improbable", silent);
}

/* What pulses have of their own, by how much it scatters, and the parameter that this
 * puts out. */
struct own {
	int own;
	const char *name, *out;
	double scatter;
	double (*square)(
		const struct joint_pulse *found, const struct joint_pulse *truth);
};

/* Squares of errors over their variances. */
static double delay_square(const struct joint_pulse *p, const struct joint_pulse *truth)
{
	return pow(p->delta - truth->delta, 2) / joint_delay_variance(p);
}

static double size_square(const struct joint_pulse *p, const struct joint_pulse *truth)
{
	return pow(p->a - truth->a, 2) / p->cov[5];
}

static const struct own owns[JOINT_OWN] = {
	[JOINT_WIDTH] = { JOINT_WIDTH, "width", "delays", 0.02, delay_square },
	[JOINT_RATIO] = { JOINT_RATIO, "ratio", "amplitudes", 0.03, size_square },
};

/* Adds a pulse that has deviations of its own. */
static void add_own(const struct joint_scene *s, const struct joint_pulse *p,
	const double deviation[JOINT_OWN], double y[2][N])
{
	struct joint_scene other = *s;

	other.duration *= exp(deviation[JOINT_WIDTH]);
	other.gain *= exp(deviation[JOINT_RATIO]);
	joint_add(&other, p, 1, y[0], y[1], N);
}

/* Pulses whose widths scatter by 2 % beside their velocities, at which the delay is known
 * to 0.4 %, or whose ratios scatter by 3 %, at which the amplitude is known to 0.4 %.
 * With the prior, errors are as stated: the mean square of 200 over the variance is
 * within 3 sqrt(2 / 200) of 1.  Without it, they are several times that.  The deviations
 * from the line of an instrument that changes slowly, of widths the half below it, tell a
 * standard deviation within 3 / sqrt(2 * 100).  Widths of which a third are those of two
 * particles, which are only larger, move the line up, and tell of less than their error.
 */
static void test_own(
	struct joint *j, const struct joint_scene *tied, const struct own *of)
{
	enum { PULSES = 200 };
	const double part = 3 / sqrt(PULSES);
	struct joint_scene s = *tied;
	static struct joint_deviation own[PULSES];
	static double y[2][N];
	double square[2] = { 0 }, z[2], explained, plain = 0, moved = 0, most = 0,
	       scatter;

	for (unsigned i = 0; i < PULSES; i++) {
		const struct joint_pulse p = { .t = 300.4, .delta = 3, .a = 31.62 };
		struct joint_deviation *out[JOINT_OWN];
		double deviation[JOINT_OWN] = { 0 };

		out[of->own] = &own[i];
		philox_normal2(9, i, RNG_NOISE, 0, z);
		deviation[of->own] = of->scatter * z[0];
		most = fmax(most, fabs(deviation[of->own]));
		for (int k = 0; k < 2; k++) {
			struct joint_pulse found = p;
			struct joint_result r;

			s.scatter[of->own] = k ? of->scatter : 0;
			memset(y, 0, sizeof y);
			add_own(tied, &p, deviation, y);
			add_noise(y[0], 2000 + i, 0);
			add_noise(y[1], 2000 + i, 1);
			joint_refine(j, &s, y[0], y[1], N, &found, 1, &r);
			square[k] += of->square(&found, &p) / PULSES;
			if (joint_deviations(j, 1U << of->own, out, &explained) != 1)
				ok(0, "the %s of pulse %u is known", of->name, i);
			if (k)
				moved = fmax(moved, fabs(own[i].share - plain));
			plain = own[i].share;
			own[i].at = i;
		}
	}
	ok(square[0] > 2, "a %s that scatters puts %s out by %.2g of their variance",
		of->name, of->out, square[0]);
	near(square[1], 1, 0.3, "errors are as stated where the scatter is known");
	/* Without it the model is linear in them. */
	ok(moved < 2 * most * most,
		"to the second order the %s is the same whatever the prior, to %.1g",
		of->name, moved);
	for (unsigned i = 0; i < PULSES; i++)
		own[i].share += 0.1 * i / PULSES;
	near(joint_scatter(of->own, own, PULSES, LIKELIHOOD_CERTAIN), of->scatter,
		of->scatter * part, "the scatter is found, whatever the trend");
	for (unsigned i = 0; i < PULSES; i++) {
		philox_normal2(9, i, RNG_NOISE, 1, z);
		own[i].share = own[i].se * z[0] + 0.1 * i / PULSES +
			       (of->own != JOINT_WIDTH || i % 3 ? 0 : 0.03);
	}
	scatter = joint_scatter(of->own, own, PULSES, LIKELIHOOD_CERTAIN);
	ok(scatter < own[0].se,
		"trend, noise and pairs of particles are no scatter: "
		"%.1g of their error",
		scatter / own[0].se);
	/* Small pulses beside others that are not seen deviate more. */
	for (unsigned i = 0; i < PULSES; i++) {
		philox_normal2(10, i, RNG_NOISE, 1, z);
		own[i].se = i % 4 ? 0.01 : 1e-4;
		own[i].share = own[i].se * z[0] * (i % 4 ? 2 : 1);
	}
	scatter = joint_scatter(of->own, own, PULSES, LIKELIHOOD_CERTAIN);
	ok(scatter < 1e-3, "small pulses show no scatter that large ones do not have");
	for (unsigned i = 0; i < PULSES; i++) {
		philox_normal2(11, i, RNG_NOISE, 1, z);
		own[i].se = 1e-3;
		own[i].share = 40 * z[0];
	}
	scatter = joint_scatter(of->own, own, PULSES, LIKELIHOOD_CERTAIN);
	ok(scatter == 0, "a scatter of more than a factor of two is none (%.2g)",
		scatter);
}

/* Two pulses that overlap, with deviations of 1 % of both signs: those of the set are
 * found to their second order. */
static void test_own_pair(struct joint *j, const struct joint_scene *tied, unsigned set)
{
	const struct joint_pulse truth[2] = { { .t = 280.4, .delta = 3, .a = 31.62 },
		{ .t = 280.4 + 0.7 * tied->duration, .delta = 4, .a = 25 } };
	const double sign[JOINT_OWN][2] = { { 1, -1 }, { -1, 1 } };
	struct joint_pulse found[2] = { truth[0], truth[1] };
	struct joint_deviation own[JOINT_OWN][2], *const out[] = { own[0], own[1] };
	struct joint_result r;
	static double y[2][N];
	double explained = 0;

	memset(y, 0, sizeof y);
	for (int i = 0; i < 2; i++) {
		double deviation[JOINT_OWN] = { 0 };

		for (int k = 0; k < JOINT_OWN; k++)
			deviation[k] = set >> k & 1 ? 0.01 * sign[k][i] : 0;
		add_own(tied, &truth[i], deviation, y);
	}
	joint_refine(j, tied, y[0], y[1], N, found, 2, &r);
	ok(joint_deviations(j, set, out, &explained) == 2,
		"what two pulses that overlap have of their own is known");
	for (int k = 0; k < JOINT_OWN; k++)
		for (int i = 0; i < 2 && set >> k & 1; i++)
			near(own[k][i].share, 0.01 * sign[k][i], 1e-3, "and found");
	near(explained, r.chi2, 0.01 * r.chi2, "they explain all that is left");
}

/* The gain error of pulses that overlap and differ in duration: its variance is that of
 * the ratio of their sums, of which the energies are known, with the scatter of the
 * ratios.  A prior of these takes nothing of it, and less of it goes into the fit of
 * pulses that overlap. */
static void test_gain_error(struct joint *j, const struct joint_scene *tied, int m)
{
	const struct joint_pulse truth[2] = { { .t = 280.4, .delta = 3, .a = 31.62 },
		{ .t = 317.1, .delta = 60, .a = 25 } };
	const double scatter = 0.02;
	static double y[2][N];
	struct joint_scene s = *tied, other;
	double share[2], se[2], var = 0;

	s.delta_max = 80;
	other = s;
	other.gain *= 1.01;
	for (int k = 0; k < 2; k++) {
		struct joint_pulse found[2] = { truth[0], truth[1] };
		struct joint_result r;

		s.scatter[JOINT_RATIO] = k * scatter;
		memset(y, 0, sizeof y);
		for (int i = 0; i < m; i++)
			joint_add(&other, &truth[i], 1, y[0], y[1], N);
		joint_refine(j, &s, y[0], y[1], N, found, m, &r);
		joint_gain_error(j, &share[k], &se[k]);
		memset(y, 0, sizeof y);
		for (int i = 0; i < m && !k; i++)
			joint_add(&s, &found[i], 1, y[0], y[1], N);
		for (int c = 0; c < 2 && !k; c++) {
			double energy = 0;

			for (int n = 0; n < N; n++)
				energy += y[c][n] * y[c][n];
			var += 1 / energy;
		}
	}
	near(se[0], sqrt(var), 1e-6 * sqrt(var), "the error of a wrong gain is known");
	near(share[0], 0.01, m == 1 ? 1e-4 : 4e-3, "and it is found");
	near(share[1], 0.01, m == 1 ? 1e-4 : 1e-3, "also where the ratios scatter");
	var += scatter * scatter;
	ok(m == 1 ? fabs(se[1] - sqrt(var)) < 1e-2 * se[1]
		  : se[1] > se[0] && se[1] < sqrt(var),
		"then its error contains this, less if more pulses scatter");
}

int main(void)
{
	struct shape *shape = shape_new(PULSE_SINE);
	struct joint_scene s = make_scene(shape);
	struct joint *j = joint_new();

	test_clean(j, &s);
	test_bases(j, &s);
	test_wide(j, &s);
	test_bound(j, &s);
	test_adjust(j, &s);
	test_slopes(j, &s);
	test_noisy(j, &s, 1, 0, 0);
	test_noisy(j, &s, 2, 0, 0);
	test_noisy(j, &s, 6, 0, 0);
	test_noisy(j, &s, 2, 2, 0);
	test_noisy(j, &s, 2, 2, 3);
	test_hidden(j, &s);
	test_quiet(j, &s);
	test_hopeless(j, &s);
	test_pairs(j, &s, 0);
	test_pairs(j, &s, 12);
	test_exchange(j, &s);
	test_laminar(j, &s);
	for (int own = 0; own < JOINT_OWN; own++)
		test_own(j, &s, &owns[own]);
	for (unsigned set = 1; set < 1 << JOINT_OWN; set++)
		test_own_pair(j, &s, set);
	test_gain_error(j, &s, 1);
	test_gain_error(j, &s, 2);
	test_misuse(j, &s);
	joint_free(j);
	shape_free(shape);
	return tap_done();
}
