/* observed.c - see observed.h */
#include "life/observed.h"
#include "life/grey.h"
#include <math.h>
#include <stdlib.h>

struct moment {
	double t, gap;
};

struct observed {
	enum rate_rule rule;
	int keep, begun;
	long n;
	struct moment first, before, last;
	double *value, *time; /* n of each */
	long room;
};

struct observed *observed_new(enum rate_rule rule, int keep)
{
	struct observed *o = calloc(1, sizeof *o);

	if (o) {
		o->rule = rule;
		o->keep = keep;
	}
	return o;
}

void observed_free(struct observed *o)
{
	if (!o)
		return;
	free(o->value);
	free(o->time);
	free(o);
}

void observed_begin(struct observed *o, double t, double gap)
{
	o->first = o->before = o->last = (struct moment){ t, gap };
	o->begun = 1;
}

static int store(struct observed *o, double t, double value)
{
	if (o->n > o->room) {
		long room = 2 * o->n + 64;
		double *more = realloc(o->value, (size_t)room * sizeof *more);

		if (!more)
			return 0;
		o->value = more;
		more = realloc(o->time, (size_t)room * sizeof *more);
		if (!more)
			return 0;
		o->time = more;
		o->room = room;
	}
	o->value[o->n - 1] = value;
	o->time[o->n - 1] = t;
	return 1;
}

int observed_add(struct observed *o, double t, double value, double gap)
{
	if (!o->begun)
		observed_begin(o, t, gap);
	if (t > o->last.t)
		o->before = o->last;
	o->last = (struct moment){ t, gap };
	o->n++;
	return o->keep ? store(o, t, value) : 1;
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
	return o->last.gap;
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
	struct grey g = { 0 };
	double spacing, now, rate;

	if (o->n < GREY_ORDER_MIN)
		return NAN;
	spacing = (o->time[o->n - 1] - o->time[0]) / (double)(o->n - 1);
	for (long i = o->n; i-- > 0;)
		grey_add(&g, o->value[i],
			i + 1 < o->n ? (o->time[i + 1] - o->time[i]) / spacing : 1);
	now = grey_forecast(&g, 0, 1);
	rate = -grey_rate(&g);
	if (now >= threshold)
		return 0;
	return now > 0 && rate > 0 ? log(threshold / now) / rate * spacing : INFINITY;
}
