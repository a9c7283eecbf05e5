/* forecast.h - remaining life of one unit at every observation
 *
 *	struct forecast *f = forecast_new(paths, &par);
 *	forecast_add(f, t, value, gap, 0, NULL);
 *	row = forecast_at(f, t);
 *	forecast_free(f);
 *
 * With RATE_FILTER the bank of bank.h follows the observed value.  It has one more
 * coordinate: if the value is a leakage, one in which the gap grows at a constant rate,
 * and otherwise one in which the leakage does.  The rate may change in past and future.
 * If the step time of the paths is known, the bank follows the gap instead, with the rate
 * of the paths as prior.
 */
#ifndef LIFE_FORECAST_H
#define LIFE_FORECAST_H

#include "life/pair/pair.h"
#include "life/pair/paths.h"
#include "life/trend/bank.h"
#include "num/status.h"

struct forecast_par {
	struct pair pair; /* gap_new NAN: the first gap observed */
	enum pair_quantity quantity;
	int from_new;   /* 1: wear counts from the new pair at time 0 */
	int scaled;     /* 1: the paths know how long a step takes, and their rate */
	double skip;    /* run-in from the first row on, which the rates leave out, s */
	double horizon; /* lives beyond this count as no failure; NAN: none, or ten times
			 * the age for filters without paths */
	int grey;       /* 1: forecast by the grey model too */
	const struct bank_covariate *load; /* [n_loads] with RATE_FILTER, the caller's */
	int n_loads;
};

/* The forecast at a time; NAN: unknown. */
struct forecast_row {
	double *life; /* n samples, valid until the next call; may be reordered */
	long n;
	double limit; /* lives beyond this count as no failure */
	double grey;  /* remaining life by the grey model */
};

struct forecast;

/* NULL when out of memory.  par is copied; paths must outlive the forecast. */
struct forecast *forecast_new(struct paths *paths, const struct forecast_par *par);
void forecast_free(struct forecast *f);

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
