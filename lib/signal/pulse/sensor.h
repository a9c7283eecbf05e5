/* sensor.h - the voltage a wear particle induces while it is carried through a sensor
 *
 * A particle of diameter d that passes with velocity v gives the pulse
 *
 *	u(t) = A p(s),   s = (t - t0) / T,   T = length / v,   A = kappa v d^3
 *
 * where t0 is the moment the particle is at the centre of the sensor (the zero crossing
 * between the two lobes), the first lobe is positive, max |p| = 1, and length is the way
 * the particle goes in one duration T.  This is (3-1), u = (C v / 2) d(1/l^2)/dx, for
 * three magnetic path lengths l(x); b = 1/l0^2 - 1/lf^2, l0 the path with the particle at
 * the centre and lf the path with the particle far away:
 *
 *	sine     1/l^2 = 1/lf^2 + b (1 + cos(2 pi x / length)) / 2   for |x| < length / 2
 *	gauss    1/l^2 = 1/lf^2 + b exp(-(2 pi x / length)^2 / 2)
 *	lorentz  1/l^2 = 1/lf^2 + b / (1 + (2 pi x / length)^2)
 *
 * The spectra of gauss and lorentz peak at 1 / T; the one sine period peaks at 0.825 / T.
 *
 * Times of the pulse functions are in any one unit; everything else is SI.
 */
#ifndef SIGNAL_SENSOR_H
#define SIGNAL_SENSOR_H

#include <stddef.h>

enum pulse_shape { PULSE_SINE, PULSE_GAUSS, PULSE_LORENTZ, PULSE_SHAPES };

/* Their names, for options: pulse_names[0] is "auto", that of a shape one behind it, the
 * last NULL. */
#define PULSE_WORDS "sine|gauss|lorentz"
extern const char *const pulse_names[PULSE_SHAPES + 2];

/* Half the support in durations: p(s) = 0 for |s| >= reach.  1/2 is exact for sine; the
 * others are cut where |p| has fallen below 1e-17 (gauss) and 8e-7 (lorentz). */
double pulse_reach(enum pulse_shape shape);

/* p(s) and its derivative dp/ds. */
double pulse_value(enum pulse_shape shape, double s);
double pulse_slope(enum pulse_shape shape, double s);

/* The whole numbers t inside the support of a pulse at t0 that lasts T > 0: the first of
 * them is returned, their number goes to *n (0 where there is none). */
long pulse_support(enum pulse_shape shape, double t0, double T, size_t *n);

/* p((t - t0) / T) at t = first, first + 1, ..., first + n - 1, and on request (not NULL)
 * its derivatives by t0 and by T.  Outside the support all are zero.  Equal to
 * pulse_value() to 1e-14 and several times faster. */
void pulse_sample(enum pulse_shape shape, double t0, double T, long first, size_t n,
	double *p, double *by_t0, double *by_T);

/* Peak voltage A = kappa v d^3 and its inverse, the corrected (3-3). */
double sensor_voltage(double kappa, double velocity, double diameter);
double sensor_diameter(double kappa, double velocity, double voltage);
/* Standard error of a diameter d from the relative errors of the voltage and of the
 * transit time and their correlation: d = (voltage time / (kappa spacing))^(1/3). */
double sensor_diameter_error(
	double d, double voltage_error, double time_error, double correlation);

/* A sensor by its coils.  The factor (mu_r - 1) / mu_r of (3-1) is that of a flat
 * particle across the field. */
struct sensor_coil {
	double turns;        /* N, of the measuring coil */
	double field_turns;  /* N_D, of the exciting coil */
	double current;      /* I, A */
	double permeability; /* mu_r of the particle */
	double near_path;    /* l0, m */
	double far_path;     /* lf > l0, m; INFINITY allowed */
	double length;       /* m, as above */
};

double sensor_kappa(const struct sensor_coil *coil, enum pulse_shape shape);

/* Flow in a round pipe; the mean velocity is U = 4 Q / (pi D^2).
 *
 *	plug       v = U
 *	laminar    v = 2 U (1 - (r/R)^2)
 *	turbulent  v = U (n + 1)(2n + 1) / (2 n^2) (1 - r/R)^(1/n)
 */
enum pipe_profile { PIPE_PLUG, PIPE_LAMINAR, PIPE_TURBULENT };

struct pipe {
	double bore; /* D = 2 R, m */
	double flow; /* Q, m3/s */
	enum pipe_profile profile;
	double exponent; /* n of the power law, 7 for smooth pipes at Re = 1e5 */
};

double pipe_mean_velocity(const struct pipe *pipe);
double pipe_velocity(const struct pipe *pipe, double r);
/* Share of the flow that passes inside radius r, from 0 to 1. */
double pipe_flow_share(const struct pipe *pipe, double r);
/* Radius of a particle from a uniform number u in (0, 1).  Particles mixed evenly into
 * the oil pass a section in proportion to the flow, so that the share of the flow inside
 * the radius is u times the share inside rmax (no particle comes nearer to the wall). */
double pipe_position(const struct pipe *pipe, double rmax, double u);

#endif
