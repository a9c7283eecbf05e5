/* template.c - see template.h */
#include "signal/learn/template.h"
#include "num/dot.h"
#include "num/parabola.h"
#include "num/select.h"
#include "num/sigmas.h"
#include "num/wiener.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points of a duration on the coarse grid where events are compared. */
enum { COARSE = 32, ROUNDS = 4 };

/* Durations on either side of an event that are examined. */
static const double SIDE = 2;

/* Share of its energy in which an event may differ from another of the same kind, because
 * of its velocity and the coarse grid. */
static const double ALIKE = 0.02;

/* Share of their energy that variations of the width of single pulses may take: a tenth
 * of what those of pairs take.  With distances of pairs uniform up to that at which the
 * change takes ALIKE, it varies with the square of the distance, whose variance is a
 * fifth of its greatest deviation squared.  In 193 records of random instruments single
 * pulses in drift, lines or clipped take up to 3e-4, groups 4e-4 to 5e-3. */
static const double SAME_WIDTH = 4e-4;

/* Power of an event, over that of the noise, from which on it is not alike because of its
 * noise.  With 1 a drifting baseline is taken for a pulse in a group of turbulent flow, 6
 * gives the same rows (nine records that differ in shape, noise and rate). */
static const double CLEAR = 3;

struct event {
	double centre, energy, length;
	double t[2], a[2]; /* arrival and amplitude, by channel */
	double merit;      /* large for the clearest */
	int like;          /* 1: of the kind that is averaged */
};

struct search {
	const double *y[2];
	const unsigned char *hidden[2]; /* flags of samples that are not known, or NULL */
	size_t n;
	double T, transit, reach, width;
	int q;             /* samples per point of the coarse grid */
	double *z[2];      /* coarse records, noise 1 */
	size_t points;     /* of them */
	int half;          /* of the template, samples */
	double *p;         /* 2 half + 1: the template */
	double *wide;      /* the same as sensor 2 has it, width times as long */
	double *coarse[2]; /* either on the coarse grid */
	int coarse_half;
	double scatter; /* standard error of a point of the template */
	struct event event[TEMPLATE_EVENTS];
	int count;
};

static void coarsen(const double *x, size_t n, int q, double *out)
{
	for (size_t i = 0; i < n / (size_t)q; i++) {
		double sum = 0;

		for (int k = 0; k < q; k++)
			sum += x[i * (size_t)q + (size_t)k];
		out[i] = sum / sqrt(q);
	}
}

/* 1 if all samples of [from, to) of the coarse grid are known. */
static int is_known(const struct search *s, size_t from, size_t to)
{
	for (int c = 0; c < 2; c++)
		for (size_t i = from * (size_t)s->q;
			s->hidden[c] && i < to * (size_t)s->q; i++)
			if (s->hidden[c][i])
				return 0;
	return 1;
}

/* Stores the event at [from, to) of the coarse grid if it is among the clearest, that is,
 * large and short. */
static void offer(struct search *s, size_t from, size_t to)
{
	double energy = 0, moment = 0;
	double margin = SIDE * s->T + s->reach + s->T;
	struct event e = { 0 };
	int at;

	for (size_t i = from; i < to; i++) {
		double v = s->z[0][i] * s->z[0][i] + s->z[1][i] * s->z[1][i] - 2;

		energy += v;
		moment += v * (double)i;
	}
	if (!(energy > 0) || !is_known(s, from, to))
		return;
	e.centre = (moment / energy + 0.5) * s->q;
	e.energy = energy;
	e.length = (double)(to - from);
	e.merit = energy * pow(e.length, -4);
	if (e.centre < margin || e.centre + margin > (double)s->n)
		return;
	for (at = s->count; at > 0 && s->event[at - 1].merit < e.merit; at--)
		if (at < TEMPLATE_EVENTS)
			s->event[at] = s->event[at - 1];
	if (at == TEMPLATE_EVENTS)
		return;
	s->event[at] = e;
	s->count += s->count < TEMPLATE_EVENTS;
}

/* Share of the power of an event at its loudest below which it has ended: behind a
 * high-pass the tail of a loud pulse stays above the noise until the next one.  In eight
 * records of pulses behind one at 25 to 40 dB, 0.001, 0.003 and 0.01 find 170, 180 and
 * 180 of 320 particles, with 2, 8 and 8 wrong rows, and 44 with 4 where only the noise
 * ends an event. */
