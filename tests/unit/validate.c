/* Rows tested by their velocities: particles and other events */
#include "signal/separate/validate.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ALONE = 40, PAIRS = 100, ROWS = ALONE + 2 * PAIRS };

static const double SPREAD = 1.5; /* of the delays, samples */

static double normal(uint64_t i)
{
	double z[2];

	philox_normal2(11, 0, RNG_NOISE, i, z);
	return z[0];
}

/* Pulses alone, and pairs, whose delays are by shift beside those of the flow.  error:
 * standard error of a delay. */
static void draw(struct evidence *e, double shift, double error, uint64_t seed)
{
	memset(e, 0, ROWS * sizeof *e);
	for (uint64_t i = 0; i < ROWS; i++) {
		uint64_t pair = i < ALONE ? i : ALONE + (i - ALONE) / 2;
		int second = i >= ALONE && (i - ALONE) % 2;

		e[i] = (struct evidence){ .group = (int)pair + 1,
			.fits = 1,
			.delay = SPREAD * normal(seed + 4 * i + 1) +
				 error * normal(seed + 4 * i + 2),
			.var = error * error,
			.amplitude = second ? 10 : 20,
			/* nowhere in particular */
			.time = second ? 0.3 + 0.02 * (double)pair : 0 };
		if (i >= ALONE)
			e[i].delay += second ? shift : -shift;
	}
}

/* Share of the rows from .. to that are doubted. */
static double doubted(const struct evidence *e, int from, int to)
{
	double sum = 0;

	for (int i = from; i < to; i++)
		sum += e[i].doubted;
	return sum / (to - from);
}

/* Without particles of other velocities no row is doubted, whatever the error. */
static void test_flow(double error, uint64_t seed)
{
	static struct evidence e[ROWS];
	struct validation *v = validation_new();

	draw(e, 0, error, seed);
	validation_test(v, e, ROWS);
	ok(doubted(e, 0, ROWS) == 0, "no row is doubted at an error of %g", error);
	validation_free(v);
}

static void test_other_velocities(void)
{
	static struct evidence e[ROWS];
	struct validation *v = validation_new();
	int few = ALONE + 20;

	draw(e, 20, 0.1, 90000);
	for (int i = few; i < ROWS; i++)
		e[i] = (struct evidence){ .group = 1000 + i,
			.fits = 1,
			.delay = SPREAD * normal(100000 + (uint64_t)i),
			.var = 0.01,
			.amplitude = 20 };
	validation_test(v, e, ROWS);
	ok(doubted(e, ALONE, few) == 1 && doubted(e, 0, ALONE) == 0 &&
			doubted(e, few, ROWS) == 0,
		"groups with velocities that the flow has not are doubted, others not");
	validation_free(v);
}

/* A twentieth as high, its velocity unknown, at one distance in one group of three. */
static void test_recurring(void)
{
	static struct evidence e[ROWS];
	struct validation *v = validation_new();
	int missed = 0;

	draw(e, 0, 0.1, 120000);
	for (int i = ALONE + 1; i < ROWS; i += 2) {
		e[i].var = 1e4;
		e[i].amplitude = 1;
		e[i].time = i % 3 ? 0.3 + 0.015 * (i - ALONE) / 2 : -0.7;
	}
	validation_test(v, e, ROWS);
	for (int i = ALONE + 1; i < ROWS; i += 2)
		missed += i % 3 == 0 && !(e[i].doubted && e[i - 1].doubted);
	ok(missed == 0,
		"a weak pulse that recurs at one distance is doubted, and the strong one");
	ok(doubted(e, 0, ALONE) == 0, "pulses alone are not");
	validation_free(v);
}

/* In groups of three whose velocities differ by up to a third, each of two strong pulses
 * leaves a weak one 0.7 of its own durations behind it, so that another pulse may be
 * nearer; transit times are 200 samples. */
static void test_own_durations(void)
{
	enum { GROUPS = 30, EACH = 4 };
	static struct evidence e[GROUPS * EACH];
	struct validation *v = validation_new();
	int missed = 0;

	for (int g = 0; g < GROUPS; g++)
		for (int k = 0; k < 2; k++) {
			double u = philox_uniform(
				23, 0, RNG_PARTICLE, (uint64_t)(2 * g + k));
			struct evidence strong = { .group = g + 1,
				.fits = 1,
				.amplitude = 20,
				.var = 0.1,
				.delay = 200 * (0.4 * u - 0.2),
				.time = 0.4 * k };
			struct evidence weak = strong;

			weak.amplitude = 2;
			weak.time += 0.7 * (1 + strong.delay / 200);
			e[EACH * g + k] = strong;
			e[EACH * g + 2 + k] = weak;
		}
	validation_range(v, 200, -90, 90);
	validation_test(v, e, GROUPS * EACH);
	for (int i = 0; i < GROUPS * EACH; i++)
		missed += !e[i].doubted;
	ok(missed == 0,
		"weak pulses at one distance in durations of their own are doubted");
	validation_free(v);
}

