/* The pulse of a record whose pulses overlap throughout, from its spectrum */
#include "signal/learn/crowd.h"
#include "num/philox.h"
#include "signal/learn/calibration.h"
#include "signal/learn/learn.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { N = 40000, HOP = 8192 };

/* rate pulses per duration, noise 1, amplitudes uniform in 20 .. 60, arrivals at random.
 */
static void make_record(enum pulse_shape pulse, double duration, double rate,
	uint32_t realisation, double *y1, double *y2)
{
	struct shape *shape = shape_new(pulse);
	double *p = malloc(N * sizeof *p), z[2];

	memset(y1, 0, N * sizeof *y1);
	memset(y2, 0, N * sizeof *y2);
	for (uint64_t k = 0; k < (uint64_t)(rate * N / duration); k++) {
		double t = N * philox_uniform(7, realisation, RNG_PARTICLE, 2 * k);
		double a =
			20 + 40 * philox_uniform(7, realisation, RNG_PARTICLE, 2 * k + 1);

		shape_sample(shape, t, duration, 0, N, p, NULL, NULL);
		for (int i = 0; i < N; i++) {
			y1[i] += a * p[i];
			y2[i] += 0.9 * a * p[i];
		}
	}
	for (int i = 0; i < N; i++) {
		philox_normal2(7, realisation, RNG_NOISE, (uint64_t)i, z);
		y1[i] += z[0];
		y2[i] += z[1];
	}
	free(p);
	shape_free(shape);
}

/* An offset that follows its errors of twice the noise at every hop, in straight lines.
 */
static void add_offset(double *y, uint32_t realisation)
{
	double knot[N / HOP + 2], z[2];

	for (int k = 0; k < N / HOP + 2; k++) {
		philox_normal2(8, realisation, RNG_NOISE, (uint64_t)k, z);
		knot[k] = 2 * z[0];
	}
	for (int i = 0; i < N; i++) {
		double x = (double)(i % HOP) / HOP;

		y[i] += (1 - x) * knot[i / HOP] + x * knot[i / HOP + 1];
	}
}

/* A pulse that was taken from a crowd by mistake does not describe it. */
static void test_wrong_template(const double *y1, const double *y2)
{
	struct calibrate_par par = { .duration = NAN,
		.gain = NAN,
		.spread = NAN,
		.pulse = CALIBRATE_ANY_PULSE,
		.false_alarm = 1e-9,
		.most = INFINITY };
	struct calibration c = { .shape = shape_new(PULSE_SINE),
		.duration = 124,
		.gain = 0.9,
		.width = 1,
		.noise = { 1, 1 },
		.transit = 200,
		.delta_min = -10,
		.delta_max = 10,
		.threshold = 40,
		.threshold_near = 23 };
	struct template found = { .shape = shape_new(PULSE_GAUSS),
		.duration = 140,
		.events = TEMPLATE_LEAST,
		.pulse = PULSE_GAUSS };

	ok(learn_pulse(&par, y1, y2, N / 4, 62, &found, &c) == SEPARATE_OK &&
			c.pulse == PULSE_SINE && !c.measured,
		"a pulse that does not describe the record gives way to a known one");
	near(c.duration, 93, 2, "and its duration is near that of the crowd");
	template_clear(&found);
	calibration_clear(&c);
}

int main(void)
{
	static const char *const name[] = { "sine", "gauss", "lorentz" };
	static double y1[N], y2[N];

	/* The guess is wrong by a third.  The spectrum of the sine has zeros, which
	 * determine its duration to one in a thousand; those of the others are smooth and
	 * determine it to one in two hundred. */
	for (int k = PULSE_SINE; k <= PULSE_LORENTZ; k++)
		for (int many = 0; many < 2; many++) {
			int pulse = CALIBRATE_ANY_PULSE;
			double T = NAN, error = 0;

			make_record((enum pulse_shape)k, 93, many ? 6 : 2,
				(uint32_t)(2 * k + many), y1, y2);
			ok(crowd_pulse(y1, y2, N, HOP, 124, &pulse, &T, &error) ==
						NUM_OK &&
					pulse == k,
				"the shape of %s pulses is found where %d overlap",
				name[k], many ? 6 : 2);
			near(T, 93, k == PULSE_SINE ? 0.1 : 0.5, "and their duration");
			if (k == PULSE_SINE && !many)
				test_wrong_template(y1, y2);
		}
	for (int k = PULSE_SINE; k <= PULSE_LORENTZ; k++) {
		int pulse = CALIBRATE_ANY_PULSE;
		double T = NAN, error = 0;

		make_record((enum pulse_shape)k, 93, 3, (uint32_t)(10 + k), y1, y2);
		add_offset(y1, 1);
		add_offset(y2, 2);
		ok(crowd_pulse(y1, y2, N, HOP, 124, &pulse, &T, &error) == NUM_OK &&
				pulse == k,
			"and of %s pulses whose offset is not known", name[k]);
		near(T, 93, 5 * error * T,
			"within five standard errors of their duration");
		ok(error < 0.01, "which are below one in a hundred");
	}
	{
		int pulse = PULSE_GAUSS;
		double T = 77, error;

		ok(crowd_pulse(y1, y2, N, HOP, 124, &pulse, &T, &error) == NUM_OK &&
				pulse == PULSE_GAUSS && T == 77,
			"what is known is kept");
	}
	return tap_done();
}