static const double FADED = 0.001;

/* Power of the points of the coarse grid from from to before from + width. */
static double power_from(const struct search *s, size_t from, size_t width)
{
	return dot(s->z[0] + from, s->z[0] + from, width) +
	       dot(s->z[1] + from, s->z[1] + from, width);
}

/* Offers what is around the loudest part of [begin, end) if it is not much longer than a
 * pulse: up to where it has faded for as long as pulses are compared, so that no other
 * one is beside it there. */
static void offer_loudest(struct search *s, size_t begin, size_t end, size_t width)
{
	size_t longest = (size_t)(5 * s->T / s->q), side = (size_t)s->coarse_half;
	size_t loudest = begin, first, last;
	double most = 0;

	for (size_t i = begin; i + width <= end; i++)
		if (power_from(s, i, width) > most) {
			most = power_from(s, i, width);
			loudest = i;
		}
	first = last = loudest;
	for (size_t i = loudest; i + width < end && i <= last + side; i++)
		if (power_from(s, i + 1, width) > FADED * most)
			last = i + 1;
	for (size_t i = loudest; i > begin && i + side >= first; i--)
		if (power_from(s, i - 1, width) > FADED * most)
			first = i - 1;
	if (last + width - first < longest)
		offer(s, first, last + width);
}

/* Finds the intervals whose power within a duration exceeds the noise by eight standard
 * deviations. */
static void find_events(struct search *s)
{
	size_t width = (size_t)fmax(floor(s->T / s->q), 4), begin = 0, end = 0;
	double limit = 2 * (double)width + 8 * sqrt(4 * (double)width), sum = 0;

	for (size_t i = 0; i < s->points; i++) {
		sum += s->z[0][i] * s->z[0][i] + s->z[1][i] * s->z[1][i];
		if (i >= width)
			sum -= s->z[0][i - width] * s->z[0][i - width] +
			       s->z[1][i - width] * s->z[1][i - width];
		if (i < width || sum < limit)
			continue;
		if (end + width / 2 < i) { /* another one begins */
			if (end > begin)
				offer_loudest(s, begin, end, width);
			begin = i - width;
		}
		end = i + 1;
	}
	if (end > begin)
		offer_loudest(s, begin, end, width);
}

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

