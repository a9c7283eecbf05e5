/* tune.h - duration, gain, width and drift of the gain of least chi-square */
#ifndef SIGNAL_TUNE_H
#define SIGNAL_TUNE_H

#include "signal/learn/examples.h"

/* Adjusts duration and gain of the scene, unless they are known. */
void tune(struct examples *ex, double step, int rounds);
/* The same in turn with the pulses of the examples, for the scene and c. */
enum separate_status tune_pulse(struct examples *ex, struct calibration *c);
/* The same with all parameters. */
enum separate_status tune_all(struct examples *ex, struct calibration *c);

#endif
