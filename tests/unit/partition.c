/* partition - sums over classes and zone, draws of the mean, large particles */
#include "life/prior/partition.h"
#include "num/rng.h"
#include "tap.h"
#include <gsl/gsl_randist.h>

static const double fragment = 1e-8, area = 1e-6; /* 100 fragments */

/* integral of y0 (p / p0)^s by many midpoints */
static double mean_by_midpoints(double p0, double y0, double p1, double y1)
{
	int n = 200000;
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += y0 * pow(1 + (p1 / p0 - 1) * (i + 0.5) / n,
				    log(y1 / y0) / log(p1 / p0));
	return sum / n;
}

static void check_power_mean(void)
{
	double s[] = { -3, -1, -0.5, 0, 0.7, 1, 1.5 };

	for (int i = 0; i < 7; i++) {
		double y1 = 2 * pow(20, s[i]);

		near(partition_power_mean(1e6, 2, 20e6, y1) /
				mean_by_midpoints(1e6, 2, 20e6, y1),
			1, 1e-7,
			"the mean of a power law between two pressures is right");
	}
	near(partition_power_mean(1, 0, 3, 4), 2, 0,
		"the law is linear where one class does not wear");
}

static enum partition_status add_row(
	struct partition *p, int class, long r, long step, double volume, int large)
{
	return partition_fragment(
		p, class, &(struct realisation_cell){ r, step, 0, volume, 1, large });
}

/* Two classes, three realisations of two steps each. */
static struct partition *two_classes(double area1, double area2, long first_step)
{
	struct partition *p = partition_new(area, first_step, 1);
	int high = partition_class(p, 0, 21e6, area1),
	    low = partition_class(p, 0, 1e6, area2);

	for (int r = 0; r < 3; r++)
		for (int s = 1; s <= 2; s++) {
			add_row(p, high, r, s, 10 + r + 3 * s, 0);
			add_row(p, low, r, s, 1 + r * 0.1, 0);
		}
	return p;
}

static void check_estimate(void)
{
	struct partition *p = two_classes(-1, -1, 1);
	struct partition_wear w, one;
	double mh = 15.5, ml = 1.1, zone;

	ok(partition_close(p, fragment, 0.1) == PARTITION_OK, "two classes are closed");
	w = partition_estimate(p, 0);
	zone = partition_power_mean(1e6, ml, 21e6, mh);
	near(w.mean, 45 * mh + 45 * ml + 10 * zone, 1e-9,
		"the wear of the component is right");
	/* Only the zone keeps both classes from adding up by hand: remove it. */
	partition_free(p);
	p = two_classes(-1, -1, 2);
	partition_close(p, fragment, 0);
	w = partition_estimate(p, 0);
	one = partition_estimate(p, 1);
	near(w.mean, 50 * 17 + 50 * 1.1, 1e-9, "steps before the first one do not count");
	near(w.life_variance, 50 * 1 + 50 * 0.01, 1e-9,
		"the variance of independent fragments is that of one times their number");
	near(one.life_variance, 2500 * 1 + 2500 * 0.01, 1e-7,
		"the variance of a single part is that of one fragment times their number squared");
	near(w.step_variance, w.life_variance, 1e-9,
		"with one step the variance of a unit is that of a step");
	partition_free(p);
	p = two_classes(0.3e-6, 0.2e-6, 1);
	partition_close(p, fragment, 0.1);
	w = partition_estimate(p, 0);
	near(w.mean, 30 * mh + 20 * ml + 50 * zone, 1e-9,
		"the zone has the area that the classes leave");
	partition_free(p);
}

