/* masks.h - degenerate unmixing (DUET): sources separated by attenuation and delay
 *
 * Thesis (3-6) to (3-18), with a sign corrected:
 *
 *	(3-15) a(tau, w) = |Y2 / Y1|
 *
 *	(3-16) delta(tau, w) = -angle(Y2 / Y1) / w'      (the thesis lacks the minus sign)
 *
 *	(3-18) weight |Y1 Y2|
 *
 * Bin 0 has no phase and is omitted, as are bins above the band of the pulse.  A pulse is
 * wider than a bin, so that the phase of a bin turns slower or faster than the frequency
 * w of its middle says: w' is that of one pulse of the expected shape under the same
 * windows (with 64 samples and a 100-sample pulse, 0.56 w in bin 1).  The peaks of the
 * histogram are sources (histogram.h), and the mask (3-17) of a source holds the bins of
 * the time-frequency plane whose cell belongs to it.
 *
 * Pulses that overlap share bins, which masks cannot separate: see duet(1).
 */
#ifndef SIGNAL_MASKS_H
#define SIGNAL_MASKS_H

#include "num/status.h"
#include "signal/mixture/histogram.h"
#include "signal/pulse/shape.h"
#include <stddef.h>

enum { MASKS_SOURCES_MAX = HISTOGRAM_PEAKS, MASKS_CELLS = HISTOGRAM_CELLS };

/* A pulse has hardly anything above this frequency over one cycle per duration. */
enum { MASKS_BAND = 2 };

struct masks_par {
	/* Of the transform, under a Hamming window, samples: window even, 4 or more;
	 * 1 <= hop <= window. */
	size_t window, hop;
	double duration;             /* of a pulse, samples, 4 or more */
	double delta_min, delta_max; /* range of the histogram, samples, not empty */
	double gain_max;             /* attenuation from 0 to this */
	double peak_share; /* peaks lower than this share of the highest are noise */
	int sources;       /* how many to find; 0: as many as there are peaks */
	const struct shape *shape; /* to calibrate w' */
};

struct masks_source {
	double attenuation, delta; /* of the peak, samples */
	double weight;             /* share of the histogram that belongs to it */
};

struct masks;
struct masks *masks_new(const struct masks_par *par); /* NULL: no memory */
void masks_free(struct masks *masks);

/* Finds the *sources sources of y1[0..n), y2[0..n) (aligned), largest weight first. */
enum num_status masks_find(struct masks *masks, const double *y1, const double *y2,
	size_t n, struct masks_source source[MASKS_SOURCES_MAX], int *sources);

/* Signal of source k of the last masks_find() at sensor 1: x[0..n). */
void masks_separate(struct masks *masks, int k, double *x);

/* Weighted histogram of the last masks_find(): MASKS_CELLS * MASKS_CELLS, attenuation
 * by rows; what place (i, j) stands for, in cells. */
const double *masks_histogram(const struct masks *masks);
void masks_cell(const struct masks *masks, double i, double j, double *attenuation,
	double *delta);

#endif
