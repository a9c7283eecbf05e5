/* template_alike.c - the events that are alike, and their mean, see template_state.h */
#include "num/dot.h"
#include "num/parabola.h"
#include "num/sigmas.h"
#include "signal/learn/template_state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 4 }; /* of averaging */

/* Share of its energy in which an event may differ from another of the same kind, because
 * of its velocity and the coarse grid. */
static const double ALIKE = 0.02;

/* Share of their energy that variations of the width of single pulses may take: a tenth
 * of what those of pairs take.  With distances of pairs uniform up to that at which the
 * change takes ALIKE, it varies with the square of the distance, whose variance is a
 * fifth of its greatest deviation squared.  In 193 records of random instruments single
 * pulses in drift, lines or clipped take up to 3e-4, groups 4e-4 to 5e-3. */
static const double SAME_WIDTH = 4e-4;

/* Lag of x, 2 half + 1 points around at, within +-range, at which it is most similar to p
 * except for its sign; *value: the product. */
static long best_lag(const double *p, int half, const double *x, size_t n, long at,
	long range, double *value)
{
	long best = 0;

	*value = 0;
	for (long lag = -range; lag <= range; lag++) {
		long first = at + lag - half;
		double v;

		if (first < 0 || first + 2 * half + 1 > (long)n)
			continue;
		v = dot(p, x + first, 2 * (size_t)half + 1);
		if (fabs(v) > fabs(*value)) {
			*value = v;
			best = lag;
		}
	}
	return best;
}

/* The clear event that most others equal, by channel 1 on the coarse grid; -1 if too few
 * do.  Others that are not clear may be like it or not. */
static int most_common(struct search *s)
{
	size_t length = 2 * (size_t)s->coarse_half + 1;
	long range = (long)(s->T / s->q);
	int best = -1, most = 0;

	for (int i = 0; i < s->count; i++) {
		long at = (long)(s->event[i].centre / s->q);
		const double *x = s->z[0] + at - s->coarse_half;
		double own = dot(x, x, length);
		int like = 0;

		if (!is_clear(&s->event[i]))
			continue;
		for (int k = 0; k < s->count; k++) {
			long to = (long)(s->event[k].centre / s->q), lag;
			double value, other, left;

			lag = best_lag(
				x, s->coarse_half, s->z[0], s->points, to, range, &value);
			other = dot(s->z[0] + to + lag - s->coarse_half,
				s->z[0] + to + lag - s->coarse_half, length);
			left = 1 - value * value / (own * other);
			like += left <
				ALIKE + 1.5 * (double)length * (1 / own + 1 / other);
		}
		if (like > most) {
			most = like;
			best = i;
		}
	}
	return most >= TEMPLATE_LEAST ? best : -1;
}

double value_between(const double *x, size_t n, double t)
{
	double u = t - floor(t), a, b, c, d;
	long k = (long)floor(t);

	if (k < 1 || k + 2 >= (long)n)
		return 0;
	a = x[k - 1];
	b = x[k];
	c = x[k + 1];
	d = x[k + 2];
	return b +
	       u * (c - a / 3 - b / 2 - d / 6 +
			   u * (0.5 * (a + c) - b + u * ((d - a) / 6 + 0.5 * (b - c))));
}

/* By how much an event is longer on a channel than the template. */
static double stretch_of(const struct search *s, const struct event *e, int channel)
{
	return (1 + (e->t[1] - e->t[0]) / s->transit) * (channel ? s->width : 1);
}

/* Arrival and amplitude of an event on one channel by the template, near at. */
static void measure_event(
	const struct search *s, struct event *e, int channel, double at, double range)
{
	const double *y = s->y[channel], *p = channel ? s->wide : s->p;
	size_t n = 2 * (size_t)s->half + 1;
	double v[3], move;
	long middle = (long)(at / s->q + 0.5), lag, near;

	lag = best_lag(s->coarse[channel], s->coarse_half, s->z[channel], s->points,
		middle, (long)(range / s->q) + 1, &v[0]);
	near = (middle + lag) * s->q + s->q / 2;
	near += best_lag(p, s->half, y, s->n, near, s->q + 1, &v[1]);
	if (near - s->half < 1 || near + s->half + 2 > (long)s->n) {
		e->a[channel] = 0;
		return;
	}
	v[0] = dot(p, y + near - 1 - s->half, n);
	v[2] = dot(p, y + near + 1 - s->half, n);
	move = v[1] > 0 ? parabola_top(v[0], v[1], v[2])
			: parabola_top(-v[0], -v[1], -v[2]);
	if (fabs(move) > 1)
		move = 0;
	e->t[channel] = (double)near + move;
	e->a[channel] = (v[1] - 0.25 * (v[0] - v[2]) * move) / dot(p, p, n);
}

/* Residual power of an event after the template and a straight line, relative to that of
 * noise. */
