/* forecast.c - see forecast.h */
#include "life/pair/forecast.h"
#include "life/trend/passage.h"
#include "num/passage.h"
#include "num/rng.h"
#include "num/running.h"
#include "num/select.h"
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>

struct forecast {
	struct forecast_par par;
	struct path *path;   /* NULL without fragments */
	double mean;         /* of the component per step, by all fragments */
	struct running logs; /* of the slopes of earlier units */
	gsl_rng *rng;
	struct observed observed;
	struct bank *bank; /* NULL without a limit; unless RATE_FILTER, to tell repairs */
	struct bank_chances *chances;
	struct bank_shape other; /* coordinate of the bank */
	int by_gap;              /* the bank follows the gap, not the value */
	double threshold;        /* of the bank */
	double *life, *later;    /* remaining times at the latest observation, and now */
	long rows, n;
	double first_t, grey;
};

/* --- paths -------------------------------------------------------------------------- */

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
static void draw_path(struct forecast *f, struct partition *partition, long i)
{
	const struct forecast_par *par = &f->par;
	struct path *path = &f->path[i];

	rng_reset(f->rng, par->seed, par->first + (uint32_t)i, RNG_BOOTSTRAP);
	path->wear = partition_replicate(partition, par->parts, f->rng);
	if (!isnan(par->critical))
		path->large_step =
			partition_large(partition, par->critical, par->cumulative);
	/* With (4-28) every step has this scatter instead. */
	if (par->rule != RATE_LAST)
		path->wear.mean =
			draw_rate(path->wear.mean, path->wear.life_variance, f->rng);
	path->step_time = par->step_time;
	if (par->nslopes)
		path->step_time = f->mean / par->pair.area / draw_slope(&f->logs, f->rng);
}

static void draw_paths(struct forecast *f, struct partition *partition)
{
	f->mean = partition_estimate(partition, f->par.parts).mean;
	for (int k = 0; k < f->par.nslopes; k++)
		running_add(&f->logs, log(f->par.slope[k]));
	for (long i = 0; i < f->par.count; i++) {
		draw_path(f, partition, i);
		if (f->par.progress)
			f->par.progress(i + 1, f->par.count);
	}
}

struct forecast *forecast_new(const struct forecast_par *par, struct partition *partition)
{
	struct forecast *f = calloc(1, sizeof *f);
	int filters = par->rule == RATE_FILTER;
	size_t count = (size_t)par->count;

	if (!f)
		return NULL;
	f->par = *par;
	f->grey = NAN;
	f->rng = rng_new(par->seed, 0, RNG_BOOTSTRAP);
	f->path = partition ? calloc(count, sizeof *f->path) : NULL;
	f->life = calloc(count, sizeof *f->life);
	f->later = calloc(count, sizeof *f->later);
	if (filters)
		f->chances = bank_chances_new(
			(int)count, par->seed + par->first * 0x9e3779b97f4a7c15u);
	if (!f->rng || (partition && !f->path) || !f->life || !f->later ||
		(filters && !f->chances)) {
		forecast_free(f);
		return NULL;
	}
	if (partition)
		draw_paths(f, partition);
	if (par->from_new)
		observed_begin(&f->observed, (struct moment){ .gap = par->pair.gap_new });
	return f;
}

void forecast_free(struct forecast *f)
{
	if (!f)
		return;
	if (f->rng)
		gsl_rng_free(f->rng);
	free(f->path);
	bank_free(f->bank);
	bank_chances_free(f->chances);
	free(f->life);
	free(f->later);
	free(f);
}

const struct path *forecast_paths(const struct forecast *f)
{
	return f->path;
}

/* 1 if the paths know how long a step takes. */
static int is_timed(const struct forecast *f)
{
	return f->path && !isnan(f->path[0].step_time);
}

/* Quantiles of the rate of the gap over the paths at n levels, in [0, 1), per s; 0: the
 * paths have none.  Overwrites later. */
