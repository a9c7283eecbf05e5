#include "debris/footprint.h"
#include "debris/debris.h"
#include "debris/reserve.h"
#include "num/lesser.h"
#include "num/room.h"
#include "stress/point_sum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells of a region below which the depth is found: LEAST, the root of their number, or
 * of the surface SHARE times the part of it that the region is, whichever is most.  Of 48
 * surfaces that lose 620 columns the volumes have rms errors of 7.3, 4.3 and 3.4 %
 * without SHARE and with 1, 1.25 and 1.5 times the root, and of 2 % with SHARE; of four
 * that lose 9900 columns 2.2, 1.2 and 1.0 %. */
enum { LEAST = 4, SHARE = 250 };

/* Cells of a surface at which the sums are checked, or all that fail.  Intervals of 90 %
 * hold .91, .91, .91 and .92 of 11 300 particles of 150 kinds with 16, 24, 32 and 48. */
enum { CHECKS = 24 };
/* Relative error of careful sums.  With 1e-5, 3e-5 and 1e-4 intervals of 90 % hold .91,
 * .90 and .90 of these particles, .93, .92 and .91 of 5500 on rough surfaces, and .94,
 * .96 and .94 and .91, .89 and .78 of the total volumes. */
static const double CAREFUL_ERROR = 3e-5;

/* Relative change of the stress by which a cell may come to end at another depth, so that
 * careful sums decide: twice what nine in ten of the others are off by.  These are
 * off by DECIDED (root mean square). */
static const double TIE = 0.005, DECIDED = 1.5e-4;

struct footprints {
	struct stress_par par;
	struct stress_node *node, *spare; /* failing cells, row by row */
	size_t *region; /* of each node: one before it that it touches, then its region */
	size_t *cell;   /* nodes of the regions, one region after another */
	size_t nodes;
	/* Of each column or row, and each region, where its next node goes. */
	size_t *place, *next;
	struct stress_span *span;
	double yield;
	struct point_sum *below;
	int deepest;           /* depths that are allowed */
	double passed, checks; /* cells */
	double squares;        /* of the relative errors of stresses below these */
	struct footprint *list;
	size_t count;
	size_t node_room, spare_room, region_room, cell_room, next_room, list_room,
		span_room;
};

struct footprints *footprints_new(const struct stress_par *par)
{
	struct footprints *f = calloc(1, sizeof *f);
	size_t nx = (size_t)par->nx, ny = (size_t)par->ny;

	if (!f)
		return NULL;
	f->par = *par;
	f->place = malloc((nx > ny ? nx : ny) * sizeof *f->place);
	f->below = point_sum_new(par);
	if (!f->place || !f->below) {
		footprints_free(f);
		return NULL;
	}
	f->deepest = point_sum_above(f->below, debris_deepest(par));
	return f;
}

void footprints_free(struct footprints *f)
{
	if (!f)
		return;
	free(f->node);
	free(f->spare);
	free(f->place);
	free(f->next);
	free(f->region);
	free(f->cell);
	free(f->span);
	point_sum_free(f->below);
	free(f->list);
	free(f);
}

/* Turns the number of nodes of each row, or region, into the place of its first node. */
static void find_places(size_t *count, size_t n)
{
	size_t sum = 0;

	for (size_t i = 0; i < n; i++) {
		sum += count[i];
		count[i] = sum - count[i];
	}
}

/* Puts nodes in the order of their columns, or rows, and otherwise leaves them as they
 * are. */
static void sort_nodes(struct footprints *f, const struct stress_node *from,
	struct stress_node *to, int by_row)
{
	size_t n = (size_t)(by_row ? f->par.ny : f->par.nx);

	memset(f->place, 0, n * sizeof *f->place);
	for (size_t i = 0; i < f->nodes; i++)
		f->place[by_row ? from[i].iy : from[i].ix]++;
	find_places(f->place, n);
	for (size_t i = 0; i < f->nodes; i++)
		to[f->place[by_row ? from[i].iy : from[i].ix]++] = from[i];
}

/* Whether one node is before another in the order of the rows. */
static int is_before(const struct stress_node *a, int iy, int ix)
{
	return a->iy < iy || (a->iy == iy && a->ix < ix);
}

