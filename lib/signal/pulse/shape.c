/* shape.c - see shape.h */
#include "signal/pulse/shape.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 256 }; /* grid steps per duration for the pulses of sensor.h */

struct shape {
	double reach, step;
	int cells;
	double *cubic; /* four coefficients per cell, of powers of its unit coordinate */
	double energy, slope_energy, fourth;
};

static struct shape *shape_alloc(double reach, int cells)
{
	struct shape *shape = cells > 0 ? calloc(1, sizeof *shape) : NULL;

	if (!shape)
		return NULL;
	shape->reach = reach;
	shape->cells = cells;
	shape->step = 2 * reach / cells;
	shape->cubic = calloc(4 * (size_t)cells, sizeof *shape->cubic);
	if (!shape->cubic) {
		free(shape);
		return NULL;
	}
	return shape;
}

/* The cubic c of a cell from values and slopes (per cell) at its ends. */
static void set_cubic(double c[4], double v0, double m0, double v1, double m1)
{
	c[0] = v0;
	c[1] = m0;
	c[2] = 3 * (v1 - v0) - 2 * m0 - m1;
	c[3] = 2 * (v0 - v1) + m0 + m1;
}

/* Integrals of p^2 and p'^2 over each cell by Simpson's rule. */
static void shape_integrate(struct shape *shape)
{
	for (int i = 0; i < shape->cells; i++) {
		const double *c = shape->cubic + 4 * i;

		for (int k = 0; k < 3; k++) {
			double u = 0.5 * k, weight = k == 1 ? 4 : 1;
			double v = c[0] + u * (c[1] + u * (c[2] + u * c[3]));
			double d = c[1] + u * (2 * c[2] + u * 3 * c[3]);

			shape->energy += weight * v * v;
			shape->fourth += weight * v * v * v * v;
			shape->slope_energy += weight * d * d;
		}
	}
	shape->energy *= shape->step / 6;
	shape->fourth *= shape->step / 6;
	shape->slope_energy /= 6 * shape->step;
}

struct shape *shape_new(enum pulse_shape pulse)
{
	double reach = pulse_reach(pulse);
	struct shape *shape;
	int cells, half;

	while (reach > 0.5 && fabs(pulse_value(pulse, reach - 1.0 / STEPS)) < 1e-4)
		reach -= 1.0 / STEPS;
	cells = 2 * (int)ceil(reach * STEPS - 1e-9);
	half = cells / 2;
	reach = cells / (2.0 * STEPS);
	shape = shape_alloc(reach, cells);
	if (!shape)
		return NULL;
	for (int i = 0; i < cells; i++) {
		/* The ends lie on the support's edge: take them from just inside. */
		double s0 = (i - half) / (double)STEPS + (i == 0 ? 1e-12 : 0);
		double s1 = (i + 1 - half) / (double)STEPS - (i == cells - 1 ? 1e-12 : 0);

		set_cubic(shape->cubic + 4 * i, pulse_value(pulse, s0),
			pulse_slope(pulse, s0) * shape->step, pulse_value(pulse, s1),
			pulse_slope(pulse, s1) * shape->step);
	}
	shape_integrate(shape);
	return shape;
}

struct shape *shape_from_values(const double *value, int half, double reach)
{
	struct shape *shape;
	double peak = 0;
	int cells = 2 * half, sane = half >= 2 && reach > 0 && isfinite(reach);

	for (int i = 0; i <= cells && sane; i++) {
		sane = isfinite(value[i]);
		peak = fmax(peak, fabs(value[i]));
	}
	if (!sane || peak == 0) {
		errno = EDOM;
		return NULL;
	}
	shape = shape_alloc(reach, cells);
	if (!shape)
		return NULL;
	for (int i = 0; i < cells; i++) {
		double before = i > 0 ? value[i - 1] : 0,
		       after = i + 2 <= cells ? value[i + 2] : 0;

		set_cubic(shape->cubic + 4 * i, value[i] / peak,
			(value[i + 1] - before) / (2 * peak), value[i + 1] / peak,
			(after - value[i]) / (2 * peak));
	}
	shape_integrate(shape);
	return shape;
}

/* Value and slope (by s) at s of a filtered pulse of duration T; work: two of its
 * support, less than 2 reach T + 2. */
static void filter_at(const struct shape *shape, double T, const double *tap, int half,
	double s, double *work, double *value, double *slope)
{
	size_t n;
	long first = shape_support(shape, -s * T, T, &n);

	*value = *slope = 0;
	shape_sample(shape, -s * T, T, first, n, work, work + n, NULL);
	for (size_t i = 0; i < n; i++) {
		long k = first + (long)i;

		if (k < -half || k > half)
			continue;
		*value += tap[half + k] * work[i];
		*slope -= tap[half + k] * work[n + i] * T; /* by t0 is - 1/T by s */
	}
}

