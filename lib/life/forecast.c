#include "life/forecast.h"
#include "life/remaining.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct forecast {
	struct forecast_par par;
	struct paths *paths;
	struct observed *observed;
	struct rate *filter;  /* NULL unless RATE_FILTER */
	double *life, *later; /* samples at the latest observation, and now */
	long rows, n;
	double first_t, grey;
};

struct forecast *forecast_new(struct paths *paths, const struct forecast_par *par)
{
	struct forecast *f = calloc(1, sizeof *f);

	if (!f)
		return NULL;
	f->par = *par;
	f->paths = paths;
	f->grey = NAN;
	f->observed = observed_new(par->rule);
	f->filter = par->rule == RATE_FILTER ? paths_filter(paths) : NULL;
	f->life = calloc((size_t)par->count, sizeof *f->life);
	f->later = calloc((size_t)par->count, sizeof *f->later);
	if (!f->observed || (par->rule == RATE_FILTER && !f->filter) || !f->life ||
		!f->later) {
		forecast_free(f);
		return NULL;
	}
	if (par->from_new)
		observed_begin(f->observed, 0, par->pair.gap_new);
	return f;
}

void forecast_free(struct forecast *f)
{
	if (!f)
		return;
	rate_free(f->filter);
	if (f->observed)
		observed_free(f->observed);
	free(f->life);
	free(f->later);
	free(f);
}

long forecast_add(struct forecast *f, double t, double value, double gap, double error)
{
	struct pair *pair = &f->par.pair;
	int run_in;

	if (f->rows++ == 0)
		f->first_t = t;
	run_in = t - f->first_t < f->par.skip;
	if (f->filter && !run_in && (f->rows == 1 || t > observed_time(f->observed)))
		rate_add(f->filter, t, gap);
	if (isnan(gap))
		return -1;
	if (isnan(pair->gap_new))
		pair->gap_new = gap;
	if (run_in || (f->par.skip > 0 && observed_count(f->observed) == 0))
		observed_begin(f->observed, t, gap);
	if (!run_in)
		observed_add(f->observed, t, value, gap);
	f->n = paths_predict(
		f->paths, f->observed, f->filter, pair_limit(pair), error, f->life);
	if (f->par.grey)
		f->grey = observed_grey(
			f->observed, pair_value(pair, f->par.quantity, pair_limit(pair)));
	return f->n;
}

void forecast_foresee(struct forecast *f)
{
	f->n = paths_predict(
		f->paths, f->observed, NULL, pair_limit(&f->par.pair), 0, f->life);
}

static double later_life(double life, double gone)
{
	return life < gone ? 0 : life - gone;
}

struct forecast_row forecast_at(struct forecast *f, double t)
{
	const struct forecast_par *par = &f->par;
	double gone = t - observed_time(f->observed);
	struct forecast_row row = { f->later, f->n, par->horizon,
		later_life(f->grey, gone) };

	memcpy(f->later, f->life, (size_t)f->n * sizeof *f->later);
	for (long i = 0; i < f->n; i++)
		f->later[i] = later_life(f->later[i], gone);
	if (isnan(row.limit))
		row.limit = par->rule == RATE_FILTER && !par->scaled
				    ? 10 * (t - observed_first(f->observed) + par->skip)
				    : INFINITY;
	return row;
}
