/* grey.c - see grey.h */
#include "life/grey.h"
#include <math.h>

void grey_add(struct grey *g, double x, double gap)
{
	if (g->n > 0) {
		double rows = g->n, share = g->oldest * gap;
		double du = g->tail + share / 2 - g->mean_u, dx = g->oldest - g->mean_x;

		g->mean_u += du / rows;
		g->mean_x += dx / rows;
		g->suu += du * (g->tail + share / 2 - g->mean_u);
		g->sux += du * (g->oldest - g->mean_x);
		g->sxx += dx * (g->oldest - g->mean_x);
		g->tail += share;
		g->span += gap;
	}
	g->oldest = x;
	g->n++;
}

double grey_rate(const struct grey *g)
{
	return g->suu > 0 && isfinite(g->suu) && isfinite(g->sux) ? g->sux / g->suu : 0;
}

double grey_level(const struct grey *g)
{
	return g->n > 1 ? g->mean_x + grey_rate(g) * (g->tail - g->mean_u) : g->oldest;
}

double grey_control(const struct grey *g)
{
	return grey_level(g) + grey_rate(g) * g->oldest;
}

double grey_residual(const struct grey *g)
{
	double sum = g->sxx - grey_rate(g) * g->sux;

	return g->n > 3 && sum > 0 ? sum / (g->n - 3) : 0;
}

double grey_rate_error(const struct grey *g)
{
	return g->suu > 0 ? sqrt(grey_residual(g) / g->suu) : 0;
}

double grey_level_error(const struct grey *g)
{
	return g->n > 1 ? sqrt(grey_residual(g) / (g->n - 1)) : 0;
}

static double clamp(double x, double limit)
{
	return x > limit ? limit : x < -limit ? -limit : x;
}

/* Growth beyond e^600 is as good as for ever; the clamps keep it finite. */
double grey_curve(double level, double rate, double t, double gap)
{
	double a = clamp(rate * gap, 600), mean;

	mean = fabs(a) > GREY_SERIES ? expm1(a) / a : grey_mean_exp(lanes_all(a))[0];
	return level * mean * lanes_exp(lanes_all(clamp(-rate * t, 600)))[0];
}

double grey_forecast(const struct grey *g, double h, double gap)
{
	return grey_curve(grey_level(g), grey_rate(g), g->span + h, gap);
}
