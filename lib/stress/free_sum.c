#include "stress/free_sum.h"
#include "num/dot.h"
#include "num/lesser.h"
#include "num/pages.h"
#include "num/status.h"
#include "stress/lattice.h"
#include "stress/narrow.h"
#include "stress/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	/* Points to the radius of the window that finer points sum.  Below 30 contacts of
	 * 180 x 180 cells 10, 12 and 14 leave 8e-6, 3e-6 and 1e-6 of the largest
	 * pressure.  A wear step takes 5 to 7 % fewer instructions with 12 than with 14.
	 */
	INNER = 12,
	OUTER = 2 * INNER, /* to that of the next */
	RADIUS =
		2 * INNER, /* cells to the radius of the innermost, on every other cell */
	REACH = RADIUS +
		1,  /* radius of the part summed on the cells; the element adds one */
	CLOSE = 4,  /* cells within which elements take many points each */
	SMALL = 32, /* sides up to this are summed in full, which is no slower */
	/* Loads of a tile of which few nodes are left.  The surrogate takes the same time
	 * within 3 % with 128 to 512 (640 x 640 to 1536 x 1536 cells), with 64 up to 8 %
	 * more, and with 256 3 % more where 7 % of the cells fail. */
	NARROWED_FEW = 2 * WINDOW_FEW,
	COARSEST = 64, /* points per side that take no larger plane than a tile does */
	LEVELS = 20    /* of points, up to 2^20 cells a side */
};

/* Depth over the distance of points: interpolation through eight of them leaves 2e-4,
 * 4e-5, 1e-5 and 3e-6 of the largest pressure at 4, 5, 6 and 7 (tests/unit/stress.c, half
 * of the cells loaded). */
static const double SMOOTH = 7;

/* The elongation of cells up to which the window, round in cells, separates near from
 * far. */
static const double OBLONG = 2;

struct box {
	int x0, y0, wx, wy;
};

/* Memory of a level, kept from one layer to the next: taken anew, the system would clear
 * it every time. */
struct level_memory {
	double *values;
	size_t size; /* doubles */
};

struct free_sum {
	struct influence_par par;
	int nx, ny, full;
	struct pool *pool;
	const double *pressure;
	double scale;                    /* of loads over pressures */
	const struct stress_span *loads; /* runs of loaded cells */
	size_t load_count;
	struct stress_box box; /* of the loads */
	struct sum_work work;
	struct window_kept kept;
	struct influence close[CLOSE][CLOSE]; /* elements at the surface, if known */
	int close_known;
	/* Of the part summed on the cells, at the surface: the kernel, or NULL, and the
	 * equivalent stress by a unit load, in rows of 2 REACH + 1. */
	struct influence *inner;
	float *size;
	struct level_memory level[LEVELS];
};

struct free_sum *free_sum_new(
	const struct influence_par *par, int nx, int ny, int full, struct pool *pool)
{
	struct free_sum *s = calloc(1, sizeof *s);

	if (s)
		*s = (struct free_sum){
			.par = *par, .nx = nx, .ny = ny, .full = full, .pool = pool
		};
	return s;
}

void free_sum_free(struct free_sum *s)
{
	if (!s)
		return;
	window_forget(&s->kept);
	free(s->inner);
	free(s->size);
	for (int k = 0; k < LEVELS; k++)
		free(s->level[k].values);
	free(s);
}

struct sum_work free_sum_work(const struct free_sum *s)
{
	return s->work;
}

void free_sum_load(struct free_sum *s, const double *pressure, double scale,
	const struct stress_span *loads, size_t count, const struct stress_box *box)
{
	s->pressure = pressure;
	s->scale = scale;
	s->loads = loads;
	s->load_count = count;
	s->box = *box;
}

/* The cells of all loads and all nodes wanted. */
static struct box box_of(const struct free_sum *s, const struct stress_want *want)
{
	int x0 = s->box.x0, x1 = s->box.x1, y0 = s->box.y0, y1 = s->box.y1;

	for (size_t i = 0; i < want->count; i++) {
		x0 = lesser_int(x0, want->span[i].begin);
		x1 = larger_int(x1, want->span[i].end - 1);
		y0 = lesser_int(y0, want->span[i].y);
		y1 = larger_int(y1, want->span[i].y);
	}
	return (struct box){ x0, y0, x1 - x0 + 1, y1 - y0 + 1 };
}

