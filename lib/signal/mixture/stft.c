/* stft.c - see stft.h */
#include "signal/mixture/stft.h"
#include "num/fft.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct stft {
	size_t window, hop;
	double *shape, *frame;
	double complex *spectrum;
	struct fft *fft;
};

struct stft *stft_new(size_t window, size_t hop)
{
	struct stft *s;

	if (window < 4 || window % 2 || hop < 1 || hop > window) {
		errno = EDOM;
		return NULL;
	}
	s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	s->window = window;
	s->hop = hop;
	s->shape = fft_alloc(window);
	s->frame = fft_alloc(window);
	s->spectrum = fft_alloc_complex(window / 2 + 1);
	s->fft = fft_new(window, 1);
	if (!s->shape || !s->frame || !s->spectrum || !s->fft) {
		stft_free(s);
		return NULL;
	}
	for (size_t i = 0; i < window; i++)
		s->shape[i] =
			0.54 - 0.46 * cos(2 * M_PI * (double)i / (double)(window - 1));
	return s;
}

void stft_free(struct stft *s)
{
	if (!s)
		return;
	fft_free(s->shape);
	fft_free(s->frame);
	fft_free(s->spectrum);
	fft_done(s->fft);
	free(s);
}

size_t stft_bins(const struct stft *s)
{
	return s->window / 2 + 1;
}

size_t stft_frames(const struct stft *s, size_t n)
{
	return n <= s->window ? 1 : 1 + (n - s->window + s->hop - 1) / s->hop;
}

void stft_forward(const struct stft *s, const double *x, size_t n, double complex *y)
{
	size_t frames = stft_frames(s, n), bins = stft_bins(s);

	for (size_t f = 0; f < frames; f++) {
		for (size_t i = 0; i < s->window; i++) {
			size_t at = f * s->hop + i;

			s->frame[i] = at < n ? x[at] * s->shape[i] : 0;
		}
		fft_forward(s->fft, s->frame, y + f * bins);
	}
}

void stft_inverse(const struct stft *s, const double complex *y, size_t n, double *x)
{
	size_t frames = stft_frames(s, n), bins = stft_bins(s);

	memset(x, 0, n * sizeof *x);
	for (size_t f = 0; f < frames; f++) {
		memcpy(s->spectrum, y + f * bins, bins * sizeof *y);
		fft_inverse(s->fft, s->spectrum, s->frame);
		for (size_t i = 0; i < s->window && f * s->hop + i < n; i++)
			x[f * s->hop + i] += s->frame[i] / (double)s->window;
	}
	for (size_t i = 0; i < n; i++) {
		size_t last = i / s->hop,
		       first = i < s->window ? 0 : (i - s->window) / s->hop + 1;
		double sum = 0;

		for (size_t f = first; f <= last && f < frames; f++)
			sum += s->shape[i - f * s->hop];
		x[i] /= sum;
	}
}
