/* sections.c - see sections.h */
#include "signal/sections.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct sections {
	double *filter; /* the pulse, scaled to unit energy */
	size_t len;
	long first; /* place of filter[0] relative to the pulse */
	long stride, margin;
	double threshold;
	long long next; /* point to scan next */
	struct section *queue;
	int count, capacity;
};

struct sections *sections_new(
	const struct shape *shape, double duration, double threshold, long margin)
{
	struct sections *s;
	double energy = 0;

	if (!(duration >= 4))
		return NULL;
	s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	s->first = shape_support(shape, 0, duration, &s->len);
	s->stride = duration >= 48 ? (long)(duration / 24) : 1;
	s->margin = margin;
	s->threshold = threshold;
	s->filter = malloc(s->len * sizeof *s->filter);
	if (!s->filter) {
		sections_free(s);
		return NULL;
	}
	shape_sample(shape, 0, duration, s->first, s->len, s->filter, NULL, NULL);
	for (size_t i = 0; i < s->len; i++)
		energy += s->filter[i] * s->filter[i];
	for (size_t i = 0; i < s->len; i++)
		s->filter[i] /= sqrt(energy);
	return s;
}

void sections_free(struct sections *s)
{
	if (!s)
		return;
	free(s->filter);
	free(s->queue);
	free(s);
}

void sections_skip(struct sections *s, long long upto)
{
	s->next = upto;
}

long sections_reach(const struct sections *s)
{
	return (-s->first > s->margin ? -s->first : s->margin) + 1;
}

static double filter_at(const struct sections *s, const double *y, size_t n, long long at)
{
	long long from = at + s->first;
	size_t begin = from < 0 ? (size_t)-from : 0, end = s->len, i;
	double s0 = 0, s1 = 0, s2 = 0, s3 = 0;

	if (from + (long long)end > (long long)n)
		end = (long long)n > from ? (size_t)((long long)n - from) : 0;
	for (i = begin; i + 4 <= end; i += 4) {
		s0 += s->filter[i] * y[from + (long long)i];
		s1 += s->filter[i + 1] * y[from + (long long)i + 1];
		s2 += s->filter[i + 2] * y[from + (long long)i + 2];
		s3 += s->filter[i + 3] * y[from + (long long)i + 3];
	}
	for (; i < end; i++)
		s0 += s->filter[i] * y[from + (long long)i];
	return (s0 + s1) + (s2 + s3);
}

/* A trigger at sample at, which is later than all before it. */
static void add_trigger(struct sections *s, long long at)
{
	struct section *last = s->count ? &s->queue[s->count - 1] : NULL;

	if (last && last->open && at - s->margin <= last->end) {
		last->end = at + s->margin;
		return;
	}
	if (last)
		last->open = 0;
	if (!s->queue || s->count >= s->capacity) {
		int capacity = 2 * s->count + 16;
		struct section *more = realloc(s->queue, (size_t)capacity * sizeof *more);

		if (!more) { /* out of memory: one long section instead of two */
			if (last) {
				last->end = at + s->margin;
				last->open = 1;
			}
			return;
		}
		s->queue = more;
		s->capacity = capacity;
	}
	s->queue[s->count++] = (struct section){ at - s->margin, at + s->margin, 1 };
}

void sections_scan(struct sections *s, const double *y1, const double *y2, long long base,
	size_t n, long long limit)
{
	for (; s->next < limit; s->next += s->stride)
		if (filter_at(s, y1, n, s->next - base) > s->threshold ||
			filter_at(s, y2, n, s->next - base) > s->threshold)
			add_trigger(s, s->next);
	if (s->count && s->queue[s->count - 1].end + s->margin < s->next)
		s->queue[s->count - 1].open = 0;
}

int sections_first(const struct sections *s, struct section *section)
{
	if (s->count == 0)
		return 0;
	*section = s->queue[0];
	return 1;
}

void sections_take(struct sections *s, long long upto)
{
	if (s->count == 0)
		return;
	if (upto < s->queue[0].end || s->queue[0].open) {
		s->queue[0].begin = upto;
		return;
	}
	memmove(s->queue, s->queue + 1, (size_t)--s->count * sizeof *s->queue);
}

void sections_end(struct sections *s)
{
	if (s->count)
		s->queue[s->count - 1].open = 0;
}

long long sections_scanned(const struct sections *s)
{
	return s->next;
}
