/* mixture.c - sources of a whole record, told apart by attenuation and delay */
#include "signal/mixture/mixture.h"
#include "num/fft.h"
#include "num/room.h"
#include <complex.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Passes of a fit to the points of each source, and of a closer look at them. */
enum { CELLS = HISTOGRAM_CELLS, ROUNDS = 5, CLOSER = ROUNDS + 1 };

/* Range of the histogram: a - 1/a from -ODDS to ODDS; delays from -reach to reach
 * samples, the first of these that leaves little beyond it.  Of 72 mixtures of one to
 * three voices with delays up to 15 samples, and of 72 with one of 19 to 60, BEYOND of
 * 0.1 and 0.2 doubts 4 and 2 of the former and misses 2 and 9 of the latter.  PLAIN of 4,
 * with 0.2, doubts 33 and misses 2: voices have little at frequencies so low. */
static const double ODDS = 2.5, REACH[] = { 4, 16 }, BEYOND = 0.1, PLAIN = 2;
enum { REACHES = sizeof REACH / sizeof *REACH };
/* Lower peaks are noise, unless the number of sources is given. */
static const double PEAK_SHARE = 0.1;

struct mixture {
	struct mixture_par par;
	struct fft *fft;
	size_t bins, n, room;
	long passed;                         /* windows transformed */
	double *x;                           /* frames of two */
	struct histogram histogram, *closer; /* closer: one for each source */
	double reach, lost;                  /* share of the weight beyond it */
	int count;
	struct mixture_source source[MIXTURE_SOURCES];
	double complex *path;           /* a exp(-i w delta) of each source and bin */
	double *shape, *frame;          /* of the window; one channel in it */
	double complex *y1, *y2, *part; /* the window of either channel; of a source */
};

struct mixture *mixture_new(const struct mixture_par *par)
{
	struct mixture *m;
	size_t w = par->window;

	if (w < 4 || w % 2 || par->hop < 1 || par->hop > w / 2 || par->sources < 0 ||
		par->sources > MIXTURE_SOURCES) {
		errno = EDOM;
		return NULL;
	}
	m = calloc(1, sizeof *m);
	if (!m)
		return NULL;
	m->par = *par;
	m->bins = w / 2 + 1;
	m->fft = fft_new(w, 1);
	m->path = calloc(MIXTURE_SOURCES * m->bins, sizeof *m->path);
	m->shape = fft_alloc(w);
	m->frame = fft_alloc(w);
	m->y1 = fft_alloc_complex(m->bins);
	m->y2 = fft_alloc_complex(m->bins);
	m->part = fft_alloc_complex(m->bins);
	m->closer = calloc(MIXTURE_SOURCES, sizeof *m->closer);
	if (!m->closer || !m->fft || !m->path || !m->shape || !m->frame || !m->y1 ||
		!m->y2 || !m->part) {
		mixture_free(m);
		return NULL;
	}
	for (size_t i = 0; i < w; i++)
		m->shape[i] = 0.54 - 0.46 * cos(2 * M_PI * ((double)i + 0.5) / (double)w);
	return m;
}

void mixture_free(struct mixture *m)
{
	if (!m)
		return;
	fft_done(m->fft);
	free(m->x);
	free(m->path);
	free(m->closer);
	fft_free(m->shape);
	fft_free(m->frame);
	fft_free(m->y1);
	fft_free(m->y2);
	fft_free(m->part);
	free(m);
}

enum num_status mixture_push(struct mixture *m, const double *x, size_t n)
{
	if (room_for(&m->x, &m->room, 2 * (m->n + n), sizeof *m->x))
		return NUM_MEMORY;
	memcpy(m->x + 2 * m->n, x, 2 * n * sizeof *x);
	m->n += n;
	return NUM_OK;
}

size_t mixture_frames(const struct mixture *m)
{
	return m->n;
}

