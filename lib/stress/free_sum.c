#include "stress/free_sum.h"
#include "num/status.h"
#include "stress/lattice.h"
#include "stress/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	INNER = 8,         /* points to the radius of the window left to finer points */
	OUTER = 2 * INNER, /* to that of the next */
	RADIUS =
		2 * INNER, /* cells to the radius of the innermost, on every other cell */
	REACH = RADIUS + 1, /* of what it leaves to the cells: the element adds one */
	RUN = 8,            /* loads side by side that are summed at once */
	BLOCK = 8,          /* cells of a row that are summed at once */
	WIDTH = (2 * REACH + RUN + BLOCK - 1) / BLOCK * BLOCK, /* cells a run reaches */
	SMALL = 32,          /* sides up to this are summed in full, which is no slower */
	COARSEST = 6 * OUTER /* points a side up to which no window is worth its while */
};

/* Depth over the distance of points: interpolation through eight of them leaves 2e-5 of
 * the largest pressure at 5, 2e-4 at 4 (tests/bench/stress.c). */
static const double SMOOTH = 5;

/* The elongation of cells up to which the window, round in cells, parts near from far. */
static const double OBLONG = 2;

struct box {
	int x0, y0, wx, wy;
};

/* Loads side by side. */
struct run {
	double p[RUN];
	int count, x, y; /* of the first, from the corner of the box */
};

struct free_sum {
	struct influence_par par;
	int nx, ny, full;
	struct pool *pool;
	const double *pressure;
	int x0, x1, y0, y1; /* of the loads, inclusive; x1 < x0: there are none */
	double loads;
	struct sum_work work;
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
	free(s);
}

struct sum_work free_sum_work(const struct free_sum *s)
{
	return s->work;
}

void free_sum_load(struct free_sum *s, const double *pressure)
{
	s->pressure = pressure;
	s->loads = 0;
	s->x0 = s->nx, s->x1 = -1, s->y0 = s->ny, s->y1 = -1;
	for (int y = 0; y < s->ny; y++)
		for (int x = 0; x < s->nx; x++) {
			if (pressure[(size_t)y * (size_t)s->nx + (size_t)x] == 0)
				continue;
			s->loads++;
			s->x0 = x < s->x0 ? x : s->x0;
			s->x1 = x > s->x1 ? x : s->x1;
			s->y0 = y < s->y0 ? y : s->y0;
			s->y1 = y;
		}
}

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

static int larger(int a, int b)
{
	return a > b ? a : b;
}

/* The cells of all loads and all nodes wanted. */
static struct box box_of(const struct free_sum *s, const struct stress_want *want)
{
	int x0 = s->x0, x1 = s->x1, y0 = s->y0, y1 = s->y1;

	for (size_t i = 0; i < want->count; i++) {
		x0 = smaller(x0, want->span[i].begin);
		x1 = larger(x1, want->span[i].end - 1);
		y0 = smaller(y0, want->span[i].y);
		y1 = larger(y1, want->span[i].y);
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
	POINT_OUTER    /* outside that of INNER points */
};

struct kernel {
	const struct influence_par *par;
	enum source source;
	int wx;
	double dx, dy, z; /* offsets are multiples of these */
	struct influence *value;
};

static struct influence kernel_value(const struct kernel *k, double x, double y)
{
	const struct influence_par *p = k->par;
	double z = k->z, rx = RADIUS * p->dx, ry = RADIUS * p->dy;
	struct influence far;

	switch (k->source) {
	case ELEMENT:
		return influence_element(p, x, y, z);
	case ELEMENT_INNER:
		far = influence_outer_element(p, x, y, z, rx, ry);
		return influence_less(influence_element(p, x, y, z), &far);
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
		k->value[j * (size_t)k->wx + (size_t)i] =
			kernel_value(k, i * k->dx, (double)j * k->dy);
}

static struct influence *kernel_new(
	struct free_sum *s, enum source source, double z, double cells, int wx, int wy)
{
	struct kernel k = { &s->par, source, wx, cells * s->par.dx, cells * s->par.dy, z,
		malloc((size_t)wx * (size_t)wy * sizeof(struct influence)) };

