#include "stats/estimates.h"
#include "num/rng.h"
#include "num/select.h"
#include "num/status.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* What the estimates are made of: an ensemble or a draw of it. */
struct basis {
	const double *diameter, *weight;
	size_t diameters;
	const double *step, *growth; /* number, and particles in it or so far */
	size_t steps;
};

/* Intervals where the confidence is no nan. */
static enum weibull_status fit(const struct ensemble_par *par, const double *x,
	const double *weight, size_t n, double confidence, struct weibull *w)
{
	return weibull_fit(x, weight, n, par->truncated ? par->low : 0,
		par->truncated ? par->high : INFINITY, confidence, w);
}

enum weibull_status estimate_weibull(
	const struct ensemble *e, const struct sketch *diameters, struct weibull *w)
{
	return fit(ensemble_par(e), diameters->value, diameters->weight, diameters->n,
		NAN, w);
}

static enum num_status estimate_fits(const struct ensemble_par *par,
	const struct basis *b, double confidence, struct weibull *w,
	struct estimate out[ESTIMATES])
{
	enum weibull_status status =
		fit(par, b->diameter, b->weight, b->diameters, confidence, w);
	struct power p;

	for (int q = 0; q < ESTIMATES; q++)
		out[q] = (struct estimate){ NAN, NAN, NAN };
	if (status == WEIBULL_MEMORY)
		return NUM_MEMORY;
	if (status == WEIBULL_OK) {
		out[ESTIMATE_SHAPE] = w->shape;
		out[ESTIMATE_SCALE] = w->scale;
		out[ESTIMATE_WEIBULL_MEAN].value = w->mean;
	}
	if (power_fit(b->step, b->growth, b->steps, par->confidence, &p) == 0) {
		out[ESTIMATE_FACTOR] = p.factor;
		out[ESTIMATE_EXPONENT] = p.exponent;
		out[ESTIMATE_OFFSET] = p.offset;
	}
	return NUM_OK;
}

/* Numbers of the steps that count, and as many places for their particles. */
static double *new_growth(const struct ensemble_par *par, struct basis *b)
{
	double *step;

	b->steps = par->last < par->first ? 0 : (size_t)(par->last - par->first + 1);
	step = calloc(2 * b->steps + 1, sizeof *step);
	for (size_t k = 0; step && k < b->steps; k++)
		step[k] = (double)(par->first + (long)k);
	b->step = step;
	b->growth = step + b->steps;
	return step;
}

enum num_status estimate_all(const struct ensemble *e, struct estimate out[ESTIMATES])
{
	const struct ensemble_par *par = ensemble_par(e);
	const struct sketch *x = ensemble_diameters(e);
	struct basis b = { .diameter = x->value, .weight = x->weight, .diameters = x->n };
	double *step = new_growth(par, &b);
	struct weibull w;
	enum num_status status;

	if (!step)
		return NUM_MEMORY;
	for (size_t k = 0; k < b.steps; k++) {
		const struct ensemble_step *s = ensemble_step(e, par->first + (long)k);

		step[b.steps + k] =
			par->per_step ? s->count.mean * s->count.n : s->total_count;
	}
	status = estimate_fits(par, &b, par->confidence, &w, out);
	if (!isnan(out[ESTIMATE_SHAPE].value))
		out[ESTIMATE_KS].value = weibull_distance(&w, x->value, x->weight, x->n);
	if (ensemble_diameter(e)->n > 0)
		out[ESTIMATE_MEAN_DIAMETER] =
			sample_mean(ensemble_diameter(e), par->confidence);
	out[ESTIMATE_VOLUME_STEP] = sample_mean(ensemble_volume(e), par->confidence);
	free(step);
	return status;
}

/* Draws of the groups. */
struct bootstrap {
	const struct ensemble *e;
	const struct ensemble_group *group;
	size_t groups, values;
	double *times; /* how often each is in the draw */
	double *value, *weight, *step;
	struct basis basis;
	gsl_rng *rng;
};

static void bootstrap_free(struct bootstrap *b)
{
	free(b->times);
	free(b->value);
	free(b->weight);
	free(b->step);
	if (b->rng)
		gsl_rng_free(b->rng);
}

static enum num_status bootstrap_open(
	struct bootstrap *b, const struct ensemble *e, uint64_t seed)
{
	*b = (struct bootstrap){ .e = e };
	b->group = ensemble_groups(e, &b->groups);
	for (size_t g = 0; g < b->groups; g++)
		b->values += b->group[g].diameters.n;
	b->times = calloc(b->groups + 1, sizeof *b->times);
	b->value = calloc(b->values + 1, sizeof *b->value);
	b->weight = calloc(b->values + 1, sizeof *b->weight);
	b->step = new_growth(ensemble_par(e), &b->basis);
	b->basis.diameter = b->value;
	b->basis.weight = b->weight;
	b->rng = rng_new(seed, 0, RNG_BOOTSTRAP);
	if (b->times && b->value && b->weight && b->step && b->rng)
		return NUM_OK;
	bootstrap_free(b);
	return NUM_MEMORY;
}

