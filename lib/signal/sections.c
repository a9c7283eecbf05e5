/* sections.c - see sections.h */
#include "signal/sections.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A trigger is less than 2^OCTAVES standard deviations, or its margin is the largest. */
enum { OCTAVES = 24 };

/* Standard deviations of the noise that the rest of a pulse stays below. */
static const double hidden = 0.2;

struct filter {
	double *tap; /* a pulse, scaled to unit energy */
	size_t len;
	long first; /* place of tap[0] relative to the pulse */
};

struct sections {
	int bank; /* durations */
	struct filter *filter[2];
	long reach; /* of the longest filter before its pulse */
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
static void set_margins(struct sections *s, const struct joint_scene *scene)
{
	double longest =
		scene->duration * (1 + fmax(scene->delta_max, 0) / scene->transit);
	double slack = fmax(scene->delta_max, -scene->delta_min);

	for (int c = 0; c < 2; c++) {
		const struct shape *shape = scene->shape[c];
		double least = hidden * sqrt(scene->duration * shape_energy(shape));

		for (int k = 0; k <= OCTAVES; k++) {
			double reach =
				shape_reach_above(shape, fmin(ldexp(least, -k), 0.01));
			long margin = (long)(1.2 * reach * longest + slack);

			s->margin[k] = margin > s->margin[k] ? margin : s->margin[k];
		}
	}
}

static int set_filter(struct filter *f, const struct shape *shape, double T)
{
	double energy = 0;

	f->first = shape_support(shape, 0, T, &f->len);
	f->tap = malloc(f->len * sizeof *f->tap);
	if (!f->tap)
		return 0;
	shape_sample(shape, 0, T, f->first, f->len, f->tap, NULL, NULL);
	for (size_t i = 0; i < f->len; i++)
		energy += f->tap[i] * f->tap[i];
	for (size_t i = 0; i < f->len; i++)
		f->tap[i] /= sqrt(energy);
	return 1;
}

/* One filter per duration of the bank, each in the middle of its part of the range. */
static int set_filters(struct sections *s, const struct joint_scene *scene)
{
	double lo = 1 + scene->delta_min / scene->transit;
	double hi = 1 + scene->delta_max / scene->transit;

	for (int c = 0; c < 2; c++) {
		s->filter[c] = calloc((size_t)s->bank, sizeof *s->filter[c]);
		for (int b = 0; s->filter[c] && b < s->bank; b++) {
			double T = s->bank > 1 ? scene->duration * lo *
							 pow(hi / lo, (b + 0.5) / s->bank)
					       : scene->duration;

			if (!set_filter(&s->filter[c][b], scene->shape[c], T))
				return 0;
			if (-s->filter[c][b].first > s->reach)
				s->reach = -s->filter[c][b].first;
		}
		if (!s->filter[c])
			return 0;
	}
	return 1;
}

struct sections *sections_new(const struct joint_scene *scene, double threshold)
{
	struct sections *s;

	if (!(scene->duration >= 4))
		return NULL;
	s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	s->bank = joint_bank(scene);
	s->stride = scene->duration >= 48 ? (long)(scene->duration / 24) : 1;
	set_margins(s, scene);
	s->threshold = threshold;
	if (!set_filters(s, scene)) {
		sections_free(s);
		return NULL;
	}
	return s;
}

void sections_free(struct sections *s)
{
	if (!s)
		return;
	for (int c = 0; c < 2; c++) {
		for (int b = 0; s->filter[c] && b < s->bank; b++)
			free(s->filter[c][b].tap);
		free(s->filter[c]);
	}
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

	return (s->reach > margin ? s->reach : margin) + 1;
}

static double filter_at(const struct filter *f, const double *y, size_t n, long long at)
{
	long long from = at + f->first;
	size_t begin = from < 0 ? (size_t)-from : 0, end = f->len, i;
	double s0 = 0, s1 = 0, s2 = 0, s3 = 0;

	if (from + (long long)end > (long long)n)
		end = (long long)n > from ? (size_t)((long long)n - from) : 0;
	for (i = begin; i + 4 <= end; i += 4) {
		s0 += f->tap[i] * y[from + (long long)i];
		s1 += f->tap[i + 1] * y[from + (long long)i + 1];
		s2 += f->tap[i + 2] * y[from + (long long)i + 2];
		s3 += f->tap[i + 3] * y[from + (long long)i + 3];
	}
	for (; i < end; i++)
		s0 += f->tap[i] * y[from + (long long)i];
	return (s0 + s1) + (s2 + s3);
}

/* The largest of all filters on both channels. */
static double loudest(const struct sections *s, const double *y1, const double *y2,
	size_t n, long long at)
{
	double z = 0;

	for (int b = 0; b < s->bank; b++) {
		z = fmax(z, fabs(filter_at(&s->filter[0][b], y1, n, at)));
		z = fmax(z, fabs(filter_at(&s->filter[1][b], y2, n, at)));
	}
	return z;
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
 * What it reaches becomes one section with it. */
static void add_trigger(struct sections *s, long long at, double z)
{
	int octave = z < ldexp(1, OCTAVES) ? ilogb(fmax(z, 1)) + 1 : OCTAVES;
	long long begin = at - s->margin[octave], end = at + s->margin[octave];

	while (s->count && s->queue[s->count - 1].end >= begin) {
		struct section *last = &s->queue[--s->count];

		begin = last->begin < begin ? last->begin : begin;
		end = last->end > end ? last->end : end;
	}
	if (!reserve(s)) { /* out of memory: one long section instead of two */
		if (s->count)
			begin = s->queue[--s->count].begin;
		else
			return;
	}
	begin = begin < s->taken ? s->taken : begin;
	s->queue[s->count++] = (struct section){ begin, end, 1 };
}

void sections_scan(struct sections *s, const double *y1, const double *y2, long long base,
	size_t n, long long limit)
{
	for (; s->next < limit; s->next += s->stride) {
		double z = loudest(s, y1, y2, n, s->next - base);

		if (z > s->threshold)
			add_trigger(s, s->next, z);
	}
	for (int i = 0; i < s->count; i++)
		if (s->queue[i].end + s->margin[OCTAVES] < s->next)
			s->queue[i].open = 0;
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
