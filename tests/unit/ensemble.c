/* Ensembles of wear particles against counts by hand. */
#include "num/philox.h"
#include "stats/estimates.h"
#include "tap.h"
#include <gsl/gsl_cdf.h>

/* Realisations 7 and 2, out of order; diameter and volume as easy numbers. */
static const struct particle_row particles[] = { { 7, 1, 10, 1, 0 }, { 2, 3, 20, 2, 0 },
	{ 7, 3, 30, 4, 0 }, { 7, 3, 40, 8, 0 }, { 2, 1, 50, 16, 0 } };

/* mark: realisation of which step 2 is stated; 0: none. */
static struct ensemble *make(const struct ensemble_par *par, long mark)
{
	struct ensemble *e = ensemble_new(par);

	for (int i = 0; i < 5; i++)
		ensemble_add(e, &particles[i]);
	if (mark)
		ensemble_took_place(e, mark, 2);
	ok(ensemble_close(e) == ENSEMBLE_OK, "the ensemble is closed");
	ok(ensemble_reported(e) == (mark && mark != 2 && mark != 7 ? 3 : 2),
		"realisations with rows are counted");
	return e;
}

static void test_sums(void)
{
	struct ensemble_par par = {
		.first = 1, .low = 15, .high = 45, .confidence = 0.9, .by_step = 1
	};
	struct ensemble *e = make(&par, 0);
	const struct ensemble_step *third = ensemble_step(e, 3);
	const struct sketch *x = ensemble_diameters(e);

	ok(ensemble_par(e)->realisations == 2 && ensemble_par(e)->last == 3,
		"the default of 0 is replaced");
	near(third->count.mean, 1.5, 0, "the mean count includes the selected diameters");
	near(sqrt(running_variance(&third->count)), sqrt(0.5), 1e-15,
		"the standard deviation of the count is right");
	near(third->total_volume.mean, (18 + 13) / 2., 0,
		"the volumes of all steps include every diameter");
	near(ensemble_step(e, 1)->count.mean, 0, 0,
		"diameters outside the limits do not count");
	near(ensemble_step(e, 2)->count.n, 2, 0,
		"a step without particles counts as a step");
	near(ensemble_step(e, 2)->total_volume.mean, (16 + 1) / 2., 0,
		"a step without particles keeps the cumulative volume");
	near(third->total_count, 3, 0, "the particles of all steps so far are summed");
	ok(x->n == 3 && x->value[0] == 20 && x->value[1] == 30 && x->value[2] == 40,
		"the selected diameters are in ascending order");
	ok(ensemble_step_diameters(e, 1)->n == 0 && ensemble_step_diameters(e, 3)->n == 3,
		"selected diameters are stored by step");
	near(ensemble_volume(e)->mean, (18 + 13) / 2. / 3, 1e-15,
		"the mean volume of a realisation per step is right");
	ensemble_free(e);
}

static void test_partial(void)
{
	struct ensemble_par par = { .first = 1,
		.last = 5,
		.partial = 1,
		.high = INFINITY,
		.confidence = 0.9,
		.by_step = 1 };
	struct ensemble *e = make(&par, 4);
	const struct ensemble_step *third = ensemble_step(e, 3);

	near(ensemble_step(e, 2)->count.n, 1, 0, "a step without particles is accepted");
	near(ensemble_step(e, 2)->count.mean, 0, 0,
		"a step without particles has no particles");
	near(ensemble_step(e, 5)->count.n, 0, 0,
		"steps after the last one are missing values");
	near(third->count.n, 2, 0, "the realisations with a step are counted");
	near(third->total_count, 5, 0, "the particles of all steps so far are summed");
	near(third->volume.mean, 7, 1e-15, "the mean volume is right");
	near(third->total_volume.mean, (18 + 13) / 2., 1e-14,
		"the mean volume of all steps so far is right");
	/* Two steps each of 2 and 7, one of 4. */
	near(ensemble_volume(e)->mean, (9 + 6.5 + 0) / 3, 1e-14,
		"volumes are divided by the steps that took place");
	ensemble_free(e);
}

static void test_estimates(void)
{
	struct ensemble_par par = {
		.first = 1, .high = INFINITY, .confidence = 0.9, .groups = 8
	};
	struct ensemble *e = make(&par, 0);
	struct estimate all[ESTIMATES];
	double wider;
	size_t n;

	ensemble_groups(e, &n);
	ok(n == 2, "each realisation is a group");
	ok(estimate_all(e, all) == 0, "the estimates are computed");
	near(all[ESTIMATE_MEAN_DIAMETER].value, 30, 1e-14, "the mean diameter is right");
	near(all[ESTIMATE_VOLUME_STEP].value, 31 / 6., 1e-14,
		"the volume per step is right");
	ok(estimate_bootstrap(e, 1, 200, all) == 0, "the bootstrap succeeds");
	/* Draws: 7 twice, 2 twice, or both.  Student's t of one degree over the normal
	 * quantile, and half of the variance. */
	wider = 6.313751514675043 / 1.6448536269514722 * sqrt(2);
	near(all[ESTIMATE_VOLUME_STEP].low, 31 / 6. * pow(26 / 31., wider), 1e-12,
		"the interval begins as far below as the lowest draw, times wider");
	near(all[ESTIMATE_VOLUME_STEP].high, 31 / 6. * pow(36 / 31., wider), 1e-12,
		"it ends as far above as the highest draw, times wider");
	ensemble_free(e);
}

