/* masks.c - see masks.h */
#include "signal/mixture/masks.h"
#include "num/fft.h"
#include "num/room.h"
#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = MASKS_CELLS };

struct masks {
	struct masks_par par;
	struct fft *fft;
	double *hamming, *frame; /* the window; one frame under it, ... */
	double complex *part;    /* ... and of one source, transformed */
	size_t bins, top;        /* bins 1 .. top are used */
	double *omega;           /* calibrated frequency of each bin, rad per sample */
	struct histogram histogram;
	size_t n, frames, room1, room2, cells;
	double complex *y1, *y2; /* bins of each frame */
	int *cell; /* of each point of the plane, -1 outside the histogram */
};

/* Room for the frames that cover n samples: frame f those from f hop on. */
static enum num_status reserve(struct masks *m, size_t n)
{
	size_t window = m->par.window, hop = m->par.hop, count;

	m->n = n;
	m->frames = n <= window ? 1 : 1 + (n - window + hop - 1) / hop;
	count = m->frames * m->bins;
	return room_for(&m->y1, &m->room1, count, sizeof *m->y1) ||
			       room_for(&m->y2, &m->room2, count, sizeof *m->y2) ||
			       room_for(&m->cell, &m->cells, count, sizeof *m->cell)
		       ? NUM_MEMORY
		       : NUM_OK;
}

/* The short-time Fourier transform (3-6) of x, with zeros behind it. */
static void transform(struct masks *m, const double *x, double complex *y)
{
	for (size_t f = 0; f < m->frames; f++) {
		for (size_t i = 0; i < m->par.window; i++) {
			size_t at = f * m->par.hop + i;

			m->frame[i] = at < m->n ? x[at] * m->hamming[i] : 0;
		}
		fft_forward(m->fft, m->frame, y + f * m->bins);
	}
}

/* Phase per sample of delay of one pulse in each bin, weighted as (3-18). */
static enum num_status calibrate(struct masks *m)
{
	double T = m->par.duration, shift = T / 50;
	size_t n = (size_t)(2 * shape_reach(m->par.shape) * T) + 4 * m->par.window;
	double *x = calloc(2 * n, sizeof *x);
	double complex *turn = calloc(m->bins, sizeof *turn);
	enum num_status status = x && turn ? reserve(m, n) : NUM_MEMORY;

	for (int place = 0; !status && place < 16; place++) {
		double t0 = (double)n / 2 + place * (double)m->par.hop / 16;

		shape_sample(m->par.shape, t0, T, 0, n, x, NULL, NULL);
		shape_sample(m->par.shape, t0 + shift, T, 0, n, x + n, NULL, NULL);
		transform(m, x, m->y1);
		transform(m, x + n, m->y2);
		for (size_t i = 0; i < m->frames * m->bins; i++)
			turn[i % m->bins] += m->y1[i] * conj(m->y2[i]);
	}
	for (size_t k = 0; !status && k < m->bins; k++)
		m->omega[k] = carg(turn[k]) / shift;
	free(x);
	free(turn);
	return status;
}

struct masks *masks_new(const struct masks_par *par)
{
	struct masks *m = calloc(1, sizeof *m);
	const size_t w = par->window;

	if (!m)
		return NULL;
	m->par = *par;
	m->bins = w / 2 + 1;
	m->fft = fft_new(w, 1);
	m->hamming = fft_alloc(w);
	m->frame = fft_alloc(w);
	m->part = fft_alloc_complex(m->bins);
	m->omega = calloc(m->bins, sizeof *m->omega);
	for (size_t i = 0; m->hamming && i < w; i++)
		m->hamming[i] = 0.54 - 0.46 * cos(2 * M_PI * (double)i / (double)(w - 1));
	if (!m->fft || !m->hamming || !m->frame || !m->part || !m->omega ||
		calibrate(m)) {
		masks_free(m);
		return NULL;
	}
	m->top = (size_t)floor(MASKS_BAND * (double)par->window / par->duration);
	if (m->top < 1)
		m->top = 1;
	if (m->top > m->bins - 1)
		m->top = m->bins - 1;
	return m;
}

