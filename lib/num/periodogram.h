/* periodogram.h - energy spectra of real samples, added up
 *
 *	struct periodogram *p = periodogram_new(size);
 *	for (size_t i = 0; i < n; i++)
 *		p->x[i] = ...;
 *	periodogram_add(p, scale, power, bins);
 *	periodogram_free(p);
 */
#ifndef NUM_PERIODOGRAM_H
#define NUM_PERIODOGRAM_H

#include "num/fft.h"

struct periodogram {
	size_t size;
	struct fft *fft;
	double *x; /* size samples, at first 0, which a transform keeps */
	double complex *spectrum;
};

struct periodogram *periodogram_new(size_t size); /* NULL: no memory */
void periodogram_free(struct periodogram *p);
/* Adds scale times the squared modulus of the transform of x to power[0 .. bins), bins up
 * to size / 2 + 1. */
void periodogram_add(struct periodogram *p, double scale, double *power, size_t bins);
/* The same for y[0 .. n) under Hann's window, and zeros. */
#define HANN_SQUARE 0.375 /* mean square of the window */
void periodogram_add_hann(struct periodogram *p, const double *y, size_t n, double scale,
	double *power, size_t bins);

#endif
