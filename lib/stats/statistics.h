/* statistics.h - distributions of wear particles: Weibull and power-law fits
 *
 *	struct weibull w;
 *	if (weibull_fit(diameter, NULL, n, 0, INFINITY, 0.95, &w) == WEIBULL_OK)
 *		printf("%g (%g .. %g)\n", w.shape.value, w.shape.low, w.shape.high);
 */
#ifndef CONTACT_STATISTICS_H
#define CONTACT_STATISTICS_H

#include "num/running.h"
#include "num/status.h"
#include <stddef.h>

/* A value and its confidence interval; nan if there is none. */
struct estimate {
	double value, low, high;
};

/* f(x) = (k / s) (x / s)^(k - 1) exp(-(x / s)^k), k the shape and s the scale (2-17). */
struct weibull {
	struct estimate shape, scale;
	double mean;      /* of the distribution: s Gamma(1 + 1/k) */
	double low, high; /* limits of truncation */
};

enum weibull_status {
	WEIBULL_OK,
	WEIBULL_NONE, /* fewer than two different values (apart by 1e-12 of themselves),
		       * values outside [low, high], or no maximum: a truncated sample
		       * that no Weibull distribution fits */
	WEIBULL_MEMORY
};

/* Maximum likelihood for n values x > 0, each of them weight[i] times (NULL: once).
 * If values below low or above high could not be observed, the density is that of the
 * distribution truncated there; 0 and INFINITY: not truncated.  Intervals by the
 * profile of the likelihood: where its maximum over the other parameter has fallen by
 * t^2 / 2, Student's t with two degrees of freedom fewer than values; 0 or INFINITY where
 * it never does, since a power law fits as well, and nan for two values or a confidence
 * of nan.  w is set only where the fit succeeds. */
enum weibull_status weibull_fit(const double *x, const double *weight, size_t n,
	double low, double high, double confidence, struct weibull *w);
double weibull_density(const struct weibull *w, double x); /* truncated as fitted */
/* Kolmogorov-Smirnov: largest |empirical - fitted| distribution of n ascending values,
 * each weight[i] times (NULL: once). */
double weibull_distance(
	const struct weibull *w, const double *x, const double *weight, size_t n);

/* y = factor x^exponent + offset (2-16). */
struct power {
	struct estimate factor, exponent, offset;
	double rms; /* of the residuals */
};

/* Least squares for n points with x > 0.  Intervals from the Jacobian and Student's t,
 * nan with three points.  NUM_DOMAIN with fewer than three different x or without a
 * minimum for an exponent in [0.01, 20]. */
enum num_status power_fit(
	const double *x, const double *y, size_t n, double confidence, struct power *p);

/* The mean of values, with its interval by Student's t; that of its logarithm if it is
 * positive, since positive values are rather skewed to the right. */
struct estimate sample_mean(const struct running *r, double confidence);

#endif
