/* instrument.h - what is known beforehand of the two sensors: options of duet */
#ifndef INSTRUMENT_H
#define INSTRUMENT_H

#include "shell/opt.h"
#include "signal/calibrate.h"

/* Values of the options. */
extern struct instrument {
	struct opt_choice align, duration, gain, spread;
	int pulse; /* 0: to be learned; else 1 + enum pulse_shape */
	struct opt_list lines;
	double false_alarm;
} instrument;

extern struct opt instrument_rows[]; /* for OPT_TABLE; not that of align */

/* Time from sensor to sensor, s; nan where it is to be learned. */
double instrument_align(void);
/* Dies where the lines do not suit the rate. */
struct calibrate_par instrument_par(double rate);
/* Tells what was learned. */
void instrument_note(const struct calibration *c, double rate);

#endif