/* The first node of a region, as far as known. */
static size_t first_of(size_t *before, size_t node)
{
	while (before[node] != node)
		node = before[node] = before[before[node]];
	return node;
}

static void join(size_t *before, size_t a, size_t b)
{
	a = first_of(before, a);
	b = first_of(before, b);
	before[a > b ? a : b] = a < b ? a : b;
}

static int is_at(const struct stress_node *a, int iy, int ix)
{
	return a->iy == iy && a->ix == ix;
}

/* Joins each node with those on its left and above it, unless these are joined. */
static void join_nodes(struct footprints *f)
{
	const struct stress_node *node = f->node, *above = node;

	for (size_t i = 0; i < f->nodes; i++) {
		int ix = node[i].ix, iy = node[i].iy;
		int left = i > 0 && is_at(&node[i - 1], iy, ix - 1);

		f->region[i] = left ? f->region[i - 1] : i;
		while (is_before(above, iy - 1, ix))
			above++;
		if (is_at(above, iy - 1, ix) &&
			!(left && above > node && is_at(above - 1, iy - 1, ix - 1)))
			join(f->region, (size_t)(above - node), i);
	}
}

static void take_node(struct footprints *f, struct footprint *r, struct stress_node n)
{
	const struct stress_par *s = &f->par;
	double x = n.ix * s->dx, y = n.iy * s->dy;

	r->cells++;
	r->border += debris_border(s, (size_t)n.ix, (size_t)n.iy);
	r->stress = larger_double(r->stress, n.value);
	r->x += x + 0.5 * s->dx;
	r->y += y + 0.5 * s->dy;
	r->low[0] = lesser_double(r->low[0], x);
	r->low[1] = lesser_double(r->low[1], y);
	r->high[0] = larger_double(r->high[0], x + s->dx);
	r->high[1] = larger_double(r->high[1], y + s->dy);
}

/* The regions in the order of their first nodes. */
static enum num_status list_regions(struct footprints *f)
{
	f->count = 0;
	for (size_t i = 0; i < f->nodes; i++) {
		if (f->region[i] < i) {
			f->region[i] = f->region[f->region[i]];
		} else {
			if (room_for(&f->list, &f->list_room, f->count + 1,
				    sizeof *f->list))
				return NUM_MEMORY;
			f->list[f->count] = (struct footprint){
				.first = (size_t)f->node[i].iy * (size_t)f->par.nx +
					 (size_t)f->node[i].ix,
				.low = { INFINITY, INFINITY },
				.high = { -INFINITY, -INFINITY }
			};
			f->region[i] = f->count++;
		}
		take_node(f, &f->list[f->region[i]], f->node[i]);
	}
	return NUM_OK;
}

/* The nodes of each region, which stay in order. */
static enum num_status list_cells(struct footprints *f)
{
	if (room_for(&f->next, &f->next_room, f->count + 1, sizeof *f->next))
		return NUM_MEMORY;
	for (size_t k = 0; k < f->count; k++) {
		struct footprint *r = &f->list[k];

		f->next[k] = r->cells;
		r->area = (double)r->cells * f->par.dx * f->par.dy;
		r->x /= (double)r->cells;
		r->y /= (double)r->cells;
	}
	find_places(f->next, f->count);
	for (size_t i = 0; i < f->nodes; i++)
		f->cell[f->next[f->region[i]]++] = i;
	return NUM_OK;
}

static enum num_status find_regions(struct footprints *f)
{
	size_t n = f->nodes + 1;

	if (room_for(&f->spare, &f->spare_room, n, sizeof *f->spare) ||
		room_for(&f->region, &f->region_room, n, sizeof *f->region) ||
		room_for(&f->cell, &f->cell_room, n, sizeof *f->cell))
		return NUM_MEMORY;
	sort_nodes(f, f->node, f->spare, 0);
	sort_nodes(f, f->spare, f->node, 1);
	join_nodes(f);
	return list_regions(f) ? NUM_MEMORY : list_cells(f);
}

static int by_size(const void *a, const void *b)
{
	const struct footprint *f = a, *g = b;

	if (f->cells != g->cells)
		return f->cells < g->cells ? 1 : -1;
	return f->first < g->first ? -1 : f->first > g->first;
}

