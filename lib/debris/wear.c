#include "debris/wear.h"

#include <stdlib.h>
#include <string.h>

struct wear {
	struct stress *stress;
	const struct wear_par *par;
	int nx, ny;
	struct particles *particles;
	int *removed;
	struct wear_result *result;
	struct stress_span *span;
	size_t nspans;
	double *mises;
	unsigned char *mask;
};

/* Marks the cells of this layer that fail; their number. */
static double mark(struct wear *w)
{
	struct wear_result *r = w->result;
	double cells = 0, nodes = 0;

	memset(w->mask, 0, (size_t)w->nx * w->ny);
	for (size_t i = 0; i < w->nspans; i++) {
		const struct stress_span *s = &w->span[i];

		nodes += s->end - s->begin;
		for (int x = s->begin; x < s->end; x++) {
			size_t at = (size_t)s->y * w->nx + x;

			if (w->mises[at] > r->mises)
				r->mises = w->mises[at];
			if (!(w->mises[at] > w->par->yield))
				continue;
			w->mask[at] = 1;
			r->columns += w->removed[at] == 0;
			w->removed[at]++;
			cells++;
		}
	}
	r->nodes += nodes;
	r->nodes_skipped += (double)w->nx * w->ny - nodes;
	return cells;
}

/* Spans of the marked cells: what the layer below may lose under the column rule. */
static void follow(struct wear *w)
{
	w->nspans = 0;
	for (int y = 0; y < w->ny; y++) {
		const unsigned char *row = w->mask + (size_t)y * w->nx;

		for (int x = 0; x < w->nx; x++) {
			struct stress_span *s = &w->span[w->nspans];

			if (!row[x])
				continue;
			*s = (struct stress_span){ y, x, x };
			while (x < w->nx && row[x])
				x++;
			s->end = x;
			w->nspans++;
		}
	}
}

static enum wear_status remove_layers(struct wear *w)
{
	double yield = w->par->yield;

	if (w->par->max_layers && stress_deep(w->stress, w->par->max_layers) > yield)
		return WEAR_DEEP;
	w->nspans = stress_reach(w->stress, 0, yield, w->span);
	for (long m = 0; w->nspans > 0; m++) {
		double cells;

		if (w->par->max_layers && m == w->par->max_layers)
			return WEAR_DEEP;
		if (stress_mises(w->stress, m, w->span, w->nspans, w->mises))
			return WEAR_MEMORY;
		cells = mark(w);
		w->result->layers++;
		w->result->cells += cells;
		if (w->particles && particles_layer(w->particles, w->mask))
			return WEAR_MEMORY;
		if (w->par->rule == WEAR_COLUMN)
			follow(w);
		else
			w->nspans = stress_reach(w->stress, m + 1, yield, w->span);
	}
	return WEAR_OK;
}

enum wear_status wear_remove(struct stress *stress, const struct wear_par *par, int nx,
	int ny, struct particles *particles, int *removed, struct wear_result *result)
{
	struct wear w = { .stress = stress,
		.par = par,
		.nx = nx,
		.ny = ny,
		.particles = particles,
		.removed = removed,
		.result = result };
	size_t n = (size_t)nx * ny, spans = stress_spans_max(stress);
	enum wear_status status = WEAR_MEMORY;

	/* Marked cells make at most every other cell a span. */
	if (spans < (size_t)ny * ((nx + 1) / 2))
		spans = (size_t)ny * ((nx + 1) / 2);
	memset(result, 0, sizeof(*result));
	memset(removed, 0, n * sizeof(*removed));
	w.span = malloc(spans * sizeof(*w.span));
	w.mises = malloc(n * sizeof(*w.mises));
	w.mask = malloc(n);
	if (w.span && w.mises && w.mask)
		status = remove_layers(&w);
	free(w.span);
	free(w.mises);
	free(w.mask);
	return status;
}
