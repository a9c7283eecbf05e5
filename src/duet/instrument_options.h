/* instrument_options.h - what is known beforehand of the two sensors: options of duet */
#ifndef INSTRUMENT_OPTIONS_H
#define INSTRUMENT_OPTIONS_H

#include "cli/opt.h"
#include "signal/learn/calibration.h"

/* Values of the options. */
extern struct instrument_given {
	struct opt_choice align, duration, gain, spread;
	int pulse; /* 0: to be learned; else 1 + enum pulse_shape */
	struct opt_list lines;
	const char *undo; /* file of taps, "none", or NULL: as stated in the record */
	double false_alarm;
} instrument;

extern struct opt instrument_rows[]; /* for OPT_TABLE; not that of align */

/* Time from sensor to sensor, s; nan where it is to be learned. */
double instrument_align(void);
/* passed: the filters that the record says it has passed, or NULL.  Dies where lines or
 * filter do not suit the rate.  The filter is the caller's to free. */
struct calibrate_par instrument_par(double rate, const char *passed);
/* Prints the instrument that was learned. */
void instrument_note(const struct calibration *c, double rate);

#endif
