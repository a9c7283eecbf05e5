/* buffer.c - see buffer.h */
#include "signal/separate/buffer.h"
#include "num/room.h"
#include "signal/filter/fir.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

void buffer_clear(struct buffer *b)
{
	free(b->x);
	free(b->hidden);
	free(b->piece);
	fir_free(b->whiten);
	memset(b, 0, sizeof *b);
}

static enum num_status reserve(struct buffer *b, size_t n)
{
	return room_for(&b->x, &b->room, b->n + n, sizeof *b->x) ||
			       room_for(&b->hidden, &b->flags, b->n + n, 1)
		       ? NUM_MEMORY
		       : NUM_OK;
}

void buffer_hide(struct buffer *b, size_t i)
{
	b->missing += !b->hidden[i];
	b->hidden[i] = 1;
}

/* Hides the last samples, as far as they are still stored. */
static void hide_last(struct buffer *b, size_t lost)
{
	for (size_t i = lost < b->n ? b->n - lost : 0; i < b->n; i++)
		buffer_hide(b, i);
}

static size_t ratio_of(const struct buffer *b)
{
	return b->ratio ? b->ratio : 1;
}

/* Adds a sample to the mean; lost: so many of the last ones are not measured. */
static void put(struct buffer *b, double x, size_t lost)
{
	const size_t ratio = ratio_of(b);

	b->sum += x;
	b->lost |= lost > 0;
	b->parts++;
	if (lost > b->parts) /* in means before this one */
		hide_last(b, (lost - b->parts - 1) / ratio + 1);
	if (b->parts < ratio)
		return;
	b->x[b->n] = b->sum / (double)ratio;
	b->hidden[b->n++] = 0;
	hide_last(b, (size_t)b->lost);
	b->parts = 0;
	b->sum = b->lost = 0;
}

enum num_status buffer_append(
	struct buffer *b, const double *x, const size_t *lost, size_t n)
{
	if (reserve(b, (b->parts + n) / ratio_of(b)) != NUM_OK)
		return NUM_MEMORY;
	for (size_t i = 0; i < n; i++)
		put(b, x[i], lost[i]);
	return NUM_OK;
}

enum num_status buffer_average(
	const struct buffer *b, size_t n, size_t ratio, struct buffer *mean)
{
	size_t skip = (ratio - (size_t)b->begin % ratio) % ratio;

	memset(mean, 0, sizeof *mean);
	mean->ratio = ratio;
	mean->begin = (b->begin + (long long)skip) / (long long)ratio;
	mean->flat = mean->clean = mean->begin;
	if (reserve(mean, n / ratio + 1) != NUM_OK)
		return NUM_MEMORY;
	for (size_t i = skip; i < n; i++)
		put(mean, b->x[i], b->hidden[i]);
	return NUM_OK;
}

void buffer_discard(struct buffer *b, size_t n)
{
	if (n == 0)
		return;
	memmove(b->x, b->x + n, (b->n - n) * sizeof *b->x);
	memmove(b->hidden, b->hidden + n, b->n - n);
	b->n -= n;
	b->begin += (long long)n;
	if (b->clean < b->begin)
		b->flat = b->clean = b->begin;
}

void buffer_forget(struct buffer *b, long long keep)
{
	size_t old = keep > b->begin ? (size_t)(keep - b->begin) : 0;

	if (old < b->n / 2 || old < 4096)
		return;
	buffer_discard(b, old > b->n ? b->n : old);
}

enum num_status buffer_start(
	struct buffer *b, const struct calibration *c, double mean, double scale)
{
	const struct whitening *w = &c->whitening;
	size_t taps = 2 * (size_t)w->half + 1;

	b->mean = mean;
	b->scale = scale;
	b->fed = b->white = b->flat = b->clean;
	b->hold = w->tap && whitening_removes_mean(w);
	tones_track_start(&b->tones, c->tones, c->omega, b->flat, c->tone_hop);
	if (!w->tap)
		return NUM_OK;
	b->whiten = fir_new(w->tap, taps, 1, taps > 1024 ? taps : 1024);
	b->piece = b->whiten ? malloc(fir_block(b->whiten) * sizeof *b->piece) : NULL;
	return b->piece ? NUM_OK : NUM_MEMORY;
}

static void scale(struct buffer *b, long long from, long long to, double noise)
{
	for (long long i = from - b->begin; i < to - b->begin; i++)
		b->x[i] /= noise;
}