/* Every other row from right to left, so that neighbours follow each other. */
static void turn_rows(const struct footprints *f, size_t *cell, size_t n)
{
	for (size_t i = 0, end; i < n; i = end) {
		int row = f->node[cell[i]].iy;

		for (end = i; end < n && f->node[cell[end]].iy == row; end++)
			;
		for (size_t a = i, z = end; row % 2 && a + 1 < z; a++) {
			size_t swap = cell[a];

			cell[a] = cell[--z];
			cell[z] = swap;
		}
	}
}

static double reserve_below(const struct footprints *f, struct stress_node n, int k)
{
	return reserve(f->yield, point_sum_at(f->below, n.ix, n.iy, k));
}

/* Takes the reserve g at the next depth z.  Returns the depth at which it has passed 1
 * since the one before, or a negative number. */
static double next_depth(struct reserve *r, double z, double g)
{
	*r = (struct reserve){ r->depths < 3 ? r->depths + 1 : 3, { z, r->z[0], r->z[1] },
		{ g, r->g[0], r->g[1] } };
	return g > 1 ? reserve_crossing(r) : reserve_dip(r);
}

/* Below a cell: the depth of the loss, and its change with a relative one of the stress.
 * With one of margin it ends at another depth. */
struct loss {
	double depth, change, margin, other;
};

/* Takes note of a reserve that nearly reaches 1, or hardly exceeds it. */
static void note_tie(struct loss *loss, double peak, double other)
{
	double margin = 2 * fabs(peak - 1);

	if (margin < fmin(loss->margin, TIE)) {
		loss->margin = margin;
		loss->other = other;
	}
}

/* Where a cell ends in depths k and deeper if it does not where the reserve exceeds 1 a
 * little, up to peak: only depths after that count. */
static void look_on(const struct footprints *f, struct stress_node n, int k,
	struct reserve r, double peak, struct loss *loss)
{
	double z = -1, top;

	for (; r.g[0] > 1 && k < f->deepest && 2 * (peak - 1) < TIE; k++) {
		next_depth(&r, point_sum_depth(f->below, k), reserve_below(f, n, k));
		peak = fmax(fmax(peak, r.g[0]), reserve_peak(&r, &top));
	}
	r.depths = 1;
	for (; z < 0 && k < f->deepest && 2 * (peak - 1) < TIE; k++)
		z = next_depth(&r, point_sum_depth(f->below, k), reserve_below(f, n, k));
	if (z >= 0)
		note_tie(loss, peak, z);
}

/* The first depth at which the stress below a cell is the yield stress.  From the surface
 * down: below a film that fails there may be material that holds, above more that fails,
 * and friction may leave a thin layer nearly without stress.  nan: deeper than allowed.
 */
static struct loss loss_below(const struct footprints *f, struct stress_node n)
{
	struct reserve r = { 1, { 0 }, { reserve(f->yield, n.value) } };
	struct loss loss = { NAN, NAN, INFINITY, NAN };

	for (int k = 0; k < f->deepest; k++) {
		double g = reserve_below(f, n, k), top = NAN, peak;
		double z = next_depth(&r, point_sum_depth(f->below, k), g);

		peak = reserve_peak(&r, &top);
		if (z >= 0) {
			loss.depth = z;
			loss.change = 0.5 / reserve_slope(&r, z);
			look_on(f, n, k + 1, r, fmax(g, peak), &loss);
			break;
		}
		if (r.g[1] > fmax(g, r.g[2]))
			note_tie(&loss, peak, top);
	}
	return loss;
}

/* By careful sums where others do not decide. */
static struct loss decide(struct footprints *f, struct stress_node n)
{
	struct loss loss = loss_below(f, n);

	if (loss.margin < INFINITY) {
		point_sum_take_care(f->below, 1);
		loss = loss_below(f, n);
		point_sum_take_care(f->below, 0);
	}
	return loss;
}

/* Checks the sums at one of evenly spread cells; this one stands for so many. */
static void check(
	struct footprints *f, struct stress_node n, struct loss loss, double cells)
{
	double step = fmax(1, (double)f->nodes / CHECKS), off;
	double place = floor(f->passed / step + 0.5);

	f->passed += cells;
	if (floor(f->passed / step + 0.5) == place)
		return;
	point_sum_take_care(f->below, 1);
	off = loss_below(f, n).depth - loss.depth;
	point_sum_take_care(f->below, 0);
	f->checks++;
	f->squares += off * off / (loss.change * loss.change);
}

