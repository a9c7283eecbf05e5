/* marks.c - see marks.h */
#include "signal/learn/marks.h"
#include "num/dot.h"
#include "num/parabola.h"
#include "num/room.h"
#include "num/sigmas.h"
#include "signal/noise/robust.h"
#include "signal/pulse/shape.h"
#include <math.h>
#include <stdlib.h>

/* Points of a pulse on the grid where it is looked for, and pulses of a channel that are
 * kept. */
enum { POINTS = 24, MOST = 512 };

/* Longest pulse, as a share of the record: there are more than three times as many as
 * are needed to compare the channels. */
static const double LONGEST = 0.05;

/* Largest distance, in durations of the longer one, of what is within a larger pulse: its
 * lobes look like pulses at half a duration from it. */
static const double WITHIN = 0.75;

/* Products of the pulse of so many points, of energy 1, with z[0 .. m): the period of a
 * sine, or one lobe. */
static void filter(const double *z, size_t m, int lobe, int points, double *out)
{
	double p[2 * POINTS + 1], energy = 0;

	for (int k = 0; k < points; k++) {
		double s = (k + 0.5) / points;

		p[k] = lobe ? marks_lobe(s - 0.5) : sin(2 * M_PI * s);
		energy += p[k] * p[k];
	}
	for (int k = 0; k < points; k++)
		p[k] /= sqrt(energy);
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

/* Pulses of either kind with durations from least to most.  The variance of the product
 * with a sine of T samples, of energy 1, is that of white noise, and step^2 T^2 times the
 * mean square of its integral, 3 / (4 pi^2). */
static enum num_status find(const double *x, size_t n, int lobe, double step,
	double least, double most, double *work, struct marks *m)
{
	double noise = robust_noise(x, NULL, n, work), *z = work, *out = work + n;
	size_t kept = 0;

	*m = (struct marks){ .noise = noise };
	if (!(noise > 0))
		return NUM_OK;
	for (double T = least; T < most; T *= exp(MARKS_STEP)) {
		size_t q = T > 2 * POINTS ? (size_t)(T / POINTS) : 1, count = n / q;
		int points = (int)(T / (double)q + 0.5);
		double walk = step / noise * points * (double)q / M_PI;
		double spread = sqrt(1 + 0.75 * walk * walk);

		for (size_t i = 0; i < count; i++) {
			z[i] = 0;
			for (size_t k = 0; k < q; k++)
				z[i] += x[i * q + k] / (noise * sqrt((double)q));
		}
		filter(z, count, lobe, points, out);
		for (size_t i = 1; i + 1 < count; i++) {
			double a = fabs(out[i - 1]), b = fabs(out[i]),
			       c = fabs(out[i + 1]), at;

			if (b < SIGMAS_NEVER * spread || b < a || b <= c)
				continue;
			if (room_for(&m->mark, &m->room, m->count + 1, sizeof *m->mark))
				return NUM_MEMORY;
			at = (double)i + parabola_top(a, b, c) + (points % 2 ? 0.5 : 0);
			m->mark[m->count++] = (struct mark){ at * (double)q,
				points * (double)q, out[i] / spread };
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

enum num_status marks_find(
	const double *x, size_t n, double step, double *work, struct marks *m)
{
	return find(x, n, 0, step, SHAPE_SHORTEST, LONGEST * (double)n, work, m);
}

enum num_status marks_find_lobes(const double *x, size_t n, double least, double most,
	double *work, struct marks *m)
{
	return find(x, n, 1, 0, least, most, work, m);
}

void marks_clear(struct marks *m)
{
	free(m->mark);
	*m = (struct marks){ 0 };
}
