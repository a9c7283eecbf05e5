#include "contact/mlms.h"
#include "num/fft.h"
#include "num/lesser.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	ORDER_MAX = 12,
	LEVELS_MAX = 40,
	/* Cells a side to sum directly.  Free contacts of 200 and 512 cells a side take
	 * the same time within its scatter with 12, 24 and 48, and 1.6 times it with 96.
	 */
	COARSEST = 24,
	/* Rows in one job of a thread.  bemcontact on 512 x 512 free cells, 3 % loaded,
	 * takes 1.06 s of processor time with 16, and 1.36, 1.17, 1.19, 1.28 s with 1, 4,
	 * 64 and 256 (least of three runs). */
	ROWS = 16
};

typedef double (*kernel_value)(const void *context, size_t ix, size_t iy);

struct level {
	size_t nx, ny;
	int depth_x, depth_y; /* a step here is 2^depth cells of the finest level */
	int halve_x, halve_y; /* directions in which the next level is coarser */
	int reach_x, reach_y; /* of the corrections, cells */
	double *source;       /* finest: the caller's x */
	double *image;        /* finest: the caller's y */
	double *half;        /* between the levels: ny rows as long as the next level's */
	size_t *begin, *end; /* of the sources of each row that are not zero */
	double *near;        /* corrections [parity y][parity x][offset y][offset x] of
			      * sources at even and odd places; coarsest: K itself */
};

struct mlms {
	int order, levels;
	double weight[ORDER_MAX]; /* Lagrange's, for the middle between two nodes */
	struct level level[LEVELS_MAX];
	struct pool *pool;
	int now; /* level of the call in progress */
	const double *x;
	double *y;
};

/* The coarse grid reaches order / 2 nodes beyond the fine one, so that the same weights
 * apply up to its edge. */
static size_t coarse_size(size_t n, int order)
{
	return (n - 1) / 2 + (size_t)order;
}

static int worth_halving(size_t n, int order)
{
	return n > COARSEST && coarse_size(n, order) * 4 <= n * 3;
}

static void set_weights(struct mlms *m)
{
	for (int k = 0; k < m->order; k++) {
		double w = 1;

		/* Nodes at odd places 1 - order .. order - 1, value at 0. */
		for (int j = 0; j < m->order; j++)
			if (j != k)
				w *= (double)(m->order - 1 - 2 * j) / (2 * (k - j));
		m->weight[k] = w;
	}
}

/* Positions, relative to a cell, of the coarse nodes that represent it, and their
 * weights.
 */
struct nodes {
	int n, place[ORDER_MAX];
	double weight[ORDER_MAX];
};

static struct nodes nodes_of(const struct mlms *m, int odd)
{
	struct nodes s = { .n = 1, .weight = { 1 } };

	for (int k = 0; odd && k < m->order; k++) {
		s.n = m->order;
		s.place[k] = 2 * k - (m->order - 1);
		s.weight[k] = m->weight[k];
	}
	return s;
}

/* K less its interpolation between a source of some parity and a cell at an offset.
 * table: K at offsets of this level, rows of width. */
static double missing(const struct mlms *m, const double *table, size_t width,
	const int odd[4], int dx, int dy)
{
	struct nodes sx = nodes_of(m, odd[0]), sy = nodes_of(m, odd[1]);
	struct nodes tx = nodes_of(m, odd[2]), ty = nodes_of(m, odd[3]);
	double sum = table[(size_t)abs(dy) * width + (size_t)abs(dx)];

	for (int a = 0; a < sy.n; a++)
		for (int b = 0; b < ty.n; b++) {
			size_t y = (size_t)abs(dy + ty.place[b] - sy.place[a]);
			double row = 0;

			for (int c = 0; c < sx.n; c++)
				for (int d = 0; d < tx.n; d++)
					row += sx.weight[c] * tx.weight[d] *
					       table[y * width +
						       (size_t)abs(dx + tx.place[d] -
								   sx.place[c])];
			sum -= sy.weight[a] * ty.weight[b] * row;
		}
	return sum;
}

