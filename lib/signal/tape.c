/* tape.c - see tape.h */
#include "signal/tape.h"
#include "signal/fir.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Beside those of gaps.h: near a gap, once filtered. */
enum { SMEARED = 4 };

void tape_clear(struct tape *t)
{
	free(t->x);
	free(t->bad);
	free(t->piece);
	fir_free(t->whiten);
	memset(t, 0, sizeof *t);
}

int tape_append(struct tape *t, const double *x, size_t stride, size_t n)
{
	if (t->n + n > t->capacity) {
		size_t capacity = 2 * t->capacity > t->n + n ? 2 * t->capacity : t->n + n;
		double *more = realloc(t->x, capacity * sizeof *more);
		unsigned char *bad = more ? realloc(t->bad, capacity) : NULL;

		if (more)
			t->x = more;
		if (!bad)
			return 0;
		t->bad = bad;
		t->capacity = capacity;
	}
	for (size_t i = 0; i < n; i++)
		t->x[t->n + i] = x[stride * i];
	memset(t->bad + t->n, 0, n);
	t->n += n;
	return 1;
}

void tape_drop(struct tape *t, size_t n)
{
	memmove(t->x, t->x + n, (t->n - n) * sizeof *t->x);
	memmove(t->bad, t->bad + n, t->n - n);
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

int tape_start(struct tape *t, const struct calibration *c, int channel)
{
	const struct whitening *w = &c->whitening[channel];
	size_t taps = 2 * (size_t)w->half + 1;

	t->fed = t->white = t->clean;
	if (!w->tap)
		return 1;
	t->whiten = fir_new(w->tap, taps, 1, taps > 1024 ? taps : 1024);
	t->piece = t->whiten ? malloc(fir_block(t->whiten) * sizeof *t->piece) : NULL;
	return t->piece != NULL;
}

static void scale(struct tape *t, long long from, long long to, double noise)
{
	for (long long i = from - t->begin; i < to - t->begin; i++)
		t->x[i] = t->bad[i] ? 0 : t->x[i] / noise;
}

/* Looks for gaps in what has come in but is not yet filtered. */
static void mark(struct tape *t, const struct gaps *g)
{
	size_t from = t->marked > t->begin ? (size_t)(t->marked - t->begin) : 0;

	if (from < t->n)
		t->clipped += (double)gaps_mark(g, t->x, from, t->n, t->bad);
	t->marked = t->begin + (long long)t->n;
}

/* A gap spoils as much on either side as the filter reaches. */
static void smear(struct tape *t, long long from, long long to, int edge)
{
	long long last = -1;

	for (int pass = 0; pass < 2; pass++) {
		long long i = pass ? to - 1 : from, end = pass ? from - 1 : to;

		last = -1;
		for (; i != end; i += pass ? -1 : 1) {
			unsigned char *bad = &t->bad[i - t->begin];

			if (*bad & (GAPS_HELD | GAPS_CLIPPED))
				last = i;
			else if (last >= 0 && llabs(i - last) <= edge)
				*bad |= SMEARED;
		}
	}
}

/* Takes tones from what has come in and divides by the noise.  Tones are fitted around
 * the middle of every hop, over two hops, and run linearly in between; they depend on
 * the record alone, not on how it came in. */
static int clean(struct tape *t, const struct calibration *c, double noise, int ended)
{
	long long end = t->white, hop = (long long)c->tone_hop;

	if (c->tones == 0) {
		scale(t, t->clean, end, noise);
		t->clean = end;
		return 1;
	}
	for (;;) {
		long long middle =
			t->started ? (long long)t->at + hop : t->clean + hop / 2;
		long long from = middle - hop > t->clean ? middle - hop : t->clean,
			  until = middle;
		double after[2 * TONES_MAX + 1];

		if (t->clean == end || (middle + hop > end && !ended))
			return 1;
		if (middle + hop > end) { /* the last one reaches to the end */
			until = end;
			middle = end - hop / 2 > t->clean ? end - hop / 2 : end;
			from = t->clean;
		}
		if (!tones_fit(t->x + (from - t->begin),
			    (size_t)((middle + hop < end ? middle + hop : end) - from),
			    (double)from, c->tones, c->omega, after, NULL, NULL)) {
			if (!t->started)
				return 0;
			memcpy(after, t->coefficient, sizeof after); /* a short rest */
		}
		if (!t->started)
			memcpy(t->coefficient, after, sizeof after);
		for (int k = 1; t->started && k <= 2 * c->tones; k++, t->count++)
			t->squares += pow(after[k] - t->coefficient[k], 2);
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

/* Undoes the filter in whole blocks, so that the bits do not depend on how the record
 * came in; what is written lags behind what is read. */
static void whiten(struct tape *t, const struct calibration *c, int channel, int ended)
{
	const struct whitening *w = &c->whitening[channel];
	long long end = t->begin + (long long)t->n, last, block;

	/* What comes next may show that the last samples are held. */
	if (!ended)
		end -= (long long)c->gaps[channel].run;
	last = end - w->edge;
	if (!t->whiten) {
		for (; t->white < end; t->white++)
			t->x[t->white - t->begin] -= c->mean[channel];
		return;
	}
	smear(t, t->smeared > t->begin ? t->smeared : t->begin, end, w->edge);
	t->smeared = end - w->edge > t->begin ? end - w->edge : t->begin;
	block = (long long)fir_block(t->whiten);
	while (ended ? t->white < last : t->fed + block <= end) {
		for (long long i = 0; i < block; i++)
			t->piece[i] = t->fed + i < end ? t->x[t->fed + i - t->begin] -
								 c->mean[channel]
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

int tape_prepare(struct tape *t, const struct calibration *c, int channel, int ended)
{
	mark(t, &c->gaps[channel]);
	whiten(t, c, channel, ended);
	return clean(t, c, c->noise[channel], ended);
}
