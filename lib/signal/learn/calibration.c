/* calibration.c - see calibration.h */
#include "signal/learn/calibration.h"
#include <math.h>

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