static const double *corner(const struct free_sum *s, const struct box *b)
{
	return s->pressure + (size_t)b->y0 * (size_t)s->nx + (size_t)b->x0;
}

/* Influence for offsets 0 <= i < wx, 0 <= j < wy. */

enum source {
	ELEMENT,       /* of cells: all */
	ELEMENT_INNER, /* inside the innermost window */
	POINT,         /* of points: all */
	POINT_INNER,   /* inside the window of OUTER points */
	POINT_RING,    /* and outside that of INNER points */
	POINT_OUTER,   /* outside that of INNER points */
	SOURCES
};

struct kernel {
	struct free_sum *sum;
	enum source source;
	int wx;
	double dx, dy, z; /* offsets are multiples of these */
	struct influence *value;
};

static struct influence element_at(const struct kernel *k, int i, int j)
{
	const struct free_sum *s = k->sum;

	return k->z == 0 && s->close_known && i < CLOSE && j < CLOSE
		       ? s->close[j][i]
		       : influence_element(&s->par, i * k->dx, j * k->dy, k->z);
}

static struct influence kernel_value(const struct kernel *k, int i, int j)
{
	double x = i * k->dx, y = j * k->dy;
	const struct influence_par *p = &k->sum->par;
	double z = k->z, rx = RADIUS * p->dx, ry = RADIUS * p->dy;
	struct influence far;

	switch (k->source) {
	case ELEMENT:
		return element_at(k, i, j);
	case ELEMENT_INNER:
		far = influence_outer_element(p, x, y, z, rx, ry);
		return influence_less(element_at(k, i, j), &far);
	case POINT:
		return influence_point(p, x, y, z);
	case POINT_OUTER:
		return influence_outer_point(p, x, y, z, INNER * k->dx, INNER * k->dy);
	default:
		break;
	}
	far = influence_outer_point(p, x, y, z, OUTER * k->dx, OUTER * k->dy);
	return influence_less(
		k->source == POINT_INNER
			? influence_point(p, x, y, z)
			: influence_outer_point(p, x, y, z, INNER * k->dx, INNER * k->dy),
		&far);
}

static void kernel_row(void *context, size_t j, int worker)
{
	const struct kernel *k = context;

	(void)worker;
	for (int i = 0; i < k->wx; i++)
		k->value[j * (size_t)k->wx + (size_t)i] = kernel_value(k, i, (int)j);
}

static void know_close(struct free_sum *s)
{
	for (int j = 0; j < CLOSE && !s->close_known; j++)
		for (int i = 0; i < CLOSE; i++)
			s->close[j][i] = influence_element(
				&s->par, i * s->par.dx, j * s->par.dy, 0);
	s->close_known = 1;
}

static struct influence *make_kernel(void *context, int reach_x, int reach_y)
{
	struct kernel *k = context;
	size_t rows = (size_t)reach_y + 1, size;
	const struct influence *known = k->sum->inner;

	if (k->source <= ELEMENT_INNER && k->z == 0)
		know_close(k->sum);
	k->wx = reach_x + 1;
	size = (size_t)k->wx * rows * sizeof *k->value;
	k->value = malloc(size);
	if (k->value && known && k->source == ELEMENT_INNER && k->z == 0)
		return memcpy(k->value, known, size);
	if (k->value)
		pool_run(k->sum->pool, rows, kernel_row, k);
	k->sum->work.kernel_cells += (double)k->wx * (double)rows;
	return k->value;
}

/* Every contact needs the kernels of the surface itself; those of all depths would take
 * much memory. */
static int name_of(const struct free_sum *s, enum source source, double z, int cells)
{
	return z == 0 && !s->full ? (int)SOURCES * cells + (int)source : WINDOW_NAMELESS;
}

/* Convolution of loads with a kernel of the reach that the window has: a field for each
 * number. */
static enum num_status convolve(struct free_sum *s, enum source source, double z,
	int cells, const struct window *window)
{
	/* On the surface the stress of a point load falls with the square of the distance
	 * in every direction: points of all spacings share one kernel. */
	int apart = z == 0 && source >= POINT ? 1 : cells;
	struct kernel k = { .sum = s,
		.source = source,
		.dx = apart * s->par.dx,
		.dy = apart * s->par.dy,
		.z = z };
	struct window w = *window;
	enum num_status status;
	double transforms = 0;

	w.scale *= (double)apart * apart / ((double)cells * cells);
	w.par = &s->par;
	w.make = make_kernel;
	w.maker = &k;
	w.name = name_of(s, source, z, apart);
	w.pool = s->pool;
	status = window_sum(&w, &s->kept, &transforms);
	s->work.transforms += transforms;
	return status;
}

