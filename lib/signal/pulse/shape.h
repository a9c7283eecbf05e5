/* shape.h - a pulse shape as a table, for fits that sample it millions of times
 *
 * The pulse p(s) of duration 1 is stored with its slope on a fine grid and read with
 * cubic Hermite polynomials (error below 1e-8 for the smooth pulses of sensor.h).
 * A pulse at t0 that lasts T is p((t - t0) / T); all times are in samples here.
 */
#ifndef SIGNAL_SHAPE_H
#define SIGNAL_SHAPE_H

#include "signal/pulse/sensor.h"
#include <stddef.h>

struct shape;

/* One of the pulses of sensor.h, cut where |p| stays below 1e-4.  NULL: no memory. */
struct shape *shape_new(enum pulse_shape pulse);

/* Samples of a duration below which a pulse is not learned: they do not describe it. */
enum { SHAPE_SHORTEST = 8 };

/* Frequency, in cycles per duration, above which pulses have little power, and half of
 * its period, in durations: what changes within less is no pulse. */
#define SHAPE_BAND 10.0
#define SHAPE_FINEST (0.5 / SHAPE_BAND)

/* Any other pulse: value[0 .. 2 half] at s = -reach .. reach in equal steps, smooth
 * between them (slopes by central differences); it is scaled to max |p| = 1.  NULL
 * with errno EDOM (half < 2, reach <= 0, a value not finite, all zero) or ENOMEM. */
struct shape *shape_from_values(const double *value, int half, double reach);
/* A pulse of duration T filtered by symmetric taps -half .. half, cut
 * where it stays below 2e-3 of its peak; its peak is no longer 1.  NULL: no memory. */
struct shape *shape_filter(
	const struct shape *shape, double T, const double *tap, int half);
/* The pulse with more[k] added at s = k step, -half <= k <= half, and linearly between;
 * it reaches that far at least.  NULL: no memory. */
struct shape *shape_correct(
	const struct shape *shape, const double *more, int half, double step);
/* Multiplies all values. */
void shape_scale(struct shape *shape, double factor);
/* From what shape_cells() and shape_cubic() tell of another; NULL: no memory, or
 * cells < 1 or reach <= 0. */
struct shape *shape_from_cubic(double reach, int cells, const double *cubic);
void shape_free(struct shape *shape);

/* Cells of the grid, and four coefficients of each. */
int shape_cells(const struct shape *shape);
const double *shape_cubic(const struct shape *shape);

double shape_reach(const struct shape *shape); /* p(s) = 0 for |s| >= reach */
/* Least grid point from which on |p| stays below level. */
double shape_reach_above(const struct shape *shape, double level);
/* Integrals of p^2, p^4 and p'^2 over s. */
double shape_energy(const struct shape *shape);
double shape_fourth(const struct shape *shape);
double shape_slope_energy(const struct shape *shape);

/* The whole t inside the support: returns the first, their number in *n. */
long shape_support(const struct shape *shape, double t0, double T, size_t *n);

/* Samples from point to point of a matched filter: its phase then changes by half a turn
 * between them at no frequency that the pulse has. */
static inline long shape_stride(double T)
{
	return T >= 48 ? (long)(T / 24) : 1;
}

/* p((t - t0) / T) at t = first .. first + n - 1, and where not NULL its derivatives by
 * t0 and T.  Zero outside the support. */
void shape_sample(const struct shape *shape, double t0, double T, long first, size_t n,
	double *p, double *by_t0, double *by_T);

#endif
