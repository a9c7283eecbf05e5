/* sections.c - see sections.h */
#include "signal/detect/sections.h"
#include "num/dot.h"
#include "num/room.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triggers are classified by octaves; from 2^OCTAVES standard deviations on the margin is
 * the largest. */
enum { OCTAVES = 24 };

/* Standard deviations of the noise below which the rest of a pulse is neglected, and the
 * share of its peak above which it is not; by how much farther a section reaches. */
static const double hidden = 0.2, FOOT = 0.01, FARTHER = 1.2;

struct sections {
	double *filter; /* the pulse, scaled to unit energy */
	size_t len;
	long first; /* place of filter[0] relative to the pulse */
	long stride;
	long margin[OCTAVES + 1]; /* of a trigger below 2^k standard deviations */
	double threshold;
	long aside;      /* samples beyond a section that are scanned */
	long long next;  /* point to scan next */
	long long taken; /* samples before this one are in no section */
	struct section *queue;
	int count;
	size_t capacity;
};

/* A pulse whose trigger is z has the amplitude z / sqrt(its energy at amplitude 1).  A
 * weak trigger may be the flank of a strong pulse. */
static void set_margins(
	struct sections *s, const struct shape *shape, double duration, double slack)
{
	double least = hidden * sqrt(duration * shape_energy(shape));

	for (int k = 0; k <= OCTAVES; k++) {
		double reach = shape_reach_above(shape, fmin(ldexp(least, -k), FOOT));

		s->margin[k] = (long)(FARTHER * reach * duration + slack);
	}
}

struct sections *sections_new(
	const struct shape *shape, double duration, double threshold, double slack)
{
	struct sections *s = calloc(1, sizeof *s);
	double energy;

	if (!s)
		return NULL;
	s->first = shape_support(shape, 0, duration, &s->len);
	s->stride = shape_stride(duration);
	set_margins(s, shape, duration, slack);
	s->threshold = threshold;
	s->aside = (long)ceil(shape_reach_above(shape, FOOT) * duration);
	s->filter = malloc(s->len * sizeof *s->filter);
	if (!s->filter) {
		sections_free(s);
		return NULL;
	}
	shape_sample(shape, 0, duration, s->first, s->len, s->filter, NULL, NULL);
	energy = dot(s->filter, s->filter, s->len);
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

/* Adds a trigger of z standard deviations at sample at, which is later than all before
 * it.  Sections within its reach are joined. */
static enum num_status add_trigger(struct sections *s, long long at, double z)
{
	int octave = z < ldexp(1, OCTAVES) ? ilogb(fmax(z, 1)) + 1 : OCTAVES;
	long long begin = at - s->margin[octave], end = at + s->margin[octave];

	while (s->count && s->queue[s->count - 1].end >= begin) {
		struct section *last = &s->queue[--s->count];

		begin = last->begin < begin ? last->begin : begin;
		end = last->end > end ? last->end : end;
	}
	if (room_for(&s->queue, &s->capacity, (size_t)s->count + 1, sizeof *s->queue))
		return NUM_MEMORY;
	begin = begin < s->taken ? s->taken : begin;
	s->queue[s->count++] = (struct section){ begin, end, 1 };
	return NUM_OK;
}

enum num_status sections_scan(struct sections *s, const double *const y[], int channels,
	long long base, size_t n, long long limit)
{
	for (; s->next < limit; s->next += s->stride) {
		double z = 0;

		for (int c = 0; c < channels; c++) {
			double here = dot_within(
				s->filter, s->len, y[c], n, s->next - base + s->first);

			z = fmax(z, c < 2 ? here : fabs(here));
		}
		if (z > s->threshold && add_trigger(s, s->next, z))
			return NUM_MEMORY;
	}
	for (int i = 0; i < s->count; i++)
		if (s->queue[i].end + s->aside + s->margin[OCTAVES] < s->next)
			s->queue[i].open = 0;
	return NUM_OK;
}

long sections_margin(const struct sections *s)
{
	return s->margin[0];
}

int sections_first(const struct sections *s, struct section *section)
{
	if (s->count == 0)
		return 0;
	*section = s->queue[0];
	return 1;
}

long sections_aside(const struct sections *s, int side)
{
	long long free = s->aside;

	if (s->count == 0)
		return 0;
	if (side == 0 && s->queue[0].begin - s->taken < free)
		free = s->queue[0].begin - s->taken;
	if (side == 1 && s->count > 1 && s->queue[1].begin - s->queue[0].end < free)
		free = s->queue[1].begin - s->queue[0].end;
	return (long)(free > 0 ? free : 0);
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
