/* standing.h - how many values of a signal stand out of white noise */
#ifndef NUM_STANDING_H
#define NUM_STANDING_H

#include "num/status.h"
#include <stddef.h>

/* *count: the Fourier coefficients of two signals of n samples, real and imaginary parts,
 * whose power is more than ten times that of noise of variance 1: by chance, 5 in
 * 100 000.  NUM_MEMORY. */
enum num_status standing_count(const double *const y[2], size_t n, double *count);

#endif
