/* sections.c - see sections.h */
#include "signal/detect/sections.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A trigger is less than 2^OCTAVES standard deviations, or its margin is the largest. */
enum { OCTAVES = 24 };

/* Standard deviations of the noise that the rest of a pulse stays below. */
static const double hidden = 0.2;

struct sections {
	double *filter; /* the pulse, scaled to unit energy */
	size_t len;
	long first; /* place of filter[0] relative to the pulse */
	long stride;
	long margin[OCTAVES + 1]; /* of a trigger below 2^k standard deviations */
	double threshold;
	long long next;  /* point to scan next */
	long long taken; /* samples before this one are in no section */
	struct section *queue;
	int count, capacity;
};

/* A pulse whose trigger is z has the amplitude z / sqrt(its energy at amplitude 1).  A
 * weak trigger may be the flank of a strong pulse: a hundredth always counts. */
static void set_margins(
	struct sections *s, const struct shape *shape, double duration, double slack)
{
	double least = hidden * sqrt(duration * shape_energy(shape));

	for (int k = 0; k <= OCTAVES; k++) {
		double reach = shape_reach_above(shape, fmin(ldexp(least, -k), 0.01));

		s->margin[k] = (long)(1.2 * reach * duration + slack);
	}
}

struct sections *sections_new(
	const struct shape *shape, double duration, double threshold, double slack)
{
	struct sections *s;
	double energy = 0;

	if (!(duration >= SECTIONS_SHORTEST)) {
		errno = EDOM;
		return NULL;
	}
	s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	s->first = shape_support(shape, 0, duration, &s->len);
	s->stride = duration >= 48 ? (long)(duration / 24) : 1;
	set_margins(s, shape, duration, slack);
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
	s->next = s->taken = upto;
}

long sections_reach(const struct sections *s)
{
	long margin = s->margin[OCTAVES];

	return (-s->first > margin ? -s->first : margin) + 1;
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

static int reserve(struct sections *s)
{
	int capacity = 2 * s->count + 16;
	struct section *more;

	if (s->queue && s->count < s->capacity)
		return 1;
	more = realloc(s->queue, (size_t)capacity * sizeof *more);
	if (!more)
		return 0;
	s->queue = more;
	s->capacity = capacity;
	return 1;
}

/* A trigger of z standard deviations at sample at, which is later than all before it.
 * What it reaches becomes one section with it.  Returns 0 when out of memory. */
static int add_trigger(struct sections *s, long long at, double z)
{
	int octave = z < ldexp(1, OCTAVES) ? ilogb(fmax(z, 1)) + 1 : OCTAVES;
	long long begin = at - s->margin[octave], end = at + s->margin[octave];

	while (s->count && s->queue[s->count - 1].end >= begin) {
		struct section *last = &s->queue[--s->count];

		begin = last->begin < begin ? last->begin : begin;
		end = last->end > end ? last->end : end;
	}
	if (!reserve(s))
		return 0;
	begin = begin < s->taken ? s->taken : begin;
	s->queue[s->count++] = (struct section){ begin, end, 1 };
	return 1;
}

enum num_status sections_scan(struct sections *s, const double *y1, const double *y2,
	long long base, size_t n, long long limit)
{
	for (; s->next < limit; s->next += s->stride) {
		double z = fmax(filter_at(s, y1, n, s->next - base),
			filter_at(s, y2, n, s->next - base));

		if (z > s->threshold && !add_trigger(s, s->next, z))
			return NUM_MEMORY;
	}
	for (int i = 0; i < s->count; i++)
		if (s->queue[i].end + s->margin[OCTAVES] < s->next)
			s->queue[i].open = 0;
	return NUM_OK;
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
	s->taken = upto;
	if (upto < s->queue[0].end || s->queue[0].open) {
		s->queue[0].begin = upto;
		return;
	}
	memmove(s->queue, s->queue + 1, (size_t)--s->count * sizeof *s->queue);
}

void sections_end(struct sections *s)
{
	for (int i = 0; i < s->count; i++)
		s->queue[i].open = 0;
}

long long sections_scanned(const struct sections *s)
{
	return s->next;
}
