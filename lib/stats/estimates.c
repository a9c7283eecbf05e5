#include "stats/estimates.h"
#include "num/philox.h"
#include <math.h>
#include <stdlib.h>

int estimate_weibull(
	const struct ensemble *e, const double *x, size_t n, struct weibull *w)
{
	const struct ensemble_par *par = ensemble_par(e);

	return weibull_fit(x, n, par->truncated ? par->low : 0,
		par->truncated ? par->high : INFINITY, par->confidence, w);
}

static int estimate_diameters(
	const struct ensemble *e, const size_t *pick, struct estimate out[ESTIMATES])
{
	const struct ensemble_par *par = ensemble_par(e);
	struct weibull w;
	double deviation, *x;
	size_t n;

	x = ensemble_diameters(e, pick, par->first, par->last, &n);
	if (!x)
		return -1;
	if (n > 0)
		out[ESTIMATE_MEAN_DIAMETER] =
			sample_mean(x, n, par->confidence, &deviation);
	if (estimate_weibull(e, x, n, &w) == 0) {
		out[ESTIMATE_SHAPE] = w.shape;
		out[ESTIMATE_SCALE] = w.scale;
		out[ESTIMATE_WEIBULL_MEAN].value = w.mean;
		if (!pick)
			out[ESTIMATE_KS].value = weibull_distance(&w, x, n);
	}
	free(x);
	return 0;
}

static int estimate_growth(
	const struct ensemble *e, const size_t *pick, struct estimate out[ESTIMATES])
{
	const struct ensemble_par *par = ensemble_par(e);
	size_t n = par->last < par->first ? 0 : (size_t)(par->last - par->first + 1);
	double *x = calloc(2 * n + 1, sizeof *x), *y;
	struct power p;

	if (!x)
		return -1;
	y = x + n;
	for (size_t k = 0; k < n; k++) {
		x[k] = (double)(par->first + (long)k);
		for (size_t i = 0; i < par->realisations; i++) {
			const struct ensemble_cell *cell = ensemble_cell(
				e, pick ? pick[i] : i, par->first + (long)k);

			y[k] += par->per_step ? cell->count : cell->total_count;
		}
	}
	if (n > 0 && power_fit(x, y, n, par->confidence, &p) == 0) {
		out[ESTIMATE_FACTOR] = p.factor;
		out[ESTIMATE_EXPONENT] = p.exponent;
		out[ESTIMATE_OFFSET] = p.offset;
	}
	free(x);
	return 0;
}

static int estimate_volume(
	const struct ensemble *e, const size_t *pick, struct estimate out[ESTIMATES])
{
	const struct ensemble_par *par = ensemble_par(e);
	double *v = calloc(par->realisations + 1, sizeof *v), deviation;
	size_t n = 0;

	if (!v)
		return -1;
	for (size_t i = 0; i < par->realisations; i++) {
		double sum = 0, steps = 0;

		for (long s = par->first; s <= par->last; s++) {
			const struct ensemble_cell *cell =
				ensemble_cell(e, pick ? pick[i] : i, s);

			sum += cell->volume;
			steps += cell->there;
		}
		if (steps > 0)
			v[n++] = sum / steps;
	}
	out[ESTIMATE_VOLUME_STEP] = sample_mean(v, n, par->confidence, &deviation);
	free(v);
	return 0;
}

int estimate_all(
	const struct ensemble *e, const size_t *pick, struct estimate out[ESTIMATES])
{
	for (int q = 0; q < ESTIMATES; q++)
		out[q] = (struct estimate){ NAN, NAN, NAN };
	if (estimate_diameters(e, pick, out) || estimate_growth(e, pick, out) ||
		estimate_volume(e, pick, out))
		return -1;
	return 0;
}

/* Interval of one quantity from its draws, which are reordered. */
static void put_interval(double *x, long draws, double confidence, struct estimate *out)
{
	size_t n = 0;

	for (long b = 0; b < draws; b++)
		if (!isnan(x[b]))
			x[n++] = x[b];
	out->low = sample_quantile(x, n, 0.5 - 0.5 * confidence);
	out->high = sample_quantile(x, n, 0.5 + 0.5 * confidence);
}

int estimate_bootstrap(const struct ensemble *e, uint64_t seed, long draws,
	struct estimate out[ESTIMATES])
{
	const struct ensemble_par *par = ensemble_par(e);
	double *draw = calloc((size_t)draws * ESTIMATES, sizeof *draw);
	size_t *pick = calloc(par->realisations + 1, sizeof *pick);
	int status = draw && pick ? 0 : -1;

	for (long b = 0; status == 0 && b < draws; b++) {
		struct estimate one[ESTIMATES];

		for (size_t i = 0; i < par->realisations; i++)
			pick[i] = (size_t)(philox_uniform(
						   seed, (uint32_t)b, RNG_BOOTSTRAP, i) *
					   (double)par->realisations);
		status = estimate_all(e, pick, one);
		for (int q = 0; status == 0 && q < ESTIMATES; q++)
			draw[q * draws + b] = one[q].value;
	}
	for (int q = 0; status == 0 && q < ESTIMATES; q++)
		put_interval(draw + q * draws, draws, par->confidence, &out[q]);
	free(draw);
	free(pick);
	return status;
}

/* Means over the realisations; room holds three values for each. */
static void average(
	const struct ensemble *e, long step, double *room, struct step_estimate *out)
{
	const struct ensemble_par *par = ensemble_par(e);
	double *count = room, *volume = count + par->realisations;
	double *total = volume + par->realisations;
	size_t n = 0;

	for (size_t r = 0; r < par->realisations; r++) {
		const struct ensemble_cell *cell = ensemble_cell(e, r, step);

		out->all_count += cell->total_count;
		if (!cell->there)
			continue;
		count[n] = cell->count;
		volume[n] = cell->volume;
		total[n++] = cell->total_volume;
	}
	out->realisations = (double)n;
	out->count = sample_mean(count, n, par->confidence, &out->count_sd).value;
	out->volume = sample_mean(volume, n, par->confidence, &out->volume_sd).value;
	out->all_volume =
		sample_mean(total, n, par->confidence, &out->all_volume_sd).value;
}

int estimate_step(const struct ensemble *e, long step, struct step_estimate *out)
{
	const struct ensemble_par *par = ensemble_par(e);
	double *room = calloc(3 * par->realisations + 1, sizeof *room), spread;
	size_t n;
	double *x = ensemble_diameters(e, NULL, step, step, &n);
	struct weibull w;
	int status = room && x ? 0 : -1;

	*out = (struct step_estimate){ .shape = NAN, .scale = NAN };
	if (status == 0) {
		average(e, step, room, out);
		out->diameter = sample_mean(x, n, par->confidence, &spread).value;
		if (estimate_weibull(e, x, n, &w) == 0) {
			out->shape = w.shape.value;
			out->scale = w.scale.value;
		}
	}
	free(room);
	free(x);
	return status;
}
