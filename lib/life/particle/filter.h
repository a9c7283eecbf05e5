/* filter.h - bootstrap particle filter of a scalar state that remembers its past
 *
 * State model x_k = mean(x_{k-1}, x_{k-2}, ...) + N(0, sigma^2), observation
 * y_k = x_k + noise.  The caller computes the means from the histories of the
 * particles; the filter adds the noise, updates the weights, and resamples
 * when the effective sample size falls below a share of N (Gordon, Salmond, Smith 1993;
 * Li's thesis, eq. 4-9 to 4-19).  Histories are genealogies: each step keeps those of its
 * states that have descendants.
 *
 *	struct filter *f = filter_new(&par, draw);
 *	filter_start(f, first, 4, spread);
 *	for each observation {
 *		struct filter_step now = filter_step(f, 0);
 *		for (i = 0; i < n; i++)
 *			mean[i] = now.x[now.ancestor[i]] + drift;
 *		filter_predict(f, mean, sigma);
 *		filter_update(f, y, noise);    (not for a missing one)
 *		state = filter_now(f).mean;
 *	}
 */
#ifndef LIFE_FILTER_H
#define LIFE_FILTER_H

#include "num/draw.h"
#include <stddef.h>
#include <stdint.h>

struct filter_par {
	size_t particles; /* N >= 1 */
	int depth;        /* states remembered, >= 1 */
	double share;     /* resample when ESS < share N; 1: always */
};

struct filter;

/* draw is borrowed.  NULL when out of memory. */
struct filter *filter_new(const struct filter_par *par, struct draw *draw);
/* One that goes on from the same state with other random numbers; NULL: no memory. */
struct filter *filter_copy(const struct filter *f, struct draw *draw);
void filter_free(struct filter *f);
void filter_pass(struct filter *f, struct state *s);

/* (Re)starts with count <= depth past values, oldest first, each particle's uniform
 * within +- spread of them, and equal weights. */
void filter_start(struct filter *f, const double *past, int count, double spread);

/* The states x[n] of step k - lag that have descendants, and the index among them of the
 * ancestor of each state of the next step (lag 0: of each particle), which ascend without
 * gaps from 0. */
struct filter_step {
	const double *x;
	const uint32_t *ancestor;
	size_t n;
};
struct filter_step filter_step(const struct filter *f, int lag);

/* Moves to the next step: states mean[N] plus normal noise. */
void filter_predict(struct filter *f, const double *mean, double sigma);
/* Weights particles by y with observation noise of scale noise > 0, then resamples if
 * necessary.  Returns the log of the evidence, log mean(p(y|x)). */
double filter_update(struct filter *f, double y, double noise);

/* Weighted mean of the states of the present step, as predicted; after an update it is
 * that before resampling, as is the effective sample size. */
struct filter_now {
	double mean, ess;
	unsigned long resamplings; /* so far */
};
struct filter_now filter_now(const struct filter *f);

/* Systematic resampling (Douc, Cappe, Moulines, "Comparison of resampling schemes for
 * particle filtering", ISPA 2005): fills ancestor[n] in ascending order with the floor or
 * the ceiling of n w[i] copies of particle i, n w[i] on average, from weight[n] >= 0 with
 * the given sum > 0. */
void resample(struct draw *draw, const double *weight, double sum, size_t n,
	uint32_t *ancestor);

#endif