/* Two thousand groups of two, a third of the weak pulses at one distance. */
static void test_long(void)
{
	struct validation *v = validation_new();
	int missed = 0, many = 2000;

	for (int g = 1; g <= many; g++) {
		double u = philox_uniform(19, 0, RNG_PARTICLE, (uint64_t)g);
		struct evidence e[2] = { { .group = g, .fits = 1, .amplitude = 20 },
			{ .group = g, .fits = 1, .amplitude = 1 } };

		e[0].delay = e[1].delay = SPREAD * normal(190000 + (uint64_t)g);
		e[0].var = e[1].var = 0.01;
		e[1].time = g % 3 ? 0.1 + 1.9 * u : 0.7;
		validation_test(v, e, 2);
		missed += g > many / 2 && g % 3 == 0 && !e[1].doubted;
	}
	ok(missed == 0, "a weak pulse that recurs is doubted after %d groups, too", many);
	validation_free(v);
}

/* One negative particle, alone, after as many positive ones as are given. */
static void test_first_negative(int before)
{
	struct validation *v = validation_new();
	struct evidence e = { .fits = 1, .pulse = 1, .var = 0.01 };

	for (int g = 1; g <= before + 1; g++) {
		e.group = g;
		e.delay = SPREAD * normal(200000 + (uint64_t)g);
		e.amplitude = g > before ? -20 : 20;
		validation_test(v, &e, 1);
	}
	ok(!e.doubted, "the first negative particle after %d positive ones is believed",
		before);
	validation_free(v);
}

/* A crowd: up to ten thousand groups of pulses at random, of any height. */
static void test_crowd(double density, int groups, uint64_t seed)
{
	enum { MOST = 40 };
	static struct evidence e[MOST];
	struct validation *v = validation_new();
	double rows = 0, wrong = 0;

	for (int g = 1; g <= groups; g++) {
		int m = 0;
		double t = 0;

		memset(e, 0, sizeof e);
		do {
			double u[2];

			for (uint64_t k = 0; k < 2; k++)
				u[k] = philox_uniform(seed, (uint32_t)g, RNG_PARTICLE,
					2 * (uint64_t)m + k);
			e[m] = (struct evidence){ .group = g,
				.fits = 1,
				.delay = SPREAD *
					 normal(seed + 977 * (uint64_t)g + (uint64_t)m),
				.var = 0.01,
				.amplitude = 20 * exp(u[0]),
				.time = t };
			t += 0.1 - log(u[1]) / density;
			m++;
		} while (m < MOST && t < 12);
		validation_test(v, e, (size_t)m);
		rows += m;
		for (int i = 0; i < m; i++)
			wrong += e[i].doubted;
	}
	ok(wrong < 5e-3 * rows, /* before the flow is known */
		"%.0f of %.0f pulses at random, %g per duration, are doubted", wrong,
		rows, density);
	validation_free(v);
}

/* Delays anywhere in the range that is searched: one in five is at its edge. */
static void test_edge(void)
{
	static struct evidence e[ROWS];
	struct validation *v = validation_new();

	validation_range(v, 600, -6, 6);
	draw(e, 0, 0.1, 140000);
	validation_test(v, e, ROWS);
	ok(doubted(e, 0, ROWS) < 0.02,
		"no row is doubted if velocities do not fill the range");
	validation_free(v);
	v = validation_new();
	validation_range(v, 600, -6, 6);
	memset(e, 0, sizeof e);
	for (int i = 0; i < ROWS; i++)
		e[i] = (struct evidence){ .group = i + 1,
			.fits = 1,
			.delay =
				12 * philox_uniform(17, 0, RNG_PARTICLE, (uint64_t)i) - 6,
			.var = 0.01,
			.amplitude = 20 };
	validation_test(v, e, ROWS);
	ok(doubted(e, 0, ROWS) == 1, "no row is believed if velocities fill the range");
	validation_free(v);
}

/* Pulses explain so much at the sensor that shows them less. */
static double doubted_of(double weaker)
{
	static struct evidence e[ROWS];
	struct validation *v = validation_new();
	double share;

	validation_range(v, 600, -6, 6);
	draw(e, 0, 0.1, 150000);
	for (int i = 0; i < ROWS; i++)
		e[i].weaker = weaker;
	validation_test(v, e, ROWS);
	share = doubted(e, 0, ROWS);
	validation_free(v);
	return share;
}

static void test_one_sensor(void)
{
	ok(doubted_of(2) == 1, "no row is believed if one sensor shows noise alone");
	ok(doubted_of(7) < 0.02, "rows are believed if both sensors show the pulses");
}

int main(void)
{
	for (uint64_t seed = 0; seed < 5; seed++) {
		test_flow(0.1, 2000 * seed);
		test_flow(0.5, 2000 * seed + 10000);
		test_flow(2, 2000 * seed + 20000);
	}
	test_other_velocities();
	test_recurring();
	test_own_durations();
	test_long();
	test_first_negative(20);
	test_first_negative(5000);
	test_crowd(0.3, 10000, 21);
	test_crowd(3, 10000, 22);
	test_crowd(3, 40, 23);
	test_edge();
	test_one_sensor();
	return tap_done();
}
