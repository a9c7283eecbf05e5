/* known_shape.c - see known_shape.h */
#include "signal/learn/known_shape.h"
#include <math.h>
#include <stdlib.h>

/* First minimum of the autocorrelation after its smallest value has been passed by a
 * clear rise; lag in samples, 0 where there is none. */
double lowest_lag(const double *r, size_t max_lag)
{
	size_t low = 1;

	for (size_t k = 2; k <= max_lag; k++) {
		if (r[k] < r[low])
			low = k;
		else if (r[low] < 0 && r[k] > 0.5 * r[low])
			break;
	}
	return low < max_lag && r[low] < 0 ? (double)low : 0;
}

/* *lag: the same of one pulse, as a share of its duration. */
static enum num_status shape_lowest_lag(const struct shape *shape, double *lag)
{
	enum { T = 100, LAGS = 100 };
	size_t n = (size_t)(2 * shape_reach(shape) * T) + 2;
	double *p = calloc(n + LAGS, sizeof *p), r[LAGS + 1] = { 0 };

	if (!p)
		return NUM_MEMORY;
	shape_sample(shape, shape_reach(shape) * T, T, 0, n, p, NULL, NULL);
	for (int k = 0; k <= LAGS; k++)
		for (size_t i = 0; i < n; i++)
			r[k] += p[i] * p[i + (size_t)k];
	*lag = lowest_lag(r, LAGS) / T;
	free(p);
	return NUM_OK;
}

/* Takes this pulse, reversed or not, as the whitened record has it at the present
 * duration. */
enum num_status known_shape_set(struct calibration *c, int pulse)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);

	shape_free(c->shape);
	c->pulse = pulse;
	c->measured = 0;
	c->shape = plain;
	if (plain && c->reversed)
		shape_scale(plain, -1);
	if (plain && c->whitening.tap) {
		c->shape = shape_filter(plain, fmax(c->duration, SHAPE_SHORTEST),
			c->whitening.seen, c->whitening.seen_half);
		shape_free(plain);
	}
	return c->shape ? NUM_OK : NUM_MEMORY;
}

/* Duration of a pulse whose autocorrelation is lowest at this lag. */
enum num_status known_shape_duration(int pulse, double low, double *duration)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);
	double lag = NAN;
	enum num_status status = plain ? shape_lowest_lag(plain, &lag) : NUM_MEMORY;

	*duration = low / lag;
	shape_free(plain);
	return status;
}
