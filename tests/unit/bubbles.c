/* Bubbles are taken out of a record of which nothing is known, particles are not */
#include "signal/learn/bubbles.h"
#include "num/philox.h"
#include "signal/pulse/shape.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 40000, COUNT = 30 };

static const double T = 120, LAG = 360, AMPLITUDE = 40;

/* Adds to a channel a pulse of a particle or, with sigma > 0, a bump of that width. */
static void add_pulse(const struct shape *shape, double t, double sigma, double *y)
{
	double *p = malloc(N * sizeof *p);

	if (sigma == 0)
		shape_sample(shape, t, T, 0, N, p, NULL, NULL);
	for (int i = 0; i < N; i++)
		y[i] += AMPLITUDE *
			(sigma > 0 ? exp(-0.5 * pow((i - t) / sigma, 2)) : p[i]);
	free(p);
}

/* COUNT particles in noise 1; every third is followed by an event later: with sigma a
 * bump, else another particle so near that both look like a longer one. */
static void make_record(double sigma, double later, double *y)
{
	struct shape *shape = shape_new(PULSE_SINE);
	double z[2];

	for (int i = 0; i < N; i++) {
		philox_normal2(5, 0, RNG_NOISE, (uint64_t)i, z);
		y[i] = z[0];
		y[N + i] = z[1];
	}
	for (int k = 0; k < COUNT; k++) {
		double u = philox_uniform(5, 0, RNG_PARTICLE, (uint64_t)k);
		double t = 500 + (k + 0.3 * u) * (N - 2500) / COUNT;

		for (int c = 0; c < 2; c++) {
			add_pulse(shape, t + c * LAG, 0, y + c * N);
			if (k % 3 == 0)
				add_pulse(shape, t + later + c * LAG, sigma, y + c * N);
		}
	}
	shape_free(shape);
}

/* Largest value that is left in seen at the time of the bumps, or -1; *changed: samples
 * of either channel that differ. */
static double left_of(const double *y, double later, int *changed)
{
	double *copy = malloc(2 * N * sizeof *copy), *work = malloc(2 * N * sizeof *work);
	double *seen = malloc(2 * N * sizeof *seen), most = -1;
	struct marks m[2] = { { .count = 0 }, { .count = 0 } };
	struct velocities v;

	if (copy && work && seen && marks_find(y, N, 0, work, &m[0]) == NUM_OK &&
		marks_find(y + N, N, 0, work, &m[1]) == NUM_OK &&
		velocities_find(m, N, &v) == NUM_OK) {
		memcpy(copy, y, 2 * N * sizeof *copy);
		memcpy(seen, y, 2 * N * sizeof *seen);
		if (bubbles_remove(&v, 1.3, m, copy, N, work, seen) == NUM_OK)
			most = 0;
		*changed = 0;
		for (int i = 0; i < 2 * N; i++)
			*changed += seen[i] != y[i];
		for (int k = 0; k < COUNT && most >= 0; k += 3) {
			double u = philox_uniform(5, 0, RNG_PARTICLE, (uint64_t)k);
			double t = 500 + (k + 0.3 * u) * (N - 2500) / COUNT + later;

			most = fmax(most,
				fmax(fabs(seen[(int)t]), fabs(seen[N + (int)(t + LAG)])));
		}
	}
	marks_clear(&m[0]);
	marks_clear(&m[1]);
	free(copy);
	free(work);
	free(seen);
	return most;
}

int main(void)
{
	double *y = malloc(2 * N * sizeof *y), most;
	int changed = 0;

	if (!y)
		return 1;
	make_record(0.4 * T, 5 * T, y);
	most = left_of(y, 5 * T, &changed);
	ok(most >= 0 && most < 0.2 * AMPLITUDE,
		"what is learned from has no bubbles (at most %.1f left)", most);
	ok(changed < N / 2, "and most samples as they were (%d differ)", changed);
	make_record(0, 0.5 * T, y);
	most = left_of(y, 0, &changed);
	ok(most >= 0 && changed == 0,
		"two particles that overlap are no bubble (%d samples differ)", changed);
	make_record(0, 5 * T, y);
	most = left_of(y, 0, &changed);
	ok(most >= 0 && changed == 0, "nor are any particles (%d samples differ)",
		changed);
	free(y);
	return tap_done();
}
