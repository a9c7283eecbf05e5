/* Shot noise: moments of particles too many to separate */
#include "signal/detect/campbell.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 400000 };

static const double rate = 0.1; /* pulses per sample */

/* Ten pulses overlap everywhere; amplitudes uniform in 0.5 .. 1.5 times size, noise 1.
 * sums: of a^2 and a^4, per sample. */
static void make_sizes(double size, uint32_t realisation, int n,
	const struct shape *shape, double *y1, double *y2, double sums[2])
{
	double p[4000], z[2];

	sums[0] = sums[1] = 0;
	for (uint64_t k = 0; k < (uint64_t)(rate * n); k++) {
		double t = n * philox_uniform(5, realisation, RNG_PARTICLE, 2 * k);
		double a = size * (0.5 + philox_uniform(5, realisation, RNG_PARTICLE,
						 2 * k + 1));
		size_t len;
		long first = shape_support(shape, t, 100, &len);

		shape_sample(shape, t, 100, first, len, p, NULL, NULL);
		for (size_t i = 0; i < len; i++)
			if (first + (long)i >= 0 && first + (long)i < n) {
				y1[first + (long)i] += a * p[i];
				y2[first + (long)i] += 0.9 * a * p[i];
			}
		sums[0] += a * a / n;
		sums[1] += a * a * a * a / n;
	}
	for (int i = 0; i < n; i++) {
		philox_normal2(5, realisation, RNG_NOISE, (uint64_t)i, z);
		y1[i] += z[0];
		y2[i] += z[1];
	}
}

static void make_record(uint32_t realisation, int n, const struct shape *shape,
	double *y1, double *y2, double sums[2])
{
	make_sizes(10, realisation, n, shape, y1, y2, sums);
}

/* Standard errors are those of the scatter from record to record. */
static void test_errors(const struct shape *shape)
{
	enum { TIMES = 60, SHORT = 40000 };
	static double y[2][SHORT];
	double sum[2] = { 0 }, squares[2] = { 0 }, errors[2] = { 0 }, sums[2];

	for (uint32_t k = 0; k < TIMES; k++) {
		struct campbell c;

		memset(y, 0, sizeof y);
		make_record(k, SHORT, shape, y[0], y[1], sums);
		campbell_estimate(y[0], y[1], SHORT, shape, 100, 0.9, &c);
		for (int i = 0; i < 2; i++) {
			double x = i ? c.fourth : c.square;

			sum[i] += x / TIMES;
			squares[i] += x * x / TIMES;
			errors[i] += (i ? c.fourth_se : c.square_se) / TIMES;
		}
	}
	/* The scatter is known to 1 / sqrt(2 TIMES) = 9 %. */
	for (int i = 0; i < 2; i++)
		near(errors[i] / sqrt(squares[i] - sum[i] * sum[i]), 1, 0.3,
			i ? "fourth powers scatter by their standard error"
			  : "squares scatter by their standard error");
}

/* The spectrum of the record is that of its pulse, and of no other shape or duration;
 * what follows from another one is right within the errors that allow for it. */
static void test_other_pulse(
	const double *y1, const double *y2, const struct shape *shape, double square)
{
	struct shape *other = shape_new(PULSE_GAUSS);
	static const struct {
		int gauss;
		double duration;
		const char *what;
	} wrong[] = { { 1, 100, "another shape" }, { 0, 120, "a longer pulse" },
		{ 0, 80, "a shorter pulse" } };
	struct campbell c;

	campbell_estimate(y1, y2, N, shape, 100, 0.9, &c);
	campbell_compare(y1, y2, N, shape, 100, 0.9, &c);
	/* Chance leaves some 1 / sqrt(2000 frequencies in a band). */
	ok(c.unlike < 0.05, "the spectrum of the record is that of its pulse");
	for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
		const struct shape *p = wrong[k].gauss ? other : shape;

		campbell_estimate(y1, y2, N, p, wrong[k].duration, 0.9, &c);
		ok(fabs(c.square - square) > 3 * c.square_se,
			"by %s the sum of squares is wrong", wrong[k].what);
		campbell_compare(y1, y2, N, p, wrong[k].duration, 0.9, &c);
		ok(c.unlike > 0.2, "a wrong pulse differs in spectrum");
		near(c.square, square, 2 * c.square_se,
			"the standard error includes the error by a wrong pulse");
	}
	shape_free(other);
}

/* A line of the power of the pulses, where their spectrum is largest, is in one of many
 * bands; where weak pulses have no power, their noise is no difference. */
