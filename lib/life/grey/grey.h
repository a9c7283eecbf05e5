/* grey.h - the grey model GM(1,1), fitted backward from the newest point
 *
 * With x1 the running integral of a positive series x, dx1/dt + a x1 = b is fitted by
 * least squares, x_k = -a z_k + b with z_k the mean of x1 over the last interval (Deng
 * 1982; Li's thesis, eq. 4-23 to 4-25 with x^(0) on the right-hand side).  Points are
 * taken newest first: with T the integral of all newer points, z = W - T - x dt / 2, so
 * x regresses on u = T + x dt / 2 with slope a, and the total W drops out.  Adding one
 * older point is one update of centred (Welford) sums, so every order up to P costs
 * O(P) in all, no prefix sum grows with the stream, and nothing is divided by a.
 *
 * Time is in steps (any unit); the integral takes unequal gaps into account.  The oldest
 * point of a window starts the first interval; its own value is not used.
 *
 *	struct grey g = { 0 };
 *	for (int k = n; k-- > 0;)
 *		grey_add(&g, x[k], 1);
 *	next = grey_forecast(&g, 1, 1);
 */
#ifndef LIFE_GREY_H
#define LIFE_GREY_H

#include "num/lanes.h"
#include "num/running.h"

enum { GREY_ORDER_MIN = 4 }; /* fewest points of a fit */

/* Zero it to start. */
struct grey {
	long n;                /* points taken */
	double oldest;         /* the last one taken */
	double span;           /* steps from it to the newest */
	double tail;           /* integral of the points newer than it */
	struct regression fit; /* of x on u over the n - 1 intervals */
};

/* Takes the next older point, gap steps before the one taken last (the gap of the
 * newest point is not used). */
void grey_add(struct grey *g, double x, double gap);

/* The same model of a whole series, oldest point first: a point costs the same at any
 * length.  Zero it to start. */
struct grey_series {
	struct grey forward; /* its fit is of x on the integral up to mid-interval */
	double scale, unit;  /* powers of two, in which the sums are: near the first value
			      * but 0, and near the first gap */
};
/* The power of two next to |x|, at which its square neither overflows nor underflows. */
double grey_scale(double x);
/* gap: since the point before; that of the first point is not used. */
void grey_append(struct grey_series *s, double x, double gap);
/* In its scale and unit. */
struct grey grey_of(const struct grey_series *s);
/* Time from the last point until the curve of the fit, with rate and level so many
 * standard errors away, reaches a limit in this direction (+1 from below): 0 if it is
 * beyond it; INFINITY: never, also where it would have to change its sign; NAN below four
 * points. */
double grey_life(const struct grey_series *s, double limit, int direction, double rate_z,
	double level_z);

/* Development coefficient a, 1/step (negative: growing), and the level c = b - a x1 at
 * the time of the oldest point, so that x(t) = c exp(-a t).  a = 0 below three points,
 * for a zero series, beyond grey_rate_limit(), and where values over 1e150 (scale them)
 * make squares overflow. */
double grey_rate(const struct grey *g);
double grey_level(const struct grey *g);
/* Mean squared residual of the fit; 0 below four points. */
double grey_residual(const struct grey *g);

/* Forecast of the point h steps after the newest: the mean over the last gap of these
 * steps (h = gap = 1: the next point of an evenly spaced series).  Finite for finite
 * input. */
double grey_forecast(const struct grey *g, double h, double gap);

/* Largest a of a fit over n intervals of this length in all: in x_k (1 + a / 2) = b - a
 * x1_{k-1}, the model per interval, the factor is above 0 for a > -2, and backward in
 * time for a < 2 (Liu, Lin, Grey Information, Springer 2006).  A series that passes
 * through 0 is no exponential and would have any a. */
static inline double grey_rate_limit(double n, double span)
{
	return 2 * n / span;
}

/* Largest ratio of a forecast, h after the newest point, to the value of the fit there
 * that rates up to a limit allow, and one more interval as a tolerance.  Beyond, the
 * curve in time from the oldest point on has nothing to do with the points. */
static inline double grey_reach(double limit, double h)
{
	return exp(fmin(600, 2 + limit * h));
}

static inline lanes grey_limit(lanes x)
{
	return lanes_max(lanes_all(-300), lanes_min(lanes_all(300), x));
}

/* The mean of level exp(-rate t) over the gap that ends at t, of two models: what
 * grey_forecast() makes of the fitted level and rate at t = span + h.  It is level
 * exp(-rate middle) sinh(x) / x with x = rate gap / 2, near 0 by the series of powers of
 * x^2 with coefficients 1, 1 / 3!, 1 / 5!, ..., whose first omitted term is x^10 / 11!.
 * Exponents are limited: the results stay finite, and such growth is beyond any
 * threshold. */
static inline lanes grey_curve(lanes level, lanes rate, double t, double gap)
{
	lanes x = grey_limit(0.5 * gap * rate), xx = x * x, mean;
	lane_mask far = xx > 0.01;

	mean = 1 +
	       xx * (1. / 6 + xx * (1. / 120 + xx * (1. / 5040 + xx * (1. / 362880))));
	if (far[0] | far[1])
		mean = lanes_pick(far, 0.5 * (lanes_exp(x) - lanes_exp(-x)) / x, mean);
	return level * mean * lanes_exp(grey_limit(-rate * (t - 0.5 * gap)));
}

#endif
