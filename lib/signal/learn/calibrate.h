/* calibrate.h - parameters of the instrument learned from a two-sensor record
 *
 * From the beginning of a record: lag of the second sensor, interfering tones, noise of
 * either channel, shape and duration of the pulses, ratio of the gains, range of the
 * velocities.  Values known by the caller are not changed.
 *
 * The order is: tones from the periodogram; noise from the fourth difference; lag from
 * the cross-correlation; duration from the lag at which the autocorrelation is lowest
 * (which superposition does not change); then joint fits of the clearest sections under
 * each shape, with duration and gain chosen by least chi-square, and a correction of the
 * shape if all pulses have a common residual.
 */
#ifndef SIGNAL_CALIBRATE_H
#define SIGNAL_CALIBRATE_H

#include "signal/learn/calibration.h"

/* x1, x2: n >= 64 finite samples.  On SEPARATE_OK *c is filled; free it with
 * calibration_clear().  Otherwise only its work and its attempts are. */
enum separate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c);

#endif