	if (k.value)
		pool_run(s->pool, (size_t)wy, kernel_row, &k);
	s->work.kernel_cells += (double)wx * wy;
	return k.value;
}

/* Convolution of loads on mx by my points with a kernel of this reach: a field for each
 * number. */
static enum num_status convolve(struct free_sum *s, enum source source, double z,
	double cells, int reach_x, int reach_y, int mx, int my, const double *load,
	size_t load_stride, int numbers, double *const *out, size_t stride)
{
	struct influence *kernel =
		kernel_new(s, source, z, cells, reach_x + 1, reach_y + 1);
	struct window *w = kernel ? window_new(mx, my, reach_x, reach_y) : NULL;

	if (w) {
		window_load(w, load, load_stride);
		for (int c = 0; c < numbers; c++)
			window_sum(w, &s->par, kernel, (enum stress_number)c, out[c],
				stride);
		s->work.transforms += 1 + 2 * numbers;
	}
	window_free(w);
	free(kernel);
	return w ? NUM_OK : NUM_MEMORY;
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
	enum num_status status;

	if (new_fields(field, want->numbers, (size_t)b->wx * (size_t)b->wy))
		return NUM_MEMORY;
	status = convolve(s, ELEMENT, z, 1, b->wx - 1, b->wy - 1, b->wx, b->wy,
		corner(s, b), (size_t)s->nx, want->numbers, field, (size_t)b->wx);
	hand.field = field;
	if (!status)
		pool_run(s->pool, want->count, hand_span, &hand);
	free_fields(field, want->numbers);
	s->work.full_layers++;
	return status;
}

/* The part near the loads, on the cells of the box with REACH more on each side. */

/* A row of the table: 2 REACH + 1 coefficients after RUN zeros, and zeros up to the width
 * of a run. */
enum { ROW = RUN + WIDTH, ROWS = 2 * REACH + 1 };

struct scatter {
	const struct run *run;
	size_t count, stride;
	int low, high;       /* rows of nodes wanted, from the corner of the box */
	const double *table; /* ROWS for each number */
	double *const *field;
};

/* Two cells at a time; a compiler leaves it at one where it does not know the alignment.
 */
typedef double two __attribute__((vector_size(2 * sizeof(double))));

static two load_two(const double *p)
{
	two v;

	memcpy(&v, p, sizeof v);
	return v;
}

static void store_two(double *p, two v)
{
	memcpy(p, &v, sizeof v);
}

/* The sums of a block are kept apart, since each waits for its last term. */
static void add_run(double *f, const double *row, const struct run *r)
{
	for (int x = 0; x < 2 * REACH + r->count; x += BLOCK) {
		const double *k = row + RUN + x;
		two a = load_two(f + x), b = load_two(f + x + 2), c = load_two(f + x + 4),
		    d = load_two(f + x + 6);

		for (int m = 0; m < r->count; m++) {
			two p = { r->p[m], r->p[m] };

			a += p * load_two(k - m);
			b += p * load_two(k - m + 2);
			c += p * load_two(k - m + 4);
			d += p * load_two(k - m + 6);
		}
		store_two(f + x, a);
		store_two(f + x + 2, b);
		store_two(f + x + 4, c);
		store_two(f + x + 6, d);
	}
}

static void scatter_number(void *context, size_t c, int worker)
{
	const struct scatter *s = context;
	const double *table = s->table + c * ROWS * ROW;

	(void)worker;
	for (size_t i = 0; i < s->count; i++) {
		const struct run *r = &s->run[i];
		int from = larger(-REACH, s->low - r->y),
		    to = smaller(REACH, s->high - r->y);

		for (int j = from; j <= to; j++)
			add_run(s->field[c] + (size_t)(r->y + REACH + j) * s->stride +
					(size_t)r->x,
				table + (j + REACH) * ROW, r);
	}
}

static double *table_new(
	const struct free_sum *s, const struct influence *kernel, int numbers)
{
	double *table = calloc((size_t)numbers * ROWS * ROW, sizeof *table);

	for (int c = 0; table && c < numbers; c++)
		for (int j = -REACH; j <= REACH; j++)
			for (int i = -REACH; i <= REACH; i++) {
				const struct influence *f =
					&kernel[abs(j) * (REACH + 1) + abs(i)];
				double v = influence_image(
					&s->par, f, (enum stress_number)c, i < 0, j < 0);

				/* On a line of symmetry what is odd across it vanishes.
				 */
				if (!i)
					v = 0.5 * (v + influence_image(&s->par, f,
							       (enum stress_number)c, 1,
							       j < 0));
				if (!j)
					v = 0.5 * (v + influence_image(&s->par, f,
							       (enum stress_number)c,
							       i < 0, 1));
				table[((size_t)c * ROWS + (size_t)(j + REACH)) * ROW +
					(size_t)(RUN + i + REACH)] = v;
			}
	return table;
}

static enum num_status scatter_near(struct free_sum *s, double z,
	const struct stress_want *want, const struct box *b, double *const *field,
	size_t stride)
{
	struct influence *kernel =
		kernel_new(s, ELEMENT_INNER, z, 1, REACH + 1, REACH + 1);
	struct run *run = malloc((size_t)s->loads * sizeof *run);
	struct scatter sc = { run, 0, stride, b->wy, 0, NULL, field };
	double *table = kernel ? table_new(s, kernel, want->numbers) : NULL;

	for (size_t i = 0; i < want->count; i++) {
		sc.low = smaller(sc.low, want->span[i].y - b->y0);
		sc.high = larger(sc.high, want->span[i].y - b->y0);
	}
	for (int y = 0; run && y < b->wy; y++)
		for (int x = 0; x < b->wx; x++) {
			const double *p =
				corner(s, b) + (size_t)y * (size_t)s->nx + (size_t)x;
			struct run *r = &run[sc.count];

			if (*p == 0)
				continue;
			*r = (struct run){ .x = x, .y = y };
			while (r->count < RUN && x < b->wx && *p != 0) {
				r->p[r->count++] = *p++;
				x++;
			}
			x--;
			sc.count++;
		}
	sc.table = table;
	if (run && table)
		pool_run(s->pool, (size_t)want->numbers, scatter_number, &sc);
	free(run);
	free(table);
	free(kernel);
	return run && table ? NUM_OK : NUM_MEMORY;
}

/* A load takes about 0.3 ns for each of its products, a transform 1 ns for each point and
 * doubling. */
static int prefer_scatter(const struct free_sum *s, const struct box *b, int numbers)
{
	double points = ((double)b->wx + REACH) * ((double)b->wy + REACH);

	return 0.3 * s->loads * numbers * ROWS * ROWS <
	       1.0 * (1 + 2 * numbers) * points * log2(points);
}

/* The nodes of the box start REACH cells into the fields either way. */
static enum num_status sum_near(struct free_sum *s, double z,
	const struct stress_want *want, const struct box *b, double *const *field,
	double *const *inset, size_t stride)
{
	if (prefer_scatter(s, b, want->numbers))
		return scatter_near(s, z, want, b, field, stride);
	return convolve(s, ELEMENT_INNER, z, 1, REACH, REACH, b->wx, b->wy, corner(s, b),
		(size_t)s->nx, want->numbers, inset, stride);
}

/* Levels */

struct level {
	struct lattice_axis x, y;
	struct lattice *lattice; /* among the cells, or points, of the finer level */
	double *load;
	double *field[STRESS_NUMBERS];
	int numbers;
};

static void level_free(struct level *l)
{
	free_fields(l->field, l->numbers);
	free(l->load);
	lattice_done(l->lattice);
}

/* Points every so many cells, or finer points, with their loads. */
static enum num_status level_new(const struct free_sum *s, struct level *l, int mx,
	int my, int spacing, const double *load, size_t stride, int element, int numbers)
{
	size_t points;

	*l = (struct level){ .x = lattice_free(mx, spacing),
		.y = lattice_free(my, spacing),
		.numbers = numbers };
	points = (size_t)l->x.points * (size_t)l->y.points;
	l->lattice = lattice_new(&l->x, &l->y, s->pool);
	l->load = calloc(points, sizeof *l->load);
	if (!l->lattice || !l->load || new_fields(l->field, numbers, points)) {
		l->numbers = 0;
		level_free(l);
		return NUM_MEMORY;
	}
	lattice_spread(l->lattice, load, stride, element, l->load);
	return NUM_OK;
}

/* Fields on the points of a level, cells apart: of all loads, or of those outside the
 * window of INNER points where finer points have the rest. */
static enum num_status sum_level(
	struct free_sum *s, double z, int cells, int outer, struct level *l)
{
	int mx = l->x.points, my = l->y.points, status;
	struct level next;

