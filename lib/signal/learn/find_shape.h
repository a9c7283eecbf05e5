/* find_shape.h - the shape that describes some clear examples best */
#ifndef SIGNAL_FIND_SHAPE_H
#define SIGNAL_FIND_SHAPE_H

#include "signal/learn/examples.h"
#include "signal/learn/template.h"

/* Uses the pulse found in the record, whose shape c then owns. */
void find_shape_take(struct calibration *c, struct template *found);
/* Of those of sensor.h, reversed or not, with an approximate duration.  low: lag of the
 * lowest autocorrelation; hint: the pulse taken from the record, which is tried first, or
 * NULL. */
enum separate_status find_shape_known(struct examples *ex, double low,
	const struct template *hint, struct calibration *c);
/* Of the clearest single events, if it costs less than the pulse of c; else
 * SEPARATE_HARD. */
enum separate_status find_shape_single(struct examples *ex, struct calibration *c);

#endif
