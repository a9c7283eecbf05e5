/* shapes.c - the coordinates of the bank, see bank.h and bank_state.h */
#include "life/trend/bank_state.h"

/* The weights and the changes of regime to come (passage.c) were chosen together, see
 * "The first search" in doc/trends.md.  Coordinates with a weight below -2 serve their
 * families alone; the power of 0.5 also quiet wear that goes as the square of time, see
 * "Squares of time" there. */
static const struct bank_shape table[] = {
	{ BANK_LINEAR, 3.5, .par = 0 },
	{ BANK_RATE, 1.3, .par = 1 },
	{ BANK_RATE, 1, .par = 2 },
	{ BANK_RATE, -4.1, .par = 3 },
	{ BANK_EXPONENTIAL, 1.1, .scale = 0.05, .par = 1 },
	{ BANK_EXPONENTIAL, -0.8, .scale = 0.12, .par = 1 },
	{ BANK_POWER, 0.3, .scale = 0.05, .par = -1 },
	{ BANK_POWER, -4, .scale = 0.005, .par = 0.5 },
	{ BANK_POWER, -2.8, .scale = 0.3, .par = 1.5 },
	{ BANK_POWER, 3.1, .scale = 0.3, .par = 2 },
	{ BANK_SATURATING, -2, .scale = 0, .par = 0.99, .power = 1 },
	{ BANK_SATURATING, -1.5, .scale = 0, .par = 0.8, .power = 1 },
	{ BANK_SATURATING, -2, .scale = 10, .par = 0.95, .power = 1 },
	{ BANK_SATURATING, -1.7, .scale = 100, .par = 0.99, .power = 1 },
	{ BANK_SATURATING, 1, .scale = 2000, .par = 0.92, .power = 1 },
	{ BANK_SATURATING, -0.6, .scale = 10, .par = 0.95, .power = 0.5 },
	{ BANK_SATURATING, -0.5, .scale = 100, .par = 0.95, .power = 0.5 },
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

/* The straight line of a path, from low to low + 1, on which there is this level or, by
 * age, this age. */
static size_t line_of(const struct bank_point *path, size_t n, double at, int by_age)
{
	size_t low = 0, high = n - 1;

	while (high - low > 1) {
		size_t middle = (low + high) / 2;

		if ((by_age ? path[middle].age : path[middle].level) < at)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* Of the age over the level. */
static double slope_of(const struct bank_point *line)
{
	return (line[1].age - line[0].age) / (line[1].level - line[0].level);
}

double bank_path_age(const struct bank_point *path, size_t n, double level, double *slope)
{
	const struct bank_point *line = path + line_of(path, n, level, 0);

	*slope = slope_of(line);
	return line->age + *slope * (level - line->level);
}

static double path_level(const struct bank_point *path, size_t n, double age)
{
	const struct bank_point *line = path + line_of(path, n, age, 1);

	return line->level + (age - line->age) / slope_of(line);
}

/* With the scale that the value at D = 0 defines. */
static struct bank_shape settled_shape(const struct bank *b, int i)
{
	struct bank_shape s = *shape_of(b, i);

	if (s.of_value)
		s.scale = b->base / b->range;
	if (s.of_value && !(s.scale > 0))
		s.scale = s.par = 0;
	return s;
}

struct place place_of(const struct bank *b, int shape, double damage)
{
	const struct bank_shape s = settled_shape(b, shape);
	double inside = fmax(0, fmin(1, damage));
	struct place p = { 0 };

	if (s.n > 0) {
		double y = b->par.direction * (b->base + b->range * damage), slope;

		p.h = bank_path_age(s.path, (size_t)s.n, y, &slope) / b->unit;
		p.log_slope = log(slope * fabs(b->range) / b->unit);
	} else if (s.family == BANK_SATURATING) {
		p = place_where_it_saturates(&s, inside);
	} else if (s.scale > 0) {
		double u = log1p(inside / s.scale), k = 1 - s.par;

		p.log_slope = -s.par * u;
		p.bend = -s.par / (s.scale + inside);
		p.h = k == 0 ? s.scale * u : s.scale * expm1(k * u) / k;
	} else {
		p.log_slope = -s.par * inside;
		p.bend = -s.par;
		p.h = s.par == 0 ? inside : -expm1(-s.par * inside) / s.par;
	}
	if (s.n == 0)
		p.h += (damage - inside) * exp(p.log_slope);
	if (damage != inside)
		p.bend = 0;
	p.slope = exp(p.log_slope);
	return p;
}

/* The inverse of place_where_it_saturates(). */
static double damage_where_it_saturates(const struct bank_shape *s, double h)
{
	double sum = s->scale + s->par, k = sqrt(s->par / sum), e = expm1(h * sum), w;

	if (s->power == 1)
		return e / (sum + s->par * e);
	w = tanh(atanh(k) + 0.5 * h * sqrt(s->par * sum)) / k;
	return (w * w - 1) / s->scale;
}

/* The slope of every shape at D = 0 is 1. */
double damage_at(const struct bank *b, int shape, double h)
{
	const struct bank_shape s = settled_shape(b, shape);
	struct place end;
	double k = 1 - s.par;

	if (s.n > 0)
		return damage_of(b,
			b->par.direction * path_level(s.path, (size_t)s.n, h * b->unit));
	end = place_of(b, shape, 1);
	if (h < 0)
		return h;
	if (h > end.h)
		return 1 + (h - end.h) / end.slope;
	if (s.family == BANK_SATURATING)
		return damage_where_it_saturates(&s, h);
	if (s.scale > 0)
		return s.scale * expm1(k == 0 ? h / s.scale : log1p(k * h / s.scale) / k);
	return s.par == 0 ? h : -log1p(-s.par * h) / s.par;
}
