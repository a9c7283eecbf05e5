/* velocities.c - see velocities.h */
#include "signal/learn/velocities.h"
#include "num/dot.h"
#include "num/parabola.h"
#include "num/room.h"
#include "num/sigmas.h"
#include "signal/learn/calibration.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points of a pulse on the grid where it is looked for, pulses of a channel that are
 * compared, and fewest pairs that tell the ratio. */
enum { POINTS = 24, MOST = 512, PAIRS = 6 };

/* Step of the logarithm of the duration.  Pulses of one particle differ by one step at
 * most, and the mean of both is known to half a step; noise needs a little more. */
static const double STEP = 0.115, SAME = 0.15, PEAK = 0.06;

/* Longest pulse, as a share of the record: there are more than three times as many as
 * pairs are needed. */
static const double LONGEST = 0.05;

/* Largest distance, in durations of the longer one, of what is within a larger pulse: its
 * lobes look like pulses at half a duration from it. */
static const double WITHIN = 0.75;

struct mark {
	double t, T, value;
};

struct marks {
	struct mark *mark;
	size_t count, room;
};

/* Products of the sine pulse of so many points, of energy 1, with z[0 .. m). */
static void filter(const double *z, size_t m, int points, double *out)
{
	double p[2 * POINTS + 1], scale = sqrt(2.0 / points);

	for (int k = 0; k < points; k++)
		p[k] = scale * sin(2 * M_PI * (k + 0.5) / points);
	for (size_t i = 0; i < m; i++)
		out[i] = 0;
	for (size_t i = 0; i + (size_t)points <= m; i++)
		out[i + (size_t)points / 2] = dot(p, z + i, (size_t)points);
}

static int by_value(const void *a, const void *b)
{
	double x = fabs(((const struct mark *)a)->value);
	double y = fabs(((const struct mark *)b)->value);

	return (x < y) - (x > y);
}

/* The pulses of a channel: maxima of the products over arrival and duration, none within
 * a larger one. */
static enum num_status find_marks(
	const double *x, size_t n, double *work, struct marks *m)
{
	double noise = robust_noise(x, NULL, n, work), *z = work, *out = work + n;
	size_t kept = 0;

	if (!(noise > 0))
		return NUM_OK;
	for (double T = SHAPE_SHORTEST; T < LONGEST * (double)n; T *= exp(STEP)) {
		size_t q = T > 2 * POINTS ? (size_t)(T / POINTS) : 1, count = n / q;
		int points = (int)(T / (double)q + 0.5);

		for (size_t i = 0; i < count; i++) {
			z[i] = 0;
			for (size_t k = 0; k < q; k++)
				z[i] += x[i * q + k] / (noise * sqrt((double)q));
		}
		filter(z, count, points, out);
		for (size_t i = 1; i + 1 < count; i++) {
			double a = fabs(out[i - 1]), b = fabs(out[i]),
			       c = fabs(out[i + 1]), at;

			if (b < SIGMAS_NEVER || b < a || b <= c)
				continue;
			if (room_for(&m->mark, &m->room, m->count + 1, sizeof *m->mark))
				return NUM_MEMORY;
			at = (double)i + parabola_top(a, b, c) + (points % 2 ? 0.5 : 0);
			m->mark[m->count++] = (struct mark){ at * (double)q,
				points * (double)q, out[i] };
		}
	}
	if (m->count == 0)
		return NUM_OK;
	qsort(m->mark, m->count, sizeof *m->mark, by_value);
	for (size_t i = 0; i < m->count && kept < MOST; i++) {
		size_t k = 0;

		while (k < kept && fabs(m->mark[i].t - m->mark[k].t) >
					   WITHIN * fmax(m->mark[i].T, m->mark[k].T))
			k++;
		if (k == kept)
			m->mark[kept++] = m->mark[i];
	}
	m->count = kept;
	return NUM_OK;
}

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

/* The ratio at which there are more pairs than chance makes, most clearly. */
static void find_peak(
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
		return;
	v->ratio = exp(pair[(first + last) / 2].x);
	pairs = last - first;
	qsort(pair + first, pairs, sizeof *pair, by_duration);
	v->fastest = pair[first].T;
	v->slowest = pair[last - 1].T;
	v->fast = pair[first + pairs / 10].T;
	v->slow = pair[last - 1 - pairs / 10].T;
}

static enum num_status pair_up(const struct marks m[2], size_t n, struct velocities *v)
{
	struct pair *pair = malloc((m[0].count * m[1].count + 1) * sizeof *pair);
	double chance = 0;
	size_t pairs = 0;

	if (!pair)
		return NUM_MEMORY;
	for (size_t i = 0; i < m[0].count; i++)
		for (size_t k = 0; k < m[1].count; k++) {
			const struct mark *a = &m[0].mark[i], *b = &m[1].mark[k];
			double T = sqrt(a->T * b->T);

			if (a->value * b->value < 0 || fabs(log(a->T / b->T)) > SAME)
				continue;
			chance += T / (double)n;
			if (b->t - a->t > CALIBRATE_APART * T)
				pair[pairs++] =
					(struct pair){ log((b->t - a->t) / T), T };
		}
	qsort(pair, pairs, sizeof *pair, by_ratio);
	find_peak(pair, pairs, chance, v);
	free(pair);
	return NUM_OK;
}

enum num_status velocities_find(
	const double *x1, const double *x2, size_t n, struct velocities *v)
{
	struct marks m[2] = { { NULL, 0, 0 }, { NULL, 0, 0 } };
	double *work = malloc((2 * n + 1) * sizeof *work);
	enum num_status status = work ? NUM_OK : NUM_MEMORY;

	*v = (struct velocities){ 0 };
	for (int c = 0; c < 2 && status == NUM_OK; c++)
		status = find_marks(c ? x2 : x1, n, work, &m[c]);
	if (status == NUM_OK && m[0].count > 0 && m[1].count > 0)
		status = pair_up(m, n, v);
	free(m[0].mark);
	free(m[1].mark);
	free(work);
	return status;
}
