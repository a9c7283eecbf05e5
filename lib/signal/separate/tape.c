/* tape.c - see tape.h */
#include "signal/separate/tape.h"
#include "signal/filter/fir.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void tape_clear(struct tape *t)
{
	free(t->x);
	free(t->hidden);
	free(t->piece);
	fir_free(t->whiten);
	memset(t, 0, sizeof *t);
}

static enum num_status reserve(struct tape *t, size_t n)
{
	size_t capacity = 2 * t->capacity > t->n + n ? 2 * t->capacity : t->n + n;
	double *more;
	unsigned char *flags;

	if (t->n + n <= t->capacity)
		return NUM_OK;
	more = realloc(t->x, capacity * sizeof *more);
	if (!more)
		return NUM_MEMORY;
	t->x = more;
	flags = realloc(t->hidden, capacity);
	if (!flags)
		return NUM_MEMORY;
	t->hidden = flags;
	t->capacity = capacity;
	return NUM_OK;
}

static void put(struct tape *t, double x, int hidden)
{
	t->x[t->n] = x;
	t->hidden[t->n++] = (unsigned char)hidden;
}

/* Adds a sample to the mean; lost: so many of the last ones are not measured. */
static void put_part(struct tape *t, double x, size_t lost)
{
	t->sum += x;
	t->lost |= lost > 0;
	t->parts++;
	if (lost > t->parts) { /* in means before this one */
		size_t means = (lost - t->parts - 1) / t->ratio + 1;

		means = means < t->n ? means : t->n;
		memset(t->hidden + t->n - means, 1, means);
	}
	if (t->parts < t->ratio)
		return;
	put(t, t->sum / (double)t->ratio, t->lost);
	t->parts = 0;
	t->sum = t->lost = 0;
}

enum num_status tape_append(struct tape *t, const double *x, size_t n, size_t stride)
{
	if (reserve(t, t->ratio ? n / t->ratio + 1 : n) != NUM_OK)
		return NUM_MEMORY;
	for (; n > 0; n--, x += stride) {
		size_t lost = converter_next(&t->converter, *x);

		if (t->ratio) {
			put_part(t, *x, lost);
			continue;
		}
		put(t, *x, 0);
		lost = lost < t->n ? lost : t->n; /* the others are no longer stored */
		memset(t->hidden + t->n - lost, 1, lost);
	}
	return NUM_OK;
}

enum num_status tape_average(
	const struct tape *t, size_t n, size_t ratio, struct tape *mean)
{
	size_t skip = (ratio - (size_t)t->begin % ratio) % ratio;

	memset(mean, 0, sizeof *mean);
	mean->ratio = ratio;
	mean->converter = t->converter;
	mean->begin = (t->begin + (long long)skip) / (long long)ratio;
	mean->flat = mean->clean = mean->begin;
	if (reserve(mean, n / ratio + 1) != NUM_OK)
		return NUM_MEMORY;
	for (size_t i = skip; i < n; i++)
		put_part(mean, t->x[i], t->hidden[i]);
	return NUM_OK;
}

void tape_review(struct tape *t)
{
	for (size_t i = 0; i < t->n; i++)
		t->hidden[i] |=
			(unsigned char)converter_saturates(&t->converter, t->x[i]);
}

void tape_drop(struct tape *t, size_t n)
{
	if (n == 0)
		return;
	memmove(t->x, t->x + n, (t->n - n) * sizeof *t->x);
	memmove(t->hidden, t->hidden + n, t->n - n);
	t->n -= n;
	t->begin += (long long)n;
	if (t->clean < t->begin)
		t->flat = t->clean = t->begin;
}

void tape_forget(struct tape *t, long long keep)
{
	size_t old = keep > t->begin ? (size_t)(keep - t->begin) : 0;

	if (old < t->n / 2 || old < 4096)
		return;
	tape_drop(t, old > t->n ? t->n : old);
}

enum num_status tape_start(
	struct tape *t, const struct calibration *c, double mean, double scale)
{
	const struct whitening *w = &c->whitening;
	size_t taps = 2 * (size_t)w->half + 1;

	t->mean = mean;
	t->scale = scale;
	t->fed = t->white = t->flat = t->clean;
	tones_track_start(&t->tones, c->tones, c->omega, t->flat, c->tone_hop);
	if (!w->tap)
		return NUM_OK;
	t->whiten = fir_new(w->tap, taps, 1, taps > 1024 ? taps : 1024);
	t->piece = t->whiten ? malloc(fir_block(t->whiten) * sizeof *t->piece) : NULL;
	return t->piece ? NUM_OK : NUM_MEMORY;
}

