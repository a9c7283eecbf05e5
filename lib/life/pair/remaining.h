/* remaining.h - time left until worn volume or particle sizes reach their thresholds
 *
 * Remaining wear life at time t is the lesser of (Li's thesis, eq. 4-26 and 4-27, with
 * signs and indices set right)
 *
 *	(Va - V(t)) / Vdot        total volume,
 *	Ts - t                    Ts: large particles reach their critical share,
 *
 * and Va - V(t) = A (H - h(t)) for a gap that opens evenly (4-31).  Any unit of time
 * and volume, the same ones throughout.  0: the threshold is reached; INFINITY: never.
 */
#ifndef LIFE_REMAINING_H
#define LIFE_REMAINING_H

#include <gsl/gsl_rng.h>
#include <stddef.h>

/* Time to wear volume left at a constant rate (4-29); never for rate <= 0. */
double remaining_constant(double left, double rate);

/* The same where the rate changes from step to step about its mean (4-28): first
 * passage of a gamma process, whose increments over one unit of time have the given
 * mean and variance and are never negative (van Noortwijk, Reliab. Eng. Syst. Saf. 94,
 * 2009).  Exact in distribution to a relative 1e-6, at a cost independent of the number
 * of steps: the path is doubled until it is past, then bisected by beta bridges. */
double remaining_gamma(double left, double mean, double variance, gsl_rng *rng);

/* Time from t to the end of step (from 1, each of length step_time, the first from
 * time 0) in which large particles become too many; never for step < 1. */
double remaining_large(long step, double step_time, double t);

/* A gamma variate of given mean and variance; the mean where the variance is 0. */
double remaining_draw_rate(double mean, double variance, gsl_rng *rng);

struct remaining_summary {
	double mean; /* of the samples that fail by the horizon; NAN if none does */
	double p_no_failure; /* share of the others */
};

/* Sorts the samples, sets those beyond the horizon to INFINITY, and sums up. */
struct remaining_summary remaining_sum_up(double *sample, size_t n, double horizon);

#endif
