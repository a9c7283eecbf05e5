/* measure.h - the instrument measured from a record, once (see calibration.h)
 *
 * Known or assumed filters of the record have been undone before.
 */
#ifndef SIGNAL_MEASURE_H
#define SIGNAL_MEASURE_H

#include "signal/learn/calibration.h"
#include "signal/learn/template.h"
#include "signal/noise/colour.h"
#include <stddef.h>

/* What was done to learn the instrument, by all looks at its record. */
struct effort {
	int attempts;
	double work; /* samples of pulses computed so far */
};

/* What is known, the record, and results of the first examination of its noise. */
struct look {
	const struct calibrate_par *par;
	const double *x[2]; /* n samples of either channel */
	size_t n;
	struct effort *effort;
	int coloured;
	enum whiten_kind kind; /* the kind of colour that is being tried */
	int settled;           /* 1: this is the last attempt */
	double low;            /* lag of the lowest autocorrelation */
	double lowest;         /* the same of the middle velocity if it is known, or 0 */
	double wander;         /* mean square change of lines over some thousand samples,
				  noise 1 */
	struct colour noise;
	/* 1: return COLOURED if the noise drifts or, unless the pulse is known, has
	 * another colour; of a whitened record, only if no events are alike. */
	int first;
	int seen;   /* 1: another attempt told particles from noise */
	int wide;   /* 1: search the delays of turbulent flow, else of plug flow */
	int events; /* events that must be alike, as in another attempt */
	struct template found; /* the pulse taken from the record */
};

/* 1 if the noise is white above the band of a pulse of this duration. */
int measure_white_above(const struct look *look, double duration);

/* Fills the rest of c, whose whitening, mean, estimated and presumed_white are given,
 * from y1, y2[0 .. n), which are overwritten.  raw[0 .. n): y1 before whitening; work
 * holds n. */
enum separate_status measure(struct look *look, const double *raw, double *y1, double *y2,
	size_t n, double *work, struct calibration *c);

#endif
