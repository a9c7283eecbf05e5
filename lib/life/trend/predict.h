/* predict.h - time at which a degradation series will first reach its threshold
 *
 * A long-term model is fitted to the series so far and extrapolated to the threshold; the
 * distribution of the remaining time comes from draws, with the same random numbers at
 * every row, so that successive rows differ only by their data.  Draws that do not reach
 * it before the horizon are INFINITY.
 *
 *	struct predict *p = predict_new(&par);
 *	predict_add(p, t, y, state);
 *	if (predict_life(p, life) == NUM_OK)
 *		median = metric_quantile(life, n, 0.5);
 */
#ifndef LIFE_PREDICT_H
#define LIFE_PREDICT_H

#include "life/particle/adaptive.h"
#include "life/trend/bank.h"

enum predict_model {
	PREDICT_AVERAGE, /* all coordinates, see bank.h */
	PREDICT_LINEAR,  /* coordinates of one family */
	PREDICT_EXPONENTIAL,
	PREDICT_POWER,
	PREDICT_RATE,
	PREDICT_SATURATING,
	PREDICT_GREY,   /* GM(1,1) through all filtered states */
	PREDICT_LITERAL /* particles continue step by step, see adaptive_lives() */
};

struct predict_par {
	enum predict_model model;
	struct bank_par bank;      /* families and steady are those of the model */
	double zero;               /* of the grey model */
	double horizon;            /* longest time ahead; 0: ten times the time elapsed */
	struct adaptive *adaptive; /* the filter of the literal model, the caller's */
	int draws;                 /* of the literal model: its particles */
	const struct bank_chances *chances; /* of the others, the caller's */
};

struct predict;

struct predict *predict_new(const struct predict_par *par); /* NULL: no memory */
void predict_free(struct predict *p);
void predict_pass(struct predict *p, struct state *s);
/* Adds a row: the observation, NAN if it is missing, the filtered state, which only
 * the grey model uses, and the covariates [n_loads] since the row before. */
void predict_add(struct predict *p, double t, double y, double state, const double *load);
int predict_draws(const struct predict *p);
/* Fills life[draws] with the remaining times at the last row, ascending, INFINITY beyond
 * the horizon; NUM_DOMAIN below four rows.  The threshold counts as reached once the
 * model is beyond it: the remaining time is 0. */
enum num_status predict_life(struct predict *p, double *life);
/* The bank, for its weights, counts and events; NULL for the other models. */
struct bank *predict_bank(struct predict *p);

/* The time at which a unit of this age is best replaced in advance, where a failure costs
 * ratio times as much (age replacement: Barlow, Hunter, Operations Research 8 (1960) 90),
 * from n ascending lives; INFINITY: never. */
double predict_replacement(const double *life, int n, double age, double ratio);

#endif
