/* Pulses, their derivatives, the calibration constant and the pipe against closed forms.
 */
#include "signal/pulse/sensor.h"
#include "tap.h"

static const char *const name[] = { "sine", "gauss", "lorentz" };

/* l(x) as the header states it, to hold (3-1) itself against the pulses. */
static double path(enum pulse_shape shape, double x, const struct sensor_coil *c)
{
	double far = 1 / (c->far_path * c->far_path), xi = 2 * M_PI * x / c->length;
	double b = 1 / (c->near_path * c->near_path) - far, y = 0;

	if (shape == PULSE_SINE)
		y = fabs(xi) < M_PI ? (1 + cos(xi)) / 2 : 0;
	else if (shape == PULSE_GAUSS)
		y = exp(-xi * xi / 2);
	else
		y = 1 / (1 + xi * xi);
	return 1 / sqrt(far + b * y);
}

static void test_shape(enum pulse_shape shape)
{
	double top = 0, worst_slope = 0, odd = 0;

	for (double s = -0.6; s < 0.6; s += 1e-5) {
		double h = 1e-5, p = pulse_value(shape, s);
		double d =
			(pulse_value(shape, s + h) - pulse_value(shape, s - h)) / (2 * h);

		top = tap_max(top, p);
		odd = tap_max(odd, fabs(p + pulse_value(shape, -s)));
		if (fabs(fabs(s) - pulse_reach(shape)) > 2 * h)
			worst_slope =
				tap_max(worst_slope, fabs(d - pulse_slope(shape, s)));
	}
	near(top, 1, 1e-8, "the peak is 1");
	ok(odd == 0, "%s: the pulse is odd in time", name[shape]);
	ok(pulse_value(shape, -0.1) > 0, "%s: the first lobe is positive", name[shape]);
	near(worst_slope, 0, 2e-6, "the slope is the derivative");
	ok(pulse_value(shape, pulse_reach(shape)) == 0 &&
			fabs(pulse_value(shape, pulse_reach(shape) * (1 - 1e-12))) < 1e-6,
		"%s: the part that is cut off is negligible", name[shape]);
}

static void test_sample(enum pulse_shape shape, double t0, double T)
{
	static double p[200000], by_t0[200000], by_T[200000];
	size_t n;
	long first = pulse_support(shape, t0, T, &n);
	double worst = 0, worst_t = 0, worst_T = 0;

	first -= 3;
	n += 6;
	pulse_sample(shape, t0, T, first, n, p, by_t0, by_T);
	for (size_t i = 0; i < n; i++) {
		double s = ((double)(first + (long)i) - t0) / T;

		worst = tap_max(worst, fabs(p[i] - pulse_value(shape, s)));
		worst_t = tap_max(worst_t, fabs(by_t0[i] * T + pulse_slope(shape, s)));
		worst_T = tap_max(worst_T, fabs(by_T[i] * T + s * pulse_slope(shape, s)));
	}
	ok(worst < 1e-14 && worst_t < 1e-13 && worst_T < 1e-13,
		"%s: sampled values and derivatives at t0 = %g, T = %g are right (%.1g %.1g %.1g)",
		name[shape], t0, T, worst, worst_t, worst_T);
	ok(p[0] == 0 && p[n - 1] == 0, "%s: the support holds the whole pulse",
		name[shape]);
}

static void test_equation(enum pulse_shape shape)
{
	struct sensor_coil c = { 200, 150, 0.3, 2000, 5e-3, 9e-3, 0.1273 };
	double v = 12.7324, d = 80e-6, h = 1e-6, worst = 0;
	double volume = M_PI * d * d * d / 6, mu0 = 1.25663706212e-6;
	double gain = -2 * c.turns * c.field_turns * c.current * volume * mu0 *
		      (c.permeability - 1) / c.permeability * v;
	double peak = sensor_voltage(sensor_kappa(&c, shape), v, d);

	for (double x = -0.06; x < 0.06; x += 1e-4) {
		double l = path(shape, x, &c);
		double slope =
			(path(shape, x + h, &c) - path(shape, x - h, &c)) / (2 * h);
		double u = gain * slope / (l * l * l);

		worst = tap_max(worst, fabs(u / peak - pulse_value(shape, x / c.length)));
	}
	ok(worst < 1e-6, "%s: the pulse is (3-1) with the stated l(x) (%.1g)",
		name[shape], worst);
	near(sensor_diameter(sensor_kappa(&c, shape), v, peak) / d, 1, 1e-14,
		"the diameter follows from the voltage");
}

static void test_diameter_error(void)
{
	double d = sensor_diameter(1e11, 12, 0.7), ra = 3e-6, rt = 5e-6;

	/* Errors that always come together move d as the formula moves it. */
	near(sensor_diameter_error(d, ra, rt, 1),
		sensor_diameter(1e11, 12 / (1 + rt), 0.7 * (1 + ra)) - d, 1e-5 * d * rt,
		"the error of the diameter is right where voltage and time err together");
	near(sensor_diameter_error(d, ra, rt, -1),
		sensor_diameter(1e11, 12 / (1 + rt), 0.7 * (1 - ra)) - d, 1e-5 * d * rt,
		"the error of the diameter is right for opposite errors");
}

static void test_pipe(enum pipe_profile profile, double top)
{
	struct pipe pipe = { 0.01, 1e-3, profile, 7 };
	double mean = pipe_mean_velocity(&pipe), sum = 0, worst = 0;
	int n = 200000;

	near(mean, 12.732395447351628, 1e-12,
		"60 L/min in a pipe of 1 cm flow at 12.73 m/s");
	near(pipe_velocity(&pipe, 0) / mean, top, 1e-12,
		"the velocity on the axis over the mean is right");
	/* the flow is the integral of the velocity; substitution for the steep wall */
	for (int i = 0; i < n; i++) {
		double y = pow((i + 0.5) / n, 3), r = 0.005 * (1 - y);

		sum += pipe_velocity(&pipe, r) * 2 * M_PI * r * 0.005 * 3 *
		       pow((i + 0.5) / n, 2) / n;
	}
	near(sum / 1e-3, 1, 1e-8, "the profile carries the flow");
	near(pipe_flow_share(&pipe, 0.005), 1, 1e-15,
		"all of the flow is inside the pipe");
	for (double u = 0.01; u < 1; u += 0.01) {
		double r = pipe_position(&pipe, 0.00495, u), h = 1e-8;
		double slope =
			(pipe_flow_share(&pipe, r + h) - pipe_flow_share(&pipe, r - h)) /
			(2 * h);

		worst = tap_max(worst,
			fabs(pipe_flow_share(&pipe, r) / pipe_flow_share(&pipe, 0.00495) -
				u));
		worst = tap_max(worst,
			fabs(slope * 1e-3 / (2 * M_PI * r * pipe_velocity(&pipe, r)) -
				1) *
				1e-6);
	}
	ok(worst < 1e-12, "drawn positions follow the flow (%.1g)", worst);
}

int main(void)
{
	for (enum pulse_shape shape = PULSE_SINE; shape <= PULSE_LORENTZ; shape++) {
		test_shape(shape);
		test_sample(shape, 512.25, 100);
		test_sample(shape, -3.5, 7.3);
		test_sample(shape, 1e6 + 1.0 / 3, 3000);
		test_sample(shape, 5.4, 0.01);
		test_equation(shape);
	}
	test_diameter_error();
	test_pipe(PIPE_PLUG, 1);
	test_pipe(PIPE_LAMINAR, 2);
	test_pipe(PIPE_TURBULENT, 60.0 / 49);
	return tap_done();
}
