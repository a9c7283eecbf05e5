/* shapes.c - the coordinates of the bank, see bank.h and bank_state.h */
#include "life/trend/bank_state.h"

#define SATURATING(s, p, w, prior)                                                 \
	{                                                                          \
		.family = BANK_SATURATING, .scale = (s), .par = (p), .power = (w), \
		.log_prior = (prior)                                               \
	}

/* The weights and the changes of regime to come (passage.c) were chosen together (scores:
 * doc/benchmarks.md) by a random search over every other of 31 measured series, the
 * first 13 kinds of tests/long/lives.c and the sigmoid, 24 to 40 paths of each with other
 * seeds, and 30 pumps of scripts/synthetic-pump with other seeds.  It minimised the mean
 * logarithm of the CRPS, with penalties for a coverage below 0.83 of any kind, for
 * measured series outside of 0.88 to 0.93 and for fifths of theirs outside of 0.12 to
 * 0.25.  Coordinates of little weight were dropped or, with a weight below -2, serve
 * their families alone; the others were rounded.  The weights of the exponentials and of
 * saturation with power 1/2 were swept again later. */
static const struct bank_shape table[] = {
	{ .family = BANK_LINEAR, .log_prior = 3.8 },
	{ .family = BANK_RATE, .par = 1, .log_prior = 0.6 },
	{ .family = BANK_RATE, .par = 2, .log_prior = 1 },
	{ .family = BANK_RATE, .par = 3, .log_prior = -4.1 },
	{ .family = BANK_EXPONENTIAL, .scale = 0.05, .par = 1, .log_prior = 1.1 },
	{ .family = BANK_EXPONENTIAL, .scale = 0.12, .par = 1, .log_prior = -0.8 },
	{ .family = BANK_POWER, .scale = 0.05, .par = -1, .log_prior = 1 },
	{ .family = BANK_POWER, .scale = 0.3, .par = 1.5, .log_prior = -2.8 },
	{ .family = BANK_POWER, .scale = 0.3, .par = 2, .log_prior = 3.1 },
	SATURATING(0, 0.99, 1, -2),
	SATURATING(0, 0.8, 1, -1.5),
	SATURATING(10, 0.95, 1, -2),
	SATURATING(100, 0.99, 1, -1.7),
	SATURATING(2000, 0.92, 1, 1),
	SATURATING(10, 0.95, 0.5, -0.6),
	SATURATING(100, 0.95, 0.5, -0.5),
};

enum { SHAPES = sizeof table / sizeof *table };

int shapes_in_table(void)
{
	return SHAPES;
}

const struct bank_shape *shape_of(const struct bank *b, int i)
{
	return i < SHAPES ? &table[i] : &b->par.more[i - SHAPES];
}

/* With w^2 = 1 + scale D, h for power 1/2 is the integral of 2 dw / (scale + par - par
 * w^2). */
static struct place place_where_it_saturates(const struct bank_shape *s, double damage)
{
	double up = log1p(damage * s->scale), down = log1p(-damage * s->par);
	double sum = s->scale + s->par, k = sqrt(s->par / sum);
	struct place p = { .log_slope = -s->power * up - down,
		.bend = s->par / (1 - damage * s->par) -
			s->power * s->scale / (1 + damage * s->scale) };

	if (s->power == 1)
		p.h = (up - down) / sum;
	else
		p.h = 2 / sqrt(s->par * sum) * (atanh(k * exp(0.5 * up)) - atanh(k));
	return p;
}

double bank_path_age(const struct bank_point *path, size_t n, double level, double *slope)
{
	size_t low = 0, high = n - 1;

	while (high - low > 1) {
		size_t middle = (low + high) / 2;

		if (path[middle].level < level)
			low = middle;
		else
			high = middle;
	}
	*slope = (path[high].age - path[low].age) / (path[high].level - path[low].level);
	return path[low].age + *slope * (level - path[low].level);
}

struct place place_of(const struct bank *b, int shape, double damage)
{
	const struct bank_shape *s = shape_of(b, shape);
	double inside = fmax(0, fmin(1, damage)), scale = s->scale, par = s->par;
	struct place p = { 0 };

	if (s->of_value)
		scale = b->base / b->range;
	if (s->of_value && !(scale > 0))
		par = 0;

	if (s->n > 0) {
		double y = b->par.direction * (b->base + b->range * damage), slope;

		p.h = bank_path_age(s->path, (size_t)s->n, y, &slope) / b->unit;
		p.log_slope = log(slope * fabs(b->range) / b->unit);
	} else if (s->family == BANK_SATURATING) {
		p = place_where_it_saturates(s, inside);
	} else if (scale > 0) {
		double u = log1p(inside / scale), k = 1 - par;

		p.log_slope = -par * u;
		p.bend = -par / (scale + inside);
		p.h = k == 0 ? scale * u : scale * expm1(k * u) / k;
	} else {
		p.log_slope = -par * inside;
		p.bend = -par;
		p.h = par == 0 ? inside : -expm1(-par * inside) / par;
	}
	if (s->n == 0)
		p.h += (damage - inside) * exp(p.log_slope);
	if (damage != inside)
		p.bend = 0;
	p.slope = exp(p.log_slope);
	return p;
}
