/* tape.c - see tape.h */
#include "signal/separate/tape.h"
#include "signal/filter/fir.h"
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

enum num_status tape_append(struct tape *t, const double *x, size_t n)
{
	if (t->n + n > t->capacity) {
		size_t capacity = 2 * t->capacity > t->n + n ? 2 * t->capacity : t->n + n;
		double *more = realloc(t->x, capacity * sizeof *more);
		unsigned char *flags;

		if (!more)
			return NUM_MEMORY;
		t->x = more;
		flags = realloc(t->hidden, capacity);
		if (!flags)
			return NUM_MEMORY;
		t->hidden = flags;
		t->capacity = capacity;
	}
	for (size_t i = 0; i < n; i++) {
		size_t lost = converter_next(&t->converter, x[2 * i]);

		t->x[t->n] = x[2 * i];
		t->hidden[t->n++] = 0;
		lost = lost < t->n ? lost : t->n; /* the others are no longer stored */
		memset(t->hidden + t->n - lost, 1, lost);
	}
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
		t->clean = t->begin;
}

void tape_forget(struct tape *t, long long keep)
{
	size_t old = keep > t->begin ? (size_t)(keep - t->begin) : 0;

	if (old < t->n / 2 || old < 4096)
		return;
	tape_drop(t, old > t->n ? t->n : old);
}

enum num_status tape_start(struct tape *t, const struct calibration *c)
{
	const struct whitening *w = &c->whitening;
	size_t taps = 2 * (size_t)w->half + 1;

	t->fed = t->white = t->clean;
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

/* Subtracts the tones and divides by the noise.  Tones are fitted around the middle of
 * every hop, over two hops, with linear interpolation between; they depend on the record
 * alone, not on the sizes of its pieces. */
static enum num_status clean(
	struct tape *t, const struct calibration *c, double noise, int ended)
{
	long long end = t->white, hop = (long long)c->tone_hop;

	if (c->tones == 0) {
		scale(t, t->clean, end, noise);
		t->clean = end;
		return NUM_OK;
	}
	for (;;) {
		long long middle =
			t->started ? (long long)t->at + hop : t->clean + hop / 2;
		long long from = middle - hop > t->clean ? middle - hop : t->clean,
			  until = middle;
		double after[2 * TONES_MAX + 1];
		enum tones_status status;

		if (t->clean == end || (middle + hop > end && !ended))
			return NUM_OK;
		if (middle + hop > end) { /* the last hop extends to the end */
			until = end;
			middle = end - hop / 2 > t->clean ? end - hop / 2 : end;
			from = t->clean;
		}
		status = tones_fit(t->x + (from - t->begin),
			(size_t)((middle + hop < end ? middle + hop : end) - from),
			(double)from, c->tones, c->omega, after, NULL, NULL);
		if (status == TONES_MEMORY)
			return NUM_MEMORY;
		if (status == TONES_SHORT) /* the rest is too short to fit */
			memcpy(after, t->coefficient, sizeof after);
		if (!t->started)
			memcpy(t->coefficient, after, sizeof after);
		tones_remove(t->x + (t->clean - t->begin), (size_t)(until - t->clean),
			(double)t->clean, c->tones, c->omega, t->at, t->coefficient,
			(double)middle, after);
		scale(t, t->clean, until, noise);
		memcpy(t->coefficient, after, sizeof after);
		t->at = (double)middle;
		t->started = 1;
		t->clean = until;
	}
}

/* Undoes the filter in whole blocks, so that the results do not depend on the sizes of
 * the pieces; output lags behind input. */
static void whiten(struct tape *t, const struct whitening *w, double mean, int ended)
{
	long long end = t->begin + (long long)t->n, last = end - w->edge, block;

	if (!t->whiten) {
		t->white = end;
		return;
	}
	block = (long long)fir_block(t->whiten);
	while (ended ? t->white < last : t->fed + block <= end) {
		for (long long i = 0; i < block; i++)
			t->piece[i] =
				t->fed + i < end ? t->x[t->fed + i - t->begin] - mean : 0;
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

enum num_status tape_prepare(
	struct tape *t, const struct calibration *c, int channel, int ended)
{
	whiten(t, &c->whitening, c->mean[channel], ended);
	return clean(t, c, c->noise[channel], ended);
}
