/* fir.c - band-pass filters by the window method, run directly or by overlap-save */
#include "signal/filter/fir.h"
#include "num/fft.h"
#include "num/lanes.h"
#include "num/status.h"
#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LANES = 8 }; /* outputs the direct form computes side by side */

struct fir {
	size_t taps, block, points; /* points = 0: direct */
	int channels;
	double *reversed;         /* taps, last first */
	double complex *response; /* of the taps, over points */
	struct fft *fft;
	double *past; /* channels x [taps - 1 old samples | block new ones] */
	double *out;
	double complex *spectrum;
	double blocks, left_out;
};

/* Modified Bessel function I0 by its series, whose terms are all positive. */
static double bessel_i0(double x)
{
	double term = 1, sum = 1, q = 0.25 * x * x;

	for (int k = 1; term > 1e-17 * sum; k++) {
		term *= q / ((double)k * k);
		sum += term;
	}
	return sum;
}

static double window_at(const struct fir_band *band, int k)
{
	double z = 2.0 * k / band->order - 1; /* -1 .. 1 */
	double c = cos(M_PI * z);

	switch (band->window) {
	case FIR_HAMMING:
		return 0.54 + 0.46 * c;
	case FIR_HANN:
		return 0.5 + 0.5 * c;
	case FIR_BLACKMAN:
		return 0.42 + 0.5 * c + 0.08 * cos(2 * M_PI * z);
	default:
		return bessel_i0(band->beta * sqrt(fmax(0, 1 - z * z))) /
		       bessel_i0(band->beta);
	}
}

/* Ideal low-pass with edge f, at m samples from the middle. */
static double ideal(double f, double m)
{
	double x = M_PI * (2 * f * m);

	return x == 0 ? 2 * f : 2 * f * (sin(x) / x);
}

enum num_status fir_design(const struct fir_band *band, double *h)
{
	double middle = 0.5 * (band->low + band->high), sum = 0;

	if (band->low <= 0)
		middle = 0;
	else if (band->high >= 0.5)
		middle = 0.5;
	for (int k = 0; k <= band->order; k++) {
		double m = k - 0.5 * band->order;

		h[k] = (ideal(band->high, m) - ideal(band->low, m)) * window_at(band, k);
		sum += h[k] * cos(2 * M_PI * middle * m);
	}
	if (!band->scale)
		return NUM_OK;
	if (middle == 0.5 && band->order % 2)
		return NUM_DOMAIN;
	for (int k = 0; k <= band->order; k++)
		h[k] /= sum;
	return NUM_OK;
}

static const char *const window_names[] = { [FIR_HAMMING] = "hamming",
	[FIR_HANN] = "hann",
	[FIR_BLACKMAN] = "blackman",
	[FIR_KAISER] = "kaiser" };

void fir_print(const struct fir_band *band, double rate, char text[FIR_TEXT])
{
	snprintf(text, FIR_TEXT, "%.17g:%.17g %d %s %.17g %s", band->low * rate,
		band->high * rate, band->order, window_names[band->window], band->beta,
		band->scale ? "scaled" : "plain");
}

const char *fir_parse(const char *text, double rate, struct fir_band *band)
{
	char window[16], scale[16];
	int used = 0, known = -1;

	/* Seven digits hold any order, and no more are read: they might overflow. */
	if (sscanf(text, "%lf:%lf %7d %15s %lf %15s%n", &band->low, &band->high,
		    &band->order, window, &band->beta, scale, &used) != 6)
		return NULL;
	band->low /= rate;
	band->high /= rate;
	band->scale = strcmp(scale, "scaled") == 0;
	for (int k = FIR_HAMMING; k <= FIR_KAISER; k++)
		if (strcmp(window, window_names[k]) == 0)
			known = k;
	if (known < 0 || !(band->low >= 0) || !(band->low < band->high) ||
		!(band->high <= 0.5 * (1 + 1e-12)) || band->order < 1 ||
		band->order > 1000000 || !(fabs(band->beta) < 1e3) ||
		(!band->scale && strcmp(scale, "plain") != 0))
		return NULL;
	band->window = (enum fir_window)known;
	if (band->high > 0.5)
		band->high = 0.5;
	text += used;
	if (!*text)
		return text;
	return strncmp(text, " | ", 3) == 0 && text[3] ? text + 3 : NULL;
}

double fir_kaiser_beta(double attenuation)
{
	double a = attenuation;

	if (a > 50)
		return 0.1102 * (a - 8.7);
	if (a > 21)
		return 0.5842 * pow(a - 21, 0.4) + 0.07886 * (a - 21);
	return 0;
}

void fir_response(const double *h, size_t n, double f, double shift, double *real,
	double *imaginary)
{
	*real = *imaginary = 0;
	for (size_t k = 0; k < n; k++) {
		double phase = 2 * M_PI * fmod(f * ((double)k - shift), 1);

		*real += h[k] * cos(phase);
		*imaginary -= h[k] * sin(phase);
	}
}

