/* template - the pulse of a record, taken from the record itself */
#include "signal/learn/template.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const unsigned char *const known[2] = { NULL, NULL }; /* all samples are */

enum { N = 40000, PULSES = 24 };

static const double T = 80, TRANSIT = 200;

static double y[2][N];
static double arrival[PULSES], delay[PULSES], size[PULSES];

/* A pulse that is none of sensor.h: two lobes of different height and width. */
static double odd(double s)
{
	return exp(-40 * (s + 0.2) * (s + 0.2)) -
	       0.6 * exp(-15 * (s - 0.25) * (s - 0.25));
}

static double sine(double s)
{
	return fabs(s) < 0.5 ? -sin(2 * acos(-1) * s) : 0;
}

static double drawn(uint64_t index)
{
	return philox_uniform(7, 0, RNG_PARTICLE, index);
}

/* Pulses of both channels in white noise of variance 1, sign times the pulse. */
static void make_record(double (*pulse)(double), double sign)
{
	for (uint64_t i = 0; i < N; i++) {
		double z[2];

		philox_normal2(7, 0, RNG_NOISE, i, z);
		y[0][i] = z[0];
		y[1][i] = z[1];
	}
	for (int k = 0; k < PULSES; k++) {
		arrival[k] = 1500 * (k + 0.5) + 200 * drawn(3 * (uint64_t)k + 0);
		delay[k] = 8 * (drawn(3 * (uint64_t)k + 1) - 0.5);
		size[k] = 20 + 30 * drawn(3 * (uint64_t)k + 2);
		for (int c = 0; c < 2; c++)
			for (int i = 0; i < N; i++)
				y[c][i] += sign * size[k] * (c ? 0.9 : 1) *
					   pulse((i - arrival[k] - c * delay[k]) /
						   (T * (1 + delay[k] / TRANSIT)));
	}
}

/* Adds to all but every sixth pulse another of half to all of its size, within 0.3 to 0.9
 * of a duration: events of two pulses, which differ from each other. */
static void add_second_pulses(double (*pulse)(double))
{
	for (int k = 0; k < PULSES; k++) {
		double later = T * (0.3 + 0.6 * philox_uniform(8, 0, RNG_PARTICLE,
							2 * (uint64_t)k));
		double share = 0.5 + 0.5 * philox_uniform(8, 0, RNG_PARTICLE,
						   2 * (uint64_t)k + 1);

		for (int c = 0; c < 2 && k % 6; c++)
			for (int i = 0; i < N; i++)
				y[c][i] += share * size[k] * (c ? 0.9 : 1) *
					   pulse((i - arrival[k] - later) / T);
	}
}

/* Share of its energy in which a shape differs from sign times a pulse of duration T. */
static double difference(
	const struct template *t, double (*pulse)(double), double sign, double shift)
{
	enum { POINTS = 400 };
	double p[POINTS], xy = 0, xx = 0, yy = 0;

	shape_sample(
		t->shape, POINTS / 2.0 + shift, t->duration, 0, POINTS, p, NULL, NULL);
	for (int i = 0; i < POINTS; i++) {
		double want = sign * pulse((i - POINTS / 2.0) / T);

		xy += p[i] * want;
		xx += p[i] * p[i];
		yy += want * want;
	}
	return xy > 0 ? 1 - xy * xy / (xx * yy) : 1;
}

/* The shift of the arrivals that suits best: a shape has no arrival of its own. */
static double least_difference(
	const struct template *t, double (*pulse)(double), double sign)
{
	double least = 1;

	for (double shift = -20; shift <= 20; shift += 0.05)
		least = fmin(least, difference(t, pulse, sign, shift));
	return least;
}

/* 24 pulses of energy 35^2 T/3 on two channels, some 4 points of the template per
 * parameter after smoothing: the noise in it is below 1e-3 of its energy. */
static const double NOISE = 1e-3;

