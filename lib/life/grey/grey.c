/* grey.c - see grey.h */
#include "life/grey/grey.h"
#include <math.h>

void grey_add(struct grey *g, double x, double gap)
{
	if (g->n > 0) {
		double share = g->oldest * gap;

		regression_add(&g->fit, g->tail + share / 2, g->oldest);
		g->tail += share;
		g->span += gap;
	}
	g->oldest = x;
	g->n++;
}

double grey_scale(double x)
{
	int exponent;

	frexp(x, &exponent);
	return ldexp(1, exponent < -1000 ? -1000 : exponent > 1000 ? 1000 : exponent);
}

/* Zeros are the same in any scale, so the scale may be set after them. */
void grey_append(struct grey_series *s, double x, double gap)
{
	struct grey *g = &s->forward;

	if (s->scale == 0 && x != 0)
		s->scale = grey_scale(x);
	x /= s->scale > 0 ? s->scale : 1;
	if (g->n++ == 0) {
		g->oldest = x;
		return;
	}
	if (g->n == 2)
		s->unit = grey_scale(gap);
	gap /= s->unit;
	regression_add(&g->fit, g->tail + x * gap / 2, x);
	g->tail += x * gap;
	g->span += gap;
}

struct grey grey_of(const struct grey_series *s)
{
	struct grey g = s->forward;

	g.fit.mean_x = g.tail - g.fit.mean_x;
	g.fit.xy = -g.fit.xy;
	return g;
}

double grey_rate(const struct grey *g)
{
	double most = grey_rate_limit(g->fit.n, g->span);

	return isfinite(g->fit.xx) && fabs(g->fit.xy) < most * g->fit.xx
		       ? g->fit.xy / g->fit.xx
		       : 0;
}

double grey_level(const struct grey *g)
{
	return g->n > 1 ? g->fit.mean_y + grey_rate(g) * (g->tail - g->fit.mean_x)
			: g->oldest;
}

double grey_residual(const struct grey *g)
{
	double sum = g->fit.yy - grey_rate(g) * g->fit.xy;

	return g->n > 3 && sum > 0 ? sum / (g->fit.n - 2) : 0;
}

double grey_forecast(const struct grey *g, double h, double gap)
{
	double rate = grey_rate(g),
	       next = grey_curve(
		       lanes_all(grey_level(g)), lanes_all(rate), g->span + h, gap)[0],
	       newest = g->n > 1 ? g->fit.mean_y - rate * g->fit.mean_x : g->oldest,
	       reach = grey_reach(grey_rate_limit(g->fit.n, g->span), h);

	return fabs(next) > reach * fabs(newest) ? g->fit.mean_y : next;
}

/* Rate and level are uncorrelated when the level is written as mean of x + a (tail - mean
 * of u). */
double grey_life(const struct grey_series *s, double limit, int direction, double rate_z,
	double level_z)
{
	struct grey g = grey_of(s);
	double rate = grey_rate(&g), level, now, time;

	if (g.n < GREY_ORDER_MIN)
		return NAN;
	rate += g.fit.xx > 0 ? sqrt(grey_residual(&g) / g.fit.xx) * rate_z : 0;
	level = g.fit.mean_y + sqrt(grey_residual(&g) / g.fit.n) * level_z +
		rate * (g.tail - g.fit.mean_x);
	limit /= s->scale > 0 ? s->scale : 1;
	now = grey_curve(lanes_all(level), lanes_all(rate), g.span, g.span / g.fit.n)[0];
	if (direction * (now - limit) >= 0)
		return 0;
	time = -log(limit / now) / rate;
	return time >= 0 ? time * s->unit : INFINITY;
}
