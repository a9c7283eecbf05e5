/* origin.h - arrival at sensor 2 where its pulses have another width
 *
 * A shape taken from the record has no origin of its own: the arrival is where the shape
 * puts it.  At both sensors that is the same, unless their pulses differ in width: what
 * leads the arrival by a share of a pulse leads it by more in a longer pulse.  Whatever
 * filter both channels have passed, the cross-correlation of their pulses is symmetric
 * about the delay if the pulse before the filter is symmetric, or antisymmetric, about
 * its arrival.
 */
#ifndef SIGNAL_ORIGIN_H
#define SIGNAL_ORIGIN_H

#include "signal/learn/examples.h"

/* Fills origin and origin_se of c from the pulses of the examples, as last fitted.
 * NUM_MEMORY. */
enum num_status find_origin(struct examples *ex, struct calibration *c);

#endif