static void test_refusals(void)
{
	struct ensemble_par par = { .first = 1, .high = INFINITY, .realisations = 1 };
	struct ensemble *e = ensemble_new(&par);

	for (int i = 0; i < 5; i++)
		ensemble_add(e, &particles[i]);
	ok(ensemble_close(e) == ENSEMBLE_MORE && ensemble_reported(e) == 2,
		"more realisations than stated are refused");
	ensemble_free(e);
	e = ensemble_new(&par);
	for (long part = 0; part < 2; part++)
		ensemble_add(e, &(struct particle_row){ 3, 1, 1, 1, part });
	ok(ensemble_close(e) == ENSEMBLE_CLASH && ensemble_culprit(e) == 3,
		"a realisation in two parts is refused");
	ensemble_free(e);
}

/* 300000 diameters of a Weibull distribution: more than are kept one by one, in 3000
 * realisations, more than there are groups. */
static void test_large(void)
{
	enum { REALISATIONS = 3000, EACH = 100, N = REALISATIONS * EACH };
	struct ensemble_par par = {
		.first = 1, .high = INFINITY, .confidence = 0.9, .groups = 256
	};
	struct ensemble *e = ensemble_new(&par);
	static double x[N];
	struct estimate out[ESTIMATES];
	struct weibull w;
	double plain;

	for (long i = 0; i < N; i++) {
		struct particle_row s = {
			.realisation = 1000000 - i / EACH, .step = 1 + i % 4, .volume = 1
		};

		x[i] = s.diameter =
			2e-5 *
			pow(-log(philox_uniform(5, 0, RNG_BOOTSTRAP, (uint64_t)i)), 0.4);
		ensemble_add(e, &s);
	}
	ok(ensemble_close(e) == ENSEMBLE_OK, "300000 particles are counted");
	ok(ensemble_diameters(e)->n <= SKETCH_MOST, "near diameters are merged");
	weibull_fit(x, NULL, N, 0, INFINITY, 0.9, &w);
	estimate_all(e, out);
	/* The classes are narrower than 1e-4: see sketch.h. */
	near(out[ESTIMATE_SHAPE].value / w.shape.value, 1, 1e-7,
		"merging hardly changes the shape");
	near(out[ESTIMATE_SCALE].value / w.scale.value, 1, 1e-8,
		"merging hardly changes the scale");
	plain = (out[ESTIMATE_SHAPE].high - out[ESTIMATE_SHAPE].low) / 2;
	ok(estimate_bootstrap(e, 1, 200, out) == 0, "the bootstrap of groups succeeds");
	/* Independent particles: the interval of the likelihood; 200 draws of 256 groups
	 * give its width to about 10 %, taken three times. */
	near((out[ESTIMATE_SHAPE].high - out[ESTIMATE_SHAPE].low) / 2 / plain, 1, 0.3,
		"the bootstrap has the width of the interval of independent diameters");
	near((out[ESTIMATE_SHAPE].high + out[ESTIMATE_SHAPE].low) / 2, w.shape.value,
		plain, "the bootstrap interval contains the value");
	ensemble_free(e);
}

/* Few realisations whose particles are alike. */
static void test_few(void)
{
	enum { RUNS = 200, REALISATIONS = 3, EACH = 3 };
	struct ensemble_par par = {
		.first = 1, .high = INFINITY, .confidence = 0.9, .groups = 8
	};
	uint64_t at = 0;
	int held = 0;

	for (int run = 0; run < RUNS; run++) {
		struct ensemble *e = ensemble_new(&par);
		struct estimate out[ESTIMATES];

		for (long r = 0; r < REALISATIONS; r++) {
			double own = gsl_cdf_ugaussian_Pinv(
				philox_uniform(9, 0, RNG_BOOTSTRAP, at++));

			for (int i = 0; i < EACH; i++) {
				double d = gsl_cdf_ugaussian_Pinv(
					philox_uniform(9, 0, RNG_BOOTSTRAP, at++));

				ensemble_add(e, &(struct particle_row){ r, 1,
							30 + 4 * own + 4 * d, 1, 1 });
			}
		}
		ensemble_close(e);
		estimate_all(e, out);
		estimate_bootstrap(e, (uint64_t)run, 199, out);
		held += out[ESTIMATE_MEAN_DIAMETER].low <= 30 &&
			out[ESTIMATE_MEAN_DIAMETER].high >= 30;
		ensemble_free(e);
	}
	/* Three standard deviations of a binomial count of 0.9. */
	ok(fabs(held - 0.9 * RUNS) < 13,
		"90 %% intervals of three realisations contain the mean diameter in %d of %d cases",
		held, RUNS);
}

int main(void)
{
	test_sums();
	test_partial();
	test_estimates();
	test_refusals();
	test_large();
	test_few();
	return tap_done();
}
