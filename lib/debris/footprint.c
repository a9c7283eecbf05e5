#include "debris/footprint.h"
#include "num/lanes.h"
#include "num/pages.h"
#include "num/room.h"
#include "stress/point_sum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const footprint_names[FOOTPRINT_FEATURES] = { "cells", "mean_stress",
	"largest_stress", "load", "pressure", "contact", "unevenness", "spread",
	"neighbours", "friction", "poisson", "depth" };

/* First guess of the depth over the root of area times mean stress over strength.
 * Contacts of 30 N to the square millimetre on 128, 512 and 1024 cells a side, and of an
 * eighth of it, take 1.42, 1.37 and 1.51 sums a region at 0.55, 0.6 and 0.65, and 1.6
 * with 0.75 of the root of the area. */
static const double FIRST = 0.6;

struct footprints {
	struct stress_par par;
	double *value; /* equivalent stress in the spans, else 0 */
	size_t *queue; /* cells of a region */
	struct stress_span *span;
	size_t spans;
	struct point_sum *below;
	struct footprint *list;
	size_t count, room;
	/* centroids and loads of the regions, and after them one without load */
	double *x, *y, *load;
	size_t places;
};

struct footprints *footprints_new(const struct stress_par *par)
{
	struct footprints *f = calloc(1, sizeof *f);
	size_t n = (size_t)par->nx * (size_t)par->ny;

	if (!f)
		return NULL;
	f->par = *par;
	f->value = calloc(n, sizeof *f->value);
	f->queue = malloc(n * sizeof *f->queue);
	f->span = malloc((size_t)par->ny * (((size_t)par->nx + 1) / 2) * sizeof *f->span);
	f->below = point_sum_new(par);
	if (!f->value || !f->queue || !f->span || !f->below) {
		footprints_free(f);
		return NULL;
	}
	pages_large(f->value, n * sizeof *f->value);
	return f;
}

void footprints_free(struct footprints *f)
{
	if (!f)
		return;
	free(f->value);
	free(f->queue);
	free(f->span);
	point_sum_free(f->below);
	free(f->list);
	free(f->x);
	free(f);
}

/* Takes a cell into the region and marks it as taken. */
static void take_cell(
	struct footprints *f, struct footprint *r, size_t at, const double *pressure)
{
	const struct stress_par *s = &f->par;
	size_t nx = (size_t)s->nx;
	size_t row = at / nx;
	double x = (double)(at % nx) * s->dx, y = (double)row * s->dy;
	double v = f->value[at], p = pressure[at];

	f->queue[r->cells++] = at;
	f->value[at] = 0;
	r->x += x + 0.5 * s->dx;
	r->y += y + 0.5 * s->dy;
	r->low[0] = fmin(r->low[0], x);
	r->low[1] = fmin(r->low[1], y);
	r->high[0] = fmax(r->high[0], x + s->dx);
	r->high[1] = fmax(r->high[1], y + s->dy);
	r->load += p;
	r->squares += p * p;
	r->peak = fmax(r->peak, p);
	r->contact += p > 0;
	r->stress_sum += v;
	if (v > r->stress_most) {
		r->stress_most = v;
		r->most_at = at;
	}
}

/* The region that a cell belongs to, by flooding. */
static void flood(struct footprints *f, struct footprint *r, size_t first,
	const double *pressure, double yield)
{
	const struct stress_par *s = &f->par;
	size_t nx = (size_t)s->nx, ny = (size_t)s->ny;

	*r = (struct footprint){ .first = first,
		.low = { INFINITY, INFINITY },
		.high = { -INFINITY, -INFINITY } };
	take_cell(f, r, first, pressure);
	for (size_t done = 0; done < r->cells; done++) {
		size_t at = f->queue[done], x = at % nx, y = at / nx;

		if (x > 0 && f->value[at - 1] > yield)
			take_cell(f, r, at - 1, pressure);
		if (x + 1 < nx && f->value[at + 1] > yield)
			take_cell(f, r, at + 1, pressure);
		if (y > 0 && f->value[at - nx] > yield)
			take_cell(f, r, at - nx, pressure);
		if (y + 1 < ny && f->value[at + nx] > yield)
			take_cell(f, r, at + nx, pressure);
	}
	r->area = (double)r->cells * s->dx * s->dy;
	r->load *= s->dx * s->dy;
	r->x /= (double)r->cells;
	r->y /= (double)r->cells;
	/* the spread of a single cell */
	for (size_t i = 0; i < r->cells; i++) {
		size_t row = f->queue[i] / nx;
		double u = ((double)(f->queue[i] % nx) + 0.5) * s->dx - r->x,
		       v = ((double)row + 0.5) * s->dy - r->y;

		r->spread += u * u + v * v;
	}
	r->spread /= (double)r->cells;
	r->spread += (s->dx * s->dx + s->dy * s->dy) / 12;
}

static int by_size(const void *a, const void *b)
{
	const struct footprint *f = a, *g = b;

	if (f->cells != g->cells)
		return f->cells < g->cells ? 1 : -1;
	return f->first < g->first ? -1 : f->first > g->first;
}

/* Copies centroids and loads side by side, for lanes. */
static enum num_status place_regions(struct footprints *f)
{
	size_t even = f->count + 2 - f->count % 2;

	if (room_for(&f->x, &f->places, 3 * even, sizeof *f->x))
		return NUM_MEMORY;
	f->y = f->x + even;
	f->load = f->y + even;
	f->x[f->count] = f->y[f->count] = f->load[f->count] = 0;
	for (size_t i = 0; i < f->count; i++) {
		f->x[i] = f->list[i].x;
		f->y[i] = f->list[i].y;
		f->load[i] = f->list[i].load;
	}
	return NUM_OK;
}

