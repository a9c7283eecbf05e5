/* remaining - first passages, thresholds and the rate followed through noise */
#include "life/remaining.h"
#include "life/rate.h"
#include "num/rng.h"
#include "tap.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <stdlib.h>

enum { N = 4000 };

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Kolmogorov-Smirnov against P(T <= t) = P(gamma(shape t) scale >= left). */
static void check_gamma(double left, double mean, double variance)
{
	static double x[N];
	gsl_rng *rng = rng_new(1, 0, RNG_LIFE);
	double worst = 0;

	for (int i = 0; i < N; i++)
		x[i] = remaining_gamma(left, mean, variance, rng);
	qsort(x, N, sizeof *x, compare);
	for (int i = 0; i < N; i++) {
		double f = gsl_cdf_gamma_Q(
			left, x[i] * mean * mean / variance, variance / mean);

		worst = fmax(
			worst, fmax(fabs(f - (double)i / N), fabs(f - (i + 1.) / N)));
	}
	/* 1.95 / sqrt(N) is exceeded once in 1000. */
	ok(worst < 1.95 / sqrt(N), "passage of %g at %g +- %g: distance %.4f", left, mean,
		sqrt(variance), worst);
	gsl_rng_free(rng);
}

static void check_passages(void)
{
	gsl_rng *rng = rng_new(1, 0, RNG_LIFE);
	double a[4] = { 3, INFINITY, 1, 50 };
	struct remaining_summary s;

	near(remaining_constant(6, 2), 3, 0, "time at a constant rate");
	ok(isinf(remaining_constant(6, 0)) && isinf(remaining_constant(6, -1)),
		"no wear, no failure");
	ok(remaining_constant(0, 2) == 0 && remaining_constant(-1, 0) == 0,
		"a threshold that is reached leaves nothing");
	check_gamma(50, 1, 1);
	check_gamma(1, 1, 4);
	check_gamma(0.3, 1, 0.25);
	check_gamma(1e-14, 1e-15, 1e-32);
	near(remaining_gamma(50, 2, 0, rng), 25, 0, "no variance: the constant rate");
	near(remaining_gamma(1e6, 1, 1e-12, rng), 1e6, 1e-3, "law of large numbers");
	ok(remaining_gamma(0, 1, 1, rng) == 0 && isinf(remaining_gamma(1, 0, 1, rng)) &&
			isinf(remaining_gamma(INFINITY, 1, 1, rng)),
		"reached, and never");
	ok(remaining_gamma(1, 1e-200, 1e200, rng) >= 0, "a shape that underflows ends");
	near(remaining_large(3, 10, 12), 18, 0, "large particles at the end of step 3");
	ok(remaining_large(3, 10, 31) == 0 && isinf(remaining_large(0, 10, 0)),
		"passed, and never");
	s = remaining_sum_up(a, 4, 40);
	ok(s.mean == 2 && s.p_no_failure == 0.5 && a[0] == 1 && isinf(a[2]) &&
			isinf(a[3]),
		"beyond the horizon is no failure");
	a[0] = a[1] = 1.5e308;
	ok(remaining_sum_up(a, 2, INFINITY).mean == 1.5e308, "means do not overflow");
	gsl_rng_free(rng);
}

/* A straight line in white noise: the filter knows as much as a straight-line fit. */
static void check_rate(void)
{
	double slope = 2e-12, noise = 1e-7, t0 = 1e6, gap, rate;
	gsl_rng *rng = rng_new(5, 0, RNG_LIFE);
	struct rate *r = rate_new(0, INFINITY);
	int early = 0, n = 400, ready = 1;
	double sd = noise * sqrt(12. / n / n / n) / 3600;

	for (int i = 0; i < n; i++) {
		double t = t0 + 3600. * i;

		ready &= rate_ready(r) == (i >= RATE_START);
		rate_add(r, t,
			i % 10 == 9 ? NAN : slope * t + noise * gsl_ran_ugaussian(rng));
	}
	ok(ready, "ready from the fourth on");
	rate_state(r, &gap, &rate);
	near(rate / slope, 1, 5 * sd / slope,
		"slope of a line within five standard errors");
	near(gap, slope * (t0 + 3600. * (n - 1)), noise / 2, "and its end");
	for (int i = 0; i < N; i++) {
		double left = rate_passage(r, gap + 1e-6, (i + 0.5) / N,
			gsl_cdf_ugaussian_Pinv(
				philox_uniform(1, 0, RNG_LIFE, (uint64_t)i)));

		early += left < 1e-6 / slope;
	}
	ok(early > 0.02 * N && early < 0.98 * N, "the truth is inside: %d of %d early",
		early, N);
	ok(rate_passage(r, 0, 0.5, 0) == 0, "a threshold behind is reached");
	rate_free(r);
	r = rate_new(0, INFINITY);
	for (int i = 0; i < 50; i++)
		rate_add(r, i, 3);
	ok(isinf(rate_passage(r, 4, 0.5, 0)), "a constant never gets there");
	rate_free(r);
	/* A prior that is certain is believed. */
	r = rate_new(slope, slope * 1e-9);
	for (int i = 0; i < RATE_START; i++)
		rate_add(r, 3600. * i, 1e-5 + noise * gsl_ran_ugaussian(rng));
	rate_state(r, &gap, &rate);
	/* four noisy points alone would leave a standard error of six slopes */
	near(rate / slope, 1, 0.5, "a certain prior holds against few data");
	rate_free(r);
	r = rate_new(slope, 0);
	for (int i = 0; i < 100; i++)
		rate_add(r, 3600. * i, slope * 3600 * i + noise * gsl_ran_ugaussian(rng));
	rate_state(r, &gap, &rate);
	near(rate / slope, 1, 1e-12, "a prior without spread stays");
	near(rate_passage(r, gap + 1e-6, 0.5, 0) * slope, 1e-6, noise / 2,
		"and tells the passage");
	rate_free(r);
	/* Five times the prior's mean, forty of its standard deviations off. */
	r = rate_new(slope, slope / 10);
	for (int i = 0; i < 400; i++)
		rate_add(r, 3600. * i,
			5 * slope * 3600 * i + noise * gsl_ran_ugaussian(rng));
	rate_state(r, &gap, &rate);
	ok(rate > 2 * slope, "data outdo the prior: %.2f slopes", rate / slope);
	rate_free(r);
	gsl_rng_free(rng);
}

int main(void)
{
	check_passages();
	check_rate();
	return tap_done();
}
