/* metrics - scores of predictions against closed forms */
#include "life/score/metrics.h"
#include "num/select.h"
#include "tap.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_randist.h>
#include <stdlib.h>

enum { N = 2000 };

/* CRPS by the energy form E|X - y| - E|X - X'| / 2, independent of the implementation. */
static double crps_energy(const double *x, size_t n, double y)
{
	double near_y = 0, apart = 0, m = (double)n;

	for (size_t i = 0; i < n; i++) {
		near_y += fabs(x[i] - y) / m;
		for (size_t j = 0; j < n; j++)
			apart += fabs(x[i] - x[j]) / m / m;
	}
	return near_y - apart / 2;
}

/* Adds a point, whose only sample it is. */
static enum num_status add_point(struct metrics *m, double t, double point, double lower,
	double upper, struct metrics_row *row)
{
	return metrics_add(m, t, point, lower, upper, &point, 1, row);
}

static void check_crps(void)
{
	static double x[N];
	double s[5] = { -2, 1, 1, 4, 9 };
	double truth[] = { -5, 1, 3.3, 9, 20 };
	double never[3] = { 1, 2, INFINITY };

	near(metric_crps(&(double){ 7 }, 1, 10, INFINITY), 3, 1e-15,
		"the CRPS of one sample is its absolute error");
	for (int i = 0; i < 5; i++)
		near(metric_crps(s, 5, truth[i], INFINITY), crps_energy(s, 5, truth[i]),
			1e-13, "the CRPS of samples equals its energy form");
	for (int i = 0; i < N; i++)
		x[i] = (i + 0.5) / N;
	/* Midpoint samples of U(0, 1): the step function differs by 1 / (12 N^2). */
	near(metric_crps(x, N, 0.3, INFINITY), (0.027 + 0.343) / 3, 1e-6,
		"the CRPS of a uniform forecast is right");
	for (int i = 0; i < N; i++)
		x[i] = 5 + 2 * gsl_cdf_ugaussian_Pinv((i + 0.5) / N);
	near(metric_crps(x, N, 6, INFINITY),
		2 * (0.5 * (2 * gsl_cdf_ugaussian_P(0.5) - 1) +
			    2 * gsl_ran_ugaussian_pdf(0.5) - 1 / sqrt(M_PI)),
		1e-4, "the CRPS of a normal forecast is right");
	/* 1 to 2: (1/3 - 0)^2, 2 to 5: (2/3)^2 before the truth, 5 to 10: (1/3)^2 after.
	 */
	near(metric_crps(never, 3, 5, 10), 1 / 9. + 3 * 4 / 9. + 5 / 9., 1e-14,
		"the CRPS with mass that never fails is right up to the limit");
	ok(isinf(metric_crps(never, 3, 5, INFINITY)),
		"the CRPS with mass that never fails is infinite without a limit");
	near(metric_crps(&(double){ 1e300 }, 1, -1e300, INFINITY), 2e300, 1e285,
		"the CRPS of samples of 1e300 is right");
}

static void check_summary(void)
{
	double a[4] = { 3, INFINITY, 1, 50 };
	size_t failed;

	metric_cut(a, 4, 40);
	ok(metric_mean(a, 4, &failed) == 2 && failed == 2 && a[0] == 1 && isinf(a[2]) &&
			isinf(a[3]),
		"samples beyond the horizon are no failure");
	a[0] = a[1] = 1.5e308;
	ok(metric_mean(a, 2, &failed) == 1.5e308,
		"the mean of large samples does not overflow");
}

static void check_quantile(void)
{
	double x[5] = { 1, 2, 4, 8, INFINITY };

	near(sorted_quantile(x, 5, 0.5), 4, 0,
		"the median of an odd number of samples is the middle one");
	near(sorted_quantile(x, 4, 0.5), 3, 0,
		"the median of an even number of samples is the mean of two");
	near(sorted_quantile(x, 5, 0.75), 8, 0,
		"a level that meets a sample gives that sample");
	ok(isinf(sorted_quantile(x, 5, 0.8)),
		"a quantile among samples that never fail is infinite");
	near(sorted_quantile(x, 1, 0.95), 1, 0,
		"every quantile of one sample is that sample");
}

/* Point predictions of life 100: late by 30 at t = 0, by 15 at 20, by 3 at 90. */
static void check_sums(void)
{
	struct metrics m = { .eol = 100, .alpha = 0.2 };
	struct metrics_row row;
	struct metrics s;
	double pair[2] = { 8, 12 };

	ok(add_point(&m, 0, 130, 90, 140, &row) == NUM_OK && !row.inside && row.covered,
		"a prediction 30 %% late is outside the cone of 20 %%");
	near(row.accuracy, 0.7, 1e-15, "the relative accuracy is right");
	ok(add_point(&m, 20, 95, 85, 99, &row) == NUM_OK && row.inside && !row.covered,
		"a prediction late by 15 of 80 is inside the cone");
	ok(metrics_add(&m, 90, 10, 8, 12, pair, 2, &row) == NUM_OK,
		"samples are accepted");
	near(row.crps, 0.25 * 4, 1e-15, "the CRPS of two samples is right");
	near(row.mass, 1, 0, "both samples are within 20 % of 10");
	ok(add_point(&m, 100, 1, 0, 1, NULL) == NUM_DOMAIN &&
			add_point(&m, 95, NAN, 0, 1, NULL) == NUM_DOMAIN,
		"predictions after the end of life and missing ones are not counted");
	s = metrics_get(&m);
	ok(s.n == 3, "three predictions are counted");
	near(s.bias, 15, 1e-14, "the bias is right");
	near(s.rmse, sqrt((900 + 225) / 3.), 1e-14,
		"the root mean square error is right");
	near(s.accuracy, (0.7 + 0.8125 + 1) / 3, 1e-15,
		"the cumulative relative accuracy is right");
	near(s.alpha_lambda, 2 / 3., 1e-15, "the alpha-lambda share is right");
	near(s.coverage, 2 / 3., 1e-15, "the coverage is right");
	near(s.crps, (30 + 15 + 1) / 3., 1e-14, "the mean CRPS is right");
	near(s.horizon, 80, 0, "the prognostic horizon starts where the band is kept");
}

/* An infinite median must not make the mean errors of the others infinite. */
static void check_infinite(void)
{
	struct metrics m = { .eol = 100, .alpha = 0.2, .limit = 1000 };
	struct metrics s;

	add_point(&m, 0, INFINITY, 50, INFINITY, NULL);
	add_point(&m, 20, 90, 70, 100, NULL);
	add_point(&m, 40, 50, 40, 55, NULL);
	s = metrics_get(&m);
	ok(s.n == 3 && s.infinite == 1,
		"the prediction with an infinite median is counted");
	near(s.bias, 0, 1e-15, "the bias is that of the finite predictions");
	near(s.mae, 10, 1e-15,
		"the mean absolute error is that of the finite predictions");
	near(s.accuracy, 1 - (10 / 80. + 10 / 60.) / 2, 1e-15,
		"the relative accuracy is that of the finite predictions");
	near(s.coverage, 2 / 3., 1e-15,
		"the coverage includes the prediction with an infinite median");
	near(s.crps, (900 + 10 + 10) / 3., 1e-12,
		"the CRPS includes the prediction with an infinite median");
}

int main(void)
{
	check_crps();
	check_quantile();
	check_summary();
	check_sums();
	check_infinite();
	return tap_done();
}