struct shape *shape_filter(
	const struct shape *shape, double T, const double *tap, int half)
{
	int reach = (int)ceil((shape->reach + half / T) * STEPS), keep = reach;
	size_t points = 2 * (size_t)reach + 1,
	       support = (size_t)(2 * shape->reach * T) + 2;
	double *value = malloc((2 * points + 2 * support) * sizeof *value);
	double *slope, *work, peak = 0;
	struct shape *out = NULL;

	if (!value)
		return NULL;
	slope = value + points;
	work = slope + points;
	for (size_t i = 0; i < points; i++) {
		filter_at(shape, T, tap, half, ((double)i - reach) / STEPS, work,
			&value[i], &slope[i]);
		peak = fmax(peak, fabs(value[i]));
	}
	while (keep > STEPS / 2 && fabs(value[reach - keep]) < 2e-3 * peak &&
		fabs(value[reach + keep]) < 2e-3 * peak)
		keep--;
	out = shape_alloc((double)keep / STEPS, 2 * keep);
	for (int i = 0; out && i < 2 * keep; i++) {
		int k = reach - keep + i;

		set_cubic(out->cubic + 4 * i, value[k], slope[k] / STEPS, value[k + 1],
			slope[k + 1] / STEPS);
	}
	free(value);
	if (out)
		shape_integrate(out);
	return out;
}

/* more at s, between its points by cubic Hermite polynomials with central differences. */
static double more_at(const double *more, int half, double step, double s)
{
	double x = s / step + half, u = x - floor(x), c[4];
	int k = (int)floor(x);

	if (k < 0 || k >= 2 * half)
		return 0;
	set_cubic(c, more[k], 0.5 * (more[k + 1] - (k > 0 ? more[k - 1] : 0)),
		more[k + 1], 0.5 * ((k + 2 <= 2 * half ? more[k + 2] : 0) - more[k]));
	return c[0] + u * (c[1] + u * (c[2] + u * c[3]));
}

struct shape *shape_correct(
	const struct shape *shape, const double *more, int half, double step)
{
	double h = shape->step;
	int wider = (int)fmax(ceil((half * step - shape->reach) / h), 0);
	struct shape *out =
		shape_alloc(shape->reach + wider * h, shape->cells + 2 * wider);

	for (int i = 0; out && i < out->cells; i++) {
		static const double nothing[4];
		const double *c = i >= wider && i < wider + shape->cells
					  ? shape->cubic + 4 * (i - wider)
					  : nothing;
		double s = i * h - out->reach, d[4];

		for (int k = 0; k < 4; k++)
			d[k] = more_at(more, half, step, s + (k - 1) * h);
		set_cubic(out->cubic + 4 * i, c[0] + d[1], c[1] + 0.5 * (d[2] - d[0]),
			c[0] + c[1] + c[2] + c[3] + d[2],
			c[1] + 2 * c[2] + 3 * c[3] + 0.5 * (d[3] - d[1]));
	}
	if (out)
		shape_integrate(out);
	return out;
}

void shape_scale(struct shape *shape, double factor)
{
	for (int i = 0; i < 4 * shape->cells; i++)
		shape->cubic[i] *= factor;
	shape->energy *= factor * factor;
	shape->slope_energy *= factor * factor;
	shape->fourth *= factor * factor * factor * factor;
}

struct shape *shape_from_cubic(double reach, int cells, const double *cubic)
{
	struct shape *shape = reach > 0 ? shape_alloc(reach, cells) : NULL;

	if (!shape)
		return NULL;
	memcpy(shape->cubic, cubic, 4 * (size_t)cells * sizeof *cubic);
	shape_integrate(shape);
	return shape;
}

int shape_cells(const struct shape *shape)
{
	return shape->cells;
}

const double *shape_cubic(const struct shape *shape)
{
	return shape->cubic;
}

void shape_free(struct shape *shape)
{
	if (!shape)
		return;
	free(shape->cubic);
	free(shape);
}

double shape_reach(const struct shape *shape)
{
	return shape->reach;
}

double shape_reach_above(const struct shape *shape, double level)
{
	int left = 0, right = shape->cells;

	/* A cell begins with its first coefficient. */
	while (left < right && fabs(shape->cubic[4 * left]) < level)
		left++;
	while (right > left && fabs(shape->cubic[4 * (right - 1)]) < level)
		right--;
	return fmax(
		shape->reach - left * shape->step, right * shape->step - shape->reach);
}

