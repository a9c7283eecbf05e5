/* tape.h - one channel of a record while it comes in, made ready for pulses to be sought:
 * its filter undone, tones taken off, in units of its noise
 *
 * A tape that is all zero is an empty one.  What comes out depends on the record alone,
 * not on how it came in.
 */
#ifndef SIGNAL_TAPE_H
#define SIGNAL_TAPE_H

#include "num/status.h"
#include "signal/calibration.h"
#include <stddef.h>

/* Samples from index begin on: those before white have their filter undone, those before
 * clean are free of tones, too, and in units of the noise. */
struct tape {
	double *x;
	size_t n, capacity;
	long long begin, white, clean;
	struct fir *whiten; /* NULL where there is nothing to undo; has taken in ... */
	long long fed;      /* ... the samples before this one */
	double *piece;      /* a block of it */
	double at;          /* where the coefficients hold */
	double coefficient[2 * TONES_MAX + 1];
	int started;
};

void tape_clear(struct tape *t);

/* Appends n samples: x[0], x[2], x[4] ... */
enum num_status tape_append(struct tape *t, const double *x, size_t n);
/* Forgets the n oldest samples. */
void tape_drop(struct tape *t, size_t n);
/* Forgets what lies before sample keep, now and then. */
void tape_forget(struct tape *t, long long keep);

/* Starts the preparation, with what was learned of the record. */
enum num_status tape_start(struct tape *t, const struct calibration *c);
/* Prepares all samples that can be prepared without later ones; all samples if the record
 * has ended. */
enum num_status tape_prepare(
	struct tape *t, const struct calibration *c, int channel, int ended);

#endif
