/* sketch.c - see sketch.h */
#include "stats/sketch.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>

struct weighted {
	double value, weight;
};

static int ascending(const void *a, const void *b)
{
	const struct weighted *p = a, *q = b;

	return (p->value > q->value) - (p->value < q->value);
}

enum num_status sketch_sort(struct sketch *s)
{
	struct weighted *pair;

	for (size_t i = 1;; i++) {
		if (i >= s->n)
			return NUM_OK;
		if (s->value[i] < s->value[i - 1])
			break;
	}
	pair = malloc(s->n * sizeof *pair);
	if (!pair)
		return NUM_MEMORY;
	for (size_t i = 0; i < s->n; i++)
		pair[i] = (struct weighted){ s->value[i], s->weight[i] };
	qsort(pair, s->n, sizeof *pair, ascending);
	for (size_t i = 0; i < s->n; i++) {
		s->value[i] = pair[i].value;
		s->weight[i] = pair[i].weight;
	}
	free(pair);
	return NUM_OK;
}

/* How many there would be if all within a ratio of their least were one. */
static size_t merged(const struct sketch *s, double ratio)
{
	size_t n = 0;
	double least = 0;

	for (size_t i = 0; i < s->n; i++) {
		if (i == 0 || s->value[i] > least * ratio) {
			least = s->value[i];
			n++;
		}
	}
	return n;
}

static enum num_status merge(struct sketch *s, size_t most)
{
	double ratio = s->ratio > 1 ? s->ratio : 1, least = 0;
	size_t n = 0;

	if (sketch_sort(s))
		return NUM_MEMORY;
	/* The first ratio joins values that differ by rounding. */
	while (merged(s, ratio) > most / 2)
		ratio = 1 + fmax(2 * (ratio - 1), 1e-12);
	for (size_t i = 0; i < s->n; i++) {
		double value = s->value[i], weight = s->weight[i];

		if (i == 0 || value > least * ratio) {
			least = s->value[n] = value;
			s->weight[n++] = weight;
			continue;
		}
		s->weight[n - 1] += weight;
		s->value[n - 1] += (value - s->value[n - 1]) * weight / s->weight[n - 1];
	}
	s->n = n;
	s->ratio = ratio;
	return NUM_OK;
}

enum num_status sketch_add(struct sketch *s, double x, size_t most)
{
	if (s->n >= most && merge(s, most))
		return NUM_MEMORY;
	if (s->n == s->room) {
		size_t room = s->room ? 2 * s->room : 16;
		double *value = realloc(s->value, room * sizeof *value), *weight;

		if (value)
			s->value = value;
		weight = value ? realloc(s->weight, room * sizeof *weight) : NULL;
		if (!weight)
			return NUM_MEMORY;
		s->weight = weight;
		s->room = room;
	}
	s->value[s->n] = x;
	s->weight[s->n++] = 1;
	return NUM_OK;
}

void sketch_free(struct sketch *s)
{
	free(s->value);
	free(s->weight);
	*s = (struct sketch){ 0 };
}
