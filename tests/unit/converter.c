/* Samples that a converter has not measured: its limits, and runs of equal values */
#include "signal/separate/converter.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>
#include <string.h>

enum { N = 20000 };

static double x[N];

/* A sine of 2 V and 700 samples in noise of 0.1 V, in steps of a volt; 0: none. */
static void draw(double step, uint64_t seed)
{
	double z[2];

	for (uint64_t i = 0; i < N; i++) {
		philox_normal2(seed, 0, RNG_NOISE, i, z);
		x[i] = 2 * sin(2 * M_PI * (double)i / 700) + 0.1 * z[0];
		if (step > 0)
			x[i] = step * round(x[i] / step);
	}
}

static double clipped(double value, double limit)
{
	return fmin(fmax(value, -limit), limit);
}

/* Flags all samples, the last ones of runs later; returns how many are hidden. */
static int hide(struct converter *c, unsigned char *hidden)
{
	int sum = 0;

	memset(c, 0, sizeof *c);
	memset(hidden, 0, N);
	for (size_t i = 0; i < N; i++) {
		size_t lost = converter_next(c, &x[i]);

		memset(hidden + i + 1 - lost, 1, lost);
	}
	for (int i = 0; i < N; i++) {
		hidden[i] |= (unsigned char)converter_saturates(c, x[i]);
		sum += hidden[i];
	}
	return sum;
}

/* Samples from which on the converter saturates in a record of sines of 1 to 2 V, all of
 * which are beyond a limit of 0.8 V (0: none) with this noise behind it; 0: no limit. */
static double found_limit(double limit, double behind, double step, uint64_t seed)
{
	static double work[2 * N];
	static unsigned char hidden[N];
	struct converter c = { .run = 0 };
	double z[2];

	for (uint64_t i = 0; i < N; i++) {
		double peak = 1 + fmod(0.618 * floor((double)i / 700), 1);

		philox_normal2(seed, 0, RNG_NOISE, i, z);
		x[i] = peak * sin(2 * M_PI * (double)i / 700) + 0.03 * z[0];
		if (limit > 0)
			x[i] = clipped(x[i], limit);
		x[i] += behind * z[1];
		if (step > 0)
			x[i] = step * round(x[i] / step);
	}
	return converter_find_blurred(&c, x, 1, hidden, N, work) && c.blurred[0]
		       ? c.from[0]
		       : 0;
}

static void test_blurred(void)
{
	static const double behind[] = { 1e-5, 1e-3, 0.01, 0.03 };
	static const double steps[] = { 0, 1e-4, 0.01, 0.05, 0.2 };

	/* The band has all of the noise, and no more than is given away by its margin. */
	for (size_t k = 0; k < sizeof behind / sizeof *behind; k++) {
		double from = found_limit(0.8, behind[k], 0, 11 + k);

		ok(from < 0.8 - 1.5 * behind[k] && from > 0.8 - 12 * behind[k] - 0.02,
			"a limit of 0.8 V with noise of %g V behind it begins at %g V",
			behind[k], from);
	}
	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++)
		ok(found_limit(0, 0.03, steps[k], 21 + k) == 0,
			"sines of unlike size in steps of %g V have no limit", steps[k]);
}

/* Pulses of 20 V, each before 2100 samples of noise of a fifth of the step. */
static void test_quiet(void)
{
	static unsigned char hidden[N];
	struct converter c;
	int right = 0;

	draw(0, 31);
	for (int i = 0; i < N; i++) {
		double slow = 2 * sin(2 * M_PI * i / 700);

		x[i] = 0.5 * round((x[i] + (i % 2800 < 700 ? 9 * slow : -slow)) / 0.5);
	}
	hide(&c, hidden);
	ok(!memchr(hidden + 2800, 1, N - 2800),
		"after a pulse, a coarse converter may stand at the value without pulses");
	for (int i = 5000; i < 6500; i++)
		x[i] = 10;
	hide(&c, hidden);
	for (int i = 5000; i < 6500; i++)
		right += hidden[i];
	ok(right == 1500, "a dropout at another value is hidden");
}

int main(void)
{
	static const double steps[] = { 0, 1e-4, 0.01, 0.05, 0.2 };
	static unsigned char hidden[N];
	struct converter c;

	for (size_t k = 0; k < sizeof steps / sizeof *steps; k++) {
		int want = 0, right = 0;

		draw(steps[k], 7 + k);
		ok(hide(&c, hidden) == 0,
			"nothing is hidden of a record in steps of %g V", steps[k]);
		for (int i = 0; i < N; i++)
			want += fabs(x[i]) >= 1.4;
		for (int i = 0; i < N; i++)
			x[i] = clipped(x[i], 1.4);
		ok(hide(&c, hidden) == want,
			"all %d samples beyond a limit of 1.4 V, in steps of %g V, and no "
			"others are hidden",
			want, steps[k]);
		draw(steps[k], 7 + k);
		for (int i = 5000; i < 5100; i++)
			x[i] = 0;
		want = hide(&c, hidden);
		for (int i = 5000; i < 5100; i++)
			right += hidden[i];
		ok(right == 100 && want <= 110,
			"a dropout of 100 samples in steps of %g V is hidden, with %d beside it",
			steps[k], want - right);
		draw(steps[k], 7 + k);
		for (int i = 5000; i < 5100; i++)
			x[i] = NAN;
		ok(hide(&c, hidden) == 100 && memchr(hidden, 1, N) == hidden + 5000 &&
				x[5000] == x[4999] && x[5099] == x[4999],
			"100 missing samples in steps of %g V are hidden, and held",
			steps[k]);
	}
	test_blurred();
	test_quiet();
	return tap_done();
}
