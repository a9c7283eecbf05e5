/* partition - sums over classes and zone, bootstrap, large particles */
#include "life/partition.h"
#include "num/rng.h"
#include "tap.h"

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
			1, 1e-7, "mean of a power law between two pressures");
	}
	near(partition_power_mean(1, 0, 3, 4), 2, 0,
		"linear where one class does not wear");
}

/* Two classes, three realisations of two steps each. */
static struct partition *two_classes(double area1, double area2)
{
	struct partition *p = partition_new(fragment, area);
	int high = partition_class(p, 0, 21e6, area1),
	    low = partition_class(p, 0, 1e6, area2);

	for (int r = 0; r < 3; r++)
		for (int s = 1; s <= 2; s++) {
			partition_fragment(p, high, r, s, 10 + r + 3 * s, 1, 0);
			partition_fragment(p, low, r, s, 1 + r * 0.1, 1, 0);
		}
	return p;
}

static void check_estimate(void)
{
	struct partition *p = two_classes(-1, -1);
	struct partition_wear w, one;
	double mh = 15.5, ml = 1.1, zone;

	ok(partition_close(p, 0.1, 1) == PARTITION_OK, "two classes close");
	near(partition_load(p), 0.45 * 21 + 0.45 * 1 + 0.1 * 11, 1e-12,
		"load is pressure by area: 45 %% for each extreme, 10 %% for the zone");
	partition_estimate(p, 0, &w);
	zone = partition_power_mean(1e6, ml, 21e6, mh);
	near(w.mean, 45 * mh + 45 * ml + 10 * zone, 1e-9, "wear of the component");
	/* Only the zone keeps both classes from adding up by hand: take it away. */
	partition_free(p);
	p = two_classes(-1, -1);
	partition_close(p, 0, 2);
	partition_estimate(p, 0, &w);
	partition_estimate(p, 1, &one);
	near(w.mean, 50 * 17 + 50 * 1.1, 1e-9, "steps before the first do not count");
	near(w.life_variance, 50 * 2 / 3. + 50 * 0.02 / 3, 1e-9,
		"independent fragments: variance of one times their number");
	near(one.life_variance, 2500 * 2 / 3. + 2500 * 0.02 / 3, 1e-7,
		"one part: variance of one times their number squared");
	near(w.step_variance, w.life_variance, 1e-9,
		"one step: unit and step are the same");
	partition_free(p);
	p = two_classes(0.3e-6, 0.2e-6);
	partition_close(p, 0.1, 1);
	near(partition_load(p), 0.3 * 21 + 0.2 * 1 + 0.5 * 11, 1e-12,
		"the zone is what given areas leave");
	partition_free(p);
}

/* The bootstrap's scatter is that of a mean of n: variance / n. */
static void check_bootstrap(void)
{
	enum { N = 4000 };
	struct partition *p = partition_new(fragment, area);
	gsl_rng *rng = rng_new(1, 0, RNG_BOOTSTRAP);
	struct partition_wear w, all;
	double mean = 0, square = 0, want;

	partition_class(p, 0, NAN, -1);
	for (int r = 0; r < 25; r++)
		for (int s = 1; s <= 4; s++)
			partition_fragment(
				p, 0, r, s, 1 + (r * 7 % 25) * 0.1 + s * 0.01, 0, 0);
	ok(partition_close(p, 0.1, 1) == PARTITION_OK, "one class without a pressure");
	partition_estimate(p, 0, &all);
	for (int i = 0; i < N; i++) {
		double d;

		rng_reset(rng, 1, (uint32_t)i, RNG_BOOTSTRAP);
		partition_replicate(p, 0, rng, &w);
		d = w.mean - all.mean;
		mean += d / N;
		square += d * d / N;
	}
	/* 100 fragments of variance s^2 in the estimate by 25: (100)^2 s^2 / 25;
	 * all.life_variance is 100 s^2.  Sampling errors at 4 sigma. */
	want = 100 * all.life_variance / 25;
	near(mean, 0, 4 * sqrt(want / N), "replicates have no bias");
	near(square / want, 1, 4 * sqrt(2. / N),
		"their variance is that of a mean of 25");
	gsl_rng_free(rng);
	partition_free(p);
}

static void check_sparse(void)
{
	struct partition *p = partition_new(fragment, fragment);
	struct partition_wear w;

	/* Realisations 0..3 and steps 1..2; only two cells hold particles. */
	partition_class(p, 1, NAN, -1);
	partition_fragment(p, 0, 0, 1, 2, 1, 0);
	partition_fragment(p, 0, 0, 1, 4, 1, 1);
	partition_fragment(p, 0, 3, 2, 8, 1, 1);
	ok(partition_close(p, 0, 1) == PARTITION_OK, "a particle table");
	partition_estimate(p, 0, &w);
	near(w.mean, 14 / 8., 1e-15, "realisations without particles shed nothing");
	near(w.step_variance, (36 + 64) / 8. - 14 * 14 / 64., 1e-13,
		"variance over all steps");
	near(w.life_variance, (9 + 16) / 4. - 49 / 16., 1e-13,
		"variance over realisations");
	ok(partition_large(p, 0.5, 1) == 1, "half of the first particles are large");
	ok(partition_large(p, 0.6, 1) == 2, "two of three after step 2");
	ok(partition_large(p, 0.7, 1) == 0, "never 70 %% of all");
	ok(partition_large(p, 0.7, 0) == 2, "but 100 %% of those of step 2");
	partition_free(p);
}

static void check_refusals(void)
{
	struct partition *p = two_classes(-1, -1);
	int c = partition_class(p, 0, 21e6, -1);

	ok(partition_close(p, 0.1, 1) == PARTITION_EMPTY && partition_culprit(p) == c,
		"a class without fragments");
	partition_free(p);
	p = two_classes(0.9e-6, 0.2e-6);
	ok(partition_close(p, 0.1, 1) == PARTITION_AREA, "more area than there is");
	partition_free(p);
	p = two_classes(-1, -1);
	c = partition_class(p, 0, 1e6, -1);
	partition_fragment(p, c, 0, 1, 1, 0, 0);
	ok(partition_close(p, 0.1, 1) == PARTITION_PRESSURE, "a pressure twice");
	partition_free(p);
	p = two_classes(-1, -1);
	ok(partition_fragment(p, 1, 2, 2, 1, 0, 0) == PARTITION_TWICE,
		"a step twice running");
	partition_fragment(p, 0, 0, 1, 1, 0, 0);
	ok(partition_close(p, 0.1, 1) == PARTITION_TWICE && partition_culprit(p) == 0,
		"a step twice apart");
	partition_free(p);
	p = two_classes(-1, -1);
	ok(partition_close(p, 0.1, 3) == PARTITION_EMPTY,
		"no step left after running-in");
	partition_free(p);
}

int main(void)
{
	check_power_mean();
	check_estimate();
	check_bootstrap();
	check_sparse();
	check_refusals();
	return tap_done();
}
