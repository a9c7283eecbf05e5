/* standing.h - how many values of a signal stand out of white noise */
#ifndef NUM_STANDING_H
#define NUM_STANDING_H

#include "num/status.h"
#include <stddef.h>

/* Adds to *count the Fourier coefficients of y[0 .. n), real and imaginary parts, whose
 * power is more than ten times that of noise of variance 1: by chance, 5 in 100 000. */
enum num_status standing_count(const double *y, size_t n, double *count);

#endif
