/* forecast.h - one unit followed: the life left at every observation
 *
 *	struct forecast *f = forecast_new(paths, &par);
 *	forecast_add(f, t, value, gap, 0);
 *	row = forecast_at(f, t);
 *	forecast_free(f);
 *
 * With RATE_FILTER the value observed is followed by the bank of bank.h, and besides its
 * coordinates in one in which the other of gap and leakage grows at a constant rate; the
 * rate may change in past and future.  Where the paths
 * know how long a step takes, it is the gap that is followed, and their rate is known
 * beforehand.
 */
#ifndef LIFE_FORECAST_H
#define LIFE_FORECAST_H

#include "life/pair/pair.h"
#include "life/pair/paths.h"
#include "num/status.h"

struct forecast_par {
	struct pair pair; /* gap_new NAN: the first gap observed */
	enum pair_quantity quantity;
	int from_new;        /* wear counts from the new pair at time 0 */
	enum rate_rule rule; /* as that of the paths, as are count, seed and first */
	long count;
	uint64_t seed;
	uint32_t first;
	int scaled;     /* the paths know how long a step takes */
	double skip;    /* run-in left out of the rates, s from the first row */
	double horizon; /* what lives longer counts as no failure; NAN: none, or for
			 * filters on their own ten times the age */
	int grey;       /* follow the grey model too */
};

/* What is known at a time; NAN: nothing. */
struct forecast_row {
	double *life; /* n samples, valid until the next call; may be reordered */
	long n;
	double limit; /* what lives longer counts as no failure */
	double grey;  /* life left by the grey model */
};

struct forecast;

/* NULL when out of memory.  par is copied, paths are only used. */
struct forecast *forecast_new(struct paths *paths, const struct forecast_par *par);
void forecast_free(struct forecast *f);

/* The next row observed: value as read, the gap it tells and the error of that.  A gap of
 * NAN is no observation: NUM_OK, and the prediction stays as it was. */
enum num_status forecast_add(
	struct forecast *f, double t, double value, double gap, double error);
/* Instead of it, for a new pair that was not observed yet. */
void forecast_foresee(struct forecast *f);

/* What was said at the latest gap known, less the time gone since. */
struct forecast_row forecast_at(struct forecast *f, double t);

#endif