static void free_fields(double **field, int count)
{
	for (int c = 0; c < count; c++)
		free(field[c]);
}

static enum num_status new_fields(double **field, int count, size_t n)
{
	for (int c = 0; c < count; c++) {
		field[c] = calloc(n, sizeof **field);
		if (!field[c]) {
			free_fields(field, c);
			return NUM_MEMORY;
		}
	}
	return NUM_OK;
}

/* Sums of a window into fields with rows of stride. */
struct keep {
	double *const *field;
	size_t stride;
	int numbers;
};

static void keep_part(void *context, const struct stress_part *part, int worker)
{
	const struct keep *k = context;
	size_t width = (size_t)(part->x1 - part->x0);

	(void)worker;
	for (int c = 0; c < k->numbers; c++)
		for (int y = part->y0; y < part->y1; y++) {
			double *to = k->field[c] + (size_t)y * k->stride + part->x0;

			if (part->number)
				memcpy(to,
					part->number[c] +
						(size_t)(y - part->y0) * part->stride,
					width * sizeof *to);
			else
				memset(to, 0, width * sizeof *to);
		}
}

/* The full sum. */

struct hand_over {
	double *const *field;
	const struct box *box;
	const struct stress_want *want;
};

static void hand_span(void *context, size_t job, int worker)
{
	const struct hand_over *h = context;
	const struct stress_span *span = &h->want->span[job];
	const double *number[STRESS_NUMBERS] = { NULL };
	size_t at = (size_t)(span->y - h->box->y0) * (size_t)h->box->wx +
		    (size_t)(span->begin - h->box->x0);

	(void)worker;
	for (int c = 0; c < h->want->numbers; c++)
		number[c] = h->field[c] + at;
	h->want->put(h->want->context, span, number);
}

static enum num_status sum_full(
	struct free_sum *s, double z, const struct stress_want *want, const struct box *b)
{
	struct hand_over hand = { NULL, b, want };
	double *field[STRESS_NUMBERS];
	struct keep keep = { field, (size_t)b->wx, want->numbers };
	struct window w = { .mx = b->wx,
		.my = b->wy,
		.reach_x = b->wx - 1,
		.reach_y = b->wy - 1,
		.load = corner(s, b),
		.load_stride = (size_t)s->nx,
		.scale = s->scale,
		.few = WINDOW_FEW,
		.numbers = want->numbers,
		.take = keep_part,
		.context = &keep };
	enum num_status status;

	if (new_fields(field, want->numbers, (size_t)b->wx * (size_t)b->wy))
		return NUM_MEMORY;
	status = convolve(s, ELEMENT, z, 1, &w);
	hand.field = field;
	if (!status)
		pool_run(s->pool, want->count, hand_span, &hand);
	free_fields(field, want->numbers);
	s->work.full_layers++;
	return status;
}

/* Levels */

struct level {
	struct lattice_axis x, y;
	struct lattice *lattice; /* among the cells, or points, of the finer level */
	double *load, *field[STRESS_NUMBERS];
	int depth, numbers;      /* depth: 0 for the finest points */
	struct stress_want want; /* the points that wanted nodes are interpolated from */
	struct stress_span *span;
};

/* Memory of n doubles for a level; NULL: none.  Half as much again is not touched until a
 * larger part of the grid is loaded. */
static double *level_values(struct level_memory *m, size_t n)
{
	if (m->size < n) {
		free(m->values);
		m->size = n + n / 2;
		m->values = malloc(m->size * sizeof *m->values);
		m->size = m->values ? m->size : 0;
		pages_large(m->values, m->size * sizeof *m->values);
	}
	return m->values;
}

static void level_done(struct level *l)
{
	lattice_done(l->lattice);
	free(l->span);
}

