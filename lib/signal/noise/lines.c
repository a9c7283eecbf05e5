/* lines.c - removes narrow lines from a stream */
#include "signal/noise/lines.h"
#include "signal/noise/tones.h"
#include <stdlib.h>
#include <string.h>

struct lines {
	size_t channels, hop;
	size_t held;     /* frames that are not clean yet, less than two hops, ... */
	long long begin; /* ... and the index of the first of them */
	struct tones_track *track; /* of each channel */
	double *x;                 /* three hops of each channel */
	double *clean;
};

struct lines *lines_new(int count, const double *omega, int channels, size_t hop)
{
	struct lines *l = calloc(1, sizeof *l);

	if (!l)
		return NULL;
	l->channels = (size_t)channels;
	l->hop = hop;
	l->track = calloc(l->channels, sizeof *l->track);
	l->x = calloc(3 * hop * l->channels, sizeof *l->x);
	l->clean = calloc(3 * hop * l->channels, sizeof *l->clean);
	if (!l->track || !l->x || !l->clean) {
		lines_free(l);
		return NULL;
	}
	for (size_t c = 0; c < l->channels; c++) {
		tones_track_start(&l->track[c], count, omega, 0, hop);
		l->track[c].keeps_offset = 1;
	}
	return l;
}

void lines_free(struct lines *l)
{
	if (!l)
		return;
	free(l->track);
	free(l->x);
	free(l->clean);
	free(l);
}

const double *lines_run(struct lines *l, const double *x, size_t n, size_t *clean)
{
	size_t nc = l->channels, all = l->held + n;

	for (size_t c = 0; c < nc; c++) {
		double *y = l->x + 3 * l->hop * c;

		for (size_t i = 0; i < n; i++)
			y[l->held + i] = x[i * nc + c];
		if (tones_track_run(&l->track[c], y, l->begin, l->begin + (long long)all,
			    n < l->hop) != NUM_OK)
			return NULL;
		*clean = (size_t)(l->track[c].flat - l->begin);
		for (size_t i = 0; i < *clean; i++)
			l->clean[i * nc + c] = y[i];
		memmove(y, y + *clean, (all - *clean) * sizeof *y);
	}
	l->begin += (long long)*clean;
	l->held = all - *clean;
	return l->clean;
}
