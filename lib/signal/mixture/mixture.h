/* mixture.h - separation of the sources of a record by attenuation and delay
 *
 * DUET for sources that are sparse in time and frequency, such as speech, each of which
 * reaches the second channel weaker by a and later by delta,
 *
 *	x1 = sum of s_k,   X2(w) = sum of a_k exp(-i w delta_k) S_k(w)
 *
 * (Yilmaz, Rickard: Blind separation of speech mixtures via time-frequency masking, IEEE
 * Trans. Signal Process. 52, 2004).  The sources are peaks of the histogram of a - 1/a
 * and delta, weighted by |X1 X2|, over the frequencies at which no delay searched turns
 * the phase by more than half a turn.  Where delays of 16 samples are searched, these are
 * so low that sources two samples apart are one peak: the points of each peak are counted
 * again at higher frequencies, by their delay from it.  a_k and delta_k are fitted by
 * least squares to the points of each source; each point is assigned to the most likely
 * source,
 *
 *	least |a_k exp(-i w delta_k) X1 - X2|^2 / (1 + a_k^2),
 *
 * so that the sources add up to channel 1.  The record is kept: 16 bytes a frame.
 */
#ifndef SIGNAL_MIXTURE_H
#define SIGNAL_MIXTURE_H

#include "num/status.h"
#include "signal/mixture/histogram.h"
#include <stddef.h>

enum { MIXTURE_SOURCES = HISTOGRAM_PEAKS };

struct mixture_par {
	size_t window, hop; /* of the transform, samples: even, and up to half of it */
	int sources;        /* how many to find; 0: as many as there are peaks */
	void (*progress)(long done, long windows); /* called as they are transformed; or
						  NULL */
};

struct mixture_source {
	double attenuation, delta; /* at channel 2, samples */
	double share;              /* of the weight of the histogram */
};

struct mixture;
/* NULL with errno EDOM (bad sizes) or ENOMEM. */
struct mixture *mixture_new(const struct mixture_par *par);
void mixture_free(struct mixture *m);

/* n frames of two finite channels, interleaved. */
enum num_status mixture_push(struct mixture *m, const double *x, size_t n);
size_t mixture_frames(const struct mixture *m);

/* The sources of all that was pushed, largest share first: their number, 0 where both
 * channels have nothing in common or are silent. */
int mixture_find(struct mixture *m, struct mixture_source source[MIXTURE_SOURCES]);
/* Signal of each source on channel 1: x[k * frames + i]. */
enum num_status mixture_separate(struct mixture *m, double *x);

/* 1 if the record has delays of more than 16 samples, which are ambiguous. */
int mixture_is_far(const struct mixture *m);

/* Weights of the histogram of mixture_find(), by rows of the attenuation; the middle of
 * cell (i, j). */
const double *mixture_histogram(const struct mixture *m);
void mixture_cell(
	const struct mixture *m, int i, int j, double *attenuation, double *delta);

#endif