/* The corrections of one level. */
static enum num_status make_near(
	struct mlms *m, struct level *l, kernel_value value, const void *context)
{
	size_t width = (size_t)l->reach_x + 2 * (size_t)m->order, out = 0;
	size_t height = (size_t)l->reach_y + 2 * (size_t)m->order;
	double *table = fft_alloc(width * height);

	l->near = fft_alloc(
		4 * (size_t)(2 * l->reach_x + 1) * (size_t)(2 * l->reach_y + 1));
	if (!table || !l->near) {
		fft_free(table);
		return NUM_MEMORY;
	}
	for (size_t i = 0; i < width * height; i++)
		table[i] = value(
			context, (i % width) << l->depth_x, (i / width) << l->depth_y);
	for (int parity = 0; parity < 4; parity++)
		for (int dy = -l->reach_y; dy <= l->reach_y; dy++)
			for (int dx = -l->reach_x; dx <= l->reach_x; dx++) {
				int px = parity & 1, py = parity >> 1;
				int odd[4] = { l->halve_x && px, l->halve_y && py,
					l->halve_x && ((px + dx) & 1),
					l->halve_y && ((py + dy) & 1) };

				l->near[out++] = missing(m, table, width, odd, dx, dy);
			}
	fft_free(table);
	return NUM_OK;
}

static enum num_status make_coarsest(
	struct level *l, kernel_value value, const void *context)
{
	l->near = fft_alloc(l->nx * l->ny);
	if (!l->near)
		return NUM_MEMORY;
	for (size_t i = 0; i < l->nx * l->ny; i++)
		l->near[i] = value(
			context, (i % l->nx) << l->depth_x, (i / l->nx) << l->depth_y);
	return NUM_OK;
}

/* No farther than the grid. */
static int reach_of(double cells, size_t n)
{
	return cells < (double)n ? (int)ceil(cells - 1e-9) : (int)n - 1;
}

/* Where the cells of a level are twice as long as wide or more, only their short sides
 * are doubled, as long as these have enough cells. */
static void choose_coarser(
	const struct mlms *m, struct level *l, double aspect, double reach)
{
	double hx = ldexp(1, l->depth_x), hy = ldexp(aspect, l->depth_y), widest;
	int x = worth_halving(l->nx, m->order), y = worth_halving(l->ny, m->order);

	l->halve_x = x && !(y && hx >= 2 * hy);
	l->halve_y = y && !(x && hy >= 2 * hx);
	widest = fmax(l->halve_x ? hx : 0, l->halve_y ? hy : 0);
	l->reach_x = reach_of(reach * widest / hx, l->nx);
	l->reach_y = reach_of(reach * widest / hy, l->ny);
}

static enum num_status make_levels(struct mlms *m, size_t nx, size_t ny, double aspect,
	double reach, kernel_value value, const void *context)
{
	int depth_x = 0, depth_y = 0;

	for (int k = 0; k < LEVELS_MAX; k++) {
		struct level *l = &m->level[k];

		m->levels = k + 1;
		l->nx = nx;
		l->ny = ny;
		l->depth_x = depth_x;
		l->depth_y = depth_y;
		if (k > 0) {
			l->source = fft_alloc(nx * ny);
			l->image = fft_alloc(nx * ny);
			if (!l->source || !l->image)
				return NUM_MEMORY;
		}
		choose_coarser(m, l, aspect, reach);
		if (!l->halve_x && !l->halve_y)
			return make_coarsest(l, value, context);
		l->begin = calloc(2 * ny, sizeof *l->begin);
		if (!l->begin)
			return NUM_MEMORY;
		l->end = l->begin + ny;
		if (make_near(m, l, value, context) != 0)
			return NUM_MEMORY;
		nx = l->halve_x ? coarse_size(nx, m->order) : nx;
		l->half = fft_alloc(nx * ny);
		if (!l->half)
			return NUM_MEMORY;
		ny = l->halve_y ? coarse_size(ny, m->order) : ny;
		depth_x += l->halve_x;
		depth_y += l->halve_y;
	}
	return NUM_MEMORY;
}

