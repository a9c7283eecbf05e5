/* sensor.c - pulses of an inductive sensor and the flow that carries the particles */
#include "signal/pulse/sensor.h"
#include <math.h>

static const double vacuum_permeability = 1.25663706212e-6; /* V s/(A m), CODATA 2018 */

/* Samples between fresh starts of a recurrence, so that rounding does not build up. */
enum { RESTART = 8 };

const char *const pulse_names[PULSE_SHAPES + 2] = { "auto", "sine", "gauss", "lorentz" };

/* Value and slope of the pulses at xi = 2 pi s; slope by xi. */
static double sine_at(double xi, double *slope)
{
	*slope = -cos(xi);
	return -sin(xi);
}

static double gauss_at(double xi, double *slope)
{
	double e = exp(0.5 - 0.5 * xi * xi);

	*slope = (xi * xi - 1) * e;
	return -xi * e;
}

static double lorentz_at(double xi, double *slope)
{
	const double peak = 16 / (3 * sqrt(3)); /* 1 / max of xi / (1 + xi^2)^2 */
	double q = 1 / (1 + xi * xi), q2 = q * q;

	*slope = peak * (3 * xi * xi - 1) * q2 * q;
	return -peak * xi * q2;
}

static const struct {
	double reach;
	/* max |l'/l^3| = max |d(1/l^2)/dx| / 2, times length over (1/l0^2 - 1/lf^2) */
	double peak_of_path;
	double (*at)(double xi, double *slope);
} forms[PULSE_SHAPES] = {
	[PULSE_SINE] = { 0.5, M_PI / 2, sine_at },
	[PULSE_GAUSS] = { 1.5, M_PI * 0.60653065971263342, gauss_at }, /* exp(-1/2) */
	[PULSE_LORENTZ] = { 25, 2 * M_PI * 3 * 1.7320508075688772 / 16, lorentz_at },
};

double pulse_reach(enum pulse_shape shape)
{
	return forms[shape].reach;
}

static double pulse_at(enum pulse_shape shape, double s, double *slope)
{
	double p;

	*slope = 0;
	if (!(fabs(s) < pulse_reach(shape)))
		return 0;
	p = forms[shape].at(2 * M_PI * s, slope);
	*slope *= 2 * M_PI;
	return p;
}

double pulse_value(enum pulse_shape shape, double s)
{
	double slope;

	return pulse_at(shape, s, &slope);
}

double pulse_slope(enum pulse_shape shape, double s)
{
	double slope;

	pulse_at(shape, s, &slope);
	return slope;
}

long pulse_support(enum pulse_shape shape, double t0, double T, size_t *n)
{
	double half = pulse_reach(shape) * T;
	double first = ceil(t0 - half), last = floor(t0 + half);

	*n = last >= first ? (size_t)(last - first) + 1 : 0;
	return (long)first;
}

/* Fills value and slope (by s) for n <= RESTART samples s, s + ds, ... inside the
 * support. */
static void fill_run(enum pulse_shape shape, double s, double ds, size_t n, double *value,
	double *slope)
{
	double xi = 2 * M_PI * s, dxi = 2 * M_PI * ds;

	if (shape == PULSE_SINE) {
		double c = cos(xi), z = sin(xi), dc = cos(dxi), dz = sin(dxi);

		for (size_t i = 0; i < n; i++) {
			double next = c * dc - z * dz;

			value[i] = -z;
			slope[i] = -2 * M_PI * c;
			z = z * dc + c * dz;
			c = next;
		}
	} else if (shape == PULSE_GAUSS) {
		/* exp of a quadratic: the ratio of neighbours is geometric */
		double e = exp(0.5 - 0.5 * xi * xi), ratio = exp(-dxi * (xi + 0.5 * dxi));
		double change = exp(-dxi * dxi);

		for (size_t i = 0; i < n; i++) {
			double x = xi + (double)i * dxi;

			value[i] = -x * e;
			slope[i] = 2 * M_PI * (x * x - 1) * e;
			e *= ratio;
			ratio *= change;
		}
	} else {
		for (size_t i = 0; i < n; i++) {
			value[i] = forms[shape].at(xi + (double)i * dxi, &slope[i]);
			slope[i] *= 2 * M_PI;
		}
	}
}

