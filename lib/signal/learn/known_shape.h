/* known_shape.h - the pulses of sensor.h at the duration of a record */
#ifndef SIGNAL_KNOWN_SHAPE_H
#define SIGNAL_KNOWN_SHAPE_H

#include "num/status.h"
#include "signal/learn/calibration.h"
#include <stddef.h>

/* Lag at which an autocorrelation is lowest, before it rises clearly; 0 where there is
 * none up to max_lag. */
double lowest_lag(const double *r, size_t max_lag);
/* *duration: of a pulse whose autocorrelation is lowest at this lag, samples. */
enum num_status known_shape_duration(int pulse, double low, double *duration);
/* Sets the shape of c to this pulse, as filtered by the whitening, at the present
 * duration. */
enum num_status known_shape_set(struct calibration *c, int pulse);

#endif