/* Draws as many groups as there are, including realisations without rows; returns the
 * number of realisations drawn. */
static double draw_groups(struct bootstrap *b)
{
	size_t n = b->groups;
	double per_group = (double)ensemble_reported(b->e) / (double)n, drawn = 0;
	double empty = round(ensemble_empty(b->e) / per_group);
	unsigned int picks = (unsigned int)n;

	if (empty > 0 && (double)n + empty < UINT_MAX)
		picks = gsl_ran_binomial(b->rng, (double)n / ((double)n + empty),
			(unsigned int)((double)n + empty));
	else if (empty > 0)
		picks = gsl_ran_poisson(b->rng, (double)n);
	for (size_t g = 0; g < n; g++)
		b->times[g] = 0;
	for (unsigned int i = 0; i < picks; i++)
		b->times[gsl_rng_uniform_int(b->rng, (unsigned long)n)]++;
	for (size_t g = 0; g < n; g++)
		drawn += b->times[g] * b->group[g].realisations;
	return drawn + fmax((double)n + empty - picks, 0) * per_group;
}

/* Particles of the draw in each step, or up to it, scaled to the number of realisations.
 */
static void sum_growth(struct bootstrap *b, double drawn)
{
	const struct ensemble_par *par = ensemble_par(b->e);
	double *growth = b->step + b->basis.steps, so_far = 0;

	for (size_t k = 0; k < b->basis.steps; k++)
		growth[k] = 0;
	for (size_t g = 0; g < b->groups; g++) {
		const struct ensemble_group *a = &b->group[g];
		double times = b->times[g] * par->realisations / drawn;

		for (size_t s = 0; b->times[g] > 0 && s < a->steps; s++) {
			long k = (long)s + 1 - par->first;

			if (k < 0 && !par->per_step)
				so_far += times * a->count[s];
			if (k >= 0 && k < (long)b->basis.steps)
				growth[k] += times * a->count[s];
		}
	}
	for (size_t k = 0; !par->per_step && k < b->basis.steps; k++)
		so_far = growth[k] += so_far;
}

/* Estimates of a draw with this number of realisations. */
static enum num_status draw_estimates(
	struct bootstrap *b, double drawn, struct estimate out[ESTIMATES])
{
	const struct ensemble_par *par = ensemble_par(b->e);
	double volume = 0, worn = 0, known = 0;
	struct running diameter = { 0 };
	struct weibull w;

	b->basis.diameters = 0;
	for (size_t g = 0; g < b->groups; g++) {
		const struct ensemble_group *a = &b->group[g];

		if (!(b->times[g] > 0))
			continue;
		known += b->times[g] * a->realisations;
		volume += b->times[g] * a->volume;
		worn += b->times[g] * a->worn;
		for (size_t i = 0; i < a->diameters.n; i++) {
			size_t k = b->basis.diameters++;

			b->value[k] = a->diameters.value[i];
			b->weight[k] = a->diameters.weight[i] * b->times[g];
			running_repeat(&diameter, b->value[k], b->weight[k]);
		}
	}
	sum_growth(b, drawn);
	if (estimate_fits(par, &b->basis, NAN, &w, out))
		return NUM_MEMORY;
	if (!par->partial)
		worn += drawn - known;
	if (diameter.n > 0)
		out[ESTIMATE_MEAN_DIAMETER].value = diameter.mean;
	if (worn > 0)
		out[ESTIMATE_VOLUME_STEP].value = volume / worn;
	return NUM_OK;
}

/* Draws of all estimates, [quantity][draw], in fresh memory; NULL when out of memory. */
static double *draw_all(const struct ensemble *e, uint64_t seed, long draws,
	const struct estimate value[ESTIMATES])
{
	double *draw = calloc((size_t)draws * ESTIMATES, sizeof *draw);
	struct estimate each[ESTIMATES];
	struct bootstrap b;
	enum num_status status = draw ? bootstrap_open(&b, e, seed) : NUM_MEMORY;

	if (status) {
		free(draw);
		return NULL;
	}
	/* Each group once: differs from the ensemble where diameters had to be merged. */
	for (size_t g = 0; g < b.groups; g++)
		b.times[g] = 1;
	status = draw_estimates(&b, ensemble_par(e)->realisations, each);
	for (long i = 0; status == 0 && i < draws; i++) {
		struct estimate one[ESTIMATES];

		rng_reset(b.rng, seed, (uint32_t)i, RNG_BOOTSTRAP);
		status = draw_estimates(&b, draw_groups(&b), one);
		for (int q = 0; status == 0 && q < ESTIMATES; q++)
			draw[q * draws + i] =
				one[q].value + (value[q].value - each[q].value);
		if (ensemble_par(e)->progress)
			ensemble_par(e)->progress(i + 1, draws);
	}
	bootstrap_free(&b);
	if (status == 0)
		return draw;
	free(draw);
	return NULL;
}