/* Volumes of mean 1, of a law: the k-th of an ensemble. */
static double draw_volume(int law, gsl_rng *rng)
{
	switch (law) {
	case 0:
		return fmax(1 + 0.1 * gsl_ran_gaussian(rng, 1), 0);
	case 1:
		return 2 * gsl_rng_uniform(rng);
	case 2:
		return gsl_ran_exponential(rng, 1);
	case 3:
		return gsl_ran_gamma(rng, 0.5, 2);
	case 4:
		return exp(gsl_ran_gaussian(rng, 1) - 0.5);
	case 5:
		return exp(1.5 * gsl_ran_gaussian(rng, 1) - 1.125);
	case 6:
		return gsl_rng_uniform(rng) < 0.3 ? 0 : gsl_ran_gamma(rng, 4, 0.25 / 0.7);
	case 7:
		return gsl_ran_weibull(rng, 0.5, 0.5);
	case 8:
		return gsl_ran_weibull(rng, 2 / sqrt(M_PI), 2);
	case 9:
		return gsl_ran_pareto(rng, 1.5, 1) / 3;
	case 10:
		return gsl_ran_pareto(rng, 2, 1) / 2;
	case 12:
		return gsl_rng_uniform(rng) < 0.5 ? 0 : gsl_ran_gamma(rng, 4, 0.5);
	default:
		return gsl_ran_pareto(rng, 3, 1) / 1.5;
	}
}

/* Share of ensembles of k realisations, of those with any wear, whose interval of 90 %
 * holds the mean; the draws lie within it where at most 95 % of them lie to either side
 * of the truth. */
static double coverage(int law, int k)
{
	enum { ENSEMBLES = 1000, DRAWS = 100 };
	gsl_rng *rng = rng_new(3, 0, RNG_LIFE);
	int held = 0, worn = 0;

	for (int i = 0; i < ENSEMBLES; i++) {
		struct partition *p = partition_new(fragment, 1, 0);
		double sum = 0;
		int below = 0;

		rng_reset(rng, 3, (uint32_t)i, RNG_LIFE);
		partition_class(p, 0, NAN, -1);
		for (int r = 0; r < k; r++) {
			double volume = draw_volume(law, rng);

			sum += volume;
			add_row(p, 0, r, 1, volume, 0);
		}
		partition_close(p, fragment, 0);
		worn += sum > 0;
		for (int d = 0; d < DRAWS; d++) {
			struct partition_wear w;

			w = partition_replicate(p, 0, rng);
			below += w.mean < 1;
		}
		held += below > 0.05 * DRAWS && below < 0.95 * DRAWS;
		partition_free(p);
	}
	gsl_rng_free(rng);
	return (double)held / worn;
}

/* Measured with 20 000 ensembles and exact quantiles: see partition.h.  Of 100 draws the
 * interval is a percent narrower; sampling error of 1000 ensembles: 0.012. */
static void check_coverage(void)
{
	static const char *const laws[] = { "normal", "uniform", "exponential",
		"gamma of shape 0.5", "lognormal of sigma 1", "lognormal of sigma 1.5",
		"gamma with zeros", "Weibull of shape 0.5", "Weibull of shape 2",
		"Pareto of index 1.5", "Pareto of index 2", "Pareto of index 3",
		"half zeros" };
	static const int counts[] = { 3, 4, 5, 10, 30 };

	for (int law = 0; law < 13; law++)
		for (int k = 0; k < 5; k++) {
			double c = coverage(law, counts[k]);

			ok(c > (law == 9 ? 0.83 : 0.85) && c < 0.97,
				"%s, %d volumes: 90 %% intervals contain the mean in %.3f of the ensembles",
				laws[law], counts[k], c);
		}
}

/* With many realisations the draws scatter like a mean: variance / n. */
static void check_draws(void)
{
	enum { N = 4000 };
	struct partition *p = partition_new(area, 1, 0);
	gsl_rng *rng = rng_new(1, 0, RNG_BOOTSTRAP);
	struct partition_wear w, all;
	double mean = 0, square = 0, want;

	partition_class(p, 0, NAN, -1);
	for (int r = 0; r < 400; r++)
		for (int s = 1; s <= 4; s++)
			add_row(p, 0, r, s, 1 + (r * 7 % 25) * 0.1 + s * 0.01, 0);
	ok(partition_close(p, fragment, 0.1) == PARTITION_OK,
		"one class needs no pressure");
	all = partition_estimate(p, 0);
	for (int i = 0; i < N; i++) {
		double d;

		rng_reset(rng, 1, (uint32_t)i, RNG_BOOTSTRAP);
		w = partition_replicate(p, 0, rng);
		d = w.mean - all.mean;
		mean += d / N;
		square += d * d / N;
	}
	/* 100 fragments of variance s^2 in the estimate by 400: (100)^2 s^2 / 400;
	 * all.life_variance is 100 s^2.  Sampling errors at 4 sigma. */
	want = 100 * all.life_variance / 400;
	near(mean, 0, 4 * sqrt(want / N), "the draws are unbiased");
	near(square / want, 1, 4 * sqrt(2. / N),
		"the variance of the draws is that of a mean of 400");
	gsl_rng_free(rng);
	partition_free(p);
}