void masks_free(struct masks *m)
{
	if (!m)
		return;
	fft_done(m->fft);
	fft_free(m->hamming);
	fft_free(m->frame);
	fft_free(m->part);
	free(m->omega);
	free(m->y1);
	free(m->y2);
	free(m->cell);
	free(m);
}

void masks_cell(
	const struct masks *m, double i, double j, double *attenuation, double *delta)
{
	*attenuation = i * m->par.gain_max / CELLS;
	*delta = m->par.delta_min + j * (m->par.delta_max - m->par.delta_min) / CELLS;
}

const double *masks_histogram(const struct masks *m)
{
	return m->histogram.weight;
}

static void fill_histogram(struct masks *m)
{
	memset(m->histogram.weight, 0, sizeof m->histogram.weight);
	for (size_t p = 0; p < m->frames * m->bins; p++) {
		size_t k = p % m->bins;
		double x, y, weight = cabs(m->y1[p]) * cabs(m->y2[p]);

		m->cell[p] = -1;
		if (k < 1 || k > m->top || weight == 0 || !(m->omega[k] > 0))
			continue;
		x = cabs(m->y2[p]) / cabs(m->y1[p]) / m->par.gain_max * CELLS;
		y = (-carg(m->y2[p] / m->y1[p]) / m->omega[k] - m->par.delta_min) /
		    (m->par.delta_max - m->par.delta_min) * CELLS;
		if (!(x >= 0 && x < CELLS && y >= 0 && y < CELLS))
			continue;
		m->cell[p] = (int)x * CELLS + (int)y;
		m->histogram.weight[m->cell[p]] += weight;
	}
}

/* Number of peaks. */
static int find_peaks(struct masks *m, struct masks_source *source)
{
	struct histogram_peak peak[HISTOGRAM_PEAKS];
	int given = m->par.sources;
	int n = histogram_peaks(&m->histogram, given ? given : MASKS_SOURCES_MAX,
		given ? 0 : m->par.peak_share, peak);

	for (int k = 0; k < n; k++) {
		masks_cell(m, peak[k].i, peak[k].j, &source[k].attenuation,
			&source[k].delta);
		source[k].weight = peak[k].share;
	}
	return n;
}

enum num_status masks_find(struct masks *m, const double *y1, const double *y2, size_t n,
	struct masks_source source[MASKS_SOURCES_MAX], int *sources)
{
	if (reserve(m, n))
		return NUM_MEMORY;
	transform(m, y1, m->y1);
	transform(m, y2, m->y2);
	fill_histogram(m);
	*sources = find_peaks(m, source);
	return NUM_OK;
}

/* Bin 0 and the bins above the band carry no delay: they go with bin 1 of their frame.
 * The frames are added up and divided by the sum of the windows, so that a transform that
 * is left as it is gives back every sample. */
void masks_separate(struct masks *m, int k, double *x)
{
	const size_t w = m->par.window, hop = m->par.hop;

	memset(x, 0, m->n * sizeof *x);
	for (size_t f = 0; f < m->frames; f++) {
		for (size_t bin = 0; bin < m->bins; bin++) {
			int cell = m->cell[f * m->bins +
					   (bin < 1 || bin > m->top ? 1 : bin)];

			m->part[bin] = cell >= 0 && m->histogram.owner[cell] == k
					       ? m->y1[f * m->bins + bin]
					       : 0;
		}
		fft_inverse(m->fft, m->part, m->frame);
		for (size_t i = 0; i < w && f * hop + i < m->n; i++)
			x[f * hop + i] += m->frame[i] / (double)w;
	}
	for (size_t i = 0; i < m->n; i++) {
		double sum = 0;

		for (size_t f = i < w ? 0 : (i - w) / hop + 1;
			f <= i / hop && f < m->frames; f++)
			sum += m->hamming[i - f * hop];
		x[i] /= sum;
	}
}