/* Windows reach over both ends of the record, so that every sample lies in as many. */
static size_t windows(const struct mixture *m)
{
	return (m->n + m->par.window - 1) / m->par.hop + 1;
}

/* The transform of window f of both channels; returns its first sample. */
static long transform(struct mixture *m, size_t f)
{
	size_t w = m->par.window;
	long first = (long)(f * m->par.hop) - (long)(w - 1);

	/* Once in every pass, and for the separation. */
	if (m->par.progress)
		m->par.progress(
			m->passed, (REACHES + CLOSER + ROUNDS + 1) * (long)windows(m));
	m->passed++;

	for (int c = 0; c < 2; c++) {
		for (size_t i = 0; i < w; i++) {
			long at = first + (long)i;

			m->frame[i] = at >= 0 && at < (long)m->n
					      ? m->shape[i] * m->x[2 * at + c]
					      : 0;
		}
		fft_forward(m->fft, m->frame, c ? m->y2 : m->y1);
	}
	return first;
}

static double frequency(const struct mixture *m, size_t bin)
{
	return 2 * M_PI * (double)bin / (double)m->par.window;
}

/* a from a - 1/a. */
static double attenuation(double odds)
{
	return odds / 2 + sqrt(odds * odds / 4 + 1);
}

void mixture_cell(const struct mixture *m, int i, int j, double *a, double *delta)
{
	*a = attenuation(ODDS * (2 * (i + 0.5) / CELLS - 1));
	*delta = m->reach * (2 * (j + 0.5) / CELLS - 1);
}

int mixture_is_far(const struct mixture *m)
{
	return m->lost > BEYOND;
}

const double *mixture_histogram(const struct mixture *m)
{
	return m->histogram.weight;
}

/* Adds a point of two amplitudes, the second one later by delta. */
static void count_point(
	struct histogram *h, double p1, double p2, double delta, double reach)
{
	double i = ((p2 / p1 - p1 / p2) / ODDS + 1) * CELLS / 2;
	double j = (delta / reach + 1) * CELLS / 2;

	if (i >= 0 && i < CELLS && j >= 0 && j < CELLS)
		h->weight[(int)i * CELLS + (int)j] += p1 * p2;
}

/* Counts the present window; returns, of the frequencies at which even delays of PLAIN
 * times the reach are plain, the weight in all and beyond the reach. */
static void count_window(struct mixture *m, double *all, double *beyond)
{
	for (size_t k = 1; k < m->bins && frequency(m, k) * m->reach < M_PI; k++) {
		double p1 = cabs(m->y1[k]), p2 = cabs(m->y2[k]), delta;
		int plain = frequency(m, k) * PLAIN * m->reach < M_PI;

		if (p1 * p2 == 0)
			continue;
		delta = -carg(m->y2[k] / m->y1[k]) / frequency(m, k);
		count_point(&m->histogram, p1, p2, delta, m->reach);
		*all += plain ? p1 * p2 : 0;
		*beyond += plain && fabs(delta) > m->reach ? p1 * p2 : 0;
	}
}

static void count_all(struct mixture *m)
{
	for (int r = 0; r < REACHES; r++) {
		double all = 0, beyond = 0;

		m->reach = REACH[r];
		memset(m->histogram.weight, 0, sizeof m->histogram.weight);
		for (size_t f = 0; f < windows(m); f++) {
			transform(m, f);
			count_window(m, &all, &beyond);
		}
		m->lost = all > 0 ? beyond / all : 0;
		if (m->lost <= BEYOND) {
			m->passed += (REACHES - 1 - r) * (long)windows(m);
			return;
		}
	}
}

static void make_paths(struct mixture *m)
{
	for (int k = 0; k < m->count; k++)
		for (size_t b = 0; b < m->bins; b++)
			m->path[(size_t)k * m->bins + b] =
				m->source[k].attenuation *
				cexp(-I * frequency(m, b) * m->source[k].delta);
}

