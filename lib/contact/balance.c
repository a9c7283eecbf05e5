#include "contact/balance.h"
#include "contact/state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Measured on 64 x 4096 and 16 x 8192 cells, white noise at 3 to 60 % contact, and on the
 * strips of tests/long/exact.c; without balance 21 to 149 and 17 to 106 iterations. */
enum {
	/* Cells a side of a square.  Smaller ones have too few contacts to share a load
	 * among: in strips of 3 cells the iterations doubled with squares of any length.
	 */
	NARROWEST = 16,
	/* Newton steps for the shifts: 2, 4 and 8 take as many iterations within a tenth,
	 * but at 60 % of 16 x 8192 76, 62 and 64. */
	STEPS = 4
};
/* Part of a step that may be misplaced: from 0 to 0.3 noise takes 16 to 62 iterations
 * alike, with 0.5 up to 84; patches, whose steps hardly need it, take the fewer the
 * higher it is. */
static const double tolerated = 0.3;

struct square {
	double wanted; /* sum of the unbounded step */
	double sum;    /* of the bounded one */
	double free;   /* cells that it leaves free */
	double shift;
};

struct balance {
	size_t nx, ny, length, squares;
	int along_x, is_periodic;
	double *line; /* shift at each place along the strip */
	struct square *square;

	/* of the call in progress */
	struct contact *c;
	double sign; /* of the shift to add */
};

enum num_status balance_new(const struct contact_par *par, struct balance **made)
{
	int along_x = par->nx * par->dx > par->ny * par->dy;
	double width = along_x ? par->ny * par->dy : par->nx * par->dx;
	double length = along_x ? par->nx * par->dx : par->ny * par->dy;
	size_t cells = (size_t)(along_x ? par->nx : par->ny);
	size_t squares = (size_t)(length / width);
	struct balance *b;

	*made = NULL;
	if (squares < 3 || cells / squares < NARROWEST ||
		(along_x ? par->ny : par->nx) < NARROWEST)
		return NUM_OK;
	b = calloc(1, sizeof *b);
	if (!b)
		return NUM_MEMORY;
	b->nx = (size_t)par->nx;
	b->ny = (size_t)par->ny;
	b->length = cells;
	b->squares = squares;
	b->along_x = along_x;
	b->is_periodic = par->boundary == CONTACT_PERIODIC;
	b->line = calloc(cells, sizeof *b->line);
	b->square = calloc(squares, sizeof *b->square);
	if (!b->line || !b->square) {
		balance_free(b);
		return NUM_MEMORY;
	}
	*made = b;
	return NUM_OK;
}

void balance_free(struct balance *b)
{
	if (b) {
		free(b->line);
		free(b->square);
	}
	free(b);
}

/* Cells of a square: rows y0 to y1 - 1, columns x0 to x1 - 1. */
struct range {
	size_t x0, x1, y0, y1;
};

static struct range square_range(const struct balance *b, size_t k)
{
	size_t begin = k * b->length / b->squares;
	size_t end = (k + 1) * b->length / b->squares;

	return b->along_x ? (struct range){ begin, end, 0, b->ny }
			  : (struct range){ 0, b->nx, begin, end };
}

static void sum_wanted(void *context, size_t k, int worker)
{
	struct balance *b = context;
	const struct contact *c = b->c;
	struct range r = square_range(b, k);
	double load = 0, step = 0;

	(void)worker;
	for (size_t y = r.y0; y < r.y1; y++)
		for (size_t i = y * b->nx + r.x0; i < y * b->nx + r.x1; i++) {
			load += c->p[i];
			step += c->active[i] ? c->image[i] + c->shift : 0;
		}
	b->square[k] = (struct square){ .wanted = fmax(c->tau * step, -load) };
}

static void sum_bounded(void *context, size_t k, int worker)
{
	struct balance *b = context;
	const struct contact *c = b->c;
	struct range r = square_range(b, k);
	double sum = 0, count = 0;

	(void)worker;
	for (size_t y = r.y0; y < r.y1; y++)
		for (size_t x = r.x0; x < r.x1; x++) {
			size_t i = y * b->nx + x;
			double shift = c->shift + b->line[b->along_x ? x : y], next;

			if (!c->active[i])
				continue;
			next = within(c, c->p[i] + c->tau * (c->image[i] + shift));
			sum += next - c->p[i];
			count += is_free(c, next);
		}
	b->square[k].sum = sum;
	b->square[k].free = count;
}

static void add_line(void *context, size_t k, int worker)
{
	struct balance *b = context;
	struct contact *c = b->c;
	struct range r = square_range(b, k);

	(void)worker;
	for (size_t y = r.y0; y < r.y1; y++)
		for (size_t x = r.x0; x < r.x1; x++)
			c->image[y * b->nx + x] += b->sign * b->line[b->along_x ? x : y];
}

static void for_squares(struct balance *b, struct contact *c,
	void (*job)(void *context, size_t k, int worker))
{
	b->c = c;
	pool_run(c->par.pool, b->squares, job, b);
}

/* Linear between the centres of the squares. */
static void draw_line(struct balance *b)
{
	size_t last = b->squares - 1;

	for (size_t i = 0; i < b->length; i++) {
		double at =
			((double)i + 0.5) * (double)b->squares / (double)b->length - 0.5;
		double below = floor(at);
		size_t low = below >= 0 ? (size_t)below : b->is_periodic ? last : 0;
		size_t high = below < (double)last ? (size_t)(below + 1)
			      : b->is_periodic     ? 0
						   : last;
		double from = b->square[low].shift, to = b->square[high].shift;

		b->line[i] = from + (at - below) * (to - from);
	}
}

int balance_direction(struct balance *b, struct contact *c, double size)
{
	double missed = 0;

	memset(b->line, 0, b->length * sizeof *b->line);
	for_squares(b, c, sum_wanted);
	for_squares(b, c, sum_bounded);
	for (size_t k = 0; k < b->squares; k++)
		missed += fabs(b->square[k].wanted - b->square[k].sum);
	if (!(missed > tolerated * size))
		return 0;
	for (int n = 0; n < STEPS; n++) {
		for (size_t k = 0; k < b->squares; k++) {
			struct square *s = &b->square[k];

			if (s->free > 0)
				s->shift += (s->wanted - s->sum) / (c->tau * s->free);
		}
		draw_line(b);
		if (n + 1 < STEPS)
			for_squares(b, c, sum_bounded);
	}
	b->sign = 1;
	for_squares(b, c, add_line);
	return 1;
}

void balance_undo(struct balance *b, struct contact *c)
{
	b->sign = -1;
	for_squares(b, c, add_line);
}
