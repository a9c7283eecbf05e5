#include "stress/narrow.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/room.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells to the side of a square; cells within which loads are added one by one: of the
 * contact of 7403 particles on 1536 x 1536 cells, of which 88000 fail, 348000, 214000,
 * 162000 and 150000 are left with 6, 10, 16 and 28, and the work grows with the square.
 * Nodes between two runs that are taken with them: with 0, 2 and 4 the surrogate takes
 * the same time within 2 %. */
enum { SQUARE = 8, CLOSE = 10, GAP = 4 };

/* Nodes close to a load in a row, filled up to three vectors of eight. */
enum { ACROSS = 24 };
_Static_assert(2 * CLOSE + 1 <= ACROSS, "loads are close to more nodes");

/* Of sums of up to a thousand loads in single precision. */
static const double ROUNDING = 1e-4;

struct load {
	int x;
	double value;
};

struct narrowing {
	const struct narrow *n;
	struct load *load;
	size_t *row;       /* the first load of each row, and the end */
	int nx, ny, apart; /* squares; between those in reach of each other */
	double *ring;      /* of each square: the bound for loads that are not close */
	/* Of the nodes of a row of squares, the first of each row at CLOSE: the sum for
	 * those that are; what one of them adds on each row. */
	float *close, size[2 * CLOSE + 1][ACROSS];
	size_t stride;
	struct stress_span *span;
	size_t load_room, span_room, count;
};

static enum num_status list_loads(struct narrowing *w)
{
	const struct narrow *n = w->n;
	size_t count = 0, k = 0;

	for (int y = 0; y < n->wy; y++) {
		const double *row = n->load + (size_t)y * n->stride;

		w->row[y] = count;
		for (; k < n->runs && n->run[k].y == y + n->y0; k++) {
			int begin = n->run[k].begin - n->x0, end = n->run[k].end - n->x0;

			if (room_for(&w->load, &w->load_room,
				    count + (size_t)(end - begin), sizeof *w->load))
				return NUM_MEMORY;
			for (int x = begin; x < end; x++)
				w->load[count++] =
					(struct load){ x, fabs(n->scale * row[x]) };
		}
	}
	w->row[n->wy] = count;
	return NUM_OK;
}

/* The largest stress by a load so many squares away that is not close. */
static double largest(const struct narrow *n, int i, int j)
{
	int width = 2 * n->reach + 1;
	double most = 0;

	for (int y = larger_int(-n->reach, (j - 1) * SQUARE + 1);
		y <= n->reach && y < (j + 1) * SQUARE; y++)
		for (int x = larger_int(-n->reach, (i - 1) * SQUARE + 1);
			x <= n->reach && x < (i + 1) * SQUARE; x++)
			if (abs(x) > CLOSE || abs(y) > CLOSE)
				most = fmax(most,
					n->size[(y + n->reach) * width + x + n->reach]);
	return most;
}

static enum num_status bound_rings(struct narrowing *w)
{
	const struct narrow *n = w->n;
	int apart = w->apart, width = 2 * apart + 1;
	double *most = malloc((size_t)(width * width) * sizeof *most);
	double *sum = calloc((size_t)w->nx, sizeof *sum);

	for (int k = 0; most && k < width * width; k++)
		most[k] = largest(n, k % width - apart, k / width - apart);
	for (int j = 0; most && sum && j < w->ny; j++) {
		size_t end = w->row[lesser_int((j + 1) * SQUARE, n->wy)];

		memset(sum, 0, (size_t)w->nx * sizeof *sum);
		for (size_t k = w->row[j * SQUARE]; k < end; k++)
			sum[w->load[k].x / SQUARE] += w->load[k].value;
		for (int i = 0; i < w->nx; i++) {
			int left = larger_int(i - apart, 0),
			    right = lesser_int(i + apart + 1, w->nx);

			for (int v = larger_int(j - apart, 0);
				sum[i] > 0 && v <= j + apart && v < w->ny; v++)
				for (int u = left; u < right; u++)
					w->ring[v * w->nx + u] +=
						sum[i] * most[(v - j + apart) * width +
								 u - i + apart];
		}
	}
	free(sum);
	free(most);
	return most && sum ? NUM_OK : NUM_MEMORY;
}

/* What a unit load adds to the rows of nodes close to it. */
static void know_close(struct narrowing *w)
{
	const struct narrow *n = w->n;
	int width = 2 * n->reach + 1;

	for (int j = -CLOSE; j <= CLOSE; j++)
		memcpy(w->size[j + CLOSE],
			n->size + (j + n->reach) * width + n->reach - CLOSE,
			(2 * CLOSE + 1) * sizeof(float));
}

/* to += load from, for eight nodes. */
static ALWAYS_INLINE void add_eight(float *to, float load, const float *from)
{
	eight a, b;

	memcpy(&a, to, sizeof a);
	memcpy(&b, from, sizeof b);
	a += load * b;
	memcpy(to, &a, sizeof a);
}