/* Adds what is interpolated from coarser points to the fields of a level. */
static void add_span(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS])
{
	const struct level *l = context;
	size_t at = (size_t)span->y * (size_t)l->x.points + (size_t)span->begin;

	for (int c = 0; c < l->numbers; c++)
		add_scaled(l->field[c] + at, 1, number[c],
			(size_t)(span->end - span->begin));
}

/* Points every so many cells, or finer points, with their loads; want: the nodes among
 * these, from (x0, y0).  The fields receive the sums of a window on the points wanted. */
static enum num_status level_new(struct free_sum *s, struct level *l, int mx, int my,
	int spacing, const double *load, size_t stride, double scale, int element,
	const struct stress_want *want, int x0, int y0)
{
	size_t points;

	l->x = lattice_free(mx, spacing);
	l->y = lattice_free(my, spacing);
	points = (size_t)l->x.points * (size_t)l->y.points;
	l->load = level_values(&s->level[l->depth], (1 + (size_t)l->numbers) * points);
	l->lattice = l->load ? lattice_new(&l->x, &l->y, s->pool) : NULL;
	if (!l->lattice)
		return NUM_MEMORY;
	for (int c = 0; c < l->numbers; c++)
		l->field[c] = l->load + (size_t)(c + 1) * points;
	memset(l->load, 0, points * sizeof *l->load);
	if (lattice_spread(l->lattice, load, stride, scale, element, l->load) ||
		lattice_points(l->lattice, want->span, want->count, x0, y0, &l->span,
			&l->want.count)) {
		level_done(l);
		return NUM_MEMORY;
	}
	l->want.span = l->span;
	l->want.numbers = l->numbers;
	l->want.put = add_span;
	l->want.context = l;
	return NUM_OK;
}

/* Fields on the points of a level, cells apart: of all loads, or of those outside the
 * window of INNER points if finer points sum the others. */
static enum num_status sum_level(
	struct free_sum *s, double z, int cells, int outer, struct level *l)
{
	int mx = l->x.points, my = l->y.points;
	enum num_status status;
	struct level next = { .depth = l->depth + 1, .numbers = l->numbers };
	struct keep keep = { l->field, (size_t)mx, l->numbers };
	struct window w = { .mx = mx,
		.my = my,
		.reach_x = mx - 1,
		.reach_y = my - 1,
		.load = l->load,
		.load_stride = (size_t)mx,
		.scale = 1,
		.few = WINDOW_FEW,
		/* To plan other sizes takes as long as ten windows of that of tiles: too
		 * long where windows of finer points take most of the time. */
		.tiles = cells > 2,
		.numbers = l->numbers,
		.want = &l->want,
		.take = keep_part,
		.context = &keep };

	if (mx <= COARSEST && my <= COARSEST)
		return convolve(s, outer ? POINT_OUTER : POINT, z, cells, &w);
	w.reach_x = w.reach_y = OUTER;
	if (convolve(s, outer ? POINT_RING : POINT_INNER, z, cells, &w) ||
		level_new(s, &next, mx, my, 2, l->load, (size_t)mx, 1, 0, &l->want, 0, 0))
		return NUM_MEMORY;
	status = sum_level(s, z, 2 * cells, 1, &next);
	if (!status)
		status = lattice_gather(next.lattice, next.field, 0, 0, &l->want);
	level_done(&next);
	return status;
}

static enum num_status sum_coarse(struct free_sum *s, double z, int cells,
	const struct stress_want *want, const struct box *b)
{
	struct level l = { .numbers = want->numbers };
	enum num_status status;

	if (level_new(s, &l, b->wx, b->wy, cells, corner(s, b), (size_t)s->nx, s->scale,
		    1, want, b->x0, b->y0))
		return NUM_MEMORY;
	status = sum_level(s, z, cells, 0, &l);
	if (!status)
		status = lattice_gather(l.lattice, l.field, b->x0, b->y0, want);
	level_done(&l);
	s->work.coarse_layers++;
	return status;
}

static void add_near(void *context, const struct stress_part *part, int worker)
{
	lattice_gather_part(context, part, worker);
}

/* The equivalent stress of unit pressure on a cell, with the tractions on itself. */
static double size_of(
	const struct free_sum *s, const struct stress_want *want, int i, int j)
{
	const struct influence *f = &s->inner[abs(j) * (REACH + 1) + abs(i)];
	double number[STRESS_NUMBERS] = { 0 };

	for (int c = 0; c < want->numbers; c++)
		number[c] =
			influence_image(&s->par, f, (enum stress_number)c, i < 0, j < 0);
	if (i == 0 && j == 0)
		number[s->par.axis ? DEV_YZ : DEV_XZ] = s->par.mu;
	return want->size(want->context, number);
}

