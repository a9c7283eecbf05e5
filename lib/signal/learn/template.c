/* template.c - see template.h */
#include "num/dot.h"
#include "num/select.h"
#include "num/sigmas.h"
#include "num/wiener.h"
#include "signal/learn/template_state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points of a duration on the coarse grid where events are compared. */
enum { COARSE = 32 };

/* Durations on either side of an event that are examined. */
static const double SIDE = 2;

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
	const size_t q = (size_t)s->q;

	for (int c = 0; c < 2; c++)
		if (s->hidden[c] && memchr(s->hidden[c] + from * q, 1, (to - from) * q))
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
			v += value_between(s->p, 2 * (size_t)s->half + 1,
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
				sum += share * t->a[i] *
				       value_between(x1, n, t->t1[i] + k + q);
		}
		peak = fmax(peak, fabs(sum) / weight);
	}
	return peak;
}