/* The sums for the rows [y0, y1). */
LANES_CLONES static void add_close(struct narrowing *w, int y0, int y1)
{
	memset(w->close, 0, w->stride * SQUARE * sizeof *w->close);
	for (int y = larger_int(y0 - CLOSE, 0); y < lesser_int(y1 + CLOSE, w->n->wy);
		y++) {
		int top = larger_int(y - CLOSE, y0), end = lesser_int(y + CLOSE + 1, y1);

		for (size_t k = w->row[y]; k < w->row[y + 1]; k++) {
			const float *from = w->size[top - y + CLOSE];
			float *to =
				w->close + (size_t)(top - y0) * w->stride + w->load[k].x;
			float load = (float)w->load[k].value;

			/* Loops are not unrolled at -O2. */
			for (int v = top; v < end; v++, to += w->stride, from += ACROSS) {
				add_eight(to, load, from);
				add_eight(to + 8, load, from + 8);
				add_eight(to + 16, load, from + 16);
			}
		}
	}
}

static enum num_status add_run(struct narrowing *w, int y, int begin, int end)
{
	struct stress_span *last = w->count > 0 ? &w->span[w->count - 1] : NULL;

	if (last && last->y == y && begin - last->end <= GAP) {
		last->end = end;
		return NUM_OK;
	}
	if (room_for(&w->span, &w->span_room, w->count + 1, sizeof *w->span))
		return NUM_MEMORY;
	w->span[w->count++] = (struct stress_span){ y, begin, end };
	return NUM_OK;
}

/* The part of a span, counted from the first cell, that lies in a square with the stress
 * that the loads close to it may add. */
static enum num_status narrow_piece(
	struct narrowing *w, int y, int begin, int end, double rest)
{
	const struct narrow *n = w->n;
	const float *close = w->close + (size_t)(y % SQUARE) * w->stride + CLOSE;

	for (int x = begin; x < end; x++) {
		int first = x;

		while (x < end && close[x] > rest)
			x++;
		if (x > first && add_run(w, y + n->y0, first + n->x0, x + n->x0))
			return NUM_MEMORY;
	}
	return NUM_OK;
}

static enum num_status narrow_span(struct narrowing *w, const struct stress_span *s)
{
	const struct narrow *n = w->n;
	int begin = s->begin - n->x0, stop = s->end - n->x0, y = s->y - n->y0;
	size_t row = (size_t)(y / SQUARE) * (size_t)w->nx;

	for (int end; begin < stop; begin = end) {
		end = lesser_int(stop, (begin / SQUARE + 1) * SQUARE);
		if (narrow_piece(
			    w, y, begin, end, w->ring[row + (size_t)(begin / SQUARE)]))
			return NUM_MEMORY;
	}
	return NUM_OK;
}

/* Turns the bounds for loads that are not close into what the others may add at most. */
static void find_rest(struct narrowing *w, int j, int y0, int y1)
{
	const struct narrow *n = w->n;

	for (int i = 0; i < w->nx; i++) {
		double *ring = &w->ring[j * w->nx + i];

		*ring = n->limit * (1 - ROUNDING) - *ring -
			lattice_most(n->far, i * SQUARE,
				lesser_int((i + 1) * SQUARE, n->wx), y0, y1);
	}
}

static enum num_status narrow_rows(
	struct narrowing *w, const struct stress_span *from, size_t count)
{
	const struct narrow *n = w->n;
	size_t at = 0;

	for (int j = 0; j < w->ny; j++) {
		int y0 = j * SQUARE, y1 = lesser_int(y0 + SQUARE, n->wy);

		if (at == count || from[at].y - n->y0 >= y1)
			continue;
		add_close(w, y0, y1);
		find_rest(w, j, y0, y1);
		for (; at < count && from[at].y - n->y0 < y1; at++)
			if (narrow_span(w, &from[at]))
				return NUM_MEMORY;
	}
	return NUM_OK;
}

enum num_status narrow_spans(const struct narrow *n, const struct stress_span *from,
	size_t count, struct stress_span **span, size_t *number)
{
	struct narrowing w = { .n = n,
		.nx = (n->wx + SQUARE - 1) / SQUARE,
		.ny = (n->wy + SQUARE - 1) / SQUARE,
		.apart = (n->reach + SQUARE - 1) / SQUARE,
		.stride = (size_t)n->wx + ACROSS };
	enum num_status status = NUM_MEMORY;

	w.row = malloc(((size_t)n->wy + 1) * sizeof *w.row);
	w.ring = calloc((size_t)w.nx * (size_t)w.ny, sizeof *w.ring);
	w.close = malloc(w.stride * SQUARE * sizeof *w.close);
	know_close(&w);
	if (w.row && w.ring && w.close && !list_loads(&w) && !bound_rings(&w))
		status = narrow_rows(&w, from, count);
	free(w.load);
	free(w.row);
	free(w.ring);
	free(w.close);
	if (status)
		free(w.span);
	*span = status ? NULL : w.span;
	*number = status ? 0 : w.count;
	return status;
}
