/* wiener.h - a short sequence without the noise in it
 *
 * Each frequency keeps the share of its power that is not noise (Wiener, Extrapolation,
 * Interpolation, and Smoothing of Stationary Time Series, 1949).  The power of the
 * sequence itself is taken from the frequencies around: what lasts width samples has a
 * spectrum that is smooth within 1 / width cycles per sample.
 */
#ifndef NUM_WIENER_H
#define NUM_WIENER_H

#include "num/status.h"
#include <stddef.h>

/* variance: of the white noise in x[0 .. n), n > 0; width > 0.  NUM_MEMORY, x is then
 * unchanged. */
enum num_status wiener_filter(double *x, size_t n, double variance, double width);

#endif
