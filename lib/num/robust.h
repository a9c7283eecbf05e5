/* robust.h - order statistics that are insensitive to outliers */
#ifndef NUM_ROBUST_H
#define NUM_ROBUST_H

#include <stddef.h>

/* Median (upper of the two middle values); 0 for n = 0.  Reorders x. */
double robust_median(double *x, size_t n);
/* 1 if that median is at most value, found without reordering x. */
int robust_median_at_most(const double *x, size_t n, double value);
/* The value below which this share of x lies. */
double robust_quantile(double *x, size_t n, double share);
/* Standard deviation of normal deviates about 0, of which x becomes the moduli, and about
 * their median. */
double robust_scale(double *x, size_t n);
double robust_spread(double *x, size_t n);

#endif