int main(void)
{
	struct template t;

	make_record(sine, 1);
	ok(template_find(&t, y[0], y[1], known, N, 1.2 * T, TRANSIT, 1, 20, -1) ==
				NUM_OK &&
			t.shape,
		"a pulse is found in a record of sine pulses");
	ok(t.events == PULSES, "all pulses are alike (%d)", t.events);
	ok(t.pulse == PULSE_SINE && !t.reversed && t.left < NOISE,
		"the nearest pulse is the sine (it leaves %.1e)", t.left);
	near(t.duration, T, 0.02 * T, "the duration is that of the pulses");
	for (int k = 0; k < t.events; k++) {
		int i = (int)floor(t.t1[k] / 1500);

		if (fabs(t.t1[k] - arrival[i]) > 0.5 ||
			fabs(t.t2[k] - t.t1[k] - delay[i]) > 0.5 ||
			fabs(t.a[k] / size[i] - 1) > 0.05)
			ok(0, "arrival %d is %g, %g, %g", i, t.t1[k], t.t2[k], t.a[k]);
	}
	near(template_peak(&t, y[0], N), 1, 0.02, "the peak of the record itself is 1");
	template_clear(&t);

	make_record(sine, -1);
	ok(template_find(&t, y[0], y[1], known, N, T, TRANSIT, 1, 20, -1) == NUM_OK &&
			t.shape && t.reversed && least_difference(&t, sine, -1) < NOISE,
		"reversed pulses are found, and are said to be");
	template_clear(&t);

	make_record(odd, 1);
	ok(template_find(&t, y[0], y[1], known, N, 0.8 * T, TRANSIT, 1, 20, -1) ==
				NUM_OK &&
			t.shape,
		"a pulse that is none of the known ones is found");
	ok(t.shape && least_difference(&t, odd, 1) < NOISE, "its shape is right");
	ok(t.left > 0.02, "and is none of the known ones (they leave %.2f)", t.left);
	template_clear(&t);

	/* Of a fifth of that size: the mean alone, smoothed, has noise of 8e-4 of its
	 * energy.  Half of it is where the pulse has no power. */
	make_record(odd, 0.2);
	ok(template_find(&t, y[0], y[1], known, N, T, TRANSIT, 1, 20, -1) == NUM_OK &&
			t.shape && least_difference(&t, odd, 1) < 6e-4,
		"the shape of small pulses is right to half of the noise in their mean");
	template_clear(&t);

	/* One event has 24 times that noise, and its own size tells more or less. */
	make_record(odd, 1);
	ok(template_find(&t, y[0], y[1], known, N, T, TRANSIT, 1, 20, 0) == NUM_OK &&
			t.shape && t.events == 1,
		"the pulse of the clearest event is found");
	ok(t.shape && least_difference(&t, odd, 1) < 24 * NOISE, "its shape is right");
	template_clear(&t);
	ok(template_find(&t, y[0], y[1], known, 1500 * 2, T, TRANSIT, 1, 20, 1) ==
				NUM_OK &&
			t.shape,
		"so is that of the second of two");
	template_clear(&t);
	ok(template_find(&t, y[0], y[1], known, 1500 * 2, T, TRANSIT, 1, 20, 2) ==
				NUM_OK &&
			!t.shape,
		"there is no third one of two");

	/* The mean of four events has six times the noise power of that of 24. */
	make_record(odd, 1);
	add_second_pulses(odd);
	ok(template_find(&t, y[0], y[1], known, N, T, TRANSIT, 1, 20, -1) == NUM_OK &&
			t.shape,
		"a pulse is found of which few stand alone among pairs");
	ok(t.events == PULSES / 6 && !t.signs, "it is the mean of those (%d)", t.events);
	ok(t.shape && least_difference(&t, odd, 1) < 6 * NOISE, "their shape is right");
	template_clear(&t);

	make_record(sine, 0);
	ok(template_find(&t, y[0], y[1], known, N, T, TRANSIT, 1, 20, -1) == NUM_OK &&
			!t.shape && t.events == 0,
		"nothing is found in noise");
	/* Two events are too few, by TEMPLATE_LEAST. */
	make_record(sine, 1);
	ok(template_find(&t, y[0], y[1], known, 1500 * 2, T, TRANSIT, 1, 20, -1) ==
				NUM_OK &&
			!t.shape,
		"two events are too few");
	make_record(sine, 1);
	ok(template_find(&t, y[0], y[1], known, N, 4, TRANSIT, 1, 20, -1) == NUM_OK &&
			!t.shape,
		"pulses of fewer than eight samples are not described");
	template_clear(&t);
	return tap_done();
}
