/* velocities.c - see velocities.h */
#include "signal/learn/velocities.h"
#include "num/sigmas.h"
#include "signal/learn/calibration.h"
#include <math.h>
#include <stdlib.h>

/* Fewest pairs that tell the ratio. */
enum { PAIRS = 6 };

/* Pulses of one particle differ by one step of the durations, MARKS_STEP, at most, and
 * the mean of both is known to half a step; noise needs a little more. */
static const double SAME = 0.15, PEAK = 0.06;

struct pair {
	double x, T; /* logarithm of the ratio, and the duration */
};

static int by_ratio(const void *a, const void *b)
{
	double x = ((const struct pair *)a)->x, y = ((const struct pair *)b)->x;

	return (x > y) - (x < y);
}

static int by_duration(const void *a, const void *b)
{
	double x = ((const struct pair *)a)->T, y = ((const struct pair *)b)->T;

	return (x > y) - (x < y);
}

/* The ratio at which there are more pairs than chance makes, most clearly; returns how
 * clearly, in standard deviations. */
static double find_peak(
	struct pair *pair, size_t pairs, double chance, struct velocities *v)
{
	double best = SIGMAS_NEVER;
	size_t from = 0, to = 0, first = 0, last = 0;

	for (size_t i = 0; i < pairs; i++) {
		double expected = chance * 2 * PEAK * exp(pair[i].x), score;

		while (pair[from].x < pair[i].x - PEAK)
			from++;
		while (to < pairs && pair[to].x <= pair[i].x + PEAK)
			to++;
		score = ((double)(to - from) - expected) / sqrt(expected + 1);
		if (to - from >= PAIRS && score > best) {
			best = score;
			first = from;
			last = to;
		}
	}
	if (last == 0)
		return 0;
	v->ratio = exp(pair[(first + last) / 2].x);
	pairs = last - first;
	qsort(pair + first, pairs, sizeof *pair, by_duration);
	v->fastest = pair[first].T;
	v->slowest = pair[last - 1].T;
	v->fast = pair[first + pairs / 10].T;
	v->slow = pair[last - 1 - pairs / 10].T;
	return best;
}

/* Looks for the ratio by pairs of pulses of this sign; returns as find_peak(). */
static double pair_up(const struct marks m[2], size_t n, double sign, struct pair *pair,
	struct velocities *v)
{
	double chance = 0;
	size_t pairs = 0;

	*v = (struct velocities){ 0 };
	for (size_t i = 0; i < m[0].count; i++)
		for (size_t k = 0; k < m[1].count; k++) {
			const struct mark *a = &m[0].mark[i], *b = &m[1].mark[k];
			double T = sqrt(a->T * b->T);

			if (sign * a->value * b->value < 0 ||
				fabs(log(a->T / b->T)) > SAME)
				continue;
			chance += T / (double)n;
			if (b->t - a->t > CALIBRATE_APART * T)
				pair[pairs++] =
					(struct pair){ log((b->t - a->t) / T), T };
		}
	qsort(pair, pairs, sizeof *pair, by_ratio);
	return find_peak(pair, pairs, chance, v);
}

enum num_status velocities_find(const struct marks m[2], size_t n, struct velocities *v)
{
	struct pair *pair = malloc((m[0].count * m[1].count + 1) * sizeof *pair);
	struct velocities other;

	if (!pair)
		return NUM_MEMORY;
	if (pair_up(m, n, -1, pair, &other) > pair_up(m, n, 1, pair, v))
		*v = (struct velocities){ .opposite = 1 };
	free(pair);
	return NUM_OK;
}
