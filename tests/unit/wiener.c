/* wiener - noise is taken from a pulse, and little else */
#include "num/wiener.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

enum { N = 400 };

static const double WIDTH = 100;

static double pulse(int i)
{
	double s = (i - N / 2) / (0.2 * WIDTH);

	return s * exp(-0.5 * s * s);
}

/* Mean square error of a pulse of amplitude a in noise of variance 1 over that noise, of
 * many of them. */
static double error_left(double a, double variance)
{
	enum { MANY = 50 };
	double x[N], sum = 0;

	for (uint32_t k = 0; k < MANY; k++) {
		for (int i = 0; i < N; i += 2)
			philox_normal2(1, k, RNG_NOISE, (uint64_t)i, &x[i]);
		for (int i = 0; i < N; i++)
			x[i] += a * pulse(i);
		if (wiener_filter(x, N, variance, WIDTH) != NUM_OK)
			return NAN;
		for (int i = 0; i < N; i++)
			sum += pow(x[i] - a * pulse(i), 2);
	}
	return sum / (MANY * N);
}

int main(void)
{
	double left = error_left(0, 1);

	/* The pulse has its power below 3 / WIDTH cycles per sample, a seventeenth of all
	 * frequencies.  Elsewhere the mean power of the noise at 9 frequencies, which
	 * are worth 4 to 5 independent ones, exceeds its expectation by about a third. */
	ok(left > 0.02 && left < 0.2,
		"a tenth of the noise is left without a pulse (%.3f)", left);
	left = error_left(10, 1);
	ok(left > 0.06 && left < 0.25, "little more is left with a pulse (%.3f)", left);
	near(error_left(1e3, 1), left, 0.03,
		"so it is with a pulse a hundred times as high");
	near(error_left(10, 0), 1, 0.02, "without noise to remove nothing is changed");
	ok(error_left(1, 1e6) < 0.2, "a pulse below the noise is removed with it");
	return tap_done();
}
