/* paths.c - see paths.h */
#include "life/pair/paths.h"
#include "num/passage.h"
#include "num/rng.h"
#include "num/running.h"
#include "num/select.h"
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>

struct paths {
	struct paths_par par;
	struct path *path;   /* NULL without fragments */
	double mean;         /* of the component per step, by all fragments */
	struct running logs; /* of the slopes of earlier units */
	gsl_rng *rng;
};

/* A gamma variate of given mean and variance; the mean where the variance is 0. */
static double draw_rate(double mean, double variance, gsl_rng *rng)
{
	if (!(variance > 0) || !(mean > 0))
		return mean;
	return gsl_ran_gamma(rng, mean * mean / variance, variance / mean);
}

/* The slope of another unit, as those of n earlier ones tell if the logarithms of all are
 * normal: the prediction has Student's t of n - 1 degrees.  One unit does not tell how
 * units differ.  With few of them t may be of any size: no infinite rates. */
static double draw_slope(const struct running *logs, gsl_rng *rng)
{
	double n = logs->n, t;

	if (n < 2)
		return exp(logs->mean);
	t = gsl_ran_tdist(rng, n - 1) * sqrt(running_variance(logs) * (1 + 1 / n));
	return exp(logs->mean + fmax(-200, fmin(t, 200)));
}

/* The draws of path i, in this order. */
static void draw_path(struct paths *e, struct partition *partition, long i)
{
	const struct paths_par *par = &e->par;
	struct path *path = &e->path[i];

	rng_reset(e->rng, par->seed, par->first + (uint32_t)i, RNG_BOOTSTRAP);
	partition_replicate(partition, par->parts, e->rng, &path->wear);
	if (!isnan(par->critical))
		path->large_step =
			partition_large(partition, par->critical, par->cumulative);
	/* With (4-28) every step has this scatter instead. */
	if (par->rule != RATE_LAST)
		path->wear.mean =
			draw_rate(path->wear.mean, path->wear.life_variance, e->rng);
	path->step_time = par->step_time;
	if (par->nslopes)
		path->step_time = e->mean / par->area / draw_slope(&e->logs, e->rng);
}

struct paths *paths_new(const struct paths_par *par, struct partition *partition)
{
	struct paths *e = calloc(1, sizeof *e);
	struct partition_wear all;

	if (!e)
		return NULL;
	e->par = *par;
	e->rng = rng_new(par->seed, 0, RNG_BOOTSTRAP);
	if (partition)
		e->path = calloc((size_t)par->count, sizeof *e->path);
	if (!e->rng || (partition && !e->path)) {
		paths_free(e);
		return NULL;
	}
	if (!partition)
		return e;
	partition_estimate(partition, par->parts, &all);
	e->mean = all.mean;
	for (int k = 0; k < par->nslopes; k++)
		running_add(&e->logs, log(par->slope[k]));
	for (long i = 0; i < par->count; i++) {
		draw_path(e, partition, i);
		if (par->progress)
			par->progress(i + 1, par->count);
	}
	return e;
}

void paths_free(struct paths *e)
{
	if (!e)
		return;
	if (e->rng)
		gsl_rng_free(e->rng);
	free(e->path);
	free(e);
}

const struct paths_par *paths_par(const struct paths *e)
{
	return &e->par;
}

const struct path *paths_get(const struct paths *e, long i)
{
	return e->path ? &e->path[i] : NULL;
}

int paths_rates(const struct paths *e, const double *level, int n, double *rate)
{
	size_t count = (size_t)e->par.count;
	double *all = NULL;

	if (e->path && !isnan(e->path[0].step_time))
		all = malloc(count * sizeof *all);
	if (!all)
		return 0;
	for (size_t i = 0; i < count; i++)
		all[i] = e->path[i].wear.mean / (e->par.area * e->path[i].step_time);
	sort_numbers(all, count);
	for (int k = 0; k < n; k++)
		rate[k] = all[(size_t)(level[k] * (double)count)];
	free(all);
	return 1;
}

/* Time in which path i opens the gap by left, in steps of tau: at a constant rate (4-29),
 * or at one that changes from step to step about its mean (4-28). */
static double wear_out(struct paths *e, long i, double left, double tau)
{
	const struct partition_wear *w = &e->path[i].wear;

	if (left <= 0)
		return 0;
	rng_reset(e->rng, e->par.seed, e->par.first + (uint32_t)i, RNG_LIFE);
	return tau * gamma_passage(left * e->par.area, w->mean,
			     e->par.rule == RATE_MEAN ? 0 : w->step_variance, e->rng);
}

/* Time from t to the end of the step in which large particles become too many. */
static double until_large(long step, double step_time, double t)
{
	return step < 1 ? INFINITY : fmax((double)step * step_time - t, 0);
}

long paths_predict(struct paths *e, const struct observed *o, const double *passage,
	double limit, double *life)
{
	double left = limit - observed_gap(o), rate = observed_rate(o, e->par.rule, NULL);
	int filtered = e->par.rule == RATE_FILTER, exact = !(o->last.error > 0);

	if (left <= 0 && exact && !passage) {
		life[0] = 0;
		return 1;
	}
	if (filtered ? !passage
		     : isnan(rate) && (!e->path || isnan(e->path[0].step_time)))
		return 0;
	if (!filtered && !e->path && exact) {
		life[0] = gamma_passage(left, rate, 0, NULL);
		return 1;
	}
	for (long i = 0; i < e->par.count; i++) {
		double here = left, tau, z[2];

		if (!exact) {
			philox_normal2(e->par.seed, e->par.first + (uint32_t)i,
				RNG_PREDICT, 1, z);
			here -= o->last.error * z[0];
			rate = observed_rate(o, e->par.rule, z);
		}
		/* by default such that the mean wears as observed */
		tau = rate > 0 ? e->mean / (e->par.area * rate) : INFINITY;
		if (e->path && !isnan(e->path[i].step_time))
			tau = e->path[i].step_time;
		if (filtered)
			life[i] = passage[i];
		else if (e->path)
			life[i] = wear_out(e, i, here, tau);
		else
			life[i] = gamma_passage(here, rate, 0, NULL);
		if (e->path && !isnan(e->par.critical))
			life[i] = fmin(life[i],
				until_large(e->path[i].large_step, tau, o->last.t));
	}
	return e->par.count;
}