struct mlms *mlms_new(size_t nx, size_t ny, double aspect, int order, int reach,
	kernel_value value, const void *context, struct pool *pool)
{
	struct mlms *m = calloc(1, sizeof *m);

	if (!m)
		return NULL;
	m->order = order < 2 ? 2 : order > ORDER_MAX ? ORDER_MAX : order / 2 * 2;
	m->pool = pool;
	set_weights(m);
	if (make_levels(m, nx, ny, aspect, reach < 1 ? 1 : reach, value, context) != 0) {
		mlms_free(m);
		return NULL;
	}
	return m;
}

void mlms_free(struct mlms *m)
{
	if (!m)
		return;
	for (int k = 0; k < m->levels; k++) {
		fft_free(m->level[k].source);
		fft_free(m->level[k].image);
		fft_free(m->level[k].half);
		fft_free(m->level[k].near);
		free(m->level[k].begin);
	}
	free(m);
}

/* Cell i of the fine level lies on node i / 2 + order / 2 - 1 of the coarse one, or
 * between the nodes from i / 2 on. */
static void gather_row(const struct mlms *m, const double *fine, size_t n, double *coarse)
{
	size_t shift = (size_t)m->order / 2 - 1;

	memset(coarse, 0, coarse_size(n, m->order) * sizeof *coarse);
	for (size_t i = 0; i < n; i += 2)
		coarse[i / 2 + shift] += fine[i];
	for (size_t i = 1; i < n; i += 2)
		for (int k = 0; k < m->order && fine[i] != 0; k++)
			coarse[i / 2 + (size_t)k] += m->weight[k] * fine[i];
}

static void spread_row(const struct mlms *m, const double *coarse, size_t n, double *fine)
{
	size_t shift = (size_t)m->order / 2 - 1;

	for (size_t i = 0; i < n; i += 2)
		fine[i] = coarse[i / 2 + shift];
	for (size_t i = 1; i < n; i += 2) {
		double sum = 0;

		for (int k = 0; k < m->order; k++)
			sum += m->weight[k] * coarse[i / 2 + (size_t)k];
		fine[i] = sum;
	}
}

static void add_row(double *to, double w, const double *from, size_t n)
{
	for (size_t i = 0; i < n; i++)
		to[i] += w * from[i];
}

static size_t half_length(const struct mlms *m, const struct level *l)
{
	return l->halve_x ? coarse_size(l->nx, m->order) : l->nx;
}

/* Notes where the sources of a row begin and end. */
static void find_sources(struct level *l, const double *row, size_t y)
{
	size_t begin = 0, end = l->nx;

	while (begin < end && row[begin] == 0)
		begin++;
	while (end > begin && row[end - 1] == 0)
		end--;
	l->begin[y] = begin;
	l->end[y] = end;
}

/* Sources of a level along x into its half array. */
static void gather_x(void *context, size_t job, int worker)
{
	struct mlms *m = context;
	struct level *l = &m->level[m->now];
	const double *source = m->now ? l->source : m->x;
	size_t n = half_length(m, l);

	(void)worker;
	for (size_t y = job * ROWS; y < lesser((job + 1) * ROWS, l->ny); y++) {
		find_sources(l, source + y * l->nx, y);
		if (l->halve_x)
			gather_row(m, source + y * l->nx, l->nx, l->half + y * n);
		else
			memcpy(l->half + y * n, source + y * n, n * sizeof *source);
	}
}

/* ... and along y into the next level: each of its rows takes the fine row on it and
 * the odd rows around. */
static void gather_y(void *context, size_t job, int worker)
{
	struct mlms *m = context;
	struct level *l = &m->level[m->now], *next = l + 1;
	size_t n = next->nx, shift = (size_t)m->order / 2 - 1;

	(void)worker;
	for (size_t y = job * ROWS; y < lesser((job + 1) * ROWS, next->ny); y++) {
		double *to = next->source + y * n;

		if (!l->halve_y) {
			memcpy(to, l->half + y * n, n * sizeof *to);
			continue;
		}
		memset(to, 0, n * sizeof *to);
		if (y >= shift && 2 * (y - shift) < l->ny)
			add_row(to, 1, l->half + 2 * (y - shift) * n, n);
		for (size_t k = 0; k < (size_t)m->order && k <= y; k++)
			if (2 * (y - k) + 1 < l->ny)
				add_row(to, m->weight[k], l->half + (2 * (y - k) + 1) * n,
					n);
	}
}