/* Two realisations with particles among 4e12 numbers: how many of them are drawn is
 * nearly Poisson with mean 2, at no cost. */
static void check_sparse_draws(void)
{
	enum { N = 4000 };
	struct partition *p = partition_new(fragment, 1, 1);
	gsl_rng *rng = rng_new(1, 0, RNG_BOOTSTRAP);
	double mean, error;
	int none = 0;

	partition_class(p, 1, NAN, -1);
	add_row(p, 0, 0, 1, 1, 1);
	add_row(p, 0, 4000000000000, 1, 1, 1);
	ok(partition_close(p, fragment, 0) == PARTITION_OK,
		"two rows in 4e12 realisations are accepted");
	near(partition_count(p, 0, &mean, &error) / 4000000000001., 1, 1e-15,
		"realisations without particles are counted");
	for (int i = 0; i < N; i++) {
		partition_replicate(p, 0, rng);
		none += partition_large(p, 0.5, 1) == 0;
	}
	near((double)none / N, exp(-2), 4 * sqrt(0.135 * 0.865 / N),
		"neither row is drawn in exp(-2) of the replicates");
	gsl_rng_free(rng);
	partition_free(p);
}

/* 20000 realisations of which one in ten sheds a large particle and all shed nine small
 * ones in step 1; in step 2 it is the other way round.  The share in groups scatters as
 * it does one by one. */
static void check_groups(void)
{
	enum { R = 20000, N = 2000 };
	struct partition *p = partition_new(fragment, 1, 1);
	gsl_rng *rng = rng_new(1, 0, RNG_BOOTSTRAP);
	struct partition_wear w;
	int first = 0;

	partition_class(p, 0, NAN, -1);
	for (int r = 0; r < R; r++) {
		add_row(p, 0, r, 1, 1, r % 10 == 3);
		add_row(p, 0, r, 2, 1, r % 10 != 3);
	}
	ok(partition_close(p, fragment, 0) == PARTITION_OK,
		"20000 realisations are accepted");
	w = partition_estimate(p, 0);
	ok(partition_large(p, 0.0999, 0) == 1 && partition_large(p, 0.1001, 0) == 2,
		"groups keep the counts of particles");
	near(w.step_variance, 0, 1e-12, "equal volumes have no variance");
	for (int i = 0; i < N; i++) {
		partition_replicate(p, 0, rng);
		first += partition_large(p, 0.1, 0) == 1;
	}
	ok(first > 0.4 * N && first < 0.6 * N,
		"half of the replicates reach the share of large particles");
	gsl_rng_free(rng);
	partition_free(p);
}

static void check_order(void)
{
	struct partition *p = partition_new(fragment, 1, 0);
	struct partition_wear w;
	enum partition_status status = PARTITION_OK;

	/* Rows by steps instead of realisations, fewer than there is room for. */
	partition_class(p, 1, NAN, -1);
	for (int s = 1; s <= 3; s++)
		for (int r = 0; r < 50; r++)
			add_row(p, 0, r, s, r + s, 0);
	ok(partition_close(p, fragment, 0) == PARTITION_OK,
		"rows in the order of steps are accepted");
	w = partition_estimate(p, 0);
	near(w.mean, 24.5 + 2, 1e-12,
		"rows in the order of steps are grouped by realisation");
	partition_free(p);
	/* More rows, so that the first realisations have been passed on. */
	p = partition_new(fragment, 1, 0);
	partition_class(p, 1, NAN, -1);
	for (int s = 1; s <= 2 && status == PARTITION_OK; s++)
		for (int r = 0; r < 600000 && status == PARTITION_OK; r++)
			status = add_row(p, 0, r, s, 1, 0);
	if (status == PARTITION_OK)
		status = partition_close(p, fragment, 0);
	ok(status == PARTITION_APART, "rows too far apart for memory are refused");
	partition_free(p);
}

