/* lines.c - removes narrow lines from a stream */
#include "signal/noise/lines.h"
#include "num/status.h"
#include "signal/noise/tones.h"
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
	size_t older;     /* frames kept that are already clean, 0 or hop */
	size_t held;      /* frames that wait for the next hop, 0 or hop */
	double start;     /* index of the first frame held */
	int windows;      /* so far */
	struct fit *last; /* of each channel */
	double *channel;  /* one channel of two hops */
	double *frames;   /* older, held and new ones */
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
	l->frames = calloc(samples + samples / 2, sizeof *l->frames);
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

/* One channel of n kept frames from index begin on. */
static void take_channel(struct lines *l, size_t c, size_t begin, size_t n)
{
	size_t nc = (size_t)l->channels;

	for (size_t i = 0; i < n; i++)
		l->channel[i] = l->frames[(begin + i) * nc + c];
}

/* Fits the last of the total frames kept, a window of them if there are so many, and
 * cleans the first of those held. */
static enum num_status clean_channel(
	struct lines *l, size_t c, size_t total, size_t cleaned)
{
	size_t nc = (size_t)l->channels, window = total < 2 * l->hop ? total : 2 * l->hop;
	double start = l->start - (double)l->older + (double)(total - window);
	struct fit next = { start + 0.5 * (double)window, { 0 } };
	enum tones_status status;

	take_channel(l, c, total - window, window);
	status = tones_fit(l->channel, window, start, l->count, l->omega,
		next.coefficient, NULL, NULL);
	if (status == TONES_MEMORY)
		return NUM_MEMORY;
	if (status == TONES_SHORT)
		memcpy(next.coefficient, l->last[c].coefficient, sizeof next.coefficient);
	next.coefficient[0] = 0; /* the offset stays */
	if (l->windows == 0)
		l->last[c] = next;
	take_channel(l, c, l->older, cleaned);
	tones_remove(l->channel, cleaned, l->start, l->count, l->omega, l->last[c].at,
		l->last[c].coefficient, next.at, next.coefficient);
	l->last[c] = next;
	for (size_t i = 0; i < cleaned; i++)
		l->clean[i * nc + c] = l->channel[i];
	return NUM_OK;
}

const double *lines_run(struct lines *l, const double *x, size_t n, size_t *clean)
{
	size_t nc = (size_t)l->channels, waiting = l->held + n;
	size_t cleaned = n < l->hop ? waiting : l->held, total = l->older + waiting;

	if (n > 0)
		memcpy(l->frames + (l->older + l->held) * nc, x, n * nc * sizeof *x);
	for (size_t c = 0; cleaned > 0 && c < nc; c++)
		if (clean_channel(l, c, total, cleaned))
			return NULL;
	if (cleaned > 0) {
		/* what was just cleaned is the older hop now */
		memmove(l->frames, l->frames + l->older * nc, waiting * nc * sizeof *x);
		l->older = cleaned;
		l->windows++;
	}
	l->start += (double)cleaned;
	l->held = waiting - cleaned;
	*clean = cleaned;
	return l->clean;
}
