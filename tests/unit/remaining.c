/* remaining - first passages, thresholds and the rate followed through noise */
#include "num/passage.h"
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
		x[i] = gamma_passage(left, mean, variance, rng);
	qsort(x, N, sizeof *x, compare);
	for (int i = 0; i < N; i++) {
		double f = gsl_cdf_gamma_Q(
			left, x[i] * mean * mean / variance, variance / mean);

		worst = tap_max(
			worst, fmax(fabs(f - (double)i / N), fabs(f - (i + 1.) / N)));
	}
	/* 1.95 / sqrt(N) is exceeded once in 1000. */
	ok(worst < 1.95 / sqrt(N),
		"the passage of %g at %g +- %g has the gamma distribution: distance %.4f",
		left, mean, sqrt(variance), worst);
	gsl_rng_free(rng);
}

static void check_passages(void)
{
	gsl_rng *rng = rng_new(1, 0, RNG_LIFE);

	near(gamma_passage(6, 2, 0, NULL), 3, 0, "the time at a constant rate is right");
	ok(isinf(gamma_passage(6, 0, 0, NULL)) && isinf(gamma_passage(6, -1, 0, NULL)),
		"without wear there is no failure");
	ok(gamma_passage(0, 2, 0, NULL) == 0 && gamma_passage(-1, 0, 0, NULL) == 0,
		"a threshold that is reached leaves nothing");
	check_gamma(50, 1, 1);
	check_gamma(1, 1, 4);
	check_gamma(0.3, 1, 0.25);
	check_gamma(1e-14, 1e-15, 1e-32);
	near(gamma_passage(50, 2, 0, rng), 25, 0,
		"without variance the passage is that of the constant rate");
	near(gamma_passage(1e6, 1, 1e-12, rng), 1e6, 1e-3,
		"for many steps the passage is that of the mean rate");
	ok(gamma_passage(0, 1, 1, rng) == 0 && isinf(gamma_passage(1, 0, 1, rng)) &&
			isinf(gamma_passage(INFINITY, 1, 1, rng)),
		"a passage is 0 where the threshold is reached and infinite where there is no wear");
	ok(gamma_passage(1, 1e-200, 1e200, rng) >= 0,
		"a shape that underflows does not loop");
	gsl_rng_free(rng);
}

int main(void)
{
	check_passages();
	return tap_done();
}
