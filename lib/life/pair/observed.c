/* observed.c - see observed.h */
#include "life/pair/observed.h"
#include "life/grey/grey.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>

struct moment {
	double t, gap;
};

/* Regression of the values on z, the integral up to the middle of their intervals. */
struct sums {
	double scale, unit; /* of values and times: the first value, the first interval */
	double oldest, span, integral;
	struct regression fit;
};

struct observed {
	enum rate_rule rule;
	int begun;
	long n, points; /* observations, and those at times of their own */
	struct moment first, before, last;
	struct sums sums;
};

struct observed *observed_new(enum rate_rule rule)
{
	struct observed *o = calloc(1, sizeof *o);

	if (o)
		o->rule = rule;
	return o;
}

void observed_free(struct observed *o)
{
	free(o);
}

void observed_begin(struct observed *o, double t, double gap)
{
	o->first = o->before = o->last = (struct moment){ t, gap };
	o->begun = 1;
}

static void add_sums(struct observed *o, double dt, double value)
{
	struct sums *s = &o->sums;
	double gap, x;

	if (o->points++ == 0) {
		*s = (struct sums){ .scale = value != 0 ? fabs(value) : 1 };
		s->oldest = value / s->scale;
		return;
	}
	if (o->points == 2)
		s->unit = dt;
	gap = dt / s->unit;
	x = value / s->scale;
	regression_add(&s->fit, s->integral + x * gap / 2, x);
	s->integral += x * gap;
	s->span += gap;
}

void observed_add(struct observed *o, double t, double value, double gap)
{
	double dt;

	if (!o->begun)
		observed_begin(o, t, gap);
	dt = t - o->last.t;
	if (dt > 0)
		o->before = o->last;
	o->last = (struct moment){ t, gap };
	if (o->points == 0 || dt > 0)
		add_sums(o, dt, value);
	o->n++;
}

long observed_count(const struct observed *o)
{
	return o->n;
}

double observed_first(const struct observed *o)
{
	return o->first.t;
}

double observed_time(const struct observed *o)
{
	return o->last.t;
}

double observed_gap(const struct observed *o)
{
	return o->begun ? o->last.gap : NAN;
}

double observed_rate(const struct observed *o)
{
	const struct moment *from = o->rule == RATE_LAST ? &o->before : &o->first;

	if (!(o->last.t > from->t))
		return NAN;
	return (o->last.gap - from->gap) / (o->last.t - from->t);
}

double observed_grey(const struct observed *o, double threshold)
{
	const struct sums *s = &o->sums;
	struct grey g = { .n = (int)fmin((double)o->points, INT_MAX),
		.oldest = s->oldest,
		.span = s->span,
		.tail = s->integral,
		.fit = { s->fit.n, s->integral - s->fit.mean_x, s->fit.mean_y, s->fit.xx,
			-s->fit.xy, s->fit.yy } };
	double now, rate;

	if (o->points < GREY_ORDER_MIN)
		return NAN;
	now = grey_forecast(&g, 0, s->span / (double)(o->points - 1));
	rate = -grey_rate(&g);
	if (now >= threshold / s->scale)
		return 0;
	if (!(now > 0 && rate > 0))
		return INFINITY;
	return log(threshold / s->scale / now) / rate * s->unit;
}