static int find_rates(const struct forecast *f, const double *level, int n, double *rate)
{
	size_t count = (size_t)f->par.count;

	if (!is_timed(f))
		return 0;
	for (size_t i = 0; i < count; i++)
		f->later[i] =
			f->path[i].wear.mean / (f->par.pair.area * f->path[i].step_time);
	sort_numbers(f->later, count);
	for (int k = 0; k < n; k++)
		rate[k] = f->later[(size_t)(level[k] * (double)count)];
	return 1;
}

/* Time in which path i opens the gap by left, in steps of tau: at a constant rate (4-29),
 * or at one that changes from step to step about its mean (4-28). */
static double wear_out(struct forecast *f, long i, double left, double tau)
{
	const struct partition_wear *w = &f->path[i].wear;

	if (left <= 0)
		return 0;
	rng_reset(f->rng, f->par.seed, f->par.first + (uint32_t)i, RNG_LIFE);
	return tau * gamma_passage(left * f->par.pair.area, w->mean,
			     f->par.rule == RATE_MEAN ? 0 : w->step_variance, f->rng);
}

/* Fills life[] at the latest observation and counts it.  passage: with RATE_FILTER,
 * samples of the time to the limit (NULL: not yet known), which include the error of the
 * observations. */
static void predict(struct forecast *f, const double *passage)
{
	const struct forecast_par *par = &f->par;
	const struct observed *o = &f->observed;
	double left = pair_limit(&par->pair) - observed_gap(o),
	       rate = observed_rate(o, par->rule, NULL);
	int filtered = par->rule == RATE_FILTER, exact = !(o->last.error > 0);

	f->n = 1;
	if (left <= 0 && exact && !passage) {
		f->life[0] = 0;
		return;
	}
	if (!filtered && !f->path && exact && !isnan(rate)) {
		f->life[0] = gamma_passage(left, rate, 0, NULL);
		return;
	}
	f->n = (filtered ? passage != NULL : !isnan(rate) || is_timed(f)) ? par->count
									  : 0;
	for (long i = 0; i < f->n; i++) {
		double here = left, tau, z[2];

		if (!exact) {
			philox_normal2(
				par->seed, par->first + (uint32_t)i, RNG_PREDICT, 1, z);
			here -= o->last.error * z[0];
			rate = observed_rate(o, par->rule, z);
		}
		/* by default such that the mean wears as observed */
		tau = rate > 0 ? f->mean / (par->pair.area * rate) : INFINITY;
		if (is_timed(f))
			tau = f->path[i].step_time;
		if (filtered)
			f->life[i] = passage[i];
		else if (f->path)
			f->life[i] = wear_out(f, i, here, tau);
		else
			f->life[i] = gamma_passage(here, rate, 0, NULL);
		if (f->path && f->path[i].large_step > 0) /* until its end */
			f->life[i] = fmin(f->life[i],
				fmax((double)f->path[i].large_step * tau - o->last.t, 0));
	}
}

/* --- observations ------------------------------------------------------------------- */

/* The value is h, or q, which goes as h^3.  Steady wear is a straight line in h; the
 * pumps of the thesis are a straight line in q.  With D = (y - y0) / (limit - y0) the
 * rate in the other coordinate goes as (1 + D / s)^par, s = y0 / (limit - y0).  The prior
 * weight of that coordinate is about that of the straight line and its neighbours in the
 * bank together. */
static enum num_status open_bank(struct forecast *f)
{
	const struct forecast_par *par = &f->par;
	double limit = pair_limit(&par->pair), rate[3];
	struct bank_par bank = {
		.direction = 1, .load = par->load, .n_loads = par->n_loads
	};