/* Subtracts the tones and divides by the noise. */
static enum num_status clean(struct buffer *b, const struct calibration *c, int ended)
{
	long long from = b->flat;

	b->flat = b->white;
	if (c->tones > 0) {
		if (tones_track_run(&b->tones, b->x, b->begin, b->white, ended) != NUM_OK)
			return NUM_MEMORY;
		b->flat = b->tones.flat;
	}
	scale(b, from, b->flat, b->scale);
	return NUM_OK;
}

/* Undoes the filter in whole blocks, so that the results do not depend on the sizes of
 * the pieces; output lags behind input. */
static void whiten(struct buffer *b, const struct whitening *w, int ended)
{
	long long end = b->begin + (long long)b->n, last = end - w->edge, block;
	const double tail = b->hold && b->n > 0 ? b->x[b->n - 1] : 0;

	if (!b->whiten) {
		b->white = end;
		return;
	}
	block = (long long)fir_block(b->whiten);
	while (ended ? b->white < last : b->fed + block <= end) {
		if (b->hold && b->fed == b->white) /* the first block */
			b->mean = b->x[b->fed - b->begin];
		for (long long i = 0; i < block; i++)
			b->piece[i] = b->fed + i < end
					      ? b->x[b->fed + i - b->begin] - b->mean
				      : b->hold ? tail - b->mean
						: 0;
		fir_run(b->whiten, b->piece, (size_t)block);
		for (long long i = 0; i < block; i++) {
			long long at = b->fed + i - w->half;

			if (at >= b->white && at < last)
				b->x[at - b->begin] = b->piece[i];
		}
		b->fed += block;
		if (b->fed - w->half > b->white)
			b->white = b->fed - w->half < last ? b->fed - w->half : last;
	}
}

void buffer_follow(struct buffer *b, long long begin, size_t block, double reference,
	long long learned)
{
	b->block = block;
	b->clean = block > 0 ? begin : b->clean;
	b->learned = learned;
	b->noise.reference = reference;
}

static double measure(const struct buffer *b, long long k)
{
	size_t at = (size_t)(b->clean - b->begin) + (size_t)k * b->block;

	return following_measure(b->x + at, b->hidden + at, b->block);
}

/* The fourth difference tells the noise in the band of the pulses if the noise is white:
 * its measure where the noise was learned is then 1, but for what the noise changed
 * between those samples and others that it was learned from. */
static const double WHITE = 0.2;

/* Starts to follow the noise once there are samples to compare with; 0: not yet. */
static int start_following(struct buffer *b, int ended)
{
	long long end = b->flat < b->learned ? b->flat : b->learned, blocks;
	double reference = b->noise.reference, sum = 0;

	if (b->flat < b->learned && !ended)
		return 0;
	if (b->flat - b->clean < 2 * (long long)b->block) {
		b->block = ended ? 0 : b->block;
		return 0;
	}
	blocks = (end - b->clean) / (long long)b->block;
	for (long long k = 0; reference == 0 && k < blocks; k++)
		sum += measure(b, k);
	if (reference == 0)
		reference = sum / (double)blocks;
	if (!(fabs(log(reference)) < WHITE))
		b->block = 0;
	else
		following_start(&b->noise, b->clean, b->block, reference, measure(b, 0),
			measure(b, 1));
	return b->block > 0;
}

/* Divides by what the noise has become; in whole blocks, so that it depends on the record
 * alone. */
static void follow(struct buffer *b, int ended)
{
	if (b->block > 0 && b->noise.block == 0 && !start_following(b, ended) &&
		b->block > 0)
		return;
	while (b->block > 0 && b->clean + (long long)b->block <= b->flat) {
		size_t at = (size_t)(b->clean - b->begin);

		following_take(&b->noise, b->x + at, b->hidden + at);
		b->clean += (long long)b->block;
	}
	if (b->block > 0 && !ended)
		return;
	scale(b, b->clean, b->flat, following_at(&b->noise, (double)b->clean));
	b->clean = b->flat;
}

enum num_status buffer_prepare(struct buffer *b, const struct calibration *c, int ended)
{
	whiten(b, &c->whitening, ended);
	if (clean(b, c, ended) != NUM_OK)
		return NUM_MEMORY;
	follow(b, ended);
	return NUM_OK;
}
