/* common.h - noise that two channels have in common at the same time */
#ifndef SIGNAL_COMMON_H
#define SIGNAL_COMMON_H

#include <stddef.h>

/* Measures the noise of x[0][0 .. n) and x[1] beside pulses of this duration: in found[0]
 * its correlation r, in found[1] and found[2] which share of the noise of either channel
 * is left without r times the other.  The correlation is 0 if removing it would reduce
 * standard errors by less than 2 %, or if it is not the same in the band of the pulses as
 * above it.  work holds 2 n. */
void common_measure(const double *const x[2], size_t n, double duration, double *work,
	double found[3]);

#endif