/* The source that makes this point of the present window most likely. */
static int likeliest(const struct mixture *m, size_t bin)
{
	double least = INFINITY;
	int best = 0;

	for (int k = 0; k < m->count; k++) {
		double a = m->source[k].attenuation;
		double complex e =
			m->path[(size_t)k * m->bins + bin] * m->y1[bin] - m->y2[bin];
		double cost = (creal(e) * creal(e) + cimag(e) * cimag(e)) / (1 + a * a);

		if (cost < least) {
			least = cost;
			best = k;
		}
	}
	return best;
}

/* Least squares for one source over the points that are its own: powers of both channels,
 * what they have in common, and how much later the second one is. */
struct sums {
	double first, second, both, late, weight;
};

static void refine(struct mixture *m)
{
	struct sums sum[MIXTURE_SOURCES] = { { 0 } };

	make_paths(m);
	for (size_t f = 0; f < windows(m); f++) {
		transform(m, f);
		for (size_t b = 1; b < m->bins; b++) {
			int k = likeliest(m, b);
			double complex path = m->path[(size_t)k * m->bins + b];
			double complex z =
				m->y2[b] * conj(m->y1[b]) * conj(path / cabs(path));
			double w = frequency(m, b);

			sum[k].first += creal(m->y1[b] * conj(m->y1[b]));
			sum[k].second += creal(m->y2[b] * conj(m->y2[b]));
			sum[k].both += creal(z);
			sum[k].late -= w * cimag(z);
			sum[k].weight += w * w * creal(z);
		}
	}
	for (int k = 0; k < m->count; k++) {
		if (!(sum[k].both > 0) || !(sum[k].weight > 0))
			continue;
		m->source[k].attenuation =
			attenuation((sum[k].second - sum[k].first) / sum[k].both);
		m->source[k].delta += sum[k].late / sum[k].weight;
	}
}

static struct mixture_source source_of(
	const struct histogram_peak *peak, double delta, double reach, double share)
{
	return (struct mixture_source){ attenuation(ODDS * (2 * peak->i / CELLS - 1)),
		delta + reach * (2 * peak->j / CELLS - 1), share * peak->share };
}

/* Counts the points of each source by their delay from its own, over the frequencies
 * that the shortest reach adds: lower ones tell delays less well. */
static void count_closer(struct mixture *m)
{
	memset(m->closer, 0, (size_t)m->count * sizeof *m->closer);
	make_paths(m);
	for (size_t f = 0; f < windows(m); f++) {
		transform(m, f);
		for (size_t b = 1; b < m->bins && frequency(m, b) * *REACH < M_PI; b++) {
			int k = likeliest(m, b);
			double complex path = m->path[(size_t)k * m->bins + b];
			double p1 = cabs(m->y1[b]), p2 = cabs(m->y2[b]);

			if (p1 * p2 > 0 && frequency(m, b) * m->reach >= M_PI)
				count_point(&m->closer[k], p1, p2,
					-carg(m->y2[b] / (m->y1[b] * path)) /
						frequency(m, b),
					*REACH);
		}
	}
}

/* Whether a delay is nearer to another source than to k. */
static int is_of_another(const struct mixture *m, int k, double delta)
{
	for (int other = 0; other < m->count; other++)
		if (fabs(delta - m->source[other].delta) <
			fabs(delta - m->source[k].delta))
			return 1;
	return 0;
}

static int by_share(const void *a, const void *b)
{
	const struct mixture_source *s = a, *t = b;

	return (s->share < t->share) - (s->share > t->share);
}

/* Divides what one peak of a long reach, of low frequencies alone, holds together.  Of 60
 * mixtures of one to three voices with delays up to 15 samples, half of them with two
 * voices 1.8 to 3.3 samples apart, 56 have all voices, and 48 without a closer look. */