/* Corrections of a row of sources for a row of cells. */
static void add_near(
	const struct level *l, const double *source, size_t ys, double *image, size_t y)
{
	size_t reach = (size_t)l->reach_x, side = 2 * reach + 1;
	size_t over = (size_t)l->reach_y;

	for (size_t x = l->begin[ys]; x < l->end[ys]; x++) {
		size_t parity = (ys & 1) * 2 + (x & 1);
		size_t first = x > reach ? x - reach : 0;
		size_t last = lesser(x + reach + 1, l->nx);
		const double *near =
			l->near + (parity * (2 * over + 1) + over + y - ys) * side;

		if (source[x] != 0)
			add_row(image + first, source[x], near + (first + reach - x),
				last - first);
	}
}

/* Images of the next level spread over some rows, and corrected. */
static void spread(void *context, size_t job, int worker)
{
	struct mlms *m = context;
	struct level *l = &m->level[m->now], *next = l + 1;
	const double *source = m->now ? l->source : m->x;
	size_t n = next->nx, reach = (size_t)l->reach_y, shift = (size_t)m->order / 2 - 1;

	(void)worker;
	for (size_t y = job * ROWS; y < lesser((job + 1) * ROWS, l->ny); y++) {
		double *image = (m->now ? l->image : m->y) + y * l->nx;
		double *half = l->half + y * n;
		size_t first = y > reach ? y - reach : 0;

		memset(half, 0, n * sizeof *half);
		if (!l->halve_y)
			add_row(half, 1, next->image + y * n, n);
		else if (y % 2 == 0)
			add_row(half, 1, next->image + (y / 2 + shift) * n, n);
		else
			for (size_t k = 0; k < (size_t)m->order; k++)
				add_row(half, m->weight[k], next->image + (y / 2 + k) * n,
					n);
		if (l->halve_x)
			spread_row(m, half, l->nx, image);
		else
			memcpy(image, half, n * sizeof *half);
		for (size_t ys = first; ys < lesser(y + reach + 1, l->ny); ys++)
			add_near(l, source + ys * l->nx, ys, image, y);
	}
}

static void sum_directly(void *context, size_t job, int worker)
{
	struct mlms *m = context;
	struct level *l = &m->level[m->now];
	const double *source = m->now ? l->source : m->x;
	size_t nx = l->nx;

	(void)worker;
	for (size_t y = job * ROWS; y < lesser((job + 1) * ROWS, l->ny); y++) {
		double *image = (m->now ? l->image : m->y) + y * nx;

		memset(image, 0, nx * sizeof *image);
		for (size_t ys = 0; ys < l->ny; ys++) {
			const double *k = l->near + (y > ys ? y - ys : ys - y) * nx;

			for (size_t xs = 0; xs < nx; xs++) {
				double x = source[ys * nx + xs];

				for (size_t i = 0; x != 0 && i < nx; i++)
					image[i] += x * k[i > xs ? i - xs : xs - i];
			}
		}
	}
}

static void run_rows(
	struct mlms *m, size_t rows, void (*job)(void *context, size_t i, int worker))
{
	pool_run(m->pool, (rows + ROWS - 1) / ROWS, job, m);
}

void mlms_apply(struct mlms *m, const double *x, double *y)
{
	int last = m->levels - 1;

	m->x = x;
	m->y = y;
	for (m->now = 0; m->now < last; m->now++) {
		run_rows(m, m->level[m->now].ny, gather_x);
		run_rows(m, m->level[m->now + 1].ny, gather_y);
	}
	run_rows(m, m->level[last].ny, sum_directly);
	for (m->now = last - 1; m->now >= 0; m->now--)
		run_rows(m, m->level[m->now].ny, spread);
}