static void check_sparse(void)
{
	struct partition *p = partition_new(fragment, 1, 1);
	struct partition_wear w;

	/* Realisations 0..3 and steps 1..2; only two cells hold particles. */
	partition_class(p, 1, NAN, -1);
	add_row(p, 0, 0, 1, 2, 0);
	add_row(p, 0, 0, 1, 4, 1);
	add_row(p, 0, 3, 2, 8, 1);
	ok(partition_close(p, fragment, 0) == PARTITION_OK,
		"a table of particles is accepted");
	w = partition_estimate(p, 0);
	near(w.mean, 14 / 8., 1e-15, "realisations without particles have no volume");
	near(w.step_variance, (36 + 64 - 14 * 14 / 8.) / 7, 1e-13,
		"the variance of a step is that over all steps");
	near(w.life_variance, (36 + 64 - 14 * 14 / 4.) / 3 / 4, 1e-13,
		"the variance of a life is that of the means of realisations");
	ok(partition_large(p, 0.5, 1) == 1, "half of the particles of step 1 are large");
	ok(partition_large(p, 0.6, 1) == 2,
		"two of three particles are large after step 2");
	ok(partition_large(p, 0.7, 1) == 0, "the large particles are never 70 %% of all");
	ok(partition_large(p, 0.7, 0) == 2,
		"the large particles are 100 %% of those of step 2");
	partition_free(p);
}

static void check_refusals(void)
{
	struct partition *p = two_classes(-1, -1, 1);
	int c = partition_class(p, 0, 21e6, -1);

	ok(partition_close(p, fragment, 0.1) == PARTITION_EMPTY &&
			partition_culprit(p) == c,
		"a class without fragments is refused");
	partition_free(p);
	p = two_classes(0.9e-6, 0.2e-6, 1);
	ok(partition_close(p, fragment, 0.1) == PARTITION_AREA,
		"classes larger than the component are refused");
	partition_free(p);
	p = two_classes(-1, -1, 1);
	c = partition_class(p, 0, 1e6, -1);
	add_row(p, c, 0, 1, 1, 0);
	ok(partition_close(p, fragment, 0.1) == PARTITION_PRESSURE,
		"a pressure that occurs twice is refused");
	partition_free(p);
	p = two_classes(-1, -1, 1);
	add_row(p, 1, 2, 2, 1, 0);
	ok(partition_close(p, fragment, 0.1) == PARTITION_TWICE &&
			partition_culprit(p) == 1,
		"a step twice in succession is refused");
	partition_free(p);
	p = two_classes(-1, -1, 1);
	add_row(p, 0, 0, 1, 1, 0);
	ok(partition_close(p, fragment, 0.1) == PARTITION_TWICE &&
			partition_culprit(p) == 0,
		"a step twice in rows apart is refused");
	partition_free(p);
	for (long step = 1; step <= 2; step++) {
		p = partition_new(1e-6, 1, 0);
		c = partition_class(p, 1, 1e6, -1);
		add_row(p, c, 0, 1, 1, 0);
		partition_fragment(
			p, c, &(struct realisation_cell){ 0, step, 1, 1, 1, 0 });
		ok(partition_close(p, fragment, 0.1) ==
				(step == 1 ? PARTITION_TWICE : PARTITION_OK),
			step == 1 ? "the particles of a step in two parts are refused"
				  : "steps in two parts are accepted");
		partition_free(p);
	}
	p = two_classes(-1, -1, 3);
	ok(partition_close(p, fragment, 0.1) == PARTITION_EMPTY,
		"fragments without a step after running-in are refused");
	partition_free(p);
	p = partition_new(area, 1, 0);
	for (int k = 0; k < PARTITION_CLASSES_MAX; k++)
		partition_class(p, 0, 1e6 * (k + 1), -1);
	ok(partition_class(p, 0, 1e9, -1) < 0,
		"a class beyond the last place is refused");
	partition_free(p);
}

int main(void)
{
	check_power_mean();
	check_estimate();
	check_coverage();
	check_draws();
	check_sparse_draws();
	check_groups();
	check_order();
	check_sparse();
	check_refusals();
	return tap_done();
}
