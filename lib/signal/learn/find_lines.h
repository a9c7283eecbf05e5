/* find_lines.h - interfering lines of a record: found, followed and subtracted
 *
 * A line is a tone of noise/tones.h, whose frequency may change.  Both channels have the
 * same lines.
 */
#ifndef SIGNAL_FIND_LINES_H
#define SIGNAL_FIND_LINES_H

#include "signal/learn/calibration.h"
#include "signal/noise/tones.h"
#include <stddef.h>

/* What the lines leave in the record, and change. */
struct lines {
	double left[2]; /* of each channel, see tones.h */
	double drift;   /* mean square change over some thousand samples, channel 1 */
};

/* Finds the lines of y1, y2[0 .. n), or follows those of par, and subtracts them with the
 * mean.  Fills tones, omega, tone_hop and tone_power of c; work holds n.  MEMORY; TONES:
 * too many samples are not known. */
enum separate_status find_lines(const struct calibrate_par *par, double *y1, double *y2,
	size_t n, double *work, struct calibration *c, struct lines *out);

/* Subtracts the lines of c and the mean from x[0 .. n). */
enum separate_status find_lines_take(
	const struct calibration *c, double *x, size_t n, struct tones_track *track);

#endif
