/* calibration.c - see calibration.h */
#include "signal/learn/calibration.h"
#include "signal/detect/align.h"
#include <math.h>
#include <stdlib.h>

double calibrate_threshold(double rate, const struct shape *shape, double duration,
	double gain, double width)
{
	double lambda =
		shape_slope_energy(shape) / shape_energy(shape) / (duration * duration);
	double area = width * lambda * gain / (1 + gain * gain) / pow(2 * M_PI, 1.5);
	double edge = sqrt(lambda) / (2 * M_PI), lo = 1, hi = 40;

	while (hi - lo > 1e-6) {
		double u = (lo + hi) / 2;

		if ((area * u + edge) * exp(-u * u / 2) > rate)
			lo = u;
		else
			hi = u;
	}
	return hi * hi;
}

double calibration_reach(double share, double transit, double duration)
{
	return fmax(share * transit, SHAPE_FINEST * duration);
}

double calibration_plug(const struct calibration *c)
{
	return calibration_reach(CALIBRATE_PLUG, (double)c->shift, c->duration);
}

double calibration_most(double transit, double least)
{
	static const double SAFELY = 0.95;

	return least + SAFELY * (transit + least) / JOINT_BEYOND;
}

void calibration_widen(double duration, double *least, double *most)
{
	double margin = fmax(0.5 * (*most - *least), 0.02 * duration);

	*least -= margin;
	*most += margin;
}

double calibration_lost(const struct calibration *c)
{
	return c->whitening.tap ? 1 - fmin(c->whitening.band, 1) : 0;
}

void calibration_clear(struct calibration *c)
{
	shape_free(c->shape);
	c->shape = NULL;
	whitening_clear(&c->whitening);
}

void calibration_unmix(const double crosstalk[2], double *x1, double *x2, size_t n)
{
	const double k1 = crosstalk[0], k2 = crosstalk[1], left = 1 - k1 * k2;

	for (size_t i = 0; i < n && (k1 != 0 || k2 != 0); i++) {
		double first = x1[i];

		x1[i] = (first - k1 * x2[i]) / left;
		x2[i] = (x2[i] - k2 * first) / left;
	}
}

void calibration_scene(const struct calibration *c, struct joint_scene *scene)
{
	*scene = (struct joint_scene){ .shape = c->shape,
		.duration = c->duration,
		.transit = c->transit,
		.gain = fabs(c->gain) * c->noise[0] / c->noise[1],
		.width = c->width,
		.delta_min = c->delta_min,
		.delta_max = c->delta_max,
		.threshold = c->threshold,
		.threshold_near = c->threshold_near,
		.misfit = c->misfit,
		.scatter = { c->scatter[JOINT_WIDTH], c->scatter[JOINT_RATIO] },
		.tone_variance = c->tone_variance,
		.tone_hop = (double)c->tone_hop,
		.low = c->whitening.low,
		.lost = calibration_lost(c) };
	for (int k = 0; k < c->tones; k++)
		if (c->omega[k] * c->duration < 8 * M_PI || isinf(c->tone_variance))
			scene->omega[scene->tones++] = c->omega[k];
}

int calibration_describes(const struct calibration *c)
{
	return c->chi2 < CALIBRATE_DESCRIBES;
}

int calibration_stands(const struct calibration *c)
{
	return calibration_describes(c) && (!c->corrected || c->isolated > 0);
}

/* *lag: at which the autocorrelation of the pulse is lowest, as a share of its duration.
 */
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

enum num_status known_shape_duration(int pulse, double low, double *duration)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);
	double lag = NAN;
	enum num_status status = plain ? shape_lowest_lag(plain, &lag) : NUM_MEMORY;

	*duration = low / lag;
	shape_free(plain);
	return status;
}
