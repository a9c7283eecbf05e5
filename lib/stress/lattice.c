#include "stress/lattice.h"
#include "num/dot.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ORDER: also in sum_points() and sum_rows(). */
enum { ORDER = 8, SIDE = ORDER / 2 - 1 };

/* Points to the side of a square that share a bound.  Surrogates of 128 x 128 to
 * 1024 x 1024 cells take the same time within its scatter, 5 %, with 2 to 8. */
enum { SQUARE = 4 };

struct line {
	struct lattice_axis axis;
	int *start;              /* first of the points around a cell, may be negative */
	double (*gather)[ORDER]; /* weights of a cell */
	double (*spread)[ORDER];
};

struct lattice {
	struct line x, y;
	struct pool *pool;
};

struct lattice_axis lattice_free(int cells, int spacing)
{
	/* Four points beyond either end: the stencils of the outermost cells. */
	int points = (cells - 1 + spacing - 1) / spacing + 1 + ORDER;

	return (struct lattice_axis){ cells, points, spacing, 0 };
}

struct lattice_axis lattice_periodic(int cells, int points)
{
	return (struct lattice_axis){ cells, points, (double)cells / points, 1 };
}

double lattice_origin(const struct lattice_axis *a)
{
	return a->wrap ? 0.5 * (a->spacing - 1)
		       : 0.5 * (a->cells - 1) - 0.5 * (a->points - 1) * a->spacing;
}

/* Adds share times the weights at t, in points from the first of the stencil. */
static void add_weights(double t, double share, double weight[ORDER])
{
	for (int k = 0; k < ORDER; k++) {
		double w = share;

		for (int m = 0; m < ORDER; m++)
			if (m != k)
				w *= (t - m) / (k - m);
		weight[k] += w;
	}
}

/* Four Gauss points on [-1/2, 1/2]; sums of two of them are spread like an element. */
static void add_element(double t, double spacing, double weight[ORDER])
{
	static const double node[4] = { -0.43056815579702628761, -0.16999052179242813253,
		0.16999052179242813253, 0.43056815579702628761 };
	static const double part[4] = { 0.17392742256872692869, 0.32607257743127307131,
		0.32607257743127307131, 0.17392742256872692869 };

	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++)
			add_weights(t + (node[i] + node[j]) / spacing, part[i] * part[j],
				weight);
}

static enum num_status line_new(struct line *l, const struct lattice_axis *axis)
{
	size_t n = (size_t)axis->cells;
	double origin = lattice_origin(axis);

	l->axis = *axis;
	l->start = malloc(n * sizeof *l->start);
	l->gather = calloc(n, sizeof *l->gather);
	l->spread = calloc(n, sizeof *l->spread);
	if (!l->start || !l->gather || !l->spread)
		return NUM_MEMORY;
	for (int i = 0; i < axis->cells; i++) {
		double t = (i - origin) / axis->spacing;
		int start = (int)floor(t) - SIDE;

		l->start[i] = start;
		/* Offsets by whole spacings have the same weights. */
		if (!axis->wrap && i >= (int)axis->spacing) {
			const int same = i - (int)axis->spacing;

			memcpy(l->gather[i], l->gather[same], sizeof *l->gather);
			memcpy(l->spread[i], l->spread[same], sizeof *l->spread);
			continue;
		}
		add_weights(t - start, 1, l->gather[i]);
		add_element(t - start, axis->spacing, l->spread[i]);
	}
	return NUM_OK;
}

static void line_free(struct line *l)
{
	free(l->start);
	free(l->gather);
	free(l->spread);
}

struct lattice *lattice_new(
	const struct lattice_axis *x, const struct lattice_axis *y, struct pool *pool)
{
	struct lattice *l = calloc(1, sizeof *l);

	if (!l)
		return NULL;
	l->pool = pool;
	if (line_new(&l->x, x) || line_new(&l->y, y)) {
		lattice_done(l);
		return NULL;
	}
	return l;
}