/* Cell i of m evenly spaced ones of n, from a start in [0, 1). */
static double place_of(size_t i, double start, double n, size_t m)
{
	return floor(((double)i + start) * n / (double)m);
}

static void measure(struct footprints *f, struct footprint *r, size_t *cell)
{
	double n = (double)r->cells, sum = 0, bends = 0, depth[3] = { 0 }, change = 0;
	double part = fmax(sqrt(n), SHARE * n / (double)f->nodes);
	size_t m = (size_t)fmin(n, ceil(fmax(LEAST, part)));
	/* The same place in every region would be deeper, or less deep, than others: the
	 * multiples of the golden ratio fill [0, 1) evenly. */
	double start = (double)(r - f->list) * 0.6180339887498949;
	double before, at, after, squares = 0, jumps = 0;

	start -= floor(start);
	turn_rows(f, cell, r->cells);
	at = place_of(0, start, n, m);
	before = place_of(m - 1, start, n, m) - n;
	for (size_t i = 0; i < m; i++, before = at, at = after) {
		struct loss loss = decide(f, f->node[cell[(size_t)at]]);
		double bend, weight;

		after = place_of(i + 1, start, n, m);
		weight = (after - before) / 2;
		check(f, f->node[cell[(size_t)at]], loss, weight);
		depth[2] = depth[1];
		depth[1] = depth[0];
		depth[0] = loss.depth;
		bend = depth[0] - 2 * depth[1] + depth[2];
		bends += i > 1 ? bend * bend : 0;
		sum += weight * depth[0];
		change += weight * loss.change;
		squares += (weight - 1) * (weight - 1);
		if (loss.margin < INFINITY)
			jumps += pow(weight * (loss.other - loss.depth), 2) *
				 erfc(loss.margin / (M_SQRT2 * DECIDED)) / 2;
	}
	r->volume = r->area * sum / n;
	r->change = r->area * change / n;
	r->jumps = r->area * sqrt(jumps) / n;
	/* By the trapezoidal rule over the order of the rows, closed to a ring, a cell
	 * left out has the mean depth of its neighbours in the sample.  Rows at both ends
	 * are shallow: mirrored ends weigh them less than others.  Second differences
	 * tell the error even where steps of one and two cells alternate.  Those of
	 * independent depths are six times their variance. */
	if (m < r->cells) {
		double variance = bends / (6 * (double)(m - 2));

		r->error = r->area * sqrt(variance * (n - (double)m + squares)) / n;
		r->freedom = (double)(m - 2);
	}
}

/* The cells that fail at the surface. */
static enum num_status find_nodes(struct footprints *f, struct stress *stress)
{
	size_t spans, most = 0;

	if (room_for(&f->span, &f->span_room, stress_spans_max(stress), sizeof *f->span))
		return NUM_MEMORY;
	spans = stress_reach_surface(stress, f->yield, f->span);
	for (size_t i = 0; i < spans; i++)
		most += (size_t)(f->span[i].end - f->span[i].begin);
	if (room_for(&f->node, &f->node_room, most + 1, sizeof *f->node))
		return NUM_MEMORY;
	return stress_above(stress, f->yield, f->span, spans, f->node, &f->nodes);
}

enum num_status footprints_find(struct footprints *f, struct stress *stress,
	const double *pressure, double yield, const struct footprint **list,
	size_t *count)
{
	size_t at = 0, runs;
	const struct stress_span *loads = stress_loads(stress, &runs);

	*count = 0;
	f->yield = yield;
	if (find_nodes(f, stress) || find_regions(f) ||
		point_sum_load(f->below, pressure, loads, runs))
		return NUM_MEMORY;
	f->passed = f->checks = f->squares = 0;
	for (size_t i = 0; i < f->count; at += f->list[i++].cells)
		measure(f, &f->list[i], f->cell + at);
	for (size_t i = 0; i < f->count; i++)
		f->list[i].sums = f->list[i].change *
				  hypot(CAREFUL_ERROR, sqrt(f->squares / f->checks));
	if (f->count > 0) /* else there may be no list */
		qsort(f->list, f->count, sizeof *f->list, by_size);
	*list = f->list;
	*count = f->count;
	return NUM_OK;
}
