#include "stress/lattice.h"
#include "num/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ORDER = 8, SIDE = ORDER / 2 - 1 };

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

/* A row of cells onto a row of points; 0 if all are zero. */
static int spread_row(
	const struct line *l, const double *cell, int element, double *restrict row)
{
	int any = 0;

	memset(row, 0, (size_t)l->axis.points * sizeof *row);
	for (int x = 0; x < l->axis.cells; x++) {
		const double *w = element ? l->spread[x] : l->gather[x];
		double value = cell[x], *to = row + l->start[x];

		if (value == 0)
			continue;
		any = 1;
		for (int i = 0; i < ORDER; i++)
			to[i] += value * w[i];
	}
	return any;
}

enum num_status lattice_spread(const struct lattice *l, const double *cell, size_t stride,
	int element, double *load)
{
	size_t points = (size_t)l->x.axis.points;
	double *row = malloc(points * sizeof *row);

	if (!row)
		return NUM_MEMORY;
	for (int y = 0; y < l->y.axis.cells; y++) {
		const double *wy = element ? l->y.spread[y] : l->y.gather[y];
		double *restrict to = load + (size_t)l->y.start[y] * points;

		if (!spread_row(&l->x, cell + (size_t)y * stride, element, row))
			continue;
		for (int j = 0; j < ORDER; j++, to += points)
			for (size_t i = 0; i < points; i++)
				to[i] += wy[j] * row[i];
	}
	free(row);
	return NUM_OK;
}

struct gather {
	const struct lattice *l;
	double *const *field, *const *more;
	size_t stride;
	int x0, y0;
	const struct stress_want *want;
	double *scratch; /* for each worker and number, a row of points and of cells */
	size_t room;
};

static int wrapped(const struct lattice_axis *a, int i)
{
	int n = a->points;

	return a->wrap ? ((i % n) + n) % n : i;
}

/* The points of a row of cells: those of eight rows together. */
static void combine_rows(const struct lattice *l, const double *field, int y, int from,
	int to, double *row)
{
	const struct line *lx = &l->x, *ly = &l->y;
	size_t points = (size_t)lx->axis.points;

	memset(row, 0, (size_t)(to - from) * sizeof *row);
	for (int j = 0; j < ORDER; j++) {
		const double *f =
			field + (size_t)wrapped(&ly->axis, ly->start[y] + j) * points;
		double w = ly->gather[y][j];

		if (lx->axis.wrap)
			for (int i = from; i < to; i++)
				row[i - from] += w * f[wrapped(&lx->axis, i)];
		else
			for (int i = from; i < to; i++)
				row[i - from] += w * f[i];
	}
}

static double interpolate(const struct line *l, int cell, const double *row)
{
	const double *p = row + l->start[cell], *w = l->gather[cell];
	double sum = 0;

	for (int k = 0; k < ORDER; k++)
		sum += w[k] * p[k];
	return sum;
}

static void gather_span(void *context, size_t job, int worker)
{
	const struct gather *g = context;
	const struct line *lx = &g->l->x;
	const struct stress_span *span = &g->want->span[job];
	double *scratch = g->scratch + (size_t)worker * g->room;
	double *row = scratch, *at = scratch + lx->axis.points + ORDER;
	const double *number[STRESS_NUMBERS] = { NULL };
	int begin = span->begin - g->x0, end = span->end - g->x0, y = span->y - g->y0;
	int from = lx->start[begin], to = lx->start[end - 1] + ORDER;

	for (int c = 0; c < g->want->numbers; c++) {
		const double *more = g->more ? g->more[c] + (size_t)y * g->stride : NULL;

		number[c] = at;
		combine_rows(g->l, g->field[c], y, from, to, row);
		for (int x = begin; x < end; x++, at++) {
			*at = interpolate(lx, x, row - from) + (more ? more[x] : 0);
		}
	}
	g->want->put(g->want->context, span, number);
}

enum num_status lattice_gather(const struct lattice *l, double *const *field,
	double *const *more, size_t stride, int x0, int y0,
	const struct stress_want *want)
{
	struct gather g = { l, field, more, stride, x0, y0, want, NULL, 0 };

	g.room = (size_t)l->x.axis.points + ORDER +
		 (size_t)want->numbers * (size_t)l->x.axis.cells;
	g.scratch = malloc(g.room * (size_t)pool_threads(l->pool) * sizeof *g.scratch);
	if (!g.scratch)
		return NUM_MEMORY;
	pool_run(l->pool, want->count, gather_span, &g);
	free(g.scratch);
	return NUM_OK;
}

enum num_status lattice_refine(const struct lattice *l, const double *field, double *cell)
{
	double *row = malloc((size_t)l->x.axis.points * sizeof *row);

	if (!row)
		return NUM_MEMORY;
	for (int y = 0; y < l->y.axis.cells; y++) {
		combine_rows(l, field, y, 0, l->x.axis.points, row);
		for (int x = 0; x < l->x.axis.cells; x++)
			*cell++ += interpolate(&l->x, x, row);
	}
	free(row);
	return NUM_OK;
}
