/* learn_scatter.h - what pulses have of their own, from the examples */
#ifndef SIGNAL_LEARN_SCATTER_H
#define SIGNAL_LEARN_SCATTER_H

#include "signal/learn/examples.h"

/* Sets the scatter of widths and ratios of the scene and of c (joint.h); 1 if there is
 * some. */
int learn_scatter(struct examples *ex, struct calibration *c);

#endif