static double left_over(const struct search *s, const struct event *e)
{
	double sum = 0, energy = 0;

	for (int c = 0; c < 2; c++) {
		double stretch = stretch_of(s, e, c);
		double mean = 0, slope = 0, n = 2 * s->half + 1;

		for (int k = -s->half; k <= s->half; k++) {
			double model = e->a[c] * s->p[k + s->half];
			double r = value_between(s->y[c], s->n, e->t[c] + k * stretch) -
				   model;

			sum += r * r;
			mean += r;
			slope += k * r;
			energy += model * model;
		}
		sum -= mean * mean / n + slope * slope / (n * (n * n - 1) / 12);
	}
	return (sum - ALIKE * energy) / (2 * (2 * s->half + 1));
}

/* Averages the events that are alike, each in its own units. */
static void average(struct search *s)
{
	double weight = 0;

	memset(s->p, 0, (2 * (size_t)s->half + 1) * sizeof *s->p);
	for (int i = 0; i < s->count; i++) {
		const struct event *e = &s->event[i];

		if (!e->like)
			continue;
		for (int c = 0; c < 2; c++) {
			double stretch = stretch_of(s, e, c);

			weight += e->a[c] * e->a[c];
			for (int k = -s->half; k <= s->half; k++)
				s->p[k + s->half] +=
					e->a[c] * value_between(s->y[c], s->n,
							  e->t[c] + k * stretch);
		}
	}
	for (int k = 0; k <= 2 * s->half; k++)
		s->p[k] /= weight;
	s->scatter = 1 / sqrt(weight);
}

/* Computes the template of sensor 2, and the coarse ones: the fine ones at the centres
 * of the coarse points. */
static void spread_template(struct search *s)
{
	size_t n = 2 * (size_t)s->half + 1;

	memcpy(s->wide, s->p, n * sizeof *s->wide);
	for (int k = -s->half; k <= s->half && s->width != 1; k++)
		s->wide[k + s->half] = value_between(s->p, n, s->half + k / s->width);
	for (int c = 0; c < 2; c++)
		for (int k = -s->coarse_half; k <= s->coarse_half; k++) {
			const double *p = c ? s->wide : s->p;
			double sum = 0;

			for (int i = 0; i < s->q; i++) {
				int at = k * s->q + i - s->q / 2 + s->half;

				if (at >= 0 && at <= 2 * s->half)
					sum += p[at];
			}
			s->coarse[c][k + s->coarse_half] = sum / sqrt(s->q);
		}
}

/* Takes the template from one event, in its own units. */
static void take_first(struct search *s, struct event *e)
{
	double at = floor(e->centre), stretch = 1;

	for (int k = -s->half; k <= s->half; k++)
		s->p[k + s->half] = s->y[0][(long)at + k];
	spread_template(s);
	measure_event(s, e, 0, at, s->T);
	measure_event(s, e, 1, e->t[0], s->reach);
	stretch += (e->t[1] - e->t[0]) / s->transit;
	for (int k = -s->half; k <= s->half; k++)
		s->p[k + s->half] = value_between(s->y[0], s->n, at + k * stretch);
}

/* How many clear events are alike, and how many are as short as they: pulses stand alone
 * where events are shortest. */
static int count_clear(const struct search *s, int *as_short)
{
	int clear = 0;
	double longest = 0;

	for (int i = 0; i < s->count; i++)
		if (s->event[i].like) {
			clear += is_clear(&s->event[i]);
			longest = fmax(longest, s->event[i].length);
		}
	*as_short = 0;
	for (int i = 0; i < s->count; i++)
		*as_short += is_clear(&s->event[i]) && s->event[i].length <= longest;
	return clear;
}

/* Averages the events that equal the one given, then those that equal their mean, a few
 * times; 0 if few are clear, or most events as short as they differ from them. */
static int refine(struct search *s, int best)
{
	int clear, as_short;

	take_first(s, &s->event[best]);
	for (int round = 0; round < ROUNDS; round++) {
		spread_template(s);
		for (int i = 0; i < s->count; i++) {
			struct event *e = &s->event[i];

			measure_event(
				s, e, 0, round ? e->t[0] : e->centre, round ? 0 : s->T);
			measure_event(
				s, e, 1, round ? e->t[1] : e->t[0], round ? 0 : s->reach);
			/* A first template has the noise of one event. */
			e->like = e->a[0] * e->a[1] > 0 &&
				  left_over(s, e) <
					  (round ? 1 : 1 + e->a[0] * e->a[0]) +
						  SIGMAS_NEVER / sqrt(2 * s->half + 1);
		}
		clear = count_clear(s, &as_short);
		if (clear < TEMPLATE_LEAST || 2 * clear < as_short)
			return 0;
		average(s);
	}
	return 1;
}

/* Subtracts from d its components along the rows of base, each of which is made
 * orthonormal to the rows before it. */
