#include "debris/wear.h"
#include "debris/reserve.h"
#include "num/pages.h"
#include "num/room.h"
#include "num/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* First depth below the surface over the spacing.  Volumes of rough contacts come within
 * 0.3 to 0.5 % of those of cells without height (2 % where a few columns are all), with
 * half of it within 0.1 to 0.3 % in a fifth more time (tests/bench/depth.sh). */
static const double FIRST = 0.125;

struct wear {
	int nx, ny;
	struct stress *stress;
	const struct wear_par *par;
	struct wear_result *result;
	struct stress_span *span;
	size_t nspans, span_room;
	double *value[3]; /* equivalent stress at this depth and the two before */
	double *top; /* where the open stretch of a column begins; < 0: none is open */
	struct stretch *stretch;
	size_t count, room;
};

struct wear *wear_new(int nx, int ny)
{
	struct wear *w = calloc(1, sizeof *w);
	size_t n = (size_t)nx * (size_t)ny;

	if (!w)
		return NULL;
	w->nx = nx;
	w->ny = ny;
	w->top = malloc(n * sizeof *w->top);
	if (!w->top) {
		wear_free(w);
		return NULL;
	}
	pages_large(w->top, n * sizeof *w->top);
	return w;
}

void wear_free(struct wear *w)
{
	if (!w)
		return;
	free(w->top);
	free(w->span);
	free(w->stretch);
	free(w);
}

static double depth_of(const struct wear_par *p, long layer)
{
	if (p->cell > 0)
		return ((double)layer + p->offset) * p->cell;
	return layer ? p->spacing * FIRST * exp2(0.5 * (double)(layer - 1)) : 0;
}

/* The last depths, and at them the reserve of a node. */
static struct reserve reserve_at(const struct wear *w, size_t at, long layer)
{
	struct reserve r = { .depths = layer < 2 ? (int)layer + 1 : 3 };

	for (int ago = 0; ago < r.depths; ago++) {
		r.z[ago] = depth_of(w->par, layer - ago);
		r.g[ago] = reserve(w->par->yield, w->value[ago][at]);
	}
	return r;
}

static enum num_status close_stretch(struct wear *w, size_t at, double bottom)
{
	double top = w->top[at];

	w->top[at] = -1;
	if (!(bottom > top))
		return NUM_OK;
	if (room_for(&w->stretch, &w->room, w->count + 1, sizeof *w->stretch))
		return NUM_MEMORY;
	w->stretch[w->count++] = (struct stretch){ at, top, bottom };
	w->result->height += bottom - top;
	return NUM_OK;
}

/* Takes the stress of one node at this depth. */
static enum num_status take_node(struct wear *w, size_t at, long layer)
{
	double cell = w->par->cell, f = w->value[0][at], z;
	int open = w->top[at] >= 0, fails = f > w->par->yield;
	struct reserve r;

	w->result->stress = fmax(w->result->stress, f);
	if (open && fails && cell == 0 && w->par->rule == WEAR_COLUMN) {
		r = reserve_at(w, at, layer);
		z = reserve_dip(&r);
		return z >= 0 ? close_stretch(w, at, z) : NUM_OK;
	}
	if (open == fails)
		return NUM_OK;
	r = reserve_at(w, at, layer);
	z = cell > 0 ? (double)layer * cell : layer > 0 ? reserve_crossing(&r) : 0;
	if (open)
		return close_stretch(w, at, z);
	if (layer == 0 || w->par->rule == WEAR_POTENTIAL)
		w->top[at] = z;
	return NUM_OK;
}

static enum num_status take_layer(struct wear *w, long layer)
{
	struct wear_result *r = w->result;
	double nodes = 0;

	for (size_t i = 0; i < w->nspans; i++) {
		const struct stress_span *s = &w->span[i];

		nodes += s->end - s->begin;
		for (int x = s->begin; x < s->end; x++)
			if (take_node(w, (size_t)s->y * (size_t)w->nx + (size_t)x, layer))
				return NUM_MEMORY;
	}
	r->layers++;
	r->nodes += nodes;
	r->nodes_skipped += (double)w->nx * w->ny - nodes;
	return NUM_OK;
}

/* Spans of open columns: the cells that greater depths may lose under the column rule.
 * They lie within the spans so far. */
static enum num_status follow(struct wear *w)
{
	size_t old = w->nspans;

	w->nspans = 0;
	if (room_for(&w->span, &w->span_room, (size_t)w->ny * (((size_t)w->nx + 1) / 2),
		    sizeof *w->span))
		return NUM_MEMORY;
	if (old == 0)
		return NUM_OK;
	for (int y = 0; y < w->ny; y++) {
		const double *row = w->top + (size_t)y * (size_t)w->nx;

		for (int x = 0; x < w->nx; x++) {
			int begin = x;

			if (!(row[x] >= 0))
				continue;
			while (x < w->nx && row[x] >= 0)
				x++;
			w->span[w->nspans++] = (struct stress_span){ y, begin, x };
		}
	}
	return NUM_OK;
}

static enum wear_status remove_layers(struct wear *w)
{
	const struct wear_par *p = w->par;

	if (p->deepest > 0 && stress_deep(w->stress, p->deepest) > p->yield)
		return WEAR_DEEP;
	w->nspans = stress_reach(w->stress, 0, p->yield, w->span);
	for (long k = 0; w->nspans > 0; k++) {
		double z = depth_of(p, k), *oldest = w->value[2];

		if (p->deepest > 0 && z > p->deepest)
			return WEAR_DEEP;
		w->value[2] = w->value[1];
		w->value[1] = w->value[0];
		w->value[0] = oldest;
		if (stress_at(w->stress, z, w->span, w->nspans, w->value[0]) ||
			take_layer(w, k))
			return WEAR_MEMORY;
		w->result->depth = z;
		/* The potential set may continue wherever the bound allowed failure at
		 * this depth: the next depth is evaluated there, so that both sides of a
		 * crossing are known. */
		if (p->rule == WEAR_POTENTIAL)
			w->nspans = stress_reach(w->stress, z, p->yield, w->span);
		else if (follow(w))
			return WEAR_MEMORY;
	}
	return WEAR_OK;
}

/* With memory for the stress, which the search for particles then has for itself. */
static enum wear_status remove_with_memory(struct wear *w)
{
	size_t n = (size_t)w->nx * (size_t)w->ny;
	double *values = malloc(3 * n * sizeof *values);
	enum wear_status status;

	if (!values)
		return WEAR_MEMORY;
	pages_large(values, 3 * n * sizeof *values);
	for (int k = 0; k < 3; k++)
		w->value[k] = values + (size_t)k * n;
	status = remove_layers(w);
	free(values);
	return status;
}

enum wear_status wear_remove(struct wear *w, struct stress *stress,
	const struct wear_par *par, struct wear_result *result)
{
	size_t n = (size_t)w->nx * (size_t)w->ny;
	enum wear_status status;

	w->stress = stress;
	w->par = par;
	w->result = result;
	w->count = w->nspans = 0;
	memset(result, 0, sizeof *result);
	for (size_t i = 0; i < n; i++)
		w->top[i] = -1;
	if (room_for(&w->span, &w->span_room, stress_spans_max(stress), sizeof *w->span))
		return WEAR_MEMORY;
	status = remove_with_memory(w);
	/* All stretches are closed; from here on 0 marks a column that is counted. */
	for (size_t i = 0; i < w->count; i++) {
		result->columns += w->top[w->stretch[i].column] != 0;
		w->top[w->stretch[i].column] = 0;
	}
	result->stretch = w->stretch;
	result->count = w->count;
	return status;
}