void lattice_done(struct lattice *l)
{
	if (!l)
		return;
	line_free(&l->x);
	line_free(&l->y);
	free(l);
}

/* to += w from, for ORDER points */
static ALWAYS_INLINE void add_points(double *to, double w, const double *from)
{
	lanes4 a, b, sum;

	for (int i = 0; i < ORDER; i += 4) {
		memcpy(&a, from + i, sizeof a);
		memcpy(&b, to + i, sizeof b);
		sum = b + w * a;
		memcpy(to + i, &sum, sizeof sum);
	}
}

/* A row of cells onto a row of points; 0 if all are zero. */
LANES_CLONES static int spread_row(const struct line *l, const double *cell, double scale,
	int element, double *restrict row)
{
	size_t cells = (size_t)l->axis.cells, x = lanes_next(cell, 0, cells);

	if (x == cells)
		return 0;
	memset(row, 0, (size_t)l->axis.points * sizeof *row);
	for (; x < cells; x = lanes_next(cell, x + 1, cells)) {
		const double *w = element ? l->spread[x] : l->gather[x];

		add_points(row + l->start[x], scale * cell[x], w);
	}
	return 1;
}

/* A row of points onto ORDER rows, where it is not zero: most of it is, as few cells are
 * loaded. */
LANES_CLONES static void spread_column(
	const double *row, size_t points, const double w[ORDER], double *to)
{
	size_t i = lanes_next(row, 0, points);

	for (; i + ORDER <= points; i = lanes_next(row, i + ORDER, points))
		for (size_t j = 0; j < ORDER; j++)
			add_points(to + j * points + i, w[j], row + i);
	for (; i < points; i++)
		for (size_t j = 0; j < ORDER; j++)
			to[j * points + i] += w[j] * row[i];
}

enum num_status lattice_spread(const struct lattice *l, const double *cell, size_t stride,
	double scale, int element, double *load)
{
	size_t points = (size_t)l->x.axis.points;
	double *row = malloc(points * sizeof *row);

	if (!row)
		return NUM_MEMORY;
	for (int y = 0; y < l->y.axis.cells; y++) {
		const double *w = element ? l->y.spread[y] : l->y.gather[y];

		if (spread_row(&l->x, cell + (size_t)y * stride, scale, element, row))
			spread_column(
				row, points, w, load + (size_t)l->y.start[y] * points);
	}
	free(row);
	return NUM_OK;
}

struct lattice_gather {
	const struct lattice *l;
	double *const *field;
	int x0, y0;
	const struct stress_want *want;
	double *scratch; /* for each worker and number, a row of points and of cells */
	size_t room;
	/* Largest equivalent stress interpolated from points in each square; NULL: none
	 * is asked for. */
	double *most;
	size_t squares; /* in a row */
};

static int wrapped(const struct lattice_axis *a, int i)
{
	int n = a->points;

	return a->wrap ? ((i % n) + n) % n : i;
}

static ALWAYS_INLINE void add_four(lanes4 *sum, double weight, const double *from)
{
	lanes4 x;

	memcpy(&x, from, sizeof x);
	*sum += weight * x;
}

/* Point i, or i and i + 1, of eight rows together. */
static inline lanes sum_rows(
	const double *const f[ORDER], const double *w, int i, const int n)
{
	return w[0] * lanes_load(f[0] + i, n) + w[1] * lanes_load(f[1] + i, n) +
	       w[2] * lanes_load(f[2] + i, n) + w[3] * lanes_load(f[3] + i, n) +
	       w[4] * lanes_load(f[4] + i, n) + w[5] * lanes_load(f[5] + i, n) +
	       w[6] * lanes_load(f[6] + i, n) + w[7] * lanes_load(f[7] + i, n);
}

