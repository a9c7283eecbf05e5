/* forecast.h - remaining life of one unit at every observation, by a Monte-Carlo ensemble
 *
 * Remaining wear life at time t is the lesser of (Li's thesis, eq. 4-26 and 4-27, with
 * signs and indices set right)
 *
 *	(Va - V(t)) / Vdot        total volume,
 *	Ts - t                    Ts: large particles reach their critical share,
 *
 * and Va - V(t) = A (H - h(t)) for a gap that opens evenly (4-31).
 *
 * Path i draws its own replicate of the fragments, its own unit and its own step time
 * from streams (seed, first + i), so that any split of an ensemble gives the same
 * numbers.
 *
 * With RATE_FILTER the bank of bank.h follows the observed value or, if the step time of
 * the paths is known, the gap, with the rate of the paths as prior.  It has one more
 * coordinate: if it follows a leakage, one in which the gap grows at a constant rate, and
 * otherwise one in which the leakage does.
 *
 *	struct forecast *f = forecast_new(&par, partition);
 *	forecast_add(f, t, value, gap, 0, NULL);
 *	row = forecast_at(f, t);
 *	forecast_free(f);
 */
#ifndef LIFE_FORECAST_H
#define LIFE_FORECAST_H

#include "life/pair/observed.h"
#include "life/pair/pair.h"
#include "life/prior/partition.h"
#include "life/trend/bank.h"
#include "num/status.h"
#include <stdint.h>

struct forecast_par {
	uint64_t seed;
	uint32_t first; /* number of the first path */
	long count;     /* paths */
	enum rate_rule rule;
	struct pair pair; /* gap_new NAN: the first gap observed */
	enum pair_quantity quantity;
	double parts;        /* see partition_estimate() */
	double critical;     /* share of large particles at failure; NAN: no criterion */
	int cumulative;      /* 1: the share is of all particles so far, 0: of one step */
	double step_time;    /* duration of a step, s; NAN: from slopes or the state */
	const double *slope; /* gap per s of earlier units, by which each path draws its
			      * own; read by forecast_new() only */
	int nslopes;
	void (*progress)(long done, long paths); /* called after each draw; or NULL */
	int from_new;   /* 1: wear counts from the new pair at time 0 */
	int doubtful;   /* 1: the rate of the paths is no prior of that of the gap */
	double skip;    /* run-in from the first row on, which the rates leave out, s */
	double horizon; /* lives beyond this count as no failure; NAN: none, or ten times
			 * the age for filters without paths */
	int grey;       /* 1: forecast by the grey model too */
	const struct bank_covariate *load; /* [n_loads] with RATE_FILTER, the caller's */
	int n_loads;
};

struct path {
	/* of the component per step, with the mean of this unit */
	struct partition_wear wear;
	double step_time; /* NAN: from the state so far */
	long large_step;  /* first with too many large particles; 0: none */
};

/* The forecast at a time; NAN: unknown. */
struct forecast_row {
	double *life; /* n samples, valid until the next call; may be reordered */
	long n;       /* count; 1 if all are the same; 0 if there is no prediction yet */
	double limit; /* lives beyond this count as no failure */
	double grey;  /* remaining life by the grey model */
};

struct forecast;

/* partition is closed, or NULL if only observations are known; only this call reads it.
 * NULL when out of memory.  par is copied. */
struct forecast *forecast_new(
	const struct forecast_par *par, struct partition *partition);
void forecast_free(struct forecast *f);

const struct path *forecast_paths(const struct forecast *f); /* [count] */

/* Adds a row: the value as read, the gap derived from it with its standard error, and the
 * covariates [n_loads] since the row before.  A gap of NAN is no observation: returns
 * NUM_OK and leaves the prediction as it was. */
enum num_status forecast_add(struct forecast *f, double t, double value, double gap,
	double error, const double *load);
/* Makes the forecast for a new pair without observations. */
void forecast_foresee(struct forecast *f);

/* The observations so far, and the bank that follows them; NULL: none yet. */
const struct observed *forecast_observed(const struct forecast *f);
const struct bank *forecast_bank(const struct forecast *f);

/* 1 if the gap does not grow at the rate of the paths, but for one series in 100; 0 also
 * where that is not known, or from fewer than 100 paths. */
int forecast_contradicts(const struct forecast *f);

/* The forecast at the latest known gap minus the time since then. */
struct forecast_row forecast_at(struct forecast *f, double t);

#endif
