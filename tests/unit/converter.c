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
	return tap_done();
}