static int is_clear(const struct event *e)
{
	return e->energy > CLEAR * 2 * e->length;
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

/* x at t, by the cubic through the four samples around it. */
static double between(const double *x, size_t n, double t)
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
			double r = between(s->y[c], s->n, e->t[c] + k * stretch) - model;

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
					e->a[c] *
					between(s->y[c], s->n, e->t[c] + k * stretch);
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
		s->wide[k + s->half] = between(s->p, n, s->half + k / s->width);
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
		s->p[k + s->half] = between(s->y[0], s->n, at + k * stretch);
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
			double share = dot(b, x, n);

			for (size_t j = 0; j < n; j++)
				x[j] -= share * b[j];
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
				r[k + s->half] =
					between(s->y[c], s->n, e->t[c] + k * stretch);
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

/* Samples from the middle of the template beyond which it is noise. */
static int template_reach(const struct search *s)
{
	int width = (int)(s->T / 8) + 1, reach = s->half;

	for (; reach > width; reach--) {
		double left = 0, right = 0;

		for (int k = 0; k < width; k++) {
			left += s->p[s->half - reach + k];
			right += s->p[s->half + reach - k];
		}
		if (fmax(fabs(left), fabs(right)) >
			SIGMAS_RARELY * s->scatter * sqrt(width))
			break;
	}
	return reach;
}

/* Most similar pulse of sensor.h at one duration: its shift and the share of energy it
 * leaves. */
static double try_match(const struct search *s, int reach, const struct shape *shape,
	double T, double *work, double *shift, int *reversed)
{
	double own = dot(
		s->p + s->half - reach, s->p + s->half - reach, 2 * (size_t)reach + 1);
	double best = 0, step = T / 64;

	for (double at = -0.75 * T; at <= 0.75 * T; at += step) {
		double value;
		size_t n = 2 * (size_t)reach + 1;

		shape_sample(shape, at, T, -reach, n, work, NULL, NULL);
		value = dot(work, s->p + s->half - reach, n) /
			sqrt(own * shape_energy(shape) * T);
		if (fabs(value) > fabs(best)) {
			best = value;
			*shift = at;
		}
	}
	*reversed = best < 0;
	return 1 - best * best;
}

static enum num_status match(
	const struct search *s, int reach, struct template *t, double *shift)
{
	double *work = malloc((2 * (size_t)reach + 1) * sizeof *work);

	t->left = 2;
	for (int pulse = 0; work && pulse < PULSE_SHAPES; pulse++) {
		struct shape *shape = shape_new((enum pulse_shape)pulse);

		if (!shape) {
			free(work);
			return NUM_MEMORY;
		}
		for (double T = 0.4 * s->T; T < 2.5 * s->T; T *= 1.02) {
			double at = 0, left;
			int reversed;

			left = try_match(s, reach, shape, T, work, &at, &reversed);
			if (left < t->left) {
				t->left = left;
				t->pulse = pulse;
				t->duration = T;
				t->reversed = reversed;
				*shift = at;
			}
		}
		shape_free(shape);
	}
	free(work);
	return work ? NUM_OK : NUM_MEMORY;
}

/* The template around its arrival, as a shape of duration 1, ends tapered. */
static enum num_status make_shape(
	const struct search *s, int reach, double shift, struct template *t)
{
	int half = reach + (int)ceil(fabs(shift)), soft = (int)(s->T / 8) + 1;
	int blur = (int)(s->T / 40);
	double *value = calloc(2 * (size_t)half + 1, sizeof *value);

	for (int k = -half; value && k <= half; k++) {
		double v = 0, edge;

		for (int i = -blur; i <= blur; i++)
			v += between(s->p, 2 * (size_t)s->half + 1,
				     k + i + shift + s->half) *
			     (1 + cos(M_PI * i / (blur + 1))) / (2 * blur + 2);
		edge = fmin(1, (reach - fabs(k + shift)) / soft);
		value[k + half] = edge > 0 ? v * (0.5 - 0.5 * cos(M_PI * edge)) : 0;
	}
	if (value)
		t->shape = shape_from_values(value, half, half / t->duration);
	free(value);
	return t->shape ? NUM_OK : NUM_MEMORY;
}

/* Arrivals and amplitudes of the clear events for the shape: one that is not clear may be
 * no pulse, and its delay any that is searched. */
static void take_events(const struct search *s, double shift, struct template *t)
{
	double peak = 0, delay[TEMPLATE_EVENTS], least = 0, most = 0;

	for (int k = 0; k <= 2 * s->half; k++)
		peak = fmax(peak, fabs(s->p[k]));
	for (int i = 0; i < s->count; i++) {
		const struct event *e = &s->event[i];

		if (!e->like || !is_clear(e))
			continue;
		t->t1[t->events] = e->t[0] + shift;
		t->t2[t->events] = e->t[1] + shift;
		t->a[t->events] = e->a[0] * peak;
		least = fmin(least, e->a[0]);
		most = fmax(most, e->a[0]);
		delay[t->events++] = e->t[1] - e->t[0];
	}
	t->signs = least < 0 && most > 0;
	sort_numbers(delay, (size_t)t->events);
	t->duration /= 1 + sorted_quantile(delay, (size_t)t->events, 0.5) / s->transit;
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

/* Takes the template from one clear event, in the order of merit, by both channels; 0 if
 * there are not so many. */
static int take_single(struct search *s, int number)
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

/* *one: 1 if events were found that are alike. */
static enum num_status take_common(struct search *s, int white, int *one)
{
	int best;

	*one = 0;
	if (s->count < TEMPLATE_LEAST || (best = most_common(s)) < 0 || !refine(s, best))
		return NUM_OK;
	return make_one_width(s, white, one);
}

static enum num_status search_template(struct search *s, int single, struct template *t)
{
	double shift = 0;
	int reach, positive = 0, one;

	find_events(s);
	if (single >= 0)
		one = take_single(s, single);
	else if (take_common(s, t->white, &one) != NUM_OK)
		return NUM_MEMORY;
	if (!one)
		return NUM_OK;
	for (int i = 0; i < s->count; i++)
		positive += s->event[i].like ? (s->event[i].a[0] > 0 ? 1 : -1) : 0;
	if (positive < 0) {
		for (int k = 0; k <= 2 * s->half; k++)
			s->p[k] = -s->p[k];
		for (int i = 0; i < s->count; i++)
			for (int c = 0; c < 2; c++)
				s->event[i].a[c] = -s->event[i].a[c];
	}
	if (wiener_filter(s->p, 2 * (size_t)s->half + 1, s->scatter * s->scatter, s->T) !=
		NUM_OK)
		return NUM_MEMORY;
	reach = template_reach(s);
	if (match(s, reach, t, &shift) != NUM_OK ||
		make_shape(s, reach, shift, t) != NUM_OK)
		return NUM_MEMORY;
	take_events(s, shift, t);
	if (t->duration < SHAPE_SHORTEST) {
		template_clear(t);
		t->events = 0;
	}
	return NUM_OK;
}

enum num_status template_find(struct template *t, const double *y1, const double *y2,
	const unsigned char *const hidden[2], size_t n, double duration, double transit,
	double width, double reach, int single)
{
	struct search s = { .y = { y1, y2 },
		.hidden = { hidden[0], hidden[1] },
		.n = n,
		.T = duration,
		.transit = transit,
		.width = width,
		.reach = reach,
		.q = duration > 2 * COARSE ? (int)(duration / COARSE) : 1 };
	size_t length;
	enum num_status status;

	*t = (struct template){ .alone = t->alone, .white = t->white };
	s.half = (int)(SIDE * duration);
	s.coarse_half = s.half / s.q;
	s.points = n / (size_t)s.q;
	length = 2 * (size_t)s.half + 1;
	if ((double)n < 20 * duration)
		return NUM_OK;
	s.z[0] = malloc((2 * s.points + 4 * length) * sizeof *s.z[0]);
	if (!s.z[0])
		return NUM_MEMORY;
	s.z[1] = s.z[0] + s.points;
	s.p = s.z[1] + s.points;
	s.wide = s.p + length;
	s.coarse[0] = s.wide + length;
	s.coarse[1] = s.coarse[0] + length;
	for (int c = 0; c < 2; c++)
		coarsen(s.y[c], n, s.q, s.z[c]);
	status = search_template(&s, single, t);
	free(s.z[0]);
	return status;
}

void template_clear(struct template *t)
{
	shape_free(t->shape);
	t->shape = NULL;
}

enum num_status template_known(
	const struct template *t, const double *tap, int half, double *left)
{
	int reach = (int)ceil(shape_reach(t->shape) * t->duration);
	size_t n = 2 * (size_t)reach + 1;
	double *p = malloc(2 * n * sizeof *p);
	struct search s = { .half = reach, .p = p };
	enum num_status status = p ? NUM_OK : NUM_MEMORY;

	*left = 2;
	if (p)
		shape_sample(t->shape, 0, t->duration, -reach, n, p, NULL, NULL);
	for (int k = 0; status == NUM_OK && k < PULSE_SHAPES; k++) {
		struct shape *plain = shape_new((enum pulse_shape)k);

		for (double T = 0.7 * t->duration; plain && T < 1.4 * t->duration;
			T *= 1.03) {
			struct shape *seen = shape_filter(plain, T, tap, half);
			double shift, rest;
			int reversed;

			if (!seen)
				break;
			rest = try_match(&s, reach, seen, T, p + n, &shift, &reversed);
			if (!reversed)
				*left = fmin(*left, rest);
			shape_free(seen);
		}
		if (!plain)
			status = NUM_MEMORY;
		shape_free(plain);
	}
	free(p);
	return status;
}

double template_peak(const struct template *t, const double *x1, size_t n)
{
	double peak = 0, weight = 0;
	int half = (int)(SIDE * t->duration), m = (int)(t->duration / 16) + 1;

	for (int i = 0; i < t->events; i++)
		weight += t->a[i] * t->a[i];
	/* Values of a parabola through 2 m + 1 points; the largest value would be too
	 * high because of noise. */
	for (int k = -half; k <= half; k++) {
		double sum = 0;

		for (int q = -m; q <= m; q++) {
			double share = 3.0 * (3 * m * m + 3 * m - 1 - 5 * q * q) /
				       ((2.0 * m - 1) * (2 * m + 1) * (2 * m + 3));

			for (int i = 0; i < t->events; i++)
				sum += share * t->a[i] * between(x1, n, t->t1[i] + k + q);
		}
		peak = fmax(peak, fabs(sum) / weight);
	}
	return peak;
}
