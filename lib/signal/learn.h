/* learn.h - the pulse of a record, learned from the clearest stretches of it
 *
 * What calibrate.h does once lag, tones and noise are known.  Stretches with one clear
 * pulse each give its form, free of any assumption but smoothness (template.h), from that
 * one on which most others agree within the noise.  If one of the pulses of sensor.h does
 * as well it is taken, since two parameters are known better than eighty.  Where hardly
 * any pulse stands alone, joint fits under each of those are compared.
 */
#ifndef SIGNAL_LEARN_H
#define SIGNAL_LEARN_H

#include "signal/calibrate.h"
#include <stddef.h>

/* A stretch learned from: pulses of y[channel][0 .. n), whitened, noise of variance 1. */
enum { LEARN_STRETCHES = 96, LEARN_PULSES = 16 };
struct stretch {
	long from; /* of the record */
	const double *y[2];
	const unsigned char *bad[2];
	size_t n;
	struct joint_pulse pulse[LEARN_PULSES];
	int m;
	int lone;    /* 1: hardly longer than one pulse */
	int foreign; /* 1: not described by the pulse */
	double chi2, dof, energy;
};

struct learning {
	struct joint *joint;
	struct joint_scene scene; /* as the instrument is taken to be now */
	struct stretch stretch[LEARN_STRETCHES];
	int count;
	int crowded;  /* 1: lone pulses were too few, and others served, too */
	int pieces;   /* 1: even these were too few: some cut pulses through */
	double limit; /* of joint_operations() in this round */
	int failed;   /* 1: reached, or nothing to learn from, before a form was found */
	double price; /* chi-square and what each pulse must take away, per degree */
};

/* Fills the pulse, its duration, the gain, the range of delays and the errors of c from
 * y[channel][0 .. n), aligned; bad: as long.  c has a first duration, gain and range.
 * On return learning has the stretches and their pulses.  again: c has a pulse already.
 */
enum calibrate_status learn_pulse(const struct calibrate_par *par, double *const y[2],
	unsigned char *const bad[2], size_t n, int again, struct learning *learning,
	struct calibration *c);

#endif
