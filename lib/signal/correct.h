/* correct.h - a pulse that is not quite one of those of sensor.h
 *
 * What the residuals around all pulses of the examples have in common is no noise: it
 * belongs to the shape.
 */
#ifndef SIGNAL_CORRECT_H
#define SIGNAL_CORRECT_H

#include "signal/examples.h"

/* Where only large pulses may be told apart, does anything stay, or are there fewer than
 * else?  That may be the shape's fault.  Ends with the examples fitted as at the end. */
int correct_doubtful(struct examples *ex, struct calibration *c);

/* Gives the shape of c what the pulses have in common, if that describes the examples
 * better; else all stays. */
enum num_status correct_shape(struct examples *ex, struct calibration *c);

#endif