/* The points of a row of cells: those of eight rows together. */
LANES_CLONES static void combine_rows(const struct lattice *l, const double *field, int y,
	int from, int to, double *row)
{
	const struct line *lx = &l->x, *ly = &l->y;
	size_t points = (size_t)lx->axis.points;
	const double *f[ORDER], *w = ly->gather[y];

	for (int j = 0; j < ORDER; j++)
		f[j] = field + (size_t)wrapped(&ly->axis, ly->start[y] + j) * points;
	if (lx->axis.wrap) {
		for (int i = from; i < to; i++) {
			int at = wrapped(&lx->axis, i);

			row[i - from] = 0;
			for (int j = 0; j < ORDER; j++)
				row[i - from] += w[j] * f[j][at];
		}
		return;
	}
	for (; from + 4 <= to; from += 4, row += 4) {
		lanes4 sum;

		memcpy(&sum, f[0] + from, sizeof sum);
		sum *= w[0];
		add_four(&sum, w[1], f[1] + from);
		add_four(&sum, w[2], f[2] + from);
		add_four(&sum, w[3], f[3] + from);
		add_four(&sum, w[4], f[4] + from);
		add_four(&sum, w[5], f[5] + from);
		add_four(&sum, w[6], f[6] + from);
		add_four(&sum, w[7], f[7] + from);
		memcpy(row, &sum, sizeof sum);
	}
	for (; from + 1 < to; from += 2, row += 2)
		lanes_store(row, sum_rows(f, w, from, 2), 2);
	if (from < to)
		lanes_store(row, sum_rows(f, w, from, 1), 1);
}

/* A cell from the points of its row. */
static inline double sum_points(const double *p, const double *w)
{
	return w[0] * p[0] + w[1] * p[1] + w[2] * p[2] + w[3] * p[3] + w[4] * p[4] +
	       w[5] * p[5] + w[6] * p[6] + w[7] * p[7];
}

/* Cells begin to end - 1 of a row, from its points after the first from.  Cells a whole
 * spacing apart have the same weights. */
LANES_CLONES static void interpolate(
	const struct line *l, int begin, int end, const double *row, int from, double *to)
{
	int step = l->axis.wrap ? end - begin : (int)l->axis.spacing;

	for (int first = begin; first < end && first < begin + step; first++) {
		const double *w = l->gather[first], *p = row + (l->start[first] - from);
		double *at = to + (first - begin);
		int count = (end - first + step - 1) / step;

		for (; count >= 4; count -= 4, p += 4, at += 4 * step) {
			lanes4 sum;

			memcpy(&sum, p, sizeof sum);
			sum *= w[0];
			add_four(&sum, w[1], p + 1);
			add_four(&sum, w[2], p + 2);
			add_four(&sum, w[3], p + 3);
			add_four(&sum, w[4], p + 4);
			add_four(&sum, w[5], p + 5);
			add_four(&sum, w[6], p + 6);
			add_four(&sum, w[7], p + 7);
			at[0] = sum[0];
			at[step] = sum[1];
			at[2 * step] = sum[2];
			at[3 * step] = sum[3];
		}
		for (; count > 0; count--, p++, at += step)
			*at = sum_points(p, w);
	}
}

/* Largest sum of the sizes of a cell's weights. */
static double largest_weight(const struct line *l)
{
	double most = 0;

	for (int i = 0; i < l->axis.cells; i++) {
		double sum = 0;

		for (int k = 0; k < ORDER; k++)
			sum += fabs(l->gather[i][k]);
		most = fmax(most, sum);
	}
	return most;
}

/* The largest equivalent stress of numbers up to these: a norm is largest in a corner. */
static double largest_size(const struct stress_want *want, const double *most)
{
	double size = 0;

	for (int signs = 0; signs < 1 << (want->numbers - 1); signs++) {
		double number[STRESS_NUMBERS] = { 0 };

		for (int c = 0; c < want->numbers; c++)
			number[c] = signs >> c & 1 ? -most[c] : most[c];
		size = fmax(size, want->size(want->context, number));
	}
	return size;
}

