/* buffer.h - preparation of one channel of a record as it arrives: its filter is undone,
 * tones are removed, and it is scaled to units of its noise
 *
 * A zeroed buffer is empty.  The result does not depend on the sizes of the pieces in
 * which the record arrives.
 */
#ifndef SIGNAL_BUFFER_H
#define SIGNAL_BUFFER_H

#include "num/status.h"
#include "signal/learn/calibration.h"
#include "signal/noise/following.h"
#include <stddef.h>

/* Samples from index begin on: the filter is undone in those before white; those before
 * flat are also free of tones and in units of the noise learned; those before clean in
 * units of the noise at their time. */
struct buffer {
	double *x;
	unsigned char *hidden; /* 1: the converter has not measured this sample */
	size_t n, room, flags; /* samples stored; room for them, and for flags */
	double missing;        /* samples hidden so far */
	size_t ratio;          /* samples of the record averaged into one; 0: 1 */
	size_t parts;          /* of the next one, so far: */
	double sum;
	int lost; /* 1: the converter has not measured all of them */
	long long begin, white, flat, clean;
	double mean, scale; /* to be subtracted, and divided by */
	int hold;           /* 1: the first and last values continue it, see whiten.h */
	struct fir *whiten; /* NULL if there is no filter to undo; it has read ... */
	long long fed;      /* ... the samples before this one */
	double *piece;      /* a block of it */
	struct tones_track tones;
	struct following noise;
	size_t block;      /* samples of which the noise is measured; 0: it is constant */
	long long learned; /* the noise was learned from the samples before this one */
};

void buffer_clear(struct buffer *b);

/* Appends n samples; averaged, if b is.  lost: after each, how many of the last samples
 * turn out not to have been measured (converter_next()). */
enum num_status buffer_append(
	struct buffer *b, const double *x, const size_t *lost, size_t n);
/* Hides sample i of those stored. */
void buffer_hide(struct buffer *b, size_t i);
/* A buffer with the means of every ratio of the n oldest samples of b, the first with an
 * index divisible by ratio; b must be neither averaged nor started.  Means of white noise
 * are white. */
enum num_status buffer_average(
	const struct buffer *b, size_t n, size_t ratio, struct buffer *mean);
/* Drops the n oldest samples. */
void buffer_discard(struct buffer *b, size_t n);
/* Drops samples before keep once there are many. */
void buffer_forget(struct buffer *b, long long keep);

/* Starts the preparation, with what was learned of the record; mean: of the channel, only
 * used if there is a filter to undo; scale: its noise. */
enum num_status buffer_start(
	struct buffer *b, const struct calibration *c, double mean, double scale);
/* Follows the noise from sample begin on, in blocks.  reference: noise once clean where
 * it was learned, or 0 if that is in the samples before learned. */
void buffer_follow(struct buffer *b, long long begin, size_t block, double reference,
	long long learned);
/* Prepares all samples that can be prepared without later ones; all samples if the record
 * has ended. */
enum num_status buffer_prepare(struct buffer *b, const struct calibration *c, int ended);

#endif
