/* whiten.h - inversion of the filter applied to a record, as far as its noise allows
 *
 * White noise that has passed a filter of gain |H(f)| has the power |H|^2 at each
 * frequency; dividing by |H| makes it white again.  If the filter has linear
 * phase, that also restores the shape of every pulse.  Frequencies where |H| is below
 * 1/200 of its largest value are lost.  Lost high frequencies make pulses smoother
 * (shape_filter() with the taps in seen); lost low ones remove a slow baseline, which
 * must be fitted as well (joint.h).
 *
 * Noise that was coloured before the pulses were added to it is made white by the same
 * taps; the pulses have then passed these taps only.
 *
 * Frequencies are in cycles per sample.
 */
#ifndef SIGNAL_WHITEN_H
#define SIGNAL_WHITEN_H

#include "num/status.h"
#include <stddef.h>

enum whiten_kind {
	WHITEN_FILTERED, /* pulses and noise went through a filter of linear phase */
	WHITEN_COLOURED  /* the noise alone has a colour */
};

struct whitening {
	int half;    /* taps on either side of the middle */
	double *tap; /* 2 half + 1, symmetric: from the record to white noise */
	int seen_half;
	double *seen; /* 2 seen_half + 1, symmetric: all filters that a pulse passed */
	int edge; /* samples at either end of a record that are wrong because those beyond
		     it are missing, which have over 1 % of the energy of the taps */
	double low, high; /* band that is kept; 0 and 0.5: everything */
	double band;      /* variance of the noise made white, 1 at all frequencies */
};

/* From the power of the noise at n frequencies f = k / (2 (n - 1)), smooth between them
 * beside the factor 1 + drift / (2 sin(pi f))^2; the white noise has that of the
 * strongest.  NUM_DOMAIN if there is none at any. */
enum num_status whitening_of_noise(struct whitening *w, const double *power, double drift,
	size_t n, enum whiten_kind kind);
/* The inverse of a symmetric filter of n taps. */
enum num_status whitening_of_filter(struct whitening *w, const double *tap, size_t n);
void whitening_clear(struct whitening *w);

/* 1 if the taps remove a constant: a record is then continued by its first and last
 * values, and otherwise by zeros. */
int whitening_removes_mean(const struct whitening *w);
/* Whitens x[0..n) in place, so continued. */
enum num_status whitening_apply(const struct whitening *w, double *x, size_t n);

#endif
