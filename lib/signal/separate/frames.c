/* frames.c - frames of a record: which samples the converter has measured, and the
 * components of both sensors that are separated */
#include "num/dot.h"
#include "signal/separate/separate_state.h"
#include <math.h>

/* Components of a sensor in the record. */
static int components(const struct separate *s)
{
	return s->channels / 2;
}

/* Sign with which samples of a sensor are separated: that of the pulses of sensor 1. */
static double sign_of(const struct separate *s, int sensor)
{
	return sensor == 1 && s->calibrated && s->cal.gain < 0 ? -1 : 1;
}

void separate_align(struct separate *s, size_t from)
{
	size_t n = s->buffer[0].n - from;

	if (n == 0) /* there may be no buffer yet */
		return;
	for (int k = 1; k < s->channels && sign_of(s, 1) < 0; k += 2)
		negate(s->buffer[k].x + from, n);
	for (int k = 0; k < s->channels; k += 2)
		calibration_unmix(s->cal.crosstalk, s->buffer[k].x + from,
			s->buffer[k + 1].x + from, n);
}

static struct converter *converter_of(struct separate *s, int sensor, int component)
{
	return &s->converter[components(s) * sensor + component];
}

enum separate_status separate_check_alive(const struct separate *s)
{
	const struct converter *c = s->converter;

	if (s->counters.samples < (double)s->par.learn && !s->ended)
		return SEPARATE_OK;
	for (int sensor = 0; sensor < 2; sensor++, c += components(s))
		if (converter_is_constant(c) &&
			converter_is_constant(c + components(s) - 1))
			return sensor ? SEPARATE_SILENT_2 : SEPARATE_SILENT_1;
	return SEPARATE_OK;
}

/* Samples are tested as the converter gives them, before they are turned.  A sample of a
 * sensor is hidden where one component of it was not measured. */
enum num_status separate_append(struct separate *s, const double *x, size_t n)
{
	enum { BLOCK = 256 };
	double turned[CHANNELS_MAX][BLOCK];
	double along = cos(s->par.angle), across = sin(s->par.angle);
	size_t lost[2][BLOCK], some, from;

	for (; n > 0; n -= some, x += some * (size_t)s->channels) {
		some = n < BLOCK ? n : BLOCK;
		for (int sensor = 0; sensor < 2; sensor++) {
			const double *in = x + components(s) * sensor;

			for (size_t i = 0; i < some; i++, in += s->channels) {
				double one = in[0], two = in[components(s) - 1];

				lost[sensor][i] =
					converter_next(converter_of(s, sensor, 0), &one);
				turned[sensor][i] = one;
				if (!has_quadrature(s))
					continue;
				size_t other =
					converter_next(converter_of(s, sensor, 1), &two);
				lost[sensor][i] =
					other > lost[sensor][i] ? other : lost[sensor][i];
				turned[sensor][i] = along * one + across * two;
				turned[sensor + 2][i] = along * two - across * one;
			}
		}
		from = s->buffer[0].n;
		for (int k = 0; k < s->channels; k++)
			if (buffer_append(&s->buffer[k], turned[k], lost[k % 2], some) !=
				NUM_OK)
				return NUM_MEMORY;
		if (s->calibrated)
			separate_align(s, from);
	}
	return NUM_OK;
}

int separate_saturates(struct separate *s, int sensor, size_t i)
{
	double sign = sign_of(s, sensor), x = sign * s->buffer[sensor].x[i], v, along,
	       across;

	if (!has_quadrature(s))
		return converter_saturates(converter_of(s, sensor, 0), x);
	along = cos(s->par.angle);
	across = sin(s->par.angle);
	v = sign * s->buffer[sensor + 2].x[i];
	return converter_saturates(converter_of(s, sensor, 0), along * x - across * v) ||
	       converter_saturates(converter_of(s, sensor, 1), along * v + across * x);
}

void separate_review(struct separate *s)
{
	for (int sensor = 0; sensor < 2; sensor++)
		for (size_t i = 0; i < s->buffer[sensor].n; i++)
			if (separate_saturates(s, sensor, i))
				buffer_hide(&s->buffer[sensor], i);
}

/* Components that were turned have no limit of their own. */
int separate_find_blurred(struct separate *s, size_t n, double *work)
{
	int found = 0;

	for (int sensor = 0; sensor < 2 && !has_quadrature(s); sensor++)
		found |= converter_find_blurred(converter_of(s, sensor, 0),
			s->buffer[sensor].x, sign_of(s, sensor), s->buffer[sensor].hidden,
			n, work);
	return found;
}