	if (!par->doubtful && find_rates(f, (double[]){ 0.159, 0.5, 0.841 }, 3, rate)) {
		bank.rate_mean = rate[1];
		/* Not 0: an ensemble without scatter may have only one realisation. */
		bank.rate_sd = fmax((rate[2] - rate[0]) / 2, 1e-6 * rate[1]);
	}
	f->by_gap = bank.rate_sd > 0 || par->quantity == PAIR_GAP;
	f->threshold = f->by_gap ? limit : pair_value(&par->pair, par->quantity, limit);
	bank.threshold = f->threshold;
	if (f->by_gap || par->quantity == PAIR_LEAKAGE) {
		f->other = (struct bank_shape){ .family = BANK_OTHER,
			.par = f->by_gap ? -2 : 2. / 3,
			.of_value = 1,
			.log_prior = 3.3 };
		bank.more = &f->other;
		bank.n_more = 1;
	}
	f->bank = bank_new(&bank);
	return f->bank ? NUM_OK : NUM_MEMORY;
}

/* Samples of the time to the limit in f->later, if there are any: from four rows on. */
static enum num_status passages(struct forecast *f, double t, double y, int run_in,
	int later, const double **passage)
{
	*passage = NULL;
	if (f->bank && !run_in && later)
		bank_add(f->bank, t, y);
	if (f->par.rule != RATE_FILTER || (f->bank && !bank_ready(f->bank)))
		return NUM_OK;
	*passage = f->later;
	if (f->bank)
		return bank_draw(f->bank, f->chances, t, f->threshold, f->later);
	for (long i = 0; i < f->par.count; i++)
		f->later[i] = INFINITY;
	return NUM_OK;
}

enum num_status forecast_add(struct forecast *f, double t, double value, double gap,
	double error, const double *load)
{
	const struct forecast_par *par = &f->par;
	struct pair *pair = &f->par.pair;
	struct moment m = { t, gap, error };
	int run_in, later;
	const double *passage;

	if (f->rows++ == 0)
		f->first_t = t;
	run_in = t - f->first_t < par->skip;
	later = f->rows == 1 || t > f->observed.last.t;
	if (isnan(pair->gap_new))
		pair->gap_new = gap;
	/* the sum of the particles so far never falls */
	if ((par->rule == RATE_FILTER || par->quantity != PAIR_DEBRIS) && !f->bank &&
		!isnan(gap) && isfinite(pair_limit(pair)) && open_bank(f))
		return NUM_MEMORY;
	if (f->bank)
		bank_load(f->bank, t, load);
	if (isnan(gap))
		return NUM_OK;
	if (passages(f, t, f->by_gap ? gap : value, run_in, later, &passage))
		return NUM_MEMORY;
	if (run_in || (par->skip > 0 && f->observed.grey.forward.n == 0))
		observed_begin(&f->observed, m);
	if (!run_in)
		observed_add(&f->observed, m, value);
	predict(f, passage);
	if (par->grey)
		f->grey = grey_life(&f->observed.grey,
			pair_value(pair, par->quantity, pair_limit(pair)), 1, 0, 0);
	return NUM_OK;
}

void forecast_foresee(struct forecast *f)
{
	predict(f, NULL);
}

static double later_life(double life, double gone)
{
	return life < gone ? 0 : life - gone;
}

struct forecast_row forecast_at(struct forecast *f, double t)
{
	const struct forecast_par *par = &f->par;
	double gone = t - f->observed.last.t;
	struct forecast_row row = { f->later, f->n, par->horizon,
		later_life(f->grey, gone) };

	for (long i = 0; i < f->n; i++)
		f->later[i] = later_life(f->life[i], gone);
	if (isnan(row.limit))
		row.limit = par->rule == RATE_FILTER && (par->doubtful || !is_timed(f))
				    ? 10 * (t - f->observed.first.t + par->skip)
				    : INFINITY;
	return row;
}

const struct observed *forecast_observed(const struct forecast *f)
{
	return &f->observed;
}

const struct bank *forecast_bank(const struct forecast *f)
{
	return bank_ready(f->bank) ? f->bank : NULL;
}

int forecast_contradicts(const struct forecast *f)
{
	double rate[2];

	return f->par.count >= 100 &&
	       find_rates(f, (double[]){ 0.005, 0.995 }, 2, rate) &&
	       observed_rate_outside(&f->observed, rate[0], rate[1]);
}