static enum num_status know_sizes(struct free_sum *s, const struct stress_want *want)
{
	enum { WIDTH = 2 * REACH + 1 };
	struct kernel k = {
		.sum = s, .source = ELEMENT_INNER, .dx = s->par.dx, .dy = s->par.dy
	};

	if (s->size)
		return NUM_OK;
	s->inner = make_kernel(&k, REACH, REACH);
	s->size = malloc(WIDTH * WIDTH * sizeof *s->size);
	if (!s->inner || !s->size)
		return NUM_MEMORY;
	for (int j = -REACH; j <= REACH; j++)
		for (int i = -REACH; i <= REACH; i++)
			s->size[(j + REACH) * WIDTH + i + REACH] =
				(float)size_of(s, want, i, j);
	return NUM_OK;
}

/* Leaves out the nodes of a request that do not exceed its limit. */
static enum num_status narrow_want(struct free_sum *s, const struct box *b,
	const struct lattice_gather *far, struct stress_want *want,
	struct stress_span **span)
{
	struct narrow n = { b->wx, b->wy, b->x0, b->y0, corner(s, b), (size_t)s->nx,
		s->loads, s->load_count, s->scale, REACH, NULL, far, want->limit };

	if (know_sizes(s, want))
		return NUM_MEMORY;
	n.size = s->size;
	if (narrow_spans(&n, want->span, want->count, span, &want->count))
		return NUM_MEMORY;
	want->span = *span;
	return NUM_OK;
}

/* The part inside the innermost window, on the cells of the box, added to that of a
 * level. */
static enum num_status sum_near(struct free_sum *s, double z,
	const struct stress_want *all, const struct box *b, const struct level *l)
{
	struct stress_want wanted = *all, *want = &wanted;
	struct stress_span *span = NULL;
	int narrows = want->size && z == 0;
	struct lattice_gather *gather =
		lattice_gather_new(l->lattice, l->field, b->x0, b->y0, want, &l->want);
	struct window w = { .mx = b->wx,
		.my = b->wy,
		.reach_x = REACH,
		.reach_y = REACH,
		.load = corner(s, b),
		.load_stride = (size_t)s->nx,
		.scale = s->scale,
		.few = narrows ? NARROWED_FEW : WINDOW_FEW,
		.numbers = want->numbers,
		.want = want,
		.x0 = b->x0,
		.y0 = b->y0,
		.take = add_near,
		.context = gather };
	enum num_status status = NUM_MEMORY;

	if (gather && narrows)
		status = narrow_want(s, b, gather, want, &span);
	else if (gather)
		status = NUM_OK;
	if (!status)
		status = convolve(s, ELEMENT_INNER, z, 1, &w);
	free(span);
	lattice_gather_free(gather);
	return status;
}

static enum num_status sum_split(
	struct free_sum *s, double z, const struct stress_want *want, const struct box *b)
{
	struct level l = { .numbers = want->numbers };
	enum num_status status;

	if (level_new(s, &l, b->wx, b->wy, 2, corner(s, b), (size_t)s->nx, s->scale, 1,
		    want, b->x0, b->y0))
		return NUM_MEMORY;
	status = sum_level(s, z, 2, 1, &l);
	if (!status)
		status = sum_near(s, z, want, b, &l);
	level_done(&l);
	s->work.split_layers++;
	return status;
}

enum num_status free_sum_at(struct free_sum *s, double z, const struct stress_want *want)
{
	double side = fmax(s->par.dx, s->par.dy), small = fmin(s->par.dx, s->par.dy);
	struct box b = box_of(s, want);
	int cells = 2;

	if (want->count == 0)
		return NUM_OK;
	if (s->full || b.wx <= SMALL || b.wy <= SMALL || side > OBLONG * small)
		return sum_full(s, z, want, &b);
	if (z < SMOOTH * cells * side)
		return sum_split(s, z, want, &b);
	while (z >= 2 * SMOOTH * cells * side && cells < larger_int(b.wx, b.wy))
		cells *= 2;
	return sum_coarse(s, z, cells, want, &b);
}