/* Load of the others over squared distance, no nearer than the region is large. */
static double pressed_by_others(struct footprints *f, const struct footprint *r)
{
	lanes x = lanes_all(r->x), y = lanes_all(r->y), near = lanes_all(r->spread);
	lanes sum = lanes_all(0);
	double *own = &f->load[r - f->list];

	*own = 0;
	for (size_t i = 0; i < f->count; i += 2) {
		lanes u = lanes_load(f->x + i, 2) - x, v = lanes_load(f->y + i, 2) - y;

		sum += lanes_load(f->load + i, 2) / lanes_max(u * u + v * v, near);
	}
	*own = r->load;
	return sum[0] + sum[1];
}

/* Roots of strength over stress at depth k, -1 for the surface, and the one below. */
static void roots_at(const struct footprints *f, const struct footprint *r, double yield,
	int k, double root[2])
{
	double stress[2];

	point_sum_at(f->below, r->most_at, k < 0 ? 0 : k, stress);
	if (k < 0) {
		stress[1] = stress[0];
		stress[0] = r->stress_most;
	}
	for (int d = 0; d < 2; d++)
		root[d] = sqrt(yield / stress[d]);
}

/* Root of strength over stress grows nearly in proportion to the depth: interpolated
 * between the two depths where it passes 1, nearest to the first guess.  On the surface
 * it is below 1. */
static double depth_below(
	const struct footprints *f, const struct footprint *r, double yield)
{
	double mean = r->stress_sum / (double)r->cells;
	int k = point_sum_above(f->below, FIRST * sqrt(r->area * mean / yield));
	double root[2], above, share = 1;

	roots_at(f, r, yield, k, root);
	if (root[0] > 1) {
		while (root[0] > 1)
			roots_at(f, r, yield, --k, root);
	} else {
		while (root[1] <= 1)
			roots_at(f, r, yield, ++k, root);
	}
	above = point_sum_depth(f->below, k);
	/* The sum at a depth varies a little with the other depth: neither root need lie
	 * on its side of 1. */
	if (root[1] > 1)
		share = fmax(0, (1 - root[0]) / (root[1] - root[0]));
	return above + share * (point_sum_depth(f->below, k + 1) - above);
}

static double unevenness(const struct footprint *r)
{
	double mean = r->load / r->area;

	return r->load > 0 ? log(r->squares / (double)r->cells / (mean * mean)) : 0;
}

static void describe(struct footprints *f, struct footprint *r, double yield)
{
	double *x = r->feature;

	r->depth = depth_below(f, r, yield);
	x[FOOTPRINT_CELLS] = log((double)r->cells);
	x[FOOTPRINT_MEAN] = log(r->stress_sum / (double)r->cells / yield);
	x[FOOTPRINT_MOST] = log(r->stress_most / yield);
	x[FOOTPRINT_LOAD] = log1p(r->load / r->area / yield);
	x[FOOTPRINT_PRESSURE] = log1p(r->peak / yield);
	x[FOOTPRINT_CONTACT] = r->contact / (double)r->cells;
	x[FOOTPRINT_UNEVEN] = unevenness(r);
	x[FOOTPRINT_SPREAD] = log(r->spread / r->area);
	x[FOOTPRINT_NEIGHBOUR] = log1p(pressed_by_others(f, r) / yield);
	x[FOOTPRINT_FRICTION] = fabs(f->par.mu);
	x[FOOTPRINT_POISSON] = f->par.nu;
	x[FOOTPRINT_DEPTH] = log(r->depth / sqrt(r->area));
}

/* The first cell above the yield stress from i on; end if there is none. */
static size_t next_failing(const struct footprints *f, size_t i, size_t end, double yield)
{
	for (; i + 2 <= end; i += 2) {
		lane_mask fails = lanes_load(f->value + i, 2) > yield;

		if (fails[0] | fails[1])
			break;
	}
	while (i < end && !(f->value[i] > yield))
		i++;
	return i;
}

/* The values of the last surface: few cells of a large grid. */
static void clear_values(struct footprints *f)
{
	for (size_t k = 0; k < f->spans; k++) {
		const struct stress_span *s = &f->span[k];

		memset(f->value + (size_t)s->y * (size_t)f->par.nx + (size_t)s->begin, 0,
			(size_t)(s->end - s->begin) * sizeof *f->value);
	}
	f->spans = 0;
}

enum num_status footprints_find(struct footprints *f, struct stress *stress,
	const double *pressure, double yield, const struct footprint **list,
	size_t *count)
{
	f->count = 0;
	*count = 0;
	clear_values(f);
	f->spans = stress_reach_surface(stress, yield, f->span);
	if (stress_above(stress, yield, f->span, f->spans, f->value))
		return NUM_MEMORY;
	/* Row by row, and in each from left to right. */
	for (size_t k = 0; k < f->spans; k++) {
		size_t row = (size_t)f->span[k].y * (size_t)f->par.nx;

		size_t end = row + (size_t)f->span[k].end;

		for (size_t i = next_failing(
			     f, row + (size_t)f->span[k].begin, end, yield);
			i < end; i = next_failing(f, i + 1, end, yield)) {
			if (room_for(&f->list, &f->room, f->count + 1, sizeof *f->list))
				return NUM_MEMORY;
			flood(f, &f->list[f->count++], i, pressure, yield);
		}
	}
	point_sum_load(f->below, pressure);
	qsort(f->list, f->count, sizeof *f->list, by_size);
	if (place_regions(f))
		return NUM_MEMORY;
	for (size_t i = 0; i < f->count; i++)
		describe(f, &f->list[i], yield);
	*list = f->list;
	*count = f->count;
	return NUM_OK;
}