/* The largest size of one number of the points [begin, end) in each square of a row;
 * step: between squares. */
static void take_most(const double *row, int begin, int end, double *most, size_t step)
{
	for (int x = begin, stop; x < end; x = stop) {
		double *to = &most[(size_t)(x / SQUARE) * step];
		lanes size = lanes_all(*to);

		stop = lesser_int((x / SQUARE + 1) * SQUARE, end);
		for (; x + 2 <= stop; x += 2)
			size = lanes_max(lanes_abs(lanes_load(row + x, 2)), size);
		if (x < stop)
			size = lanes_max(lanes_abs(lanes_load(row + x, 1)), size);
		*to = larger_double(size[0], size[1]);
	}
}

/* As in squares without a point that is wanted: most of them where little is loaded. */
static int is_zero(const double *x, size_t n)
{
	while (n > 0 && x[n - 1] == 0)
		n--;
	return n == 0;
}

/* The equivalent stress of a weighted sum is at most the sum of the weights' sizes times
 * the largest one. */
static enum num_status find_most(
	struct lattice_gather *g, const struct stress_want *points, size_t squares)
{
	const struct stress_want *want = g->want;
	size_t nx = (size_t)g->l->x.axis.points, numbers = (size_t)want->numbers;
	double weight = largest_weight(&g->l->x) * largest_weight(&g->l->y);
	double *most = calloc(squares * numbers, sizeof *most);

	if (!most)
		return NUM_MEMORY;
	for (size_t k = 0; k < points->count; k++) {
		const struct stress_span *s = &points->span[k];
		size_t first = (size_t)s->y / SQUARE * g->squares;

		for (size_t c = 0; c < numbers; c++)
			take_most(g->field[c] + (size_t)s->y * nx, s->begin, s->end,
				most + first * numbers + c, numbers);
	}
	for (size_t i = 0; i < squares; i++)
		g->most[i] = is_zero(most + i * numbers, numbers)
				     ? 0
				     : weight * largest_size(want, most + i * numbers);
	free(most);
	return NUM_OK;
}

struct lattice_gather *lattice_gather_new(const struct lattice *l, double *const *field,
	int x0, int y0, const struct stress_want *want, const struct stress_want *points)
{
	size_t rows = ((size_t)l->y.axis.points + SQUARE - 1) / SQUARE;
	struct lattice_gather *g = calloc(1, sizeof *g);

	if (!g)
		return NULL;
	*g = (struct lattice_gather){
		.l = l, .field = field, .x0 = x0, .y0 = y0, .want = want
	};
	g->room = (size_t)l->x.axis.points + ORDER +
		  (size_t)want->numbers * (size_t)l->x.axis.cells;
	g->scratch = malloc(g->room * (size_t)pool_threads(l->pool) * sizeof *g->scratch);
	g->squares = ((size_t)l->x.axis.points + SQUARE - 1) / SQUARE;
	if (want->size && points)
		g->most = malloc(g->squares * rows * sizeof *g->most);
	if (!g->scratch ||
		(want->size && points &&
			(!g->most || find_most(g, points, g->squares * rows)))) {
		lattice_gather_free(g);
		return NULL;
	}
	return g;
}

void lattice_gather_free(struct lattice_gather *g)
{
	if (!g)
		return;
	free(g->scratch);
	free(g->most);
	free(g);
}

/* The sums of a part from a node of a span on; NULL: zero. */
static const double *part_at(const struct stress_part *part, int number, int x, int y)
{
	return part && part->number
		       ? part->number[number] + (size_t)(y - part->y0) * part->stride +
				 (x - part->x0)
		       : NULL;
}

