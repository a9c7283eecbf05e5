/* The load of small blocks of cells in a bounded step.  Bounds cut off what a step takes
 * from cells near the edge of the contact.  Where the contact is rough down to the cells,
 * much of the step is cut off; restored evenly over the grid, it misplaces load at every
 * distance, which displaces far more than the step itself.  It is therefore restored
 * close by, in the other cells of the block. */
#include "contact/state.h"
#include "num/lesser.h"
#include <math.h>
#include <string.h>

/* Cells.  Six contacts of 2048 x 2048 cells that are rough down to the cells take 17 to
 * 26 iterations without blocks, 15 to 19 with 2 and 14 to 16 with 3; with 4, where some
 * blocks have too few free cells for their load, two take 32 and 45. */
enum { SIDE = 3 };

/* Cells x0 to x1 - 1 of rows y0 to y1 - 1. */
struct block {
	size_t x0, x1, y0, y1;
};

/* A step of the active cells of a block. */
struct carried {
	double wanted, bounded; /* sums without and with the bounds */
	double load;            /* that the cells carry */
	int cells, free;        /* active; of them between the bounds after the step */
};

static struct carried sum_block(
	const struct contact *c, const struct block *b, double shift)
{
	struct carried s = { 0 };

	for (size_t y = b->y0; y < b->y1; y++)
		for (size_t x = b->x0; x < b->x1; x++) {
			size_t i = y * (size_t)c->par.nx + x;
			double p = c->p[i], step, next;

			if (!c->active[i])
				continue;
			step = c->tau * (c->image[i] + shift);
			next = within(c, p + step);
			s.wanted += step;
			s.bounded += next - p;
			s.load += p;
			s.cells++;
			s.free += is_free(c, next);
		}
	return s;
}

/* A shift that takes every active cell of the block well past its bound: at the bound,
 * rounding would decide which cells stay in contact, and the result would differ from
 * that of the same contact in other units. */
static double emptying_shift(const struct contact *c, const struct block *b, double load)
{
	double shift = c->shift;

	for (size_t y = b->y0; y < b->y1; y++)
		for (size_t x = b->x0; x < b->x1; x++) {
			size_t i = y * (size_t)c->par.nx + x;
			double d = c->image[i];

			if (c->active[i])
				shift = fmin(shift, -(c->p[i] + load) / c->tau - d -
							    fabs(d + c->shift));
		}
	return shift;
}

/* Newton's method on a sum that is linear in the shift until a cell meets its bound:
 * exact as soon as none does. */
static void keep_block(struct contact *c, const struct block *b)
{
	double shift = c->shift;
	struct carried s = sum_block(c, b, shift);
	double wanted = s.wanted;
	int last = s.cells;

	if (s.free == s.cells)
		return;
	if (wanted <= -s.load)
		shift = emptying_shift(c, b, s.load);
	else
		for (int k = 0; k < s.cells && s.free > 0 && s.free != last; k++) {
			last = s.free;
			shift += (wanted - s.bounded) / (c->tau * s.free);
			s = sum_block(c, b, shift);
		}
	for (size_t y = b->y0; y < b->y1; y++)
		for (size_t x = b->x0; x < b->x1; x++)
			c->image[y * (size_t)c->par.nx + x] += shift - c->shift;
}

/* Where the first block from column x on with active cells begins, or nx. */
static size_t next_active(const struct contact *c, const struct block *rows, size_t x)
{
	size_t nx = (size_t)c->par.nx, first = nx;

	for (size_t y = rows->y0; y < rows->y1 && x < first; y++) {
		const unsigned char *a = c->active + y * nx;
		const unsigned char *found = memchr(a + x, 1, first - x);

		if (found)
			first = (size_t)(found - a);
	}
	return first < nx ? first - first % SIDE : nx;
}

static void keep_rows(void *context, size_t job, int worker)
{
	struct contact *c = context;
	size_t nx = (size_t)c->par.nx, ny = (size_t)c->par.ny;
	struct block b = { .y0 = job * SIDE, .y1 = lesser((job + 1) * SIDE, ny) };

	(void)worker;
	for (b.x0 = next_active(c, &b, 0); b.x0 < nx; b.x0 = next_active(c, &b, b.x1)) {
		b.x1 = lesser(b.x0 + SIDE, nx);
		keep_block(c, &b);
	}
}

void contact_keep_load(struct contact *c)
{
	pool_run(c->par.pool, ((size_t)c->par.ny + SIDE - 1) / SIDE, keep_rows, c);
}
