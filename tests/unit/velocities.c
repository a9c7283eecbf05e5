/* The ratio of transit time and duration where velocities differ by several times */
#include "signal/learn/velocities.h"
#include "num/philox.h"
#include "signal/pulse/shape.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 40000, COUNT = 30 };

/* COUNT particles in noise 1, amplitude 40, whose pulses last shortest to longest and
 * which take ratio durations from sensor to sensor. */
static void make_record(
	double shortest, double longest, double ratio, double *y1, double *y2)
{
	struct shape *shape = shape_new(PULSE_GAUSS);
	double *p = malloc(N * sizeof *p), z[2];

	for (int i = 0; i < N; i++) {
		philox_normal2(3, 0, RNG_NOISE, (uint64_t)i, z);
		y1[i] = z[0];
		y2[i] = z[1];
	}
	for (int k = 0; k < COUNT; k++) {
		double u = philox_uniform(3, 0, RNG_PARTICLE, (uint64_t)k);
		double T = shortest * pow(longest / shortest, u);
		double t = 400 + (k + 0.3 * u) * (N - 2000) / COUNT;

		for (int c = 0; c < 2; c++) {
			double *y = c ? y2 : y1;

			shape_sample(
				shape, t + (c ? ratio * T : 0), T, 0, N, p, NULL, NULL);
			for (int i = 0; i < N; i++)
				y[i] += 40 * p[i];
		}
	}
	free(p);
	shape_free(shape);
}

static enum num_status find(const double *y1, const double *y2, struct velocities *v)
{
	double *work = malloc(2 * N * sizeof *work);
	struct marks m[2] = { { .count = 0 }, { .count = 0 } };
	enum num_status status = work ? marks_find(y1, N, 0, work, &m[0]) : NUM_MEMORY;

	if (status == NUM_OK)
		status = marks_find(y2, N, 0, work, &m[1]);
	if (status == NUM_OK)
		status = velocities_find(m, N, v);
	marks_clear(&m[0]);
	marks_clear(&m[1]);
	free(work);
	return status;
}

/* Marks in white noise 1 with a random walk of this step: all are false. */
static size_t count_false(double step, double known, double *y, double *work)
{
	struct marks m;
	size_t count = 0;
	double walk = 0, z[2];

	for (int i = 0; i < N; i++) {
		philox_normal2(4, 0, RNG_NOISE, (uint64_t)i, z);
		y[i] = z[0] + (walk += step * z[1]);
	}
	count = marks_find(y, N, known, work, &m) == NUM_OK ? m.count : N;
	marks_clear(&m);
	return count;
}

/* A baseline that is not known to drift looks like slow particles. */
static void test_drift(double *y)
{
	static const double steps[] = { 0.01, 0.05, 0.2 };
	double *work = malloc(2 * N * sizeof *work);

	for (size_t k = 0; work && k < sizeof steps / sizeof *steps; k++) {
		size_t count = count_false(steps[k], steps[k], y, work);

		/* Noise exceeds 5 once in 1.7e6 products, of which there are 1e6. */
		ok(count <= 3, "a walk of steps of %g has no marks (%zu)", steps[k],
			count);
	}
	ok(work && count_false(0.2, 0, y, work) > 20, "one that is not known has");
	free(work);
}

int main(void)
{
	double *y1 = calloc(N, sizeof *y1), *y2 = calloc(N, sizeof *y2);
	struct velocities v, plug;

	if (!y1 || !y2)
		return 1;
	make_record(50, 250, 3, y1, y2);
	ok(find(y1, y2, &v) == NUM_OK && v.ratio > 0,
		"a ratio is found where durations differ by five times");
	/* Pulses are compared with sines, whose duration is another one. */
	ok(v.slowest > 3.5 * v.fastest && v.slowest < 6.5 * v.fastest,
		"so are the fastest and the slowest particle (%.2f times)",
		v.slowest / v.fastest);
	make_record(100, 105, 3, y1, y2);
	if (find(y1, y2, &plug) != NUM_OK)
		return 1;
	ok(fabs(log(plug.ratio / v.ratio)) < 0.05,
		"plug flow has the same ratio (%.3f, %.3f)", v.ratio, plug.ratio);
	ok(plug.slow < 1.2 * plug.fast, "and velocities that hardly differ (%.2f times)",
		plug.slow / plug.fast);
	for (int i = 0; i < N; i++)
		y2[i] = -y2[i];
	ok(find(y1, y2, &v) == NUM_OK && v.opposite && v.ratio == 0 && !plug.opposite,
		"pulses that sensor 2 reverses are told apart");
	memset(y2, 0, N * sizeof *y2);
	ok(find(y1, y2, &v) == NUM_OK && v.ratio == 0, "a silent channel has no ratio");
	make_record(50, 250, 3, y1, y2);
	for (int i = 0; i < N / 2; i++) {
		double swap = y2[i];

		y2[i] = y2[N - 1 - i];
		y2[N - 1 - i] = swap;
	}
	ok(find(y1, y2, &v) == NUM_OK && v.ratio == 0,
		"nor has one whose pulses are at other times");
	test_drift(y1);
	free(y1);
	free(y2);
	return tap_done();
}