/* Nodes of one span; part: sums to be added, or NULL. */
static void gather_run(const struct lattice_gather *g, const struct stress_span *span,
	const struct stress_part *part, int worker)
{
	const struct line *lx = &g->l->x;
	double *row = g->scratch + (size_t)worker * g->room;
	double *at = row + lx->axis.points + ORDER;
	const double *number[STRESS_NUMBERS] = { NULL };
	int begin = span->begin - g->x0, end = span->end - g->x0, y = span->y - g->y0;
	int from = lx->start[begin], to = lx->start[end - 1] + ORDER;

	for (int c = 0; c < g->want->numbers; c++, at += end - begin) {
		number[c] = at;
		combine_rows(g->l, g->field[c], y, from, to, row);
		interpolate(lx, begin, end, row, from, at);
		if (part && part->number)
			add_scaled(
				at, 1, part_at(part, c, begin, y), (size_t)(end - begin));
	}
	g->want->put(g->want->context, span, number);
}

double lattice_most(const struct lattice_gather *g, int x0, int x1, int y0, int y1)
{
	const struct line *lx = &g->l->x, *ly = &g->l->y;
	size_t left = (size_t)lx->start[x0] / SQUARE,
	       right = (size_t)(lx->start[x1 - 1] + ORDER - 1) / SQUARE,
	       low = (size_t)ly->start[y0] / SQUARE,
	       high = (size_t)(ly->start[y1 - 1] + ORDER - 1) / SQUARE;
	double most = 0;

	for (size_t j = low; j <= high; j++)
		for (size_t i = left; i <= right; i++) {
			double m = g->most[j * g->squares + i];

			most = m > most ? m : most;
		}
	return most;
}

void lattice_gather_part(
	const struct lattice_gather *g, const struct stress_part *part, int worker)
{
	const struct stress_want *want = g->want;
	int left = part->x0 + g->x0, right = part->x1 + g->x0, top = part->y1 + g->y0;

	for (const struct stress_span *next = span_first(want, part->y0 + g->y0);
		next < want->span + want->count && next->y < top; next++) {
		struct stress_span s = *next;

		s.begin = s.begin > left ? s.begin : left;
		s.end = s.end < right ? s.end : right;
		if (s.begin < s.end)
			gather_run(g, &s, part, worker);
	}
}

static void gather_job(void *context, size_t job, int worker)
{
	const struct lattice_gather *g = context;

	gather_run(g, &g->want->span[job], NULL, worker);
}

enum num_status lattice_gather(const struct lattice *l, double *const *field, int x0,
	int y0, const struct stress_want *want)
{
	struct lattice_gather *g = lattice_gather_new(l, field, x0, y0, want, NULL);

	if (!g)
		return NUM_MEMORY;
	pool_run(l->pool, want->count, gather_job, g);
	lattice_gather_free(g);
	return NUM_OK;
}

enum num_status lattice_points(const struct lattice *l, const struct stress_span *span,
	size_t count, int x0, int y0, struct stress_span **points, size_t *number)
{
	size_t nx = (size_t)l->x.axis.points, ny = (size_t)l->y.axis.points, n = 0;
	char *mark = calloc(nx, ny);
	struct stress_span *list = malloc((nx + 1) / 2 * ny * sizeof *list);

	*points = list;
	if (!mark || !list) {
		free(mark);
		return NUM_MEMORY;
	}
	for (size_t k = 0; k < count; k++) {
		int from = l->x.start[span[k].begin - x0],
		    to = l->x.start[span[k].end - 1 - x0] + ORDER;
		char *row = mark + (size_t)l->y.start[span[k].y - y0] * nx + from;

		for (int j = 0; j < ORDER; j++, row += nx)
			memset(row, 1, (size_t)(to - from));
	}
	for (size_t y = 0; y < ny; y++) {
		const char *row = mark + y * nx, *end = row + nx, *at = row;

		while ((at = memchr(at, 1, (size_t)(end - at))) != NULL) {
			const char *stop = memchr(at, 0, (size_t)(end - at));

			stop = stop ? stop : end;
			list[n++] = (struct stress_span){ (int)y, (int)(at - row),
				(int)(stop - row) };
			at = stop;
		}
	}
	free(mark);
	*number = n;
	return NUM_OK;
}