static void scale(struct tape *t, long long from, long long to, double noise)
{
	for (long long i = from - t->begin; i < to - t->begin; i++)
		t->x[i] /= noise;
}

/* Subtracts the tones and divides by the noise. */
static enum num_status clean(struct tape *t, const struct calibration *c, int ended)
{
	long long from = t->flat;

	t->flat = t->white;
	if (c->tones > 0) {
		if (tones_track_run(&t->tones, t->x, t->begin, t->white, ended) !=
			TONES_OK)
			return NUM_MEMORY;
		t->flat = t->tones.flat;
	}
	scale(t, from, t->flat, t->scale);
	return NUM_OK;
}

/* Undoes the filter in whole blocks, so that the results do not depend on the sizes of
 * the pieces; output lags behind input. */
static void whiten(struct tape *t, const struct whitening *w, int ended)
{
	long long end = t->begin + (long long)t->n, last = end - w->edge, block;

	if (!t->whiten) {
		t->white = end;
		return;
	}
	block = (long long)fir_block(t->whiten);
	while (ended ? t->white < last : t->fed + block <= end) {
		for (long long i = 0; i < block; i++)
			t->piece[i] = t->fed + i < end
					      ? t->x[t->fed + i - t->begin] - t->mean
					      : 0;
		fir_run(t->whiten, t->piece, (size_t)block);
		for (long long i = 0; i < block; i++) {
			long long at = t->fed + i - w->half;

			if (at >= t->white && at < last)
				t->x[at - t->begin] = t->piece[i];
		}
		t->fed += block;
		if (t->fed - w->half > t->white)
			t->white = t->fed - w->half < last ? t->fed - w->half : last;
	}
}

void tape_follow(struct tape *t, long long begin, size_t block, double reference,
	long long learned)
{
	t->block = block;
	t->clean = block > 0 ? begin : t->clean;
	t->learned = learned;
	t->noise.reference = reference;
}

static double measure(const struct tape *t, long long k)
{
	size_t at = (size_t)(t->clean - t->begin) + (size_t)k * t->block;

	return following_measure(t->x + at, t->hidden + at, t->block);
}

/* The fourth difference tells the noise in the band of the pulses if the noise is white:
 * its measure where the noise was learned is then 1, but for what the noise changed
 * between those samples and others that it was learned from. */
static const double WHITE = 0.2;

/* Starts to follow the noise once there are samples to compare with; 0: not yet. */
static int start_following(struct tape *t, int ended)
{
	long long end = t->flat < t->learned ? t->flat : t->learned, blocks;
	double reference = t->noise.reference, sum = 0;

	if (t->flat < t->learned && !ended)
		return 0;
	if (t->flat - t->clean < 2 * (long long)t->block) {
		t->block = ended ? 0 : t->block;
		return 0;
	}
	blocks = (end - t->clean) / (long long)t->block;
	for (long long k = 0; reference == 0 && k < blocks; k++)
		sum += measure(t, k);
	if (reference == 0)
		reference = sum / (double)blocks;
	if (!(fabs(log(reference)) < WHITE))
		t->block = 0;
	else
		following_start(&t->noise, t->clean, t->block, reference, measure(t, 0),
			measure(t, 1));
	return t->block > 0;
}

/* Divides by what the noise has become; in whole blocks, so that it depends on the record
 * alone. */
static void follow(struct tape *t, int ended)
{
	if (t->block > 0 && t->noise.block == 0 && !start_following(t, ended) &&
		t->block > 0)
		return;
	while (t->block > 0 && t->clean + (long long)t->block <= t->flat) {
		size_t at = (size_t)(t->clean - t->begin);

		following_take(&t->noise, t->x + at, t->hidden + at);
		t->clean += (long long)t->block;
	}
	if (t->block > 0 && !ended)
		return;
	scale(t, t->clean, t->flat, following_at(&t->noise, (double)t->clean));
	t->clean = t->flat;
}

enum num_status tape_prepare(struct tape *t, const struct calibration *c, int ended)
{
	whiten(t, &c->whitening, ended);
	if (clean(t, c, ended) != NUM_OK)
		return NUM_MEMORY;
	follow(t, ended);
	return NUM_OK;
}
