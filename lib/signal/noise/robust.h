/* robust.h - order statistics that are insensitive to outliers */
#ifndef SIGNAL_ROBUST_H
#define SIGNAL_ROBUST_H

#include <stddef.h>

/* Median (upper of the two middle values); 0 for n = 0.  Reorders x. */
double robust_median(double *x, size_t n);
/* The value below which this share of x lies. */
double robust_quantile(double *x, size_t n, double share);
/* Standard deviation of normal deviates about 0, of which x becomes the moduli, and about
 * their median. */
double robust_scale(double *x, size_t n);
double robust_spread(double *x, size_t n);

/* Standard deviation of the white noise under slow signals: the median of the difference
 * of the given order (1 to 16), which removes slow changes; work holds
 * n values.  0 where n < 16 + order.  White noise gives the same for every order. */
double robust_noise(const double *x, size_t n, int order, double *work);

#endif