	if (mx <= COARSEST && my <= COARSEST)
		return convolve(s, outer ? POINT_OUTER : POINT, z, cells, mx - 1, my - 1,
			mx, my, l->load, (size_t)mx, l->numbers, l->field, (size_t)mx);
	if (convolve(s, outer ? POINT_RING : POINT_INNER, z, cells, OUTER, OUTER, mx, my,
		    l->load, (size_t)mx, l->numbers, l->field, (size_t)mx) ||
		level_new(s, &next, mx, my, 2, l->load, (size_t)mx, 0, l->numbers))
		return NUM_MEMORY;
	status = sum_level(s, z, 2 * cells, 1, &next);
	for (int c = 0; !status && c < l->numbers; c++)
		status = lattice_refine(next.lattice, next.field[c], l->field[c]);
	level_free(&next);
	return status;
}

static enum num_status sum_coarse(struct free_sum *s, double z, int cells,
	const struct stress_want *want, const struct box *b)
{
	struct level l;
	enum num_status status;

	if (level_new(s, &l, b->wx, b->wy, cells, corner(s, b), (size_t)s->nx, 1,
		    want->numbers))
		return NUM_MEMORY;
	status = sum_level(s, z, cells, 0, &l);
	if (!status)
		status = lattice_gather(l.lattice, l.field, NULL, 0, b->x0, b->y0, want);
	level_free(&l);
	s->work.coarse_layers++;
	return status;
}

static enum num_status sum_split(
	struct free_sum *s, double z, const struct stress_want *want, const struct box *b)
{
	size_t stride = (size_t)b->wx + WIDTH, n = stride * ((size_t)b->wy + 2 * REACH);
	double *near[STRESS_NUMBERS], *inset[STRESS_NUMBERS];
	struct level l;
	enum num_status status;

	if (level_new(s, &l, b->wx, b->wy, 2, corner(s, b), (size_t)s->nx, 1,
		    want->numbers))
		return NUM_MEMORY;
	status = sum_level(s, z, 2, 1, &l);
	if (!status && !(status = new_fields(near, want->numbers, n))) {
		for (int c = 0; c < want->numbers; c++)
			inset[c] = near[c] + REACH * stride + REACH;
		status = sum_near(s, z, want, b, near, inset, stride);
		if (!status)
			status = lattice_gather(
				l.lattice, l.field, inset, stride, b->x0, b->y0, want);
		free_fields(near, want->numbers);
	}
	level_free(&l);
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
	while (z >= 2 * SMOOTH * cells * side && cells < larger(b.wx, b.wy))
		cells *= 2;
	return sum_coarse(s, z, cells, want, &b);
}
