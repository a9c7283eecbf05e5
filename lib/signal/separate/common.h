/* common.h - noise that both channels have in common, for lib/signal/separate only
 *
 * Noise that reaches both sensors at the same time is known from the other channel where
 * that records no pulse, or only pulses that have been fitted.  With r the correlation,
 * channel c less r times the residual of the other has noise of sqrt(1 - r^2) of its own.
 * Fitting a window and removing the noise in turn ends at the generalised least squares
 * fit of both channels: its normal equations are those of the fixed point.
 */
#ifndef SIGNAL_COMMON_H
#define SIGNAL_COMMON_H

#include "num/status.h"
#include "signal/pulse/shape.h"
#include <stddef.h>

struct common {
	double correlation;  /* of the noise at the same time; 0: not to be removed */
	double left[2];      /* noise of either channel after that, of 1 */
	struct shape *sharp; /* the pulse in units of left[0] */
	double *work;
	size_t room;
};

void common_clear(struct common *c);

/* Measures the noise of x[0][0 .. n) and x[1] beside pulses of this duration: the
 * correlation and what is left of either.  The correlation is 0 if removing it would
 * reduce standard errors by less than 2 %, or if it is not the same in the band of the
 * pulses as above it.  work holds 2 n. */
void common_measure(const double *const x[2], size_t n, double duration, double *work,
	double found[3]);

/* Takes these three for pulses of this shape. */
enum num_status common_set(
	struct common *c, const double found[3], const struct shape *shape);

#endif