static void test_bands(enum pulse_shape pulse)
{
	enum { PART = 10000 };
	static double y[2][PART];
	struct shape *shape = shape_new(pulse);
	struct campbell c;
	double sums[2], most = 0;

	for (uint32_t k = 0; k < 8; k++) {
		memset(y, 0, sizeof y);
		make_sizes(1, k, PART, shape, y[0], y[1], sums);
		campbell_estimate(y[0], y[1], PART, shape, 100, 0.9, &c);
		campbell_compare(y[0], y[1], PART, shape, 100, 0.9, &c);
		most = fmax(most, c.unlike);
	}
	/* Chance leaves 0.1, and hardly ever three times that. */
	ok(most < 0.3, "weak pulses have the spectrum of one of them");
	near(c.square, sums[0], 3 * c.square_se,
		"the sum of squares of weak pulses is right");
	for (int i = 0; i < PART; i++) {
		double line = sqrt(2 * sums[0] * 100 * shape_energy(shape)) *
			      sin(0.008 * 2 * acos(-1) * i);

		y[0][i] += line;
		y[1][i] += 0.9 * line;
	}
	campbell_estimate(y[0], y[1], PART, shape, 100, 0.9, &c);
	campbell_compare(y[0], y[1], PART, shape, 100, 0.9, &c);
	ok(c.unlike > 0.5, "a line among them shows in the spectrum");
	near(c.square, sums[0], 2 * c.square_se,
		"the standard error includes the error by a line");
	shape_free(shape);
}

/* Adds pulses of height a[i] at t[i] to the noise of a short section. */
static double add_few(const struct shape *shape, uint32_t realisation, const double *t,
	const double *a, int m, double *y, int n)
{
	double p[4000], z[2], sum = 0;

	for (int i = 0; i < n; i++) {
		philox_normal2(5, realisation, RNG_NOISE, (uint64_t)i, z);
		y[i] = z[0];
	}
	for (int k = 0; k < m; k++) {
		shape_sample(shape, t[k], 100, 0, (size_t)n, p, NULL, NULL);
		for (int i = 0; i < n; i++)
			y[i] += a[k] * p[i];
		sum += a[k] * a[k];
	}
	return sum;
}

static void test_most(enum pulse_shape pulse)
{
	enum { SECTION = 800, RUNS = 400 };
	struct shape *shape = shape_new(pulse);
	const double half[] = { 350, 400 }, same[] = { 30, 30 };
	double y[SECTION], sum, held = 0, factor = 0;

	for (uint32_t run = 0; run < RUNS; run++) {
		double t[4], a[4], u, most;
		int m = 1 + (int)(run % 4);

		for (int k = 0; k < m; k++) {
			u = philox_uniform(6, run, RNG_PARTICLE, 2 * (uint64_t)k);
			t[k] = 200 + 400 * u;
			u = philox_uniform(6, run, RNG_PARTICLE, 2 * (uint64_t)k + 1);
			a[k] = 5 + 25 * u;
		}
		sum = add_few(shape, run, t, a, m, y, SECTION);
		most = campbell_most(y, SECTION, shape, 100);
		held += most >= sum;
		factor += log(most / sum) / RUNS;
	}
	ok(held >= 0.95 * RUNS, "the energy bounds the squares of few pulses: %.0f of %d",
		held, RUNS);
	ok(factor < log(3),
		"the bound by the energy is within a factor of 3 of the squares: %.2f",
		exp(factor));
	sum = add_few(shape, 0, half, same, 2, y, SECTION);
	ok(campbell_most(y, SECTION, shape, 100) > sum,
		"the energy bounds the squares of two pulses that cancel most of each other");
	memset(y, 0, sizeof y);
	ok(campbell_most(y, SECTION, shape, 100) < 0, "less than noise is no bound");
	shape_free(shape);
}

int main(void)
{
	struct shape *shape = shape_new(PULSE_SINE);
	double *y1 = calloc(N, sizeof *y1), *y2 = calloc(N, sizeof *y2), sums[2];
	struct campbell c, d;

	make_record(0, N, shape, y1, y2, sums);
	campbell_estimate(y1, y2, N, shape, 100, 0.9, &c);
	near(c.square, sums[0], 3 * c.square_se,
		"the sum of squares is right within three standard errors");
	near(c.fourth, sums[1], 3 * c.fourth_se,
		"the sum of fourth powers is right within three standard errors");
	ok(c.square_se < 0.03 * sums[0], "the sum of squares is right to 3 %%");
	ok(c.rate - 3 * c.rate_se < rate, "the equal number is not an upper bound");
	near(c.rate, sums[0] * sums[0] / sums[1], 3 * c.rate_se,
		"the equal number is right");
	near(c.amplitude, sqrt(sums[1] / sums[0]), 3 * c.amplitude_se,
		"the equal amplitude is right");
	campbell_estimate(y1, y2, 3000, shape, 100, 0.9, &d);
	ok(isinf(d.rate_se), "a short section gives no estimate");
	d = c;
	campbell_scale(&d, 2, 1);
	near(d.square, 4 * c.square, 1e-12 * d.square,
		"the result does not depend on the units");
	test_other_pulse(y1, y2, shape, sums[0]);
	test_errors(shape);
	test_bands(PULSE_SINE);
	test_bands(PULSE_GAUSS);
	test_bands(PULSE_LORENTZ);
	test_most(PULSE_SINE);
	test_most(PULSE_GAUSS);
	test_most(PULSE_LORENTZ);
	free(y1);
	free(y2);
	shape_free(shape);
	return tap_done();
}
