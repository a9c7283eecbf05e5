/* Particles that arrive together, told by their amplitudes */
#include "signal/coincide.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

enum { PARTICLES = 1000 };

static const double REACH = 0.04; /* durations, of the amplitudes drawn */

struct rows {
	int n;
	double place[PARTICLES], height[PARTICLES];
	int sum[PARTICLES]; /* of particles more than one */
};

static double uniform(uint64_t seed, uint64_t i)
{
	return philox_uniform(17, (uint32_t)seed, RNG_PARTICLE, i);
}

/* Random arrivals, so many per duration, none sooner than gap after the last; those
 * within reach of the first become one row. */
static void draw(struct rows *rows, double density, double gap, uint64_t seed)
{
	double t = 0;

	rows->n = 0;
	for (uint64_t i = 0; i < PARTICLES; i++) {
		double a = 15 + 40 * pow(uniform(seed, 2 * i), 2);
		int last = rows->n - 1;

		t += gap - log(uniform(seed, 2 * i + 1)) / density;
		if (rows->n && t - rows->place[last] < REACH) {
			rows->height[last] += a;
			rows->sum[last] = 1;
			continue;
		}
		rows->place[rows->n] = t;
		rows->height[rows->n] = a;
		rows->sum[rows->n++] = 0;
	}
}

/* Shares among all rows: believed though sums, and single though not believed. */
static void judge(const struct rows *rows, double *wrong, double *lost)
{
	struct coincide *c = coincide_new();
	double believed = 0;

	*wrong = *lost = 0;
	for (int i = 0; i < rows->n; i++)
		coincide_take(c, rows->place[i], rows->height[i], REACH);
	coincide_learn(c, 0);
	for (int i = 0; i < rows->n; i++) {
		int doubted = coincide_is_sum(c, rows->height[i], REACH);

		believed += !doubted;
		*wrong += !doubted && rows->sum[i];
		*lost += doubted && !rows->sum[i];
	}
	*wrong /= believed;
	*lost /= rows->n;
	coincide_free(c);
}

static void test_crowds(void)
{
	static const double density[] = { 0.5, 1, 2 };

	for (uint64_t k = 0; k < 3; k++) {
		struct rows rows;
		double wrong, lost, sums = 0, wrong_sum = 0;

		for (uint64_t seed = 0; seed < 4; seed++) {
			draw(&rows, density[k], 0, seed);
			judge(&rows, &wrong, &lost);
			wrong_sum += wrong / 4;
			for (int i = 0; i < rows.n; i++)
				sums += 0.25 * rows.sum[i] / rows.n;
		}
		ok(wrong_sum < 0.01 && wrong_sum < 0.4 * sums,
			"of %.1f %% rows that are sums of particles, %.2f %% are believed",
			100 * sums, 100 * wrong_sum);
	}
}

static void test_apart(void)
{
	struct rows rows;
	double wrong, lost;

	draw(&rows, 2, 0.1, 1);
	judge(&rows, &wrong, &lost);
	ok(lost < 0.1, "where arrivals keep a distance few single ones are doubted: %g",
		lost);
	draw(&rows, 0.1, 3, 2);
	judge(&rows, &wrong, &lost);
	ok(lost == 0, "particles far apart are not doubted");
}

/* Two pulses at the reach leave what a second one must take away. */
static void test_reach(void)
{
	enum { T = 400, N = 3 * T };
	struct shape *shape = shape_new(PULSE_SINE);
	struct coincide *c = coincide_new();
	double pair[N], one[N], other[N], reach, ratio;
	double pair2 = 0, cross = 0, one2 = 0;

	ok(coincide_shape(c, shape) == NUM_OK, "a shape is taken in");
	reach = coincide_reach(
		c, T * shape_energy(shape), 1e-3 * T * shape_energy(shape));
	shape_sample(shape, 1.5 * T - 0.5 * reach * T, T, 0, N, pair, NULL, NULL);
	shape_sample(shape, 1.5 * T + 0.5 * reach * T, T, 0, N, other, NULL, NULL);
	shape_sample(shape, 1.5 * T, T, 0, N, one, NULL, NULL);
	for (int i = 0; i < N; i++) {
		double y = 0.5 * (pair[i] + other[i]);

		pair2 += y * y;
		cross += y * one[i];
		one2 += one[i] * one[i];
	}
	ratio = (pair2 - cross * cross / one2) / (1e-3 * T * shape_energy(shape));
	ok(fabs(ratio - 1) < 0.2, "two pulses at the reach leave the threshold: %.3f",
		ratio);
	coincide_free(c);
	shape_free(shape);
}

int main(void)
{
	test_crowds();
	test_apart();
	test_reach();
	return tap_done();
}
