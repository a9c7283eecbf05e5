/* observed.c - see observed.h */
#include "life/pair/observed.h"
#include <math.h>

void observed_begin(struct observed *o, double t, double gap)
{
	o->first = o->before = o->last = (struct moment){ t, gap };
	o->begun = 1;
}

static void add_sums(struct observed *o, double dt, double value)
{
	if (o->grey.n == 0)
		o->scale = value != 0 ? fabs(value) : 1;
	if (o->grey.n <= 1)
		o->unit = dt > 0 ? dt : 1;
	grey_append(&o->grey, value / o->scale, dt / o->unit);
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
	if (o->grey.n == 0 || dt > 0)
		add_sums(o, dt, value);
	o->n++;
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
	struct grey g = grey_of(&o->grey);
	double now, rate;

	if (g.n < GREY_ORDER_MIN)
		return NAN;
	now = grey_forecast(&g, 0, g.span / (g.n - 1));
	rate = -grey_rate(&g);
	if (now >= threshold / o->scale)
		return 0;
	if (!(now > 0 && rate > 0))
		return INFINITY;
	return log(threshold / o->scale / now) / rate * o->unit;
}
