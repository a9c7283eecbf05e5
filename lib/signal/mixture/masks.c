/* masks.c - see masks.h */
#include "signal/mixture/masks.h"
#include "signal/mixture/histogram.h"
#include "signal/mixture/stft.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = MASKS_CELLS };

struct masks {
	struct masks_par par;
	struct stft *stft;
	size_t bins, top; /* bins 1 .. top are used */
	double *omega;    /* calibrated frequency of each bin, rad per sample */
	struct histogram histogram;
	size_t n, frames, capacity;
	double complex *y1, *y2, *part;
	int *cell; /* of each point of the plane, -1 outside the histogram */
};

static enum num_status reserve(struct masks *m, size_t n)
{
	size_t frames = stft_frames(m->stft, n), count = frames * m->bins;

	m->n = n;
	m->frames = frames;
	if (count <= m->capacity)
		return NUM_OK;
	free(m->y1);
	free(m->y2);
	free(m->part);
	free(m->cell);
	m->y1 = malloc(count * sizeof *m->y1);
	m->y2 = malloc(count * sizeof *m->y2);
	m->part = malloc(count * sizeof *m->part);
	m->cell = malloc(count * sizeof *m->cell);
	m->capacity = m->y1 && m->y2 && m->part && m->cell ? count : 0;
	return m->capacity ? NUM_OK : NUM_MEMORY;
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
		stft_forward(m->stft, x, n, m->y1);
		stft_forward(m->stft, x + n, n, m->y2);
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

	if (!m)
		return NULL;
	m->par = *par;
	m->stft = stft_new(par->window, par->hop);
	if (!m->stft) {
		masks_free(m);
		return NULL;
	}
	m->bins = stft_bins(m->stft);
	m->omega = calloc(m->bins, sizeof *m->omega);
	if (!m->omega || calibrate(m)) {
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
	stft_free(m->stft);
	free(m->omega);
	free(m->y1);
	free(m->y2);
	free(m->part);
	free(m->cell);
	free(m);
}

void masks_cell(const struct masks *m, int i, int j, double *attenuation, double *delta)
{
	*attenuation = (i + 0.5) * m->par.gain_max / CELLS;
	*delta = m->par.delta_min +
		 (j + 0.5) * (m->par.delta_max - m->par.delta_min) / CELLS;
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

	for (int k = 0; k < n; k++)
		source[k] = (struct masks_source){ peak[k].i * m->par.gain_max / CELLS,
			m->par.delta_min +
				peak[k].j * (m->par.delta_max - m->par.delta_min) / CELLS,
			peak[k].share };
	return n;
}

enum num_status masks_find(struct masks *m, const double *y1, const double *y2, size_t n,
	struct masks_source source[MASKS_SOURCES_MAX], int *sources)
{
	if (reserve(m, n))
		return NUM_MEMORY;
	stft_forward(m->stft, y1, n, m->y1);
	stft_forward(m->stft, y2, n, m->y2);
	fill_histogram(m);
	*sources = find_peaks(m, source);
	return NUM_OK;
}

/* Bin 0 and the bins above the band carry no delay: they go with bin 1 of their frame. */
void masks_separate(struct masks *m, int k, double *x)
{
	for (size_t p = 0; p < m->frames * m->bins; p++) {
		size_t bin = p % m->bins,
		       voter = bin < 1 || bin > m->top ? p - bin + 1 : p;
		int cell = m->cell[voter];

		m->part[p] = cell >= 0 && m->histogram.owner[cell] == k ? m->y1[p] : 0;
	}
	stft_inverse(m->stft, m->part, m->n, x);
}