static void look_closer(struct mixture *m)
{
	struct mixture_source found[MIXTURE_SOURCES * HISTOGRAM_PEAKS] = { { 0 } };
	struct histogram_peak peak[HISTOGRAM_PEAKS];
	int given = m->par.sources, count = 0;

	for (int i = 0; i < ROUNDS; i++)
		refine(m);
	count_closer(m);
	for (int k = 0; k < m->count; k++) {
		int n = histogram_peaks(&m->closer[k], HISTOGRAM_PEAKS, PEAK_SHARE, peak);

		if (n == 0) /* of low frequencies alone */
			found[count++] = m->source[k];
		for (int i = 0; i < n; i++) {
			found[count] = source_of(
				&peak[i], m->source[k].delta, *REACH, m->source[k].share);
			count += !is_of_another(m, k, found[count].delta);
		}
	}
	qsort(found, (size_t)count, sizeof *found, by_share);
	while (!given && count > 1 && found[count - 1].share < PEAK_SHARE * found->share)
		count--;
	m->count = count < MIXTURE_SOURCES ? count : MIXTURE_SOURCES;
	m->count = given && given < m->count ? given : m->count;
	memcpy(m->source, found, (size_t)m->count * sizeof *found);
}

int mixture_find(struct mixture *m, struct mixture_source source[MIXTURE_SOURCES])
{
	struct histogram_peak peak[HISTOGRAM_PEAKS];
	int given = m->par.sources;

	count_all(m);
	m->count = histogram_peaks(&m->histogram, given ? given : MIXTURE_SOURCES,
		given ? 0 : PEAK_SHARE, peak);
	for (int k = 0; k < m->count; k++)
		m->source[k] = source_of(&peak[k], 0, m->reach, 1);
	if (m->reach > *REACH)
		look_closer(m);
	else
		m->passed += CLOSER * (long)windows(m);
	for (int i = 0; i < ROUNDS; i++)
		refine(m);
	make_paths(m);
	memcpy(source, m->source, sizeof m->source);
	return m->count;
}

/* Adds the present window of source k, which begins at first, to x. */
static void add_window(struct mixture *m, int k, long first, const int *owner, double *x)
{
	size_t w = m->par.window;

	for (size_t b = 0; b < m->bins; b++)
		m->part[b] = owner[b] == k ? m->y1[b] : 0;
	fft_inverse(m->fft, m->part, m->frame);
	for (size_t i = 0; i < w; i++) {
		long at = first + (long)i;

		if (at >= 0 && at < (long)m->n)
			x[at] += m->shape[i] * m->frame[i] / (double)w;
	}
}

/* Sum of the squares of all windows over sample at, which both transforms have put on it.
 */
static double cover(const struct mixture *m, size_t at)
{
	size_t w = m->par.window, hop = m->par.hop;
	/* window f lies on samples f hop - (w - 1) to f hop */
	size_t f = (at + hop - 1) / hop;
	double sum = 0;

	for (; f * hop <= at + w - 1; f++) {
		size_t i = at + w - 1 - f * hop;

		sum += m->shape[i] * m->shape[i];
	}
	return sum;
}

enum num_status mixture_separate(struct mixture *m, double *x)
{
	int *owner = calloc(m->bins, sizeof *owner);

	if (!owner)
		return NUM_MEMORY;
	memset(x, 0, (size_t)m->count * m->n * sizeof *x);
	for (size_t f = 0; f < windows(m); f++) {
		long first = transform(m, f);

		for (size_t b = 0; b < m->bins; b++)
			owner[b] = likeliest(m, b);
		for (int k = 0; k < m->count; k++)
			add_window(m, k, first, owner, x + (size_t)k * m->n);
	}
	for (size_t i = 0; i < m->n; i++) {
		double all = cover(m, i);

		for (int k = 0; k < m->count; k++)
			x[(size_t)k * m->n + i] /= all;
	}
	free(owner);
	return NUM_OK;
}
