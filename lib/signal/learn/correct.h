/* correct.h - correction of a pulse that differs from those of sensor.h
 *
 * The mean residual around all pulses of the examples is not noise but an error of the
 * shape.
 */
#ifndef SIGNAL_CORRECT_H
#define SIGNAL_CORRECT_H

#include "signal/learn/examples.h"

/* 1 if the shape may be wrong: when only large pulses may overlap others, a significant
 * chi-square remains or pulses vanish.  On return the examples are fitted as before. */
int correct_doubtful(struct examples *ex, struct calibration *c);

/* Adds the mean residual to the shape of c if that describes the examples better. */
enum num_status correct_shape(struct examples *ex, struct calibration *c);

#endif