void pulse_sample(enum pulse_shape shape, double t0, double T, long first, size_t n,
	double *p, double *by_t0, double *by_T)
{
	double reach = pulse_reach(shape), ds = 1 / T;
	double value[RESTART], slope[RESTART];

	for (size_t begin = 0; begin < n; begin += RESTART) {
		size_t m = n - begin < RESTART ? n - begin : RESTART;
		double tau = (double)(first + (long)begin) - t0, s = tau / T;

		fill_run(shape, s, ds, m, value, slope);
		for (size_t i = 0; i < m; i++) {
			double si = (tau + (double)i) / T;
			int inside = fabs(si) < reach;

			p[begin + i] = inside ? value[i] : 0;
			if (by_t0)
				by_t0[begin + i] = inside ? -slope[i] * ds : 0;
			if (by_T)
				by_T[begin + i] = inside ? -slope[i] * si * ds : 0;
		}
	}
}

double sensor_voltage(double kappa, double velocity, double diameter)
{
	return kappa * velocity * diameter * diameter * diameter;
}

double sensor_diameter(double kappa, double velocity, double voltage)
{
	return cbrt(voltage / (kappa * velocity));
}

double sensor_diameter_error(
	double d, double voltage_error, double time_error, double correlation)
{
	double ra = voltage_error, rt = time_error;

	return d / 3 * sqrt(ra * ra + rt * rt + 2 * correlation * ra * rt);
}

double sensor_kappa(const struct sensor_coil *coil, enum pulse_shape shape)
{
	double path = 1 / (coil->near_path * coil->near_path) -
		      1 / (coil->far_path * coil->far_path);
	double mu = vacuum_permeability * (coil->permeability - 1) / coil->permeability;

	/* (3-1) at the peak, over v d^3; volume = pi d^3 / 6 */
	return 2 * coil->turns * coil->field_turns * coil->current * mu * (M_PI / 6) *
	       forms[shape].peak_of_path * path / coil->length;
}

double pipe_mean_velocity(const struct pipe *pipe)
{
	return 4 * pipe->flow / (M_PI * pipe->bore * pipe->bore);
}

double pipe_velocity(const struct pipe *pipe, double r)
{
	double mean = pipe_mean_velocity(pipe), z = 2 * r / pipe->bore,
	       n = pipe->exponent;

	switch (pipe->profile) {
	case PIPE_LAMINAR:
		return 2 * mean * (1 - z * z);
	case PIPE_TURBULENT:
		return mean * (n + 1) * (2 * n + 1) / (2 * n * n) * pow(1 - z, 1 / n);
	default:
		return mean;
	}
}

double pipe_flow_share(const struct pipe *pipe, double r)
{
	double z = 2 * r / pipe->bore, y = 1 - z, n = pipe->exponent;

	switch (pipe->profile) {
	case PIPE_LAMINAR:
		return z * z * (2 - z * z);
	case PIPE_TURBULENT:
		return 1 - pow(y, 1 + 1 / n) * (2 * n + 1 - (n + 1) * y) / n;
	default:
		return z * z;
	}
}

double pipe_position(const struct pipe *pipe, double rmax, double u)
{
	double target = u * pipe_flow_share(pipe, rmax), lo = 0, hi = rmax;

	/* bisection: the share grows with r, and 60 halvings use up a double */
	for (int i = 0; i < 60 && lo < hi; i++) {
		double mid = 0.5 * (lo + hi);

		if (pipe_flow_share(pipe, mid) < target)
			lo = mid;
		else
			hi = mid;
	}
	return 0.5 * (lo + hi);
}
