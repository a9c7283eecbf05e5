/* paths.h - Monte-Carlo ensemble of units: the wear of each and its remaining life
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
 *	struct paths_par par = { .seed = 1, .count = 1000, .step_time = 3600,
 *		.area = 2346.3e-6, .critical = NAN };
 *	struct paths *e = paths_new(&par, partition);
 *	n = paths_predict(e, observed, NULL, limit, life);
 *	paths_free(e);
 */
#ifndef LIFE_PATHS_H
#define LIFE_PATHS_H

#include "life/pair/observed.h"
#include "life/prior/partition.h"
#include <gsl/gsl_rng.h>
#include <stdint.h>

struct paths_par {
	uint64_t seed;
	uint32_t first;
	long count;
	enum rate_rule rule;
	double area;      /* of the component, m2 */
	double parts;     /* see partition_estimate() */
	double critical;  /* share of large particles at failure; NAN: no criterion */
	int cumulative;   /* 1: the share is of all particles so far, 0: of one step */
	double step_time; /* duration of a step, s; NAN: from slopes or the state */
	const double
		*slope; /* gap per s of earlier units, by which each path draws its own */
	int nslopes;
	void (*progress)(long done, long paths); /* called after each draw; or NULL */
};

struct path {
	struct partition_wear
		wear;     /* of the component per step, with the mean of this unit */
	double step_time; /* NAN: from the state so far */
	long large_step;  /* first with too many large particles; 0: none */
};

struct paths;

/* partition is closed, or NULL if only observations are known.  NULL when out of memory.
 * par is copied; only this call reads partition. */
struct paths *paths_new(const struct paths_par *par, struct partition *partition);
void paths_free(struct paths *e);

const struct paths_par *paths_par(const struct paths *e);
const struct path *paths_get(const struct paths *e, long i); /* NULL without partition */

/* Quantiles of the rate of the gap over the paths at n levels, in [0, 1), per s; 0: the
 * paths have none. */
int paths_rates(const struct paths *e, const double *level, int n, double *rate);

/* Remaining life at the latest observation, until the gap reaches limit or the share of
 * large particles its critical value, as samples in life, which has room for count.
 * passage: with RATE_FILTER, count samples of the time to the limit (NULL: not yet
 * known), which include the error of the observations. Returns the number of samples:
 * count; 1 if all are the same; 0 if there is no prediction yet. */
long paths_predict(struct paths *e, const struct observed *o, const double *passage,
	double limit, double *life);

#endif
