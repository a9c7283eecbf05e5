/* Shot noise: moments of particles too many to tell apart */
#include "signal/campbell.h"
#include "num/philox.h"
#include "tap.h"
#include <stdlib.h>

enum { N = 400000 };

int main(void)
{
	struct shape *shape = shape_new(PULSE_SINE);
	double *y1 = calloc(N, sizeof *y1), *y2 = calloc(N, sizeof *y2), p[200], z[2];
	double rate = 0.1, square = 0, fourth = 0;
	struct campbell c, d;

	/* Ten pulses overlap everywhere; amplitudes uniform in 5 .. 15, noise 1. */
	for (uint64_t k = 0; k < (uint64_t)(rate * N); k++) {
		double t = philox_uniform(5, 0, RNG_PARTICLE, 2 * k) * N;
		double a = 5 + 10 * philox_uniform(5, 0, RNG_PARTICLE, 2 * k + 1);
		size_t n;
		long first = shape_support(shape, t, 100, &n);

		shape_sample(shape, t, 100, first, n, p, NULL, NULL);
		for (size_t i = 0; i < n; i++)
			if (first + (long)i >= 0 && first + (long)i < N) {
				y1[first + (long)i] += a * p[i];
				y2[first + (long)i] += 0.9 * a * p[i];
			}
		square += a * a / N;
		fourth += a * a * a * a / N;
	}
	for (uint64_t i = 0; i < N; i++) {
		philox_normal2(5, 0, RNG_NOISE, i, z);
		y1[i] += z[0];
		y2[i] += z[1];
	}
	campbell_estimate(y1, y2, N, shape, 100, 0.9, &c);
	near(c.square, square, 3 * c.square_se,
		"sum of squares within three standard errors");
	near(c.fourth, fourth, 3 * c.fourth_se, "sum of fourth powers too");
	ok(c.square_se < 0.03 * square, "squares to 3 %%");
	ok(c.rate - 3 * c.rate_se < rate, "the equal number is no upper bound");
	near(c.rate, square * square / fourth, 3 * c.rate_se, "equal number");
	near(c.amplitude, sqrt(fourth / square), 3 * c.amplitude_se, "equal amplitude");
	campbell_estimate(y1, y2, 3000, shape, 100, 0.9, &d);
	ok(isinf(d.rate_se), "a short stretch says nothing");
	d = c;
	campbell_scale(&d, 2);
	near(d.square, 4 * c.square, 1e-12 * d.square, "other units");
	free(y1);
	free(y2);
	shape_free(shape);
	return tap_done();
}
