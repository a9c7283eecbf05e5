/* metrics.h - accuracy of predictions of remaining life, given the true end of life
 *
 * A prediction made at time t is a set of samples of the remaining life, a point and an
 * interval.  With the true end of life T the truth is r = T - t.  Any unit of time, the
 * same one throughout.
 *
 *	struct metrics m = { .eol = 1186, .alpha = 0.2 };
 *	metrics_add(&m, t, mean, q05, q95, sample, n, NULL);
 *	struct metrics mean = metrics_get(&m);
 *
 * Definitions follow Saxena, Celaya, Saha, Saha, Goebel, "Metrics for offline
 * evaluation of prognostic performance", IJPHM 1 (2010), with accuracies relative
 * to the remaining life (relative to the end of life they flatter early
 * predictions), and Gneiting, Raftery, JASA 102 (2007) for the CRPS.
 */
#ifndef LIFE_METRICS_H
#define LIFE_METRICS_H

#include "num/status.h"
#include <stddef.h>

/* Sets the samples beyond the horizon to INFINITY, and sorts. */
void metric_cut(double *sample, size_t n, double horizon);
/* Mean of the finite ones of ascending samples, NAN without any; *failed: their number.
 */
double metric_mean(const double *sorted, size_t n, size_t *failed);

/* Continuous ranked probability score, the integral of (F(x) - [x >= truth])^2 over
 * x <= limit: 0 is perfect, |error| for a single sample.  sorted: n >= 1 ascending
 * samples.  Samples may be INFINITY, which needs a finite limit for a finite score. */
double metric_crps(const double *sorted, size_t n, double truth, double limit);

/* One prediction. */
struct metrics_row {
	double truth;    /* eol - t */
	double error;    /* point - truth; > 0 is late */
	double accuracy; /* relative accuracy 1 - |error| / truth, at most 1 */
	double mass;     /* probability within (1 +- alpha) truth */
	int inside;      /* alpha-lambda test: mass >= 1/2 */
	int covered;     /* lower <= truth <= upper */
	double crps;
};

/* All predictions made before the end of life: sums while they are added, all 0 at first
 * but eol, alpha and limit; what metrics_get() returns are the means. */
struct metrics {
	double eol;   /* true end of life, on the axis of t */
	double alpha; /* half-width of the accuracy cone, share > 0: 0.2 */
	double limit; /* upper end of the CRPS integral; 0: none */
	size_t n;
	size_t infinite; /* those whose point is INFINITY, left out of the next four */
	double bias, mae, rmse; /* mean error, mean |error|, root mean square error */
	double accuracy;        /* cumulative relative accuracy: mean of accuracy */
	double alpha_lambda;    /* share of predictions inside the cone */
	double horizon;         /* prognostic horizon: eol - t of the first prediction
				 * from which on all have probability >= 1/2 within
				 * truth +- alpha eol; 0 if the last one does not */
	double coverage;        /* share of intervals that contain the truth */
	double crps;
};

/* Adds the prediction made at t, n >= 1 ascending samples; times must not decrease.  row
 * may be NULL.
 * An infinite point (a median where most samples never fail) has no error that could be
 * averaged: it is counted separately and scored by its samples and interval.  NUM_DOMAIN
 * when t >= eol or the point is NAN: nothing is counted. */
enum num_status metrics_add(struct metrics *m, double t, double point, double lower,
	double upper, const double *sample, size_t n, struct metrics_row *row);
struct metrics metrics_get(const struct metrics *m); /* NAN where there were none */

#endif
