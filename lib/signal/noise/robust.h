/* robust.h - noise under slow signals, insensitive to outliers */
#ifndef SIGNAL_ROBUST_H
#define SIGNAL_ROBUST_H

#include <math.h>
#include <stddef.h>

/* Fourth difference of x[0] to x[4], which removes slow changes: that of white noise has
 * the same standard deviation. */
static inline double fourth_difference(const double *x)
{
	return (x[0] - 4 * x[1] + 6 * x[2] - 4 * x[3] + x[4]) / sqrt(70);
}

/* Standard deviation of the white noise under slow signals, by the median of the fourth
 * differences of samples that are not hidden (NULL: none is).  Where that is less than
 * the steps of the values, it includes the error of rounding to them, of variance step^2
 * / 12, which is up to an eighth too much: differences of noise of half a step show it as
 * well. work holds n values.  0 for n < 20. */
double robust_noise(const double *x, const unsigned char *hidden, size_t n, double *work);

#endif
