/* line.h - a least-squares line through points, with its uncertainty
 *
 *	struct line l;
 *	if (line_fit(x, y, n, 0.95, &l) == 0)
 *		printf("%g (%g .. %g)\n", l.slope, l.slope - l.slope_half, ...);
 */
#ifndef COUNT_LINE_H
#define COUNT_LINE_H

#include "num/status.h"
#include <stddef.h>

struct line {
	double slope, slope_se;
	double middle, value, value_se; /* at the mean of x */
	double spread;                  /* sum of the squared distances from it */
	double rms;                     /* of the residuals, n - 2 degrees of freedom */
	double degrees;                 /* of freedom of slope_se */
	double t;                       /* Student's t of the confidence */
};

/* Student's t: half-width of the interval of this confidence in standard errors. */
double line_t(double confidence, double degrees);

/* Least squares.  NUM_DOMAIN with fewer than three points or a single x. */
enum num_status line_fit(
	const double *x, const double *y, size_t n, double confidence, struct line *l);

/* Half-width of the interval of the slope, at least that of a known standard deviation of
 * the y. */
double line_slope_half(const struct line *l, double deviation, double confidence);

/* Lets the scatter vary with x: slope_se becomes at least the standard error that follows
 * from the residual of each point (White 1980), and t that of the degrees of freedom of
 * its groups of equal x (Welch 1947); points ordered by x. */
void line_allow_unequal(
	const double *x, const double *y, size_t n, double confidence, struct line *l);

/* Lack-of-fit test: p-value of the hypothesis that the means of groups of equal x lie on
 * a line, if the scatter differs between groups (Johansen, Biometrika 67 (1980) 85);
 * points ordered by x.  Groups of a single point or of equal y tell no scatter and do not
 * count; NAN with fewer than three others. */
double line_lack_of_fit(const double *x, const double *y, size_t n);

/* The lowest or highest of some numbers that are not of the others. */
struct line_outliers {
	size_t first, count;
	double p; /* of the hypothesis that all are normal numbers of one mean */
};

/* Of n ascending numbers: for k = 1 .. n/2 the k lowest and the k highest are compared
 * with the others by Student's t, times the number of ways to choose k of n and times
 * 2^k, so that the sum over k is at most 1 (Bonferroni); the least p.  For k = 1 without
 * the factor 2 this is the test of Grubbs (Technometrics 11, 1969, page 1), from which
 * outliers hide one another.  p is NAN with fewer than three numbers or equal ones. */
struct line_outliers line_outliers(const double *y, size_t n);

/* p-value of the hypothesis that the true slope is want. */
double line_slope_p(const struct line *l, double want);

#endif