double shape_energy(const struct shape *shape)
{
	return shape->energy;
}

double shape_fourth(const struct shape *shape)
{
	return shape->fourth;
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

static void clear_outside(double *x, size_t begin, size_t end, size_t n)
{
	if (!x)
		return;
	for (size_t i = 0; i < begin; i++)
		x[i] = 0;
	for (size_t i = end; i < n; i++)
		x[i] = 0;
}

/* The first m of four numbers, at least one. */
static inline void store(double *x, const lanes4 *v, size_t m)
{
	if (m == 4) {
		memcpy(x, v, sizeof *v);
		return;
	}
	x[0] = (*v)[0];
	if (m > 1)
		x[1] = (*v)[1];
	if (m > 2)
		x[2] = (*v)[2];
}

/* A pulse as shape_sample() takes it: cell rate i + x0 is that of sample i. */
struct sampling {
	const double *cubic;
	double rate, start, x0, inverse;
	int last; /* cell */
};

/* The first m of four samples from i on. */
static ALWAYS_INLINE void sample_four(const struct sampling *s, size_t i, size_t m,
	double *p, double *by_t0, double *by_T)
{
	lanes4 at = (double)(long)i + (lanes4){ 0, 1, 2, 3 }, x = s->x0 + s->rate * at;
	lanes4_int cell = __builtin_convertvector(x, lanes4_int), from = 4 * cell;
	lanes4 u = x - __builtin_convertvector(cell, lanes4), c0, c1, c2, c3, y;
	lanes4 r0, r1, r2, r3, even, odd;
	const int last = 4 * s->last;

	memcpy(&r0, s->cubic + from[0], sizeof r0);
	memcpy(&r1, s->cubic + (m < 4 ? lesser_int(from[1], last) : from[1]), sizeof r1);
	memcpy(&r2, s->cubic + (m < 4 ? lesser_int(from[2], last) : from[2]), sizeof r2);
	memcpy(&r3, s->cubic + (m < 4 ? lesser_int(from[3], last) : from[3]), sizeof r3);
	/* four rows to four columns */
	even = __builtin_shufflevector(r0, r1, 0, 4, 2, 6);
	odd = __builtin_shufflevector(r2, r3, 0, 4, 2, 6);
	c0 = __builtin_shufflevector(even, odd, 0, 1, 4, 5);
	c2 = __builtin_shufflevector(even, odd, 2, 3, 6, 7);
	even = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
	odd = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
	c1 = __builtin_shufflevector(even, odd, 0, 1, 4, 5);
	c3 = __builtin_shufflevector(even, odd, 2, 3, 6, 7);
	y = c0 + u * (c1 + u * (c2 + u * c3));
	store(p + i, &y, m);
	if (!by_t0 && !by_T)
		return;
	y = -s->rate * (c1 + u * (2 * c2 + u * 3 * c3));
	if (by_t0)
		store(by_t0 + i, &y, m);
	y *= (s->start + at) * s->inverse;
	if (by_T)
		store(by_T + i, &y, m);
}

/* Samples begin to end of shape_sample(), all of them within the cells. */
LANES_CLONES static void sample_inside(const struct shape *shape, double t0, double T,
	long first, size_t begin, size_t end, double *p, double *by_t0, double *by_T)
{
	const double rate = 1 / (T * shape->step), start = (double)first - t0;
	const struct sampling s = { shape->cubic, rate, start,
		(start + shape->reach * T) * rate, 1 / T, shape->cells - 1 };
	size_t i = begin;

	for (; i + 4 <= end; i += 4)
		sample_four(&s, i, 4, p, by_t0, by_T);
	if (i < end)
		sample_four(&s, i, end - i, p, by_t0, by_T);
}

void shape_sample(const struct shape *shape, double t0, double T, long first, size_t n,
	double *p, double *by_t0, double *by_T)
{
	double rate = 1 / (T * shape->step), start = (double)first - t0;
	double x0 = (start + shape->reach * T) * rate;
	size_t begin = 0, end = n;

	while (begin < end && !(x0 + rate * (double)begin >= 0))
		begin++;
	while (end > begin && !(x0 + rate * (double)(end - 1) < shape->cells))
		end--;
	clear_outside(p, begin, end, n);
	clear_outside(by_t0, begin, end, n);
	clear_outside(by_T, begin, end, n);
	sample_inside(shape, t0, T, first, begin, end, p, by_t0, by_T);
}
