/* predict.h - when a degradation series will first reach its threshold
 *
 * A long-term model is fitted to the series so far and carried on to the threshold; the
 * distribution of the time left comes from draws of its parameters (the same normal
 * deviates at every row, so that successive rows differ by their data alone).  Mass that
 * does not get there before the horizon is reported as such.  Where there is a fleet of
 * earlier units to compare with, it has the word instead of the model.
 *
 *	struct predict *p = predict_new(&par);
 *	predict_add(p, t, y, state);
 *	predict_life(p, level, quantile, 3, &never);
 */
#ifndef LIFE_PREDICT_H
#define LIFE_PREDICT_H

#include "life/adaptive.h"
#include "life/fleet.h"
#include <stdint.h>

enum predict_model {
	PREDICT_AVERAGE, /* all damage-rate models, see damage.h */
	PREDICT_LINEAR,  /* one family of them */
	PREDICT_EXPONENTIAL,
	PREDICT_POWER,
	PREDICT_RATE,
	PREDICT_GREY,   /* GM(1,1) through all filtered states */
	PREDICT_LITERAL /* particles go on step by step, see adaptive_lives() */
};

struct predict_par {
	enum predict_model model;
	double threshold;
	int direction;  /* +1: failed at or above the threshold, -1: at or below */
	double zero;    /* of the grey model */
	double horizon; /* longest time ahead; 0: ten times the time elapsed, or any
			 * with a fleet */
	const struct fleet *fleet; /* of earlier units, the caller\'s; NULL: none */
	struct adaptive *adaptive; /* the filter of the literal model, the caller's */
	int draws;                 /* >= 1 */
	uint64_t seed;
	uint32_t realisation;
};

struct predict;

struct predict *predict_new(const struct predict_par *par); /* NULL: no memory */
void predict_free(struct predict *p);
/* Takes a row: the observation, NAN where it is missing, and the filtered state. */
void predict_add(struct predict *p, double t, double y, double state);
/* Forgets all rows: they were run-in. */
void predict_restart(struct predict *p);
/* Quantiles of the time left from the last row at n ascending levels, INFINITY where
 * that much mass does not cross; NAN below four rows.  The threshold counts as reached
 * once the model stands beyond it: 0 left. */
void predict_life(struct predict *p, const double *level, double *quantile, int n,
	double *no_crossing);

#endif
