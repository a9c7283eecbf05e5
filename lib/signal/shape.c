/* shape.c - see shape.h */
#include "signal/shape.h"
#include <math.h>
#include <stdlib.h>

enum { STEPS = 256 }; /* grid steps per duration for the pulses of sensor.h */

struct shape {
	double reach, step;
	int cells;    /* grid cells; cells + 1 nodes */
	double *node; /* value and slope times step, alternating */
	double energy, slope_energy;
};

static struct shape *shape_alloc(double reach, int cells)
{
	struct shape *shape = calloc(1, sizeof *shape);

	if (!shape)
		return NULL;
	shape->reach = reach;
	shape->cells = cells;
	shape->step = 2 * reach / cells;
	shape->node = calloc(2 * (size_t)(cells + 1), sizeof *shape->node);
	if (!shape->node) {
		free(shape);
		return NULL;
	}
	return shape;
}

/* Integrals of p^2 and p'^2 over each cell by Simpson's rule. */
static void shape_integrate(struct shape *shape)
{
	const double *v = shape->node;

	for (int i = 0; i < shape->cells; i++, v += 2) {
		double mid = (v[0] + v[2]) / 2 + (v[1] - v[3]) / 8;
		double slope = 1.5 * (v[2] - v[0]) - (v[1] + v[3]) / 4;

		shape->energy += v[0] * v[0] + 4 * mid * mid + v[2] * v[2];
		shape->slope_energy += v[1] * v[1] + 4 * slope * slope + v[3] * v[3];
	}
	shape->energy *= shape->step / 6;
	shape->slope_energy /= 6 * shape->step;
}

struct shape *shape_new(enum pulse_shape pulse)
{
	double reach = pulse_reach(pulse);
	struct shape *shape;
	int cells;

	while (reach > 0.5 && fabs(pulse_value(pulse, reach - 1.0 / STEPS)) < 1e-4)
		reach -= 1.0 / STEPS;
	cells = 2 * (int)ceil(reach * STEPS - 1e-9);
	reach = cells / (2.0 * STEPS);
	shape = shape_alloc(reach, cells);
	if (!shape)
		return NULL;
	for (int i = 0; i <= cells; i++) {
		/* The ends lie on the support's edge: take them from just inside. */
		double s = (i - cells / 2) / (double)STEPS;
		double inside = i == 0 ? s + 1e-12 : i == cells ? s - 1e-12 : s;

		shape->node[2 * i] = pulse_value(pulse, inside);
		shape->node[2 * i + 1] = pulse_slope(pulse, inside) * shape->step;
	}
	shape_integrate(shape);
	return shape;
}

struct shape *shape_from_values(const double *value, int half, double reach)
{
	struct shape *shape;
	double peak = 0;
	int cells = 2 * half;

	if (half < 2 || !(reach > 0) || !isfinite(reach))
		return NULL;
	for (int i = 0; i <= cells; i++) {
		if (!isfinite(value[i]))
			return NULL;
		if (fabs(value[i]) > peak)
			peak = fabs(value[i]);
	}
	if (peak == 0 || !(shape = shape_alloc(reach, cells)))
		return NULL;
	for (int i = 0; i <= cells; i++) {
		double before = i > 0 ? value[i - 1] : 0,
		       after = i < cells ? value[i + 1] : 0;

		shape->node[2 * i] = value[i] / peak;
		shape->node[2 * i + 1] = (after - before) / (2 * peak);
	}
	shape_integrate(shape);
	return shape;
}

void shape_free(struct shape *shape)
{
	if (!shape)
		return;
	free(shape->node);
	free(shape);
}

double shape_reach(const struct shape *shape)
{
	return shape->reach;
}

double shape_energy(const struct shape *shape)
{
	return shape->energy;
}

double shape_slope_energy(const struct shape *shape)
{
	return shape->slope_energy;
}

long shape_support(const struct shape *shape, double t0, double T, size_t *n)
{
	long first = (long)ceil(t0 - shape->reach * T),
	     last = (long)floor(t0 + shape->reach * T);

	*n = last >= first ? (size_t)(last - first + 1) : 0;
	return first;
}

void shape_sample(const struct shape *shape, double t0, double T, long first, size_t n,
	double *p, double *by_t0, double *by_T)
{
	double rate = 1 / (T * shape->step), slope = -rate, start = (double)first - t0;

	for (size_t i = 0; i < n; i++) {
		double t = start + (double)i, x = (t + shape->reach * T) * rate, u, d;
		const double *v;
		int cell;

		if (!(x >= 0 && x <= shape->cells)) {
			p[i] = 0;
			if (by_t0)
				by_t0[i] = 0;
			if (by_T)
				by_T[i] = 0;
			continue;
		}
		cell = x < shape->cells ? (int)x : shape->cells - 1;
		v = shape->node + 2 * cell;
		u = x - cell;
		d = v[2] - v[0];
		/* Hermite: v0 + u (m0 + u (3d - 2m0 - m1 + u (m0 + m1 - 2d))) */
		p[i] = v[0] + u * (v[1] + u * (3 * d - 2 * v[1] - v[3] +
						      u * (v[1] + v[3] - 2 * d)));
		if (by_t0 || by_T) {
			double dp = v[1] + u * (2 * (3 * d - 2 * v[1] - v[3]) +
						       3 * u * (v[1] + v[3] - 2 * d));

			if (by_t0)
				by_t0[i] = slope * dp;
			if (by_T)
				by_T[i] = slope * dp * t / T;
		}
	}
}
