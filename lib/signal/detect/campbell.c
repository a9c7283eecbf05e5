/* campbell.c - see campbell.h */
#include "signal/detect/campbell.h"
#include <math.h>

enum { STRETCHES = 32 };

/* Sums of powers 1 to 4 of both channels over one stretch. */
struct sums {
	double n, power[2][4];
};

static void add(struct sums *to, const struct sums *from, double sign)
{
	to->n += sign * from->n;
	for (int c = 0; c < 2; c++)
		for (int k = 0; k < 4; k++)
			to->power[c][k] += sign * from->power[c][k];
}

static struct sums sum_stretch(
	const double *y1, const double *y2, size_t begin, size_t end)
{
	struct sums s = { 0 };

	s.n = (double)(end - begin);
	for (size_t i = begin; i < end; i++)
		for (int c = 0; c < 2; c++) {
			double y = c ? y2[i] : y1[i], square = y * y;

			s.power[c][0] += y;
			s.power[c][1] += square;
			s.power[c][2] += square * y;
			s.power[c][3] += square * square;
		}
	return s;
}

/* Both cumulants, turned into rate E[a^2] and rate E[a^4], mean of the channels. */
static void moments(const struct sums *s, double unit2, double unit4, double gain,
	double *square, double *fourth)
{
	*square = *fourth = 0;
	for (int c = 0; c < 2; c++) {
		double g2 = c ? gain * gain : 1, mean = s->power[c][0] / s->n;
		double m2 = s->power[c][1] / s->n, m3 = s->power[c][2] / s->n;
		double m4 = s->power[c][3] / s->n, k2 = m2 - mean * mean;
		double k4 = m4 - 4 * mean * m3 + 6 * mean * mean * m2 -
			    3 * mean * mean * mean * mean - 3 * k2 * k2;

		*square += 0.5 * (k2 - 1) / (g2 * unit2);
		*fourth += 0.5 * k4 / (g2 * g2 * unit4);
	}
}

void campbell_estimate(const double *y1, const double *y2, size_t n,
	const struct shape *shape, double duration, double gain, struct campbell *c)
{
	double unit2 = duration * shape_energy(shape),
	       unit4 = duration * shape_fourth(shape);
	double part[STRETCHES][4], mean[4] = { 0 }, var[4] = { 0 }, factor;
	struct sums all = { 0 }, each[STRETCHES];

	for (int k = 0; k < STRETCHES; k++) {
		each[k] = sum_stretch(y1, y2, n * (size_t)k / STRETCHES,
			n * (size_t)(k + 1) / STRETCHES);
		add(&all, &each[k], 1);
	}
	moments(&all, unit2, unit4, gain, &c->square, &c->fourth);
	c->rate = c->fourth > 0 ? c->square * c->square / c->fourth : NAN;
	c->amplitude = c->fourth > 0 && c->square > 0 ? sqrt(c->fourth / c->square) : NAN;
	for (int k = 0; k < STRETCHES; k++) {
		struct sums rest = all;

		add(&rest, &each[k], -1);
		moments(&rest, unit2, unit4, gain, &part[k][0], &part[k][1]);
		part[k][2] = part[k][0] * part[k][0] / part[k][1];
		part[k][3] = sqrt(part[k][1] / part[k][0]);
		for (int i = 0; i < 4; i++)
			mean[i] += part[k][i] / STRETCHES;
	}
	for (int k = 0; k < STRETCHES; k++)
		for (int i = 0; i < 4; i++)
			var[i] += (part[k][i] - mean[i]) * (part[k][i] - mean[i]);
	factor = (double)n < 32 * duration ? INFINITY
					   : sqrt((STRETCHES - 1.0) / STRETCHES);
	c->square_se = factor * sqrt(var[0]);
	c->fourth_se = factor * sqrt(var[1]);
	c->rate_se = factor * sqrt(var[2]);
	c->amplitude_se = factor * sqrt(var[3]);
}

void campbell_scale(struct campbell *c, double unit)
{
	double square = unit * unit;

	c->square *= square;
	c->square_se *= square;
	c->fourth *= square * square;
	c->fourth_se *= square * square;
	c->amplitude *= unit;
	c->amplitude_se *= unit;
}
