/* instrument.h - what was learned of an instrument, as numbers to keep and to restore
 *
 * A record that is separated with a kept instrument (separate.h) gives the rows that it
 * gives after learning it, without the wait; what the record itself must show, its noise
 * and the fit of its pulses, is still compared.
 */
#ifndef SIGNAL_INSTRUMENT_H
#define SIGNAL_INSTRUMENT_H

#include "num/status.h"
#include "signal/fit/quadrature.h"
#include "signal/learn/calibration.h"
#include "signal/separate/validate.h"
#include <stddef.h>

struct instrument {
	struct calibration cal;
	int ratio;            /* of separate_ratio(), whose samples these are */
	int crowded;          /* long sections hold too many pulses */
	struct flow flow;     /* delays of particles, samples around cal.shift */
	double level[4];      /* noise of all channels once clean, near 1 */
	double level_samples; /* these are known from so many samples */
	/* Correlation of the noise of both channels, 0 if it is not removed, and what
	 * removing it leaves of the noise of either. */
	double common[3];
	struct quadrature second; /* of four channels */
};

struct instrument_value {
	const char *name;
	int index;
	double value;
};

/* All of it: *n numbers; free *value. */
enum num_status instrument_values(
	const struct instrument *in, struct instrument_value **value, size_t *n);

enum instrument_status {
	INSTRUMENT_OK,
	INSTRUMENT_MEMORY,
	INSTRUMENT_MISSING, /* *which is not there, not in its place, or out of range */
	INSTRUMENT_UNKNOWN  /* some numbers are no part of an instrument */
};

/* Those values, in their order, into *in, whose cal calibration_clear() frees. */
enum instrument_status instrument_restore(struct instrument *in,
	const struct instrument_value *value, size_t n, const char **which);

#endif
