/* lines.c - takes narrow lines out of a stream */
#include "signal/lines.h"
#include "signal/tones.h"
#include <stdlib.h>
#include <string.h>

enum { TERMS = 1 + 2 * TONES_MAX };

/* Amplitudes found in one window, and its middle. */
struct fit {
	double at, coefficient[TERMS];
};

struct lines {
	int count, channels;
	double omega[TONES_MAX];
	size_t hop;
	size_t held;      /* frames of the hop before, 0 or hop */
	double start;     /* index of the first frame held */
	int windows;      /* so far */
	struct fit *last; /* of each channel */
	double *channel;  /* one channel of two hops */
	double *frames;   /* held and new frames */
	double *clean;
};

struct lines *lines_new(int count, const double *omega, int channels, size_t hop)
{
	struct lines *l = calloc(1, sizeof *l);
	size_t samples = 2 * hop * (size_t)channels;

	if (!l)
		return NULL;
	l->count = count;
	l->channels = channels;
	l->hop = hop;
	memcpy(l->omega, omega, (size_t)count * sizeof *omega);
	l->last = calloc((size_t)channels, sizeof *l->last);
	l->channel = calloc(2 * hop, sizeof *l->channel);
	l->frames = calloc(samples, sizeof *l->frames);
	l->clean = calloc(samples, sizeof *l->clean);
	if (l->last && l->channel && l->frames && l->clean)
		return l;
	lines_free(l);
	return NULL;
}

void lines_free(struct lines *l)
{
	if (!l)
		return;
	free(l->last);
	free(l->channel);
	free(l->frames);
	free(l->clean);
	free(l);
}

/* Fits the window of total frames held and cleans the first of them. */
static void clean_channel(struct lines *l, size_t c, size_t total, size_t cleaned)
{
	size_t nc = (size_t)l->channels;
	struct fit next = { l->start + 0.5 * (double)total, { 0 } };

	for (size_t i = 0; i < total; i++)
		l->channel[i] = l->frames[i * nc + c];
	if (!tones_fit(l->channel, total, l->start, l->count, l->omega, next.coefficient,
		    NULL, NULL)) {
		/* too short a rest: what was found before goes on */
		memcpy(next.coefficient, l->last[c].coefficient, sizeof next.coefficient);
	}
	next.coefficient[0] = 0; /* the offset stays */
	if (l->windows == 0)
		l->last[c] = next;
	tones_remove(l->channel, cleaned, l->start, l->count, l->omega, l->last[c].at,
		l->last[c].coefficient, next.at, next.coefficient);
	l->last[c] = next;
	for (size_t i = 0; i < cleaned; i++)
		l->clean[i * nc + c] = l->channel[i];
}

const double *lines_run(struct lines *l, const double *x, size_t n, size_t *clean)
{
	size_t nc = (size_t)l->channels, total = l->held + n;
	size_t cleaned = n < l->hop ? total : l->held;

	if (n > 0)
		memcpy(l->frames + l->held * nc, x, n * nc * sizeof *x);
	for (size_t c = 0; cleaned > 0 && c < nc; c++)
		clean_channel(l, c, total, cleaned);
	l->windows += cleaned > 0;
	l->start += (double)cleaned;
	l->held = total - cleaned;
	memmove(l->frames, l->frames + cleaned * nc, l->held * nc * sizeof *x);
	*clean = cleaned;
	return l->clean;
}
