/* adaptive.h - the adaptive-order particle filter of a degradation series
 *
 * Li, Wang, Shi, Ma, Chinese Journal of Aeronautics 31 (2018) 941; Li's thesis, 4.1.3:
 * each particle carries its own past, a grey model of the chosen order is fitted to the
 * past of each and predicts its next state, and the observation weights them.  Departures
 * from the publication that keep the filter from diverging: histories are genealogies,
 * the process noise is no less than the observation noise and than the recent errors of
 * the grey model, and the particles are restarted from the observations when their mean
 * is far from one.  A single observation whose error is ten times the usual one is
 * skipped.
 *
 *	struct adaptive *a = adaptive_new(&par);
 *	while (read(&t, &y)) {       (y may be NAN: predict only)
 *		adaptive_step(a, t, y, &row);
 *		print(row.state);
 *	}
 */
#ifndef LIFE_ADAPTIVE_H
#define LIFE_ADAPTIVE_H

#include "life/grey/order.h"
#include "life/particle/filter.h"
#include "num/status.h"

struct adaptive_par {
	struct filter_par filter; /* depth is set from the order */
	struct order_par order;
	double process; /* sigma_u; NAN: from the forecast errors */
	double noise;   /* sigma_v; NAN: from second differences */
	uint64_t seed;
	uint32_t realisation;
};

struct adaptive_row {
	double grey;       /* forecast of this observation by the grey model of the
			    * observations before it; NAN at the first */
	double prediction; /* forecast by the filter */
	double state;      /* weighted mean after the observation, if there was one */
	double ess;        /* effective sample size before resampling */
	int order;         /* of the model that made prediction; 0: none yet */
};

struct adaptive;

struct adaptive *adaptive_new(const struct adaptive_par *par); /* NULL: no memory */
void adaptive_free(struct adaptive *a);
void adaptive_pass(struct adaptive *a, struct state *s);
/* Takes the next row; t must rise.  y is finite or NAN. */
void adaptive_step(struct adaptive *a, double t, double y, struct adaptive_row *row);
/* The literal recursion (4-21): every particle continues step by step by its own model,
 * refitted to its last states, with process noise, at the mean gap of the rows.  Fills
 * life[N] with the time from the last row to its first passage of the threshold (linear
 * within a step), INFINITY beyond 1000 steps.  NUM_DOMAIN: no model yet. */
enum num_status adaptive_lives(
	struct adaptive *a, double threshold, int direction, double *life);
/* Events so far; outliers are skipped. */
struct adaptive_counts {
	unsigned long resamplings, outliers, restarts;
	struct order_counts order;
};
struct adaptive_counts adaptive_counts(const struct adaptive *a);

#endif
