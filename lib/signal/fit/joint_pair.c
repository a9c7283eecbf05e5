/* joint_pair.c - is a pulse two that arrive nearly together? see joint_state.h
 *
 * Two pulses of shares w and 1 - w a gap tau apart differ from one pulse, beside what
 * moving and scaling it can do, nearly as two equal ones 2 sqrt(w (1 - w)) tau apart do:
 * in the second moment of their arrivals.  This excess is tabulated by the gap on either
 * channel, and what the fitted pulses can take of it is taken off.
 */
#include "signal/fit/joint_state.h"
#include <stdlib.h>
#include <string.h>

/* The gaps of the table, in durations: from none by a factor of sqrt 2. */
static double knot(int k)
{
	static const double first[] = { 0.0125, 0.0125 * M_SQRT2 };

	return k ? first[(k - 1) % 2] * (1 << (k - 1) / 2) : 0;
}

/* What two equal pulses a gap apart put on channel c beside one, pulse i, at their
 * middle, in x of j->support samples; the first of them, and how many in *n. */
static long make_excess(
	const struct joint *j, int i, int c, double gap, double *x, size_t *n)
{
	const struct joint_scene *s = &j->scene;
	const struct joint_pulse *p = &j->pulse[i];
	const struct column *one = &j->col[i][c];
	double T = joint_pulse_duration(s, p, c), t0 = p->t + (c ? p->delta : 0);
	double half = 0.5 * joint_pulse_height(s, p, c), *part = j->scratch;
	long from = shape_support(s->shape, t0 - gap / 2, T, n), to;

	to = from + (long)*n + (long)gap + 1;
	from = from < one->first ? from : one->first;
	from = from < 0 ? 0 : from;
	to = to > (long)j->n ? (long)j->n : to;
	to = to - from > (long)j->support ? from + (long)j->support : to;
	*n = to > from ? (size_t)(to - from) : 0;
	shape_sample(s->shape, t0 - gap / 2, T, from, *n, x, NULL, NULL);
	shape_sample(s->shape, t0 + gap / 2, T, from, *n, part, NULL, NULL);
	for (size_t k = 0; k < *n; k++)
		x[k] = half * (x[k] + part[k]);
	for (size_t k = 0; k < one->n && one->first - from + (long)k < (long)*n; k++)
		x[one->first - from + (long)k] -= p->a * one->d[2][k];
	joint_hide(j, c, from, *n, x);
	return from;
}

void joint_pair_start(struct joint *j, int i, const int *set, int m)
{
	struct pair_table *t = &j->pair;
	double seen[PAIR_KNOTS][NPAR], along_basis[PAIR_KNOTS][BASIS_MAX];
	struct piece more[PAIR_KNOTS];

	_Static_assert(PAIR_KNOTS % 3 == 0, "three knots are reduced together");
	memset(t, 0, sizeof *t);
	for (int a = 0; a < PAIR_KNOTS; a++) {
		int c = a / PAIR_GAPS, k = a % PAIR_GAPS;
		double *x = j->excess + (size_t)a * j->support;
		struct piece *p = &more[a];

		*p = (struct piece){ .x = x, .along = along_basis[a] };
		if (k > 0)
			p->first = make_excess(
				j, i, c, knot(k) * j->scene.duration, x, &p->n);
		t->along[a] = dot(x, j->r[c] + p->first, p->n);
		joint_along(j, c, j->basis->vectors, p->first, x, p->n, along_basis[a]);
		for (int u = 0; u < PAR * m; u++)
			seen[a][u] = joint_inner(j,
				joint_column(j, set[u / PAR], u / PAR, u % PAR, c), *p);
		if (a % 3 == 2)
			joint_reduce(j, PAR * m, 0,
				(double *[]){ seen[a - 2], seen[a - 1], seen[a] });
	}
	for (int a = 0; a < PAIR_KNOTS; a++)
		for (int b = 0; b <= a; b++) {
			double shared = b / PAIR_GAPS == a / PAIR_GAPS
						? joint_inner(j, more[a], more[b])
						: 0;

			shared -= dot(seen[a], seen[b], (size_t)(PAR * m));
			t->gram[a][b] = t->gram[b][a] = shared;
		}
}

/* The gap, in durations, between two knots of the table: the first one, and the share of
 * the second in *part. */
static int find_knot(double gap, double *part)
{
	int k = 0;

	while (k + 2 < PAIR_GAPS && gap > knot(k + 1))
		k++;
	*part = fmin((gap - knot(k)) / (knot(k + 1) - knot(k)), 1);
	return k;
}

/* Logarithm of the likelihood ratio of two equal pulses, by their gaps in durations. */
static double pair_ratio(const struct joint *j, double gap1, double gap2)
{
	const struct pair_table *t = &j->pair;
	double part[2], weight[4], sum = 0;
	int at[4], k[2] = { find_knot(gap1, &part[0]), find_knot(gap2, &part[1]) };

	for (int i = 0; i < 4; i++) {
		int c = i / 2;

		at[i] = c * PAIR_GAPS + k[c] + i % 2;
		weight[i] = i % 2 ? part[c] : 1 - part[c];
	}
	for (int i = 0; i < 4; i++) {
		double row = 0;

		for (int l = 0; l < 4; l++)
			row += weight[l] * t->gram[at[i]][at[l]];
		sum += weight[i] * (t->along[at[i]] - 0.5 * row);
	}
	return sum;
}

double joint_pair_best(const struct joint *j, double *gap)
{
	const struct pair_table *t = &j->pair;
	double best = 0;

	for (int a = 1, b = PAIR_GAPS + 1; a < PAIR_GAPS; a++, b++) {
		double ratio = t->along[a] + t->along[b] -
			       0.5 * (t->gram[a][a] + t->gram[b][b]) - t->gram[a][b];

		if (ratio > best) {
			best = ratio;
			*gap = knot(a);
		}
	}
	return best;
}

void joint_pair_odds(struct joint *j, int i, double scatter, double odds[JOINT_SHARES])
{
	/* Steps of the difference of two delays, in standard deviations. */
	static const double step = 0.6;
	enum { STEPS = 4 };
	double density[2 * STEPS + 1];

	for (int d = -STEPS; d <= STEPS; d++)
		density[STEPS + d] = step * exp(-0.5 * pow(d * step, 2)) / sqrt(2 * M_PI);
	for (int w = 0; w < JOINT_SHARES; w++)
		odds[w] = 0;
	if (i >= j->inverted)
		return;
	joint_pair_start(j, i, j->all, j->inverted);
	for (int w = 0; w < JOINT_SHARES; w++) {
		double share = joint_share(w), narrow = 2 * sqrt(share * (1 - share));

		for (int k = 1 - PAIR_GAPS; k < PAIR_GAPS; k++) {
			double gap = k < 0 ? -knot(-k) : knot(k);
			double width = 0.5 * (knot(abs(k) + 1) - knot(abs(abs(k) - 1)));

			width = k ? width : knot(1);
			for (int d = -STEPS; d <= STEPS; d++) {
				double apart = d * step * scatter / j->scene.duration;
				double ratio = pair_ratio(j, narrow * fabs(gap),
					narrow * fabs(gap + apart));

				odds[w] +=
					density[STEPS + d] * width * exp(fmin(ratio, 50));
			}
		}
	}
}
