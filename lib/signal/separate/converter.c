/* converter.c - see converter.h */
#include "signal/separate/converter.h"
#include <math.h>

/* A limit must have been seen OFTEN times, and TIMES as often as the next value: in a
 * parabola quantised to a few steps, the top occurs 1 / (sqrt 2 - 1) = 2.4 times as often
 * as the step below it. */
static const double OFTEN = 8, TIMES = 4;

/* Probability below which a run of equal values was not measured. */
static const double RARELY = 1e-9;

static void see(struct converter_limit *l, double x)
{
	if (l->times == 0 || x > l->value) {
		l->next = l->value;
		l->next_times = l->times;
		l->value = x;
		l->times = 1;
	} else if (x == l->value) {
		l->times++;
	} else if (l->next_times == 0 || x > l->next) {
		l->next = x;
		l->next_times = 1;
	} else if (x == l->next) {
		l->next_times++;
	}
}

/* Components are turned back with an error of a few units in the last place. */
static const double ROUNDING = 1e-14;

static int is_at(const struct converter_limit *l, double x)
{
	return fabs(x - l->value) <= ROUNDING * fabs(l->value) && l->times >= OFTEN &&
	       l->times > TIMES * l->next_times;
}

int converter_saturates(const struct converter *c, double x)
{
	return is_at(&c->limit[0], x) || is_at(&c->limit[1], -x);
}

size_t converter_next(struct converter *c, double *sample)
{
	double share = (c->repeats + 1) / (c->samples + 2), x = *sample;

	if (isnan(x)) {
		*sample = c->last;
		return 1;
	}
	c->run = c->samples > 0 && x == c->last ? c->run + 1 : 1;
	c->last = x;
	c->samples++;
	see(&c->limit[0], x);
	see(&c->limit[1], -x);
	if ((double)(c->run - 1) * log(share) >= log(RARELY)) {
		c->repeats += c->run > 1;
		c->stands = 0;
		return converter_saturates(c, x) ? 1 : 0;
	}
	if (c->stands)
		return 1;
	c->stands = 1;
	return c->run;
}
