/* Ensembles of wear particles against counts by hand. */
#include "stats/estimates.h"
#include "tap.h"
#include <stdlib.h>

/* Realisations 7 and 2, out of order; diameter, volume and aspect as easy numbers. */
static const struct shed particles[] = { { 7, 1, 10, 1, 1.5, 0 }, { 2, 3, 20, 2, 2.5, 0 },
	{ 7, 3, 30, 4, 0.5, 0 }, { 7, 3, 40, 8, 3.5, 0 }, { 2, 1, 50, 16, 1.5, 0 } };

static struct ensemble *make(const struct ensemble_par *par, long mark)
{
	struct ensemble *e = ensemble_new();

	for (int i = 0; i < 5; i++)
		ensemble_add(e, &particles[i]);
	if (mark)
		ensemble_took_place(e, mark, 2);
	ensemble_sort(e);
	ok(ensemble_told(e) == (mark && mark != 2 && mark != 7 ? 3 : 2),
		"realisations told of");
	ok(ensemble_close(e, par) == 0, "closed");
	return e;
}

static void test_cells(void)
{
	struct ensemble_par par = {
		.first = 1, .low = 15, .high = 45, .confidence = 0.9
	};
	struct ensemble *e = make(&par, 0);
	const struct ensemble_cell *second = ensemble_cell(e, 1, 3);
	double *x, count[2];
	size_t pick[2] = { 1, 1 }, n;

	ok(ensemble_par(e)->realisations == 2 && ensemble_par(e)->last == 3,
		"what 0 stands for");
	near(second->count, 2, 0, "realisation 7 comes second");
	near(second->total_volume, 13, 0, "volumes of all steps, whatever the diameter");
	near(ensemble_cell(e, 1, 1)->count, 0, 0, "diameters below do not count");
	ok(ensemble_cell(e, 0, 2)->there, "a step without particles took place");
	x = ensemble_diameters(e, NULL, 1, 3, &n);
	ok(n == 3 && x[0] == 20 && x[1] + x[2] == 70, "diameters that count");
	free(x);
	x = ensemble_diameters(e, pick, 1, 3, &n);
	ok(n == 4 && x[0] + x[2] + x[1] + x[3] == 140, "one realisation drawn twice");
	free(x);
	near(ensemble_aspects(e, (double[]){ 1, 3 }, 2, count), 3, 0, "aspects in all");
	ok(count[0] == 1 && count[1] == 1, "in their classes");
	ensemble_free(e);
}

static void test_partial(void)
{
	struct ensemble_par par = {
		.first = 1, .last = 5, .partial = 1, .high = INFINITY, .confidence = 0.9
	};
	struct ensemble *e = make(&par, 4);
	struct step_estimate s;

	ok(!ensemble_cell(e, 0, 2)->there, "a step nobody told of");
	ok(ensemble_cell(e, 1, 2)->there, "a step told of without particles");
	ok(!ensemble_cell(e, 2, 5)->there, "steps after the last one");
	ok(estimate_step(e, 3, &s) == 0, "estimates of a step");
	near(s.realisations, 2, 0, "realisations it took place in");
	near(s.count, 1.5, 1e-15, "mean count");
	near(s.count_sd, sqrt(0.5), 1e-15, "its standard deviation");
	near(s.all_count, 5, 0, "particles so far");
	near(s.volume, 7, 1e-15, "mean volume");
	near(s.all_volume, (18 + 13) / 2., 1e-14, "mean volume so far");
	near(s.diameter, 30, 1e-14, "mean diameter");
	ensemble_free(e);
}

static void test_estimates(void)
{
	struct ensemble_par par = { .first = 1, .high = INFINITY, .confidence = 0.9 };
	struct ensemble *e = make(&par, 0);
	struct estimate all[ESTIMATES], again[ESTIMATES], drawn[ESTIMATES];
	size_t each[2] = { 0, 1 };

	estimate_all(e, NULL, all);
	estimate_all(e, each, again);
	near(all[ESTIMATE_MEAN_DIAMETER].value, 30, 1e-14, "mean diameter of all");
	near(all[ESTIMATE_VOLUME_STEP].value, 31 / 6., 1e-14, "volume per step");
	ok(all[ESTIMATE_SHAPE].value == again[ESTIMATE_SHAPE].value,
		"each one picked once is the whole");
	ok(!isnan(all[ESTIMATE_KS].value) && isnan(again[ESTIMATE_KS].value),
		"no distance of draws");
	estimate_all(e, NULL, drawn);
	ok(estimate_bootstrap(e, 1, 200, drawn) == 0, "bootstrap");
	/* Two realisations: volumes per step 6, 13/3 and their mean. */
	near(drawn[ESTIMATE_VOLUME_STEP].low, 13 / 3., 1e-14, "lower end: twice one");
	near(drawn[ESTIMATE_VOLUME_STEP].high, 6, 1e-14, "upper end: twice the other");
	near(drawn[ESTIMATE_VOLUME_STEP].value, 31 / 6., 1e-14, "the value stays");
	ensemble_free(e);
}

static void test_empty(void)
{
	struct ensemble_par par = { .first = 1, .high = INFINITY, .confidence = 0.9 };
	struct ensemble *e = ensemble_new();
	struct estimate all[ESTIMATES];

	ok(ensemble_sort(e) == 0 && ensemble_close(e, &par) == 0, "no particle at all");
	ok(estimate_all(e, NULL, all) == 0 && isnan(all[ESTIMATE_SHAPE].value) &&
			isnan(all[ESTIMATE_FACTOR].value),
		"has no fit");
	ensemble_free(e);
}

int main(void)
{
	test_cells();
	test_partial();
	test_estimates();
	test_empty();
	return tap_done();
}