/* Time per sample in units of one tap of the direct form (measured: a transform there
 * and back costs about 0.9 log2 of its points in that unit per point). */
static double cost(size_t taps, size_t points)
{
	double n = (double)points;

	return 0.9 * n * log2(n) / (n - (double)taps + 1);
}

/* Points of the cheapest transform for blocks of at most block frames (0: any); 0 where
 * the direct form is cheaper. */
static size_t choose_points(size_t taps, size_t block)
{
	size_t best = 0;
	double least = (double)taps;

	if (block) {
		size_t points = fft_good_size(taps - 1 + block);

		return cost(taps, taps - 1 + block) < least ? points : 0;
	}
	for (size_t points = 1024; points <= 64 * taps + 4096; points *= 2)
		if (points > taps && cost(taps, points) < least) {
			least = cost(taps, points);
			best = points;
		}
	return best;
}

static enum num_status make_response(struct fir *fir, const double *h)
{
	size_t half = fir->points / 2 + 1;

	fir->fft = fft_new(fir->points, 1);
	fir->response = fft_alloc_complex(half);
	fir->spectrum = fft_alloc_complex(half);
	if (!fir->fft || !fir->response || !fir->spectrum)
		return NUM_MEMORY;
	memcpy(fir->out, h, fir->taps * sizeof *h);
	fft_forward(fir->fft, fir->out, fir->response);
	for (size_t k = 0; k < half; k++)
		fir->response[k] /= (double)fir->points;
	return NUM_OK;
}

struct fir *fir_new(const double *h, size_t n, int channels, size_t block)
{
	struct fir *fir = calloc(1, sizeof *fir);
	size_t length;

	if (!fir)
		return NULL;
	fir->taps = n;
	fir->channels = channels;
	fir->points = choose_points(n, block);
	fir->block = block ? block : fir->points ? fir->points - n + 1 : 4096;
	length = fir->points ? fir->points : fir->block + n - 1 + LANES;
	fir->reversed = fft_alloc(n);
	fir->past = fft_alloc((size_t)channels * length);
	fir->out = fft_alloc(length);
	if (!fir->reversed || !fir->past || !fir->out ||
		(fir->points && make_response(fir, h))) {
		fir_free(fir);
		return NULL;
	}
	for (size_t k = 0; k < n; k++)
		fir->reversed[k] = h[n - 1 - k];
	return fir;
}

void fir_free(struct fir *fir)
{
	if (!fir)
		return;
	fft_done(fir->fft);
	fft_free(fir->response);
	fft_free(fir->spectrum);
	fft_free(fir->reversed);
	fft_free(fir->past);
	fft_free(fir->out);
	free(fir);
}

size_t fir_block(const struct fir *fir)
{
	return fir->block;
}

size_t fir_transform(const struct fir *fir)
{
	return fir->points;
}

double fir_blocks(const struct fir *fir, double *left_out)
{
	*left_out = fir->left_out;
	return fir->blocks;
}

/* Overlap-save: the circular convolution is right from sample taps - 1 on. */
static const double *convolve(struct fir *fir, double *past)
{
	const double complex *h = fir->response;
	double complex *s = fir->spectrum;

	fft_forward(fir->fft, past, s);
	for (size_t k = 0; k <= fir->points / 2; k++) {
		double a = creal(s[k]), b = cimag(s[k]), c = creal(h[k]), d = cimag(h[k]);

		s[k] = fft_complex(a * c - b * d, a * d + b * c);
	}
	fft_inverse(fir->fft, s, fir->out);
	return fir->out + fir->taps - 1;
}

static const double *multiply(struct fir *fir, const double *past, size_t n)
{
	for (size_t i = 0; i < n; i += LANES) {
		double sum[LANES] = { 0 };

		for (size_t k = 0; k < fir->taps; k++)
			for (size_t j = 0; j < LANES; j++)
				sum[j] += fir->reversed[k] * past[i + k + j];
		memcpy(fir->out + i, sum, sizeof sum);
	}
	return fir->out;
}

/* Filters what follows the old samples; the result is valid until the next call. */
static const double *filter(struct fir *fir, double *past, size_t n)
{
	size_t samples = fir->taps - 1 + n;

	if (lanes_next(past, 0, samples) == samples) {
		fir->left_out++;
		return past;
	}
	fir->blocks++;
	return fir->points ? convolve(fir, past) : multiply(fir, past, n);
}

void fir_run(struct fir *fir, double *x, size_t nframes)
{
	size_t old = fir->taps - 1, nc = (size_t)fir->channels;
	size_t length = fir->points ? fir->points : fir->block + old + LANES;

	for (size_t c = 0; c < nc; c++) {
		double *past = fir->past + c * length;
		const double *y;

		for (size_t i = 0; i < nframes; i++)
			past[old + i] = x[i * nc + c];
		memset(past + old + nframes, 0, (length - old - nframes) * sizeof *past);
		y = filter(fir, past, nframes);
		for (size_t i = 0; i < nframes; i++)
			x[i * nc + c] = y[i];
		memmove(past, past + nframes, old * sizeof *past);
	}
}
