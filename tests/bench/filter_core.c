/* filter_core N STEPS SHARE: the bare particle filter on a drifting random walk.
 * Prints particles, steps, seconds, particle-steps per second, root mean square error
 * over that of the Kalman filter, and the root mean square difference from its mean over
 * its standard deviation. */
#include "life/particle/filter.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { SETTLE = 20 }; /* steps until the uniform start is forgotten */
static const double DRIFT = 0.02, PROCESS = 0.1, NOISE = 0.2;

static double seconds(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char **argv)
{
	size_t n = argc > 1 ? strtoul(argv[1], NULL, 10) : 10000;
	int steps = argc > 2 ? atoi(argv[2]) : 1000;
	struct filter_par par = { n, 2, argc > 3 ? atof(argv[3]) : 0.5 };
	struct draw *source = draw_new(7, 0, RNG_NOISE), *d = draw_new(1, 0, RNG_FILTER);
	struct filter *f = filter_new(&par, d);
	double *mean = malloc(n * sizeof *mean), x = 0, k_x = 0, k_p = NOISE * NOISE;
	double sum = 0, k_sum = 0, apart = 0, spent = 0, past = 0;

	if (!source || !d || !f || !mean)
		return 1;
	filter_start(f, &past, 1, sqrt(3) * NOISE);
	for (int k = 0; k < steps; k++) {
		struct filter_step now;
		double y, start, gain;

		x += DRIFT + PROCESS * draw_normal(source);
		y = x + NOISE * draw_normal(source);
		k_p += PROCESS * PROCESS;
		gain = k_p / (k_p + NOISE * NOISE);
		k_x += DRIFT + gain * (y - k_x - DRIFT);
		k_p *= 1 - gain;
		start = seconds();
		now = filter_step(f, 0);
		for (size_t i = 0; i < n; i++)
			mean[i] = now.x[now.ancestor[i]] + DRIFT;
		filter_predict(f, mean, PROCESS);
		filter_update(f, y, NOISE);
		spent += seconds() - start;
		sum += pow(filter_now(f).mean - x, 2);
		k_sum += pow(k_x - x, 2);
		if (k >= SETTLE)
			apart += pow(filter_now(f).mean - k_x, 2) / k_p;
	}
	printf("%zu\t%d\t%.6f\t%.4g\t%.6f\t%.3e\n", n, steps, spent,
		(double)n * steps / spent, sqrt(sum / k_sum),
		sqrt(apart / (steps - SETTLE)));
	filter_free(f);
	draw_free(d);
	draw_free(source);
	free(mean);
	return 0;
}
