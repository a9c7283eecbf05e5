#include "life/pair/forecast.h"
#include "life/trend/bank.h"
#include "life/trend/passage.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct forecast {
	struct forecast_par par;
	struct paths *paths;
	const struct paths_par *draws; /* of paths */
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

/* The value is h, or q, which goes as h^3.  Steady wear is a straight line in h; the
 * pumps of the thesis are a straight line in q.  With D = (y - y0) / (limit - y0) the
 * rate in the other coordinate goes as (1 + D / s)^par, s = y0 / (limit - y0).  The prior
 * weight of that coordinate is about that of the straight line and its neighbours in the
 * bank together.  The other coordinates of the bank represent wear that slows down or
 * accelerates: without them, intervals of 90 % held 42 to 82 % of the ends of gaps that
 * open as the square root of time, with them 96 to 100 %. */
static enum num_status open_bank(struct forecast *f)
{
	const struct forecast_par *par = &f->par;
	double limit = pair_limit(&par->pair), rate[3];
	struct bank_par bank = {
		.direction = 1, .load = par->load, .n_loads = par->n_loads
	};

	if (par->scaled &&
		paths_rates(f->paths, (double[]){ 0.159, 0.5, 0.841 }, 3, rate)) {
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

struct forecast *forecast_new(struct paths *paths, const struct forecast_par *par)
{
	struct forecast *f = calloc(1, sizeof *f);

	if (!f)
		return NULL;
	f->par = *par;
	f->paths = paths;
	f->draws = paths_par(paths);
	f->grey = NAN;
	f->life = calloc((size_t)f->draws->count, sizeof *f->life);
	f->later = calloc((size_t)f->draws->count, sizeof *f->later);
	if (f->draws->rule == RATE_FILTER)
		f->chances = bank_chances_new((int)f->draws->count,
			f->draws->seed + f->draws->first * 0x9e3779b97f4a7c15u);
	if (!f->life || !f->later || (f->draws->rule == RATE_FILTER && !f->chances)) {
		forecast_free(f);
		return NULL;
	}
	if (par->from_new)
		observed_begin(&f->observed, (struct moment){ .gap = par->pair.gap_new });
	return f;
}

void forecast_free(struct forecast *f)
{
	if (!f)
		return;
	bank_free(f->bank);
	bank_chances_free(f->chances);
	free(f->life);
	free(f->later);
	free(f);
}

/* Samples of the time to the limit in f->later, if there are any: from four rows on. */
static enum num_status passages(struct forecast *f, double t, double y, int run_in,
	int later, const double **passage)
{
	*passage = NULL;
	if (f->bank && !run_in && later)
		bank_add(f->bank, t, y);
	if (f->draws->rule != RATE_FILTER || (f->bank && !bank_ready(f->bank)))
		return NUM_OK;
	*passage = f->later;
	if (f->bank)
		return bank_draw(f->bank, f->chances, t, f->threshold, f->later);
	for (long i = 0; i < f->draws->count; i++)
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
	run_in = t - f->first_t < f->par.skip;
	later = f->rows == 1 || t > f->observed.last.t;
	if (isnan(pair->gap_new))
		pair->gap_new = gap;
	/* the sum of the particles so far never falls */
	if ((f->draws->rule == RATE_FILTER || par->quantity != PAIR_DEBRIS) && !f->bank &&
		!isnan(gap) && isfinite(pair_limit(pair)) && open_bank(f))
		return NUM_MEMORY;
	if (f->bank)
		bank_load(f->bank, t, load);
	if (isnan(gap))
		return NUM_OK;
	if (passages(f, t, f->by_gap ? gap : value, run_in, later, &passage))
		return NUM_MEMORY;
	if (run_in || (f->par.skip > 0 && f->observed.grey.n == 0))
		observed_begin(&f->observed, m);
	if (!run_in)
		observed_add(&f->observed, m, value);
	f->n = paths_predict(f->paths, &f->observed, passage, pair_limit(pair), f->life);
	if (f->par.grey)
		f->grey = grey_life(&f->observed.grey,
			pair_value(pair, par->quantity, pair_limit(pair)), 1, 0, 0);
	return NUM_OK;
}

void forecast_foresee(struct forecast *f)
{
	f->n = paths_predict(
		f->paths, &f->observed, NULL, pair_limit(&f->par.pair), f->life);
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

	memcpy(f->later, f->life, (size_t)f->n * sizeof *f->later);
	for (long i = 0; i < f->n; i++)
		f->later[i] = later_life(f->later[i], gone);
	if (isnan(row.limit))
		row.limit = f->draws->rule == RATE_FILTER && !par->scaled
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

	return f->draws->count >= 100 &&
	       paths_rates(f->paths, (double[]){ 0.005, 0.995 }, 2, rate) &&
	       observed_rate_outside(&f->observed, rate[0], rate[1]);
}
