/* heights.h - heights of given skewness and kurtosis
 *
 * A set of n heights with mean 0, variance 1 and prescribed skewness and kurtosis:
 * the quantiles (i + 1/2) / n of the distribution of Johnson's system (Biometrika 36,
 * 1949: unbounded, lognormal or bounded, whichever contains the pair) whose set of n
 * quantiles has these moments.  ranking_impose() assigns the set to a surface in the
 * order of its heights.
 */
#ifndef SURFACE_HEIGHTS_H
#define SURFACE_HEIGHTS_H

#include <stddef.h>

enum heights_status {
	HEIGHTS_OK,
	HEIGHTS_MEMORY,
	HEIGHTS_IMPOSSIBLE, /* kurtosis <= skewness^2 + 1: no distribution has it */
	HEIGHTS_TOO_FEW     /* n quantiles cannot come within 1e-6 of the pair */
};

/* Fills sorted[n], ascending.  Kurtosis is 3 for the normal distribution. */
enum heights_status heights_sorted(
	size_t n, double skewness, double kurtosis, double *sorted);

/* Memory for ordering n numbers. */
struct ranking;
struct ranking *ranking_new(size_t n); /* NULL when out of memory */
void ranking_free(struct ranking *r);
/* Replaces the k-th smallest of z by sorted[k]; equal values keep their order. */
void ranking_impose(struct ranking *r, const double *sorted, double *z);

#endif
