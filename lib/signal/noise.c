/* noise.c - see noise.h */
#include "signal/noise.h"
#include "num/fft.h"
#include "signal/quiet.h"
#include "signal/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Deviations of a mean that chance does not reach. */
static const double BEYOND = 5;

enum { SEGMENT = 2 * (NOISE_BINS - 1), ENOUGH = 16 };

/* Autocorrelation of a Hann window of n points at this lag, 1 at lag 0. */
static double window_autocorrelation(size_t n, size_t lag)
{
	double sum = 0, all = 0, turn = 2 * M_PI / (double)n;

	for (size_t i = 0; i < n; i++) {
		double here = 0.5 - 0.5 * cos(turn * ((double)i + 0.5));

		all += here * here;
		if (i + lag < n)
			sum += here * (0.5 - 0.5 * cos(turn * ((double)(i + lag) + 0.5)));
	}
	return sum / all;
}

/* Takes from a mean of periodograms what the window did to it, and its scatter: the
 * autocorrelation is divided by that of the window, and kept up to the last lag at which
 * it is more than chance gives.  *white: 1 where that is lag 0. */
static int sharpen(double *power, int quiets, int *white)
{
	enum { LAST = SEGMENT / 2 };
	struct fft *fft = fft_new(SEGMENT, 1);
	double complex *spectrum = fft_alloc_complex(NOISE_BINS);
	double *r = fft_alloc(SEGMENT), chance;
	size_t keep = 0;
	int ok = fft && spectrum && r;

	for (size_t k = 0; ok && k < NOISE_BINS; k++)
		spectrum[k] = power[k] / SEGMENT;
	if (ok)
		fft_inverse(fft, spectrum, r);
	/* Segments that overlap by half tell as much as half of them and a bit. */
	chance = ok ? BEYOND * r[0] / sqrt(0.5 * SEGMENT * quiets) : 0;
	for (size_t k = 1; ok && k <= LAST; k++)
		if (fabs(r[k]) > chance)
			keep = k;
	*white = keep == 0;
	keep = keep < 16 ? 16 : keep;
	for (size_t k = 0; ok && k <= LAST; k++) {
		double u = (double)k / (double)keep - 1;
		double part = u <= 0 ? 1 : u >= 1 ? 0 : 0.5 + 0.5 * cos(M_PI * u);

		r[k] *= (*white ? k == 0 : part) / window_autocorrelation(SEGMENT, k);
		r[k ? SEGMENT - k : 0] = r[k];
	}
	if (ok)
		fft_forward(fft, r, spectrum);
	/* Leakage taken off must leave something: the window lets that through. */
	for (size_t k = 0; ok && k < NOISE_BINS; k++)
		power[k] = fmax(creal(spectrum[k]), *white ? 0 : 0.1 * power[k]);
	fft_done(fft);
	fft_free(spectrum);
	fft_free(r);
	return ok;
}

/* Level from the upper half of the frequencies of the whole record. */
static int measure_above(
	struct noise *noise, const double *y1, const double *y2, size_t n)
{
	double *work = malloc(n * sizeof *work);

	for (int c = 0; work && c < 2; c++) {
		double sigma = robust_noise(c ? y2 : y1, n, 4, work);

		for (int k = 0; k < NOISE_BINS; k++)
			noise->power[c][k] = sigma * sigma;
	}
	free(work);
	return work != NULL;
}

/* Quiet spectra of both channels by segments, at NOISE_BINS frequencies: between those of
 * shorter segments by the straight line.  Returns how many were quiet, -1 when out of
 * memory. */
static int measure_segments(
	struct noise *noise, const double *y1, const double *y2, size_t n, size_t segment)
{
	double part[2][NOISE_BINS];
	size_t ratio = SEGMENT / segment;
	int quiets = quiet_spectrum(y1, y2, n, segment, part[0], part[1]);

	for (int c = 0; quiets > 0 && c < 2; c++)
		for (size_t k = 0; k < NOISE_BINS; k++) {
			size_t from = k / ratio, to = from + (k % ratio > 0);
			double u = (double)(k % ratio) / (double)ratio;

			noise->power[c][k] = (1 - u) * part[c][from] + u * part[c][to];
			if (!(noise->power[c][k] > 0))
				quiets = 0;
		}
	return quiets;
}

/* Is there more in what is quiet for longer?  Then something happened in it. */
static int is_louder(
	const struct noise *longer, const struct noise *shorter, size_t segment)
{
	size_t group = 2 * SEGMENT / segment;

	for (int c = 0; c < 2; c++)
		for (size_t k = 1; k + group <= NOISE_BINS; k += group) {
			double x = 0, y = 0;

			for (size_t i = k; i < k + group; i++) {
				x += longer->power[c][i];
				y += shorter->power[c][i];
			}
			if (x > y * (1.1 + BEYOND / sqrt(0.5 * (double)group *
							    longer->quiets)))
				return 1;
		}
	return 0;
}

/* Segments are short against most pauses between pulses, or they are not quiet; those so
 * short that a pulse may be quiet in them only tell that. */
int noise_measure(struct noise *noise, const double *y1, const double *y2, size_t n)
{
	struct noise *shortest = malloc(sizeof *shortest);
	int ok = shortest != NULL, found = 0;

	if (ok)
		shortest->quiets = measure_segments(shortest, y1, y2, n, SEGMENT / 16);
	for (size_t segment = SEGMENT; ok && !found && segment >= SEGMENT / 4;
		segment /= 4) {
		noise->quiets = measure_segments(noise, y1, y2, n, segment);
		ok = noise->quiets >= 0 && shortest->quiets >= 0;
		found = noise->quiets >= ENOUGH &&
			!(shortest->quiets >= ENOUGH &&
				is_louder(noise, shortest, SEGMENT / 16));
	}
	free(shortest);
	if (!ok)
		return 0;
	if (found)
		return sharpen(noise->power[0], noise->quiets, &noise->white[0]) &&
		       sharpen(noise->power[1], noise->quiets, &noise->white[1]);
	noise->quiets = 0;
	noise->white[0] = noise->white[1] = 1;
	return measure_above(noise, y1, y2, n);
}

double noise_level(const struct noise *noise, int c)
{
	double work[NOISE_BINS];

	memcpy(work, noise->power[c], sizeof work);
	return sqrt(robust_median(work, NOISE_BINS));
}

int noise_whitening(const struct noise *noise, int c, struct whitening *w)
{
	double level = noise_level(noise, c);

	return whitening_of_noise(w, noise->power[c], NOISE_BINS, level * level);
}