/* Interval of one quantity from its draws, which are reordered: its distances from the
 * quantiles of the draws, of the logarithms of a positive quantity, times wider. */
static void put_interval(
	double *x, long draws, double confidence, double wider, struct estimate *out)
{
	size_t n = 0;
	double low, high;

	for (long b = 0; b < draws; b++)
		if (!isnan(x[b]))
			x[n++] = x[b];
	out->low = out->high = NAN;
	if (n == 0)
		return;
	sort_numbers(x, n);
	low = sorted_quantile(x, n, 0.5 - 0.5 * confidence);
	high = sorted_quantile(x, n, 0.5 + 0.5 * confidence);
	if (x[0] > 0 && out->value > 0) {
		out->low = out->value * pow(low / out->value, wider);
		out->high = out->value * pow(high / out->value, wider);
	} else {
		out->low = out->value + wider * (low - out->value);
		out->high = out->value + wider * (high - out->value);
	}
}

enum num_status estimate_bootstrap(const struct ensemble *e, uint64_t seed, long draws,
	struct estimate out[ESTIMATES])
{
	double *draw = draw_all(e, seed, draws, out), k = ensemble_par(e)->realisations;
	double confidence = ensemble_par(e)->confidence, p = 0.5 + 0.5 * confidence;
	double wider = gsl_cdf_tdist_Pinv(p, k - 1) / gsl_cdf_ugaussian_Pinv(p) *
		       sqrt(k / (k - 1));

	if (!draw)
		return NUM_MEMORY;
	for (int q = 0; q < ESTIMATES; q++)
		put_interval(draw + q * draws, draws, confidence, wider, &out[q]);
	free(draw);
	return NUM_OK;
}

enum num_status estimate_errors(const struct ensemble *e, uint64_t seed, long draws,
	const struct estimate value[ESTIMATES], double error[ESTIMATES],
	double log_error[ESTIMATES])
{
	double *draw = draw_all(e, seed, draws, value), k = ensemble_par(e)->realisations;
	const struct running *volume = ensemble_volume(e);

	if (!draw)
		return NUM_MEMORY;
	for (int q = 0; q < ESTIMATES; q++) {
		struct running plain = { 0 }, log_of = { 0 };

		for (long i = 0; i < draws; i++) {
			double x = draw[q * draws + i];

			if (!isnan(x))
				running_add(&plain, x);
			if (x > 0)
				running_add(&log_of, log(x));
		}
		error[q] = sqrt(running_variance(&plain) * k / (k - 1));
		log_error[q] = sqrt(running_variance(&log_of) * k / (k - 1));
	}
	error[ESTIMATE_VOLUME_STEP] = sqrt(running_variance(volume) / volume->n);
	log_error[ESTIMATE_VOLUME_STEP] = error[ESTIMATE_VOLUME_STEP] / volume->mean;
	free(draw);
	return NUM_OK;
}

/* Student's t of the sum of two variances (Welch, Biometrika 34 (1947) 28). */
static double welch_t(
	const double error[2], const double realisations[2], double confidence)
{
	double sum = 0, square = 0;

	for (int i = 0; i < 2; i++) {
		double v = error[i] * error[i];

		sum += v;
		square += v * v / (realisations[i] - 1);
	}
	return gsl_cdf_tdist_Pinv(0.5 + 0.5 * confidence, sum * sum / square);
}

struct estimate_contrast estimate_compare(const double value[2], const double error[2],
	const double log_error[2], const double realisations[2], double confidence)
{
	struct estimate_contrast c = { { NAN, NAN, NAN }, { NAN, NAN, NAN }, NAN };
	double wide = hypot(error[0], error[1]), log_ratio;

	c.difference.value = value[1] - value[0];
	if (wide > 0) {
		double half = wide * welch_t(error, realisations, confidence);

		c.difference.low = c.difference.value - half;
		c.difference.high = c.difference.value + half;
	}
	if (!(value[0] > 0 && value[1] > 0))
		return c;
	log_ratio = log(value[1] / value[0]);
	c.ratio.value = value[1] / value[0];
	wide = hypot(log_error[0], log_error[1]);
	if (wide > 0) {
		double half = wide * welch_t(log_error, realisations, confidence);
		/* For the normal law: the end of the interval, plus the quantile of a
		 * power of nine in ten. */
		double far = gsl_cdf_ugaussian_Pinv(0.5 + 0.5 * confidence) +
			     gsl_cdf_ugaussian_Pinv(0.9);
		double one = log_error[0] * log_error[0] * realisations[0] +
			     log_error[1] * log_error[1] * realisations[1];

		c.ratio.low = exp(log_ratio - half);
		c.ratio.high = exp(log_ratio + half);
		c.realisations = fmax(2, ceil(one * far * far / (log_ratio * log_ratio)));
	}
	return c;
}
