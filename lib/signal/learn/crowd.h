/* crowd.h - the pulse of a record whose pulses overlap throughout
 *
 * Where no pulse stands alone, its duration cannot be read off a short stretch.  Pulses
 * that arrive at random have the spectrum of one of them, whatever their number (Carson's
 * theorem), and the noise adds to it.  Shape and duration are those that make the
 * periodogram most likely (Whittle, Ark. Mat. 2, 1953).
 */
#ifndef SIGNAL_CROWD_H
#define SIGNAL_CROWD_H

#include "num/status.h"
#include <stddef.h>

/* Chooses shape and duration from y1, y2[0 .. n), aligned and in units of their white
 * noise, whose offset was followed from hop to hop (samples) and taken off.  *pulse: enum
 * pulse_shape, or CALIBRATE_ANY_PULSE for each of them; *duration: samples, or NAN,
 * sought from half to twice the guess, and on from there while it becomes more likely;
 * *error: its standard error, relative.  NUM_MEMORY. */
enum num_status crowd_pulse(const double *y1, const double *y2, size_t n, size_t hop,
	double guess, int *pulse, double *duration, double *error);

#endif
