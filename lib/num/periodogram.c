/* periodogram.c - see periodogram.h */
#include "num/periodogram.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct periodogram *periodogram_new(size_t size)
{
	struct periodogram *p = calloc(1, sizeof *p);

	if (!p)
		return NULL;
	p->size = size;
	p->fft = fft_new_forward(size);
	p->x = fft_alloc(size);
	p->spectrum = fft_alloc_complex(size / 2 + 1);
	if (p->fft && p->x && p->spectrum)
		return p;
	periodogram_free(p);
	return NULL;
}

void periodogram_free(struct periodogram *p)
{
	if (!p)
		return;
	fft_done(p->fft);
	fft_free(p->x);
	fft_free(p->spectrum);
	free(p);
}

void periodogram_add(struct periodogram *p, double scale, double *power, size_t bins)
{
	fft_forward(p->fft, p->x, p->spectrum);
	for (size_t k = 0; k < bins; k++) {
		double re = creal(p->spectrum[k]), im = cimag(p->spectrum[k]);

		power[k] += scale * (re * re + im * im);
	}
}

void periodogram_add_hann(struct periodogram *p, const double *y, size_t n, double scale,
	double *power, size_t bins)
{
	memset(p->x, 0, p->size * sizeof *p->x);
	for (size_t i = 0; i < n; i++) {
		double w = sin(M_PI * ((double)i + 0.5) / (double)n);

		p->x[i] = y[i] * (w * w);
	}
	periodogram_add(p, scale, power, bins);
}