static void orthogonalise(double *base, int rows, double *d, size_t n)
{
	for (int i = 0; i <= rows; i++) {
		double *x = i < rows ? base + (size_t)i * n : d, square;

		for (int k = 0; k < i; k++) {
			const double *b = base + (size_t)k * n;

			add_scaled(x, -dot(b, x, n), b, n);
		}
		square = dot(x, x, n);
		for (size_t j = 0; square > 0 && j < n; j++)
			x[j] /= sqrt(square);
	}
}

/* *one: 1 if the events have one width; else drops those whose width differs from that of
 * the others, and counts them.  Noise makes it differ and, if its level is that in the
 * band of pulses, whatever takes a small share of their energy.  Pairs of nearly
 * coincident pulses differ, since their distances do.  Noise that is not white is not
 * told from them: it has to be whitened.  The residual of each event is projected on the
 * change of the template with its width, orthogonal to offset, slope, amplitude and
 * arrival. */
static enum num_status check_widths(struct search *s, int white, int *one, int *dropped)
{
	enum { BASE = 4 };
	size_t n = 2 * (size_t)s->half + 1;
	double *work = malloc((BASE + 2) * n * sizeof *work);
	double *d, *r, share, sum = 0, more = 0, off[TEMPLATE_EVENTS];
	int count = 0;

	*dropped = 0;
	if (!work)
		return NUM_MEMORY;
	d = work + BASE * n;
	r = d + n;
	for (int k = -s->half; k <= s->half; k++) {
		size_t i = (size_t)(k + s->half);
		double slope = i > 0 && i + 1 < n ? 0.5 * (s->p[i + 1] - s->p[i - 1]) : 0;

		work[i] = 1;
		work[n + i] = k;
		work[2 * n + i] = s->p[i];
		work[3 * n + i] = slope;
		d[i] = k * slope;
	}
	share = white ? SAME_WIDTH * dot(s->p, s->p, n) : 0;
	orthogonalise(work, BASE, d, n);
	for (int i = 0; i < s->count; i++) {
		const struct event *e = &s->event[i];
		double z = 0, a2 = 0;

		if (!e->like)
			continue;
		for (int c = 0; c < 2; c++) {
			double stretch = stretch_of(s, e, c);

			for (int k = -s->half; k <= s->half; k++)
				r[k + s->half] = value_between(
					s->y[c], s->n, e->t[c] + k * stretch);
			z += e->a[c] * dot(r, d, n);
			a2 += e->a[c] * e->a[c];
		}
		off[i] = z * z / a2 - SIGMAS_NEVER * SIGMAS_NEVER - share * a2;
		more += share * a2;
		sum += z * z / a2;
		count++;
	}
	*one = sum < count + SIGMAS_NEVER * sqrt(2.0 * count) + more;
	for (int i = 0; i < s->count && white && !*one; i++)
		if (s->event[i].like && off[i] > 0) {
			s->event[i].like = 0;
			++*dropped;
		}
	free(work);
	return NUM_OK;
}

/* Clear events that have to be alike for each one that was dropped.  Where there are
 * fewer, those left may hold pairs, too: with two dropped beside four, 6 of 35 rows of a
 * group of Gaussian pulses are wrong; with one beside five and two beside seven none are.
 */
enum { MIXED = 3 };

/* Drops events of another width.  *found: 1 if those left have one width.  If any were
 * dropped, all others as short have to be alike: where no pulse stands alone, pairs of
 * nearly one distance may be. */
static enum num_status make_one_width(struct search *s, int white, int *found)
{
	int dropped, others = 0, as_short, clear;

	do {
		if (check_widths(s, white, found, &dropped) != NUM_OK)
			return NUM_MEMORY;
		others += dropped;
		clear = count_clear(s, &as_short);
		if (others > 0 && (clear < TEMPLATE_LEAST || clear < MIXED * others ||
					  clear + others < as_short)) {
			*found = 0;
			return NUM_OK;
		}
		if (dropped > 0)
			average(s);
	} while (dropped > 0);
	return NUM_OK;
}

int take_single(struct search *s, int number)
{
	struct event *e = s->event;

	for (; e < s->event + s->count; e++)
		if (is_clear(e) && number-- == 0)
			break;
	if (e == s->event + s->count)
		return 0;
	take_first(s, e);
	if (!(e->a[0] * e->a[1] > 0))
		return 0;
	e->like = 1;
	average(s);
	spread_template(s);
	for (int c = 0; c < 2; c++)
		measure_event(s, e, c, e->t[c], 0);
	average(s);
	return 1;
}

enum num_status take_common(struct search *s, int white, int *one)
{
	int best;

	*one = 0;
	if (s->count < TEMPLATE_LEAST || (best = most_common(s)) < 0 || !refine(s, best))
		return NUM_OK;
	return make_one_width(s, white, one);
}
