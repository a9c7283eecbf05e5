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
 * a line (F test); points ordered by x.  NAN with fewer than three groups or one point
 * each. */
double line_lack_of_fit(const double *x, const double *y, size_t n, const struct line *l);

/* Grubbs' test (Technometrics 11, 1969, page 1): the farthest of n normal numbers from
 * their mean, and the p-value of the hypothesis that it is one of them; NAN with fewer
 * than three numbers or equal ones. */
double line_outlier_p(const double *y, size_t n, size_t *farthest);

/* p-value of the hypothesis that the true slope is want. */
double line_slope_p(const struct line *l, double want);

#endif
