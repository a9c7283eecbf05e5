#include "debris/wear.h"
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

/* Square root of strength over stress.  It grows in proportion to the depth below a
 * distant load, which makes it nearly linear for the interpolation.  Bounded, far above
 * the 1 of failure, where there is no stress. */
static double reserve(const struct wear *w, int ago, size_t at)
{
	return sqrt(w->par->yield / fmax(w->value[ago][at], 1e-6 * w->par->yield));
}

/* Where the stress crosses the yield stress between the last two depths: on the parabola
 * through the last three, or the line through two. */
static double crossing(const struct wear *w, size_t at, long layer)
{
	double z1 = depth_of(w->par, layer - 1), z2 = depth_of(w->par, layer);
	double g1 = reserve(w, 1, at), g2 = reserve(w, 0, at), step = z2 - z1;
	double slope = (g2 - g1) / step, bend = 0, b, c = g1 - 1, q, s;

	if (layer > 1) {
		double z0 = depth_of(w->par, layer - 2), g0 = reserve(w, 2, at);

		bend = (slope - (g1 - g0) / (z1 - z0)) / (z2 - z0);
	}
	/* bend s^2 + b s + c = 0 has one root in [0, step]. */
	b = slope - bend * step;
	q = -0.5 * (b + copysign(sqrt(fmax(0, b * b - 4 * bend * c)), b));
	s = c / q;
	if (!(s >= 0 && s <= step))
		s = q / bend;
	return z1 + fmin(fmax(s, 0), step);
}

/* Where the parabola through the last three depths, at which the node fails, first holds;
 * < 0: nowhere. */
static double dip(const struct wear *w, size_t at, long layer)
{
	double z0, z1, z2, g0, slope, bend, b, c, most;

	if (layer < 2)
		return -1;
	z0 = depth_of(w->par, layer - 2), z1 = depth_of(w->par, layer - 1);
	z2 = depth_of(w->par, layer), g0 = reserve(w, 2, at);
	slope = (reserve(w, 1, at) - g0) / (z1 - z0);
	bend = ((reserve(w, 0, at) - reserve(w, 1, at)) / (z2 - z1) - slope) / (z2 - z0);
	/* g0 + b s + bend s^2 - 1 */
	b = slope - bend * (z1 - z0);
	c = g0 - 1;
	most = -b / (2 * bend);
	if (!(bend < 0 && most > 0 && most < z2 - z0 && b * b > 4 * bend * c))
		return -1;
	return z0 + 2 * c / (-b - sqrt(b * b - 4 * bend * c));
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

	w->result->stress = fmax(w->result->stress, f);
	if (open && fails && cell == 0 && w->par->rule == WEAR_COLUMN) {
		z = dip(w, at, layer);
		return z >= 0 ? close_stretch(w, at, z) : NUM_OK;
	}
	if (open == fails)
		return NUM_OK;
	z = cell > 0 ? (double)layer * cell : layer > 0 ? crossing(w, at, layer) : 0;
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
