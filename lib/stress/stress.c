#include "stress/stress.h"
#include "num/fft.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/status.h"
#include "stress/free_sum.h"
#include "stress/influence.h"
#include "stress/stress_kernel.h"
#include "stress/wave_sum.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Cells to the side of a block, and blocks to that of the grid at most; they decide only
 * how many nodes a bound excludes, not the result. */
enum { BLOCK = 8, BLOCKS_SIDE = 64 };

struct block {
	int x0, x1, y0, y1; /* loaded cells within, inclusive */
	double load;        /* in units times m2; 0: none */
};

struct stress {
	struct stress_par par;
	const struct stress_criterion *criterion;
	struct influence_par influence;
	/* Pressures are scaled by a power of two near the largest one, so that squares
	 * neither overflow nor underflow. */
	double unit;
	const double *given; /* pressure of the last stress_load() */
	double *lent;        /* periodic: the same in units, which wave uses */
	double total;        /* N */
	struct stress_span
		*loads; /* runs of loaded cells: later passes read these alone */
	size_t load_count;
	int side, bx, by; /* cells to a block's side, blocks */
	struct block *blocks;
	double *row_load;      /* of each row of blocks */
	double *beyond;        /* bound for the loads of rows more than so many away */
	struct stress_box box; /* of all */
	/* The loaded blocks row by row, those of row j from begin[j] to begin[j + 1]: the
	 * ranges of their loaded cells, and their loads. */
	double *low_x, *high_x, *low_y, *high_y, *weight;
	size_t *begin;
	char *held; /* of the blocks: no node can fail at held_depth and below */
	double held_depth, held_limit;
	/* Largest equivalent stress times distance^2: in all directions, in those along
	 * the surface, and the one that bounds use. */
	double deep_point, surface_point, point;
	struct free_sum *free;
	struct wave_sum *wave; /* one of the two is NULL */
	double nodes;
};

/* The numbers of a stress tensor. */
static void numbers_of(const double t[STRESS_COMPONENTS], double v[STRESS_NUMBERS])
{
	v[DEV_X] = t[STRESS_XX] - t[STRESS_ZZ];
	v[DEV_Y] = t[STRESS_YY] - t[STRESS_ZZ];
	v[DEV_XY] = t[STRESS_XY];
	v[DEV_XZ] = t[STRESS_XZ];
	v[DEV_YZ] = t[STRESS_YZ];
	v[DEV_ZZ] = t[STRESS_ZZ];
}

/* Equivalent stress, times distance squared, of a point load in a direction. */
static double point_stress(const struct stress *s, double x, double y, double z)
{
	double t[STRESS_COMPONENTS], v[STRESS_NUMBERS];

	stress_point(s->par.nu, s->par.mu, x, y, z, t);
	numbers_of(t, v);
	return s->criterion->value(v);
}

/* The largest over all directions down to so many degrees.  Between steps of 3 and 6
 * degrees it is no more than 1e-3 larger (both criteria, Poisson's ratios to 0.5,
 * friction to 2); 2 % are added. */
static double largest_point_stress(const struct stress *s, int down)
{
	double most = 0;

	for (int i = 0; i <= down; i += 3)
		for (int j = 0; j < 360; j += 6) {
			double up = i * 0.017453292519943295,
			       turn = j * 0.017453292519943295;

			most = fmax(most, point_stress(s, cos(up) * cos(turn),
						  cos(up) * sin(turn), sin(up)));
		}
	return 1.02 * most;
}

static int par_ok(const struct stress_par *p)
{
	return p->nx > 0 && p->ny > 0 && p->nx <= 1 << 20 && p->ny <= 1 << 20 &&
	       p->dx > 0 && p->dy > 0 && p->nu >= 0 && p->nu <= 0.5 &&
	       isfinite(p->dx + p->dy + p->mu);
}

struct stress *stress_new(const struct stress_par *par)
{
	struct stress *s;
	size_t n = (size_t)par->nx * (size_t)par->ny;
	int full = par->method == STRESS_FULL;

	if (!par_ok(par)) {
		errno = EDOM;
		return NULL;
	}
	s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	s->par = *par;
	s->criterion = par->criterion ? par->criterion : &stress_von_mises_criterion;
	s->influence =
		(struct influence_par){ par->dx, par->dy, par->nu, par->mu, par->axis };
	s->side = (par->nx > par->ny ? par->nx : par->ny) / BLOCKS_SIDE;
	s->side = s->side < BLOCK ? BLOCK : s->side;
	s->bx = (par->nx + s->side - 1) / s->side;
	s->by = (par->ny + s->side - 1) / s->side;
	s->blocks = calloc((size_t)s->bx * (size_t)s->by, sizeof *s->blocks);
	s->row_load = calloc((size_t)s->by, sizeof *s->row_load);
	s->beyond = calloc((size_t)s->by, sizeof *s->beyond);
	s->begin = calloc((size_t)s->by + 1, sizeof *s->begin);
	s->low_x = calloc(5 * (size_t)s->bx * (size_t)s->by, sizeof *s->low_x);
	s->held = calloc((size_t)s->bx * (size_t)s->by, sizeof *s->held);
	/* Few cells of a large grid are loaded: most of this is never touched. */
	s->loads = malloc((n + (size_t)par->ny) / 2 * sizeof *s->loads);
	if (par->periodic) {
		s->lent = fft_alloc(n);
		s->wave = wave_sum_new(&s->influence, par->nx, par->ny, full, par->pool);
	} else
		s->free = free_sum_new(&s->influence, par->nx, par->ny, full, par->pool);
	if (!s->blocks || !s->row_load || !s->beyond || !s->begin || !s->low_x ||
		!s->held || !s->loads || (par->periodic && !s->lent) ||
		(!s->wave && !s->free)) {
		stress_free(s);
		errno = ENOMEM;
		return NULL;
	}
	s->high_x = s->low_x + (size_t)s->bx * (size_t)s->by;
	s->low_y = s->high_x + (size_t)s->bx * (size_t)s->by;
	s->high_y = s->low_y + (size_t)s->bx * (size_t)s->by;
	s->weight = s->high_y + (size_t)s->bx * (size_t)s->by;
	s->deep_point = largest_point_stress(s, 90);
	s->surface_point = largest_point_stress(s, 0);
	return s;
}

void stress_free(struct stress *s)
{
	if (!s)
		return;
	free_sum_free(s->free);
	wave_sum_free(s->wave);
	free(s->blocks);
	free(s->row_load);
	free(s->beyond);
	free(s->begin);
	free(s->low_x);
	free(s->held);
	free(s->loads);
	fft_free(s->lent);
	free(s);
}

static void add_to_block(struct stress *s, int x, int y, double load)
{
	struct block *b =
		&s->blocks[(size_t)(y / s->side) * (size_t)s->bx + (size_t)(x / s->side)];

	if (b->load == 0) {
		b->x0 = b->x1 = x;
		b->y0 = b->y1 = y;
	}
	b->x0 = x < b->x0 ? x : b->x0;
	b->x1 = x > b->x1 ? x : b->x1;
	b->y1 = y;
	b->load += load;
}

static void list_loads(struct stress *s, const double *pressure)
{
	size_t nx = (size_t)s->par.nx;

	s->load_count = 0;
	for (int y = 0; y < s->par.ny; y++) {
		const double *row = pressure + (size_t)y * nx;

		for (size_t x = lanes_next(row, 0, nx); x < nx;
			x = lanes_next(row, x, nx)) {
			size_t begin = x;

			while (x < nx && row[x] != 0)
				x++;
			s->loads[s->load_count++] =
				(struct stress_span){ y, (int)begin, (int)x };
		}
	}
}

/* Power of two at or below the largest magnitude, and large enough for its inverse to be
 * finite; 0 if a value is not finite. */
static double unit_of(const struct stress *s, const double *pressure)
{
	double largest = 0;
	int exponent;

	for (size_t i = 0; i < s->load_count; i++) {
		const struct stress_span *run = &s->loads[i];
		const double *row = pressure + (size_t)run->y * (size_t)s->par.nx;

		for (int x = run->begin; x < run->end; x++) {
			double p = fabs(row[x]);

			if (!(p <= DBL_MAX))
				return 0;
			largest = p > largest ? p : largest;
		}
	}
	frexp(largest, &exponent);
	return largest > 0 ? fmax(ldexp(0.5, exponent), DBL_MIN) : 1;
}

static void list_blocks(struct stress *s)
{
	size_t n = 0;

	s->box = (struct stress_box){ s->par.nx, -1, s->par.ny, -1 };
	for (int j = 0; j < s->by; j++) {
		s->row_load[j] = 0;
		s->begin[j] = n;
		for (int i = 0; i < s->bx; i++) {
			const struct block *b =
				&s->blocks[(size_t)j * (size_t)s->bx + (size_t)i];

			if (b->load == 0)
				continue;
			s->row_load[j] += b->load;
			s->low_x[n] = b->x0;
			s->high_x[n] = b->x1;
			s->low_y[n] = b->y0;
			s->high_y[n] = b->y1;
			s->weight[n++] = b->load;
			s->box.x0 = b->x0 < s->box.x0 ? b->x0 : s->box.x0;
			s->box.x1 = b->x1 > s->box.x1 ? b->x1 : s->box.x1;
			s->box.y0 = b->y0 < s->box.y0 ? b->y0 : s->box.y0;
			s->box.y1 = b->y1 > s->box.y1 ? b->y1 : s->box.y1;
		}
	}
	s->begin[s->by] = n;
}

enum num_status stress_load(struct stress *s, const double *pressure)
{
	size_t nx = (size_t)s->par.nx, ny = (size_t)s->par.ny;
	double area = s->par.dx * s->par.dy, unit;

	list_loads(s, pressure);
	unit = unit_of(s, pressure);
	if (unit == 0) {
		s->load_count = 0;
		return NUM_DOMAIN;
	}
	s->unit = unit;
	s->given = pressure;
	s->total = 0;
	s->held_depth = INFINITY;
	memset(s->blocks, 0, (size_t)s->bx * (size_t)s->by * sizeof *s->blocks);
	for (size_t i = 0; i < s->load_count; i++) {
		const struct stress_span *run = &s->loads[i];
		const double *row = pressure + (size_t)run->y * nx;

		for (int x = run->begin; x < run->end; x++) {
			double p = row[x] / unit;

			s->total += p * area * unit;
			add_to_block(s, x, run->y, fabs(p) * area);
		}
	}
	list_blocks(s);
	if (s->free) {
		free_sum_load(
			s->free, pressure, 1 / unit, s->loads, s->load_count, &s->box);
		return NUM_OK;
	}
	for (size_t i = 0; i < nx * ny; i++)
		s->lent[i] = pressure[i] / unit;
	wave_sum_load(s->wave, s->lent);
	return NUM_OK;
}

const struct stress_span *stress_loads(const struct stress *s, size_t *count)
{
	*count = s->load_count;
	return s->loads;
}

struct stress_work stress_work(const struct stress *s)
{
	struct sum_work w = s->wave ? wave_sum_work(s->wave) : free_sum_work(s->free);

	return (struct stress_work){ w.transforms, w.kernel_cells, w.full_layers,
		w.split_layers, w.coarse_layers, s->nodes };
}

/* Nodes that may fail */

/* Distance between ranges of cells, from node centre to the edge of the elements of
 * loaded cells, which reach over half of the next. */
static inline lanes apart(double low, double high, lanes from, lanes to, double size)
{
	lanes cells = lanes_max(from - high, low - to) - 1;

	return lanes_max(cells, lanes_all(0)) * size;
}

/* What the loads of row j of the blocks may add in block bx, by. */
static double bound_row(const struct stress *s, int bx, int by, int j, double z)
{
	double x = bx * s->side, y = by * s->side, last = s->side - 1;
	lanes sum = lanes_all(0);

	for (size_t i = s->begin[j]; i < s->begin[j + 1]; i += 2) {
		int n = i + 1 < s->begin[j + 1] ? 2 : 1;
		lanes away_x = apart(x, x + last, lanes_load(s->low_x + i, n),
			lanes_load(s->high_x + i, n), s->par.dx);
		lanes away_y = apart(y, y + last, lanes_load(s->low_y + i, n),
			lanes_load(s->high_y + i, n), s->par.dy);

		/* Infinite where the node may lie on the load. */
		lanes_add(&sum,
			lanes_load(s->weight + i, n) * s->point /
				(away_x * away_x + away_y * away_y + z * z),
			n);
	}
	return sum[0] + sum[1];
}

/* Whether loads of the blocks around one may act at its nodes without a distance. */
static int block_is_touched(const struct stress *s, int bx, int by)
{
	int x0 = bx * s->side - 1, x1 = x0 + s->side + 1, y0 = by * s->side - 1,
	    y1 = y0 + s->side + 1;

	for (int j = by > 0 ? by - 1 : 0; j <= by + 1 && j < s->by; j++)
		for (int i = bx > 0 ? bx - 1 : 0; i <= bx + 1 && i < s->bx; i++) {
			const struct block *b =
				&s->blocks[(size_t)j * (size_t)s->bx + (size_t)i];

			if (b->load > 0 && b->x1 >= x0 && b->x0 <= x1 && b->y1 >= y0 &&
				b->y0 <= y1)
				return 1;
		}
	return 0;
}

static double load_of_row(const struct stress *s, int j)
{
	return j >= 0 && j < s->by ? s->row_load[j] : 0;
}

/* What the rows of blocks more than d away may add in row by, if the load of each were
 * straight above or below. */
static void bound_beyond(struct stress *s, int by, double z)
{
	double sum = 0;

	for (int d = s->by - 1; d >= 0; d--) {
		double load = load_of_row(s, by - d - 1) + load_of_row(s, by + d + 1);
		double away = d * s->side * s->par.dy;

		if (load > 0)
			sum += load * s->point / (away * away + z * z);
		s->beyond[d] = sum;
	}
}

/* Adds row by row from the block, until the sum exceeds the limit, or cannot reach it
 * with what rows farther away may add.  The block's own load, at no distance, is often
 * enough. */
static int block_may_fail(const struct stress *s, int bx, int by, double z, double limit)
{
	double own = s->blocks[(size_t)by * (size_t)s->bx + (size_t)bx].load;
	double sum = 0;

	if (own > 0 && own * s->point > limit * (z * z))
		return 1;
	if (z == 0 && block_is_touched(s, bx, by))
		return 1;
	for (int d = 0; d < s->by; d++) {
		for (int side = 0; side < (d > 0 ? 2 : 1); side++) {
			int j = side ? by - d : by + d;

			if (load_of_row(s, j) > 0)
				sum += bound_row(s, bx, by, j, z);
		}
		if (sum > limit)
			return 1;
		if (sum + s->beyond[d] <= limit)
			return 0;
	}
	return 0;
}

size_t stress_spans_max(const struct stress *s)
{
	return (size_t)s->bx * (size_t)s->par.ny;
}

static size_t reach(struct stress *s, double z, double limit, struct stress_span *span)
{
	size_t count = 0;

	if (s->load_count == 0 ||
		(s->wave && wave_sum_bound(s->wave, s->criterion, z) <= limit))
		return 0;
	for (int by = 0; by < s->by; by++) {
		size_t first = count, width;
		int y0 = by * s->side,
		    y1 = y0 + s->side < s->par.ny ? y0 + s->side : s->par.ny;

		if (s->free)
			bound_beyond(s, by, z);
		for (int bx = 0; bx < s->bx; bx++) {
			int x0 = bx * s->side;
			int x1 = x0 + s->side < s->par.nx ? x0 + s->side : s->par.nx;
			char *held = &s->held[(size_t)by * (size_t)s->bx + (size_t)bx];

			if (s->free && !*held)
				*held = !block_may_fail(s, bx, by, z, limit);
			if (*held)
				continue;
			if (count > first && span[count - 1].end == x0)
				span[count - 1].end = x1;
			else
				span[count++] = (struct stress_span){ y0, x0, x1 };
		}
		width = count - first;
		for (int y = y0 + 1; y < y1; y++)
			for (size_t k = 0; k < width; k++) {
				span[count] = span[first + k];
				span[count++].y = y;
			}
	}
	return count;
}

size_t stress_reach(struct stress *s, double z, double limit, struct stress_span *span)
{
	limit /= s->unit;
	/* A bound that held at a smaller depth still holds: it falls with depth. */
	if (!(z >= s->held_depth && limit >= s->held_limit))
		memset(s->held, 0, (size_t)s->bx * (size_t)s->by * sizeof *s->held);
	s->held_depth = z;
	s->held_limit = limit;
	s->point = s->deep_point;
	return reach(s, z, limit, span);
}

size_t stress_reach_surface(struct stress *s, double limit, struct stress_span *span)
{
	memset(s->held, 0, (size_t)s->bx * (size_t)s->by * sizeof *s->held);
	s->held_depth = INFINITY;
	s->point = s->surface_point;
	return reach(s, 0, limit / s->unit, span);
}

double stress_deep(const struct stress *s, double z)
{
	double complex mean[STRESS_NUMBERS];
	double v[STRESS_DEVIATOR];

	if (s->free)
		return point_stress(s, 0, 0, 1) * fabs(s->total) / (z * z);
	influence_wave(&s->influence, 0, 0, z, mean);
	for (int c = 0; c < STRESS_DEVIATOR; c++)
		v[c] = creal(mean[c]);
	return s->criterion->value(v) * fabs(s->total) /
	       (s->par.nx * s->par.dx * s->par.ny * s->par.dy);
}

/* Sums */

/* The last numbers, from DEV_XZ on, are tractions, which on the surface are those of the
 * load there. */
enum { SURFACE_NUMBERS = DEV_XZ };

struct take {
	const struct stress *s;
	double *out;
	int on_surface;
	/* Of stress_above(): */
	double limit;
	struct stress_node *node;
	atomic_size_t found;
};

/* Nodes whose equivalent stress is found together. */
enum { ROW = 64 };

/* The tractions along x and y on loaded cells of a row of the surface, from x on. */
static void tractions(
	const struct stress *s, int x, int y, int count, double *xz, double *yz)
{
	const double *p = s->given + (size_t)y * (size_t)s->par.nx + x;
	double along_x = s->par.axis == 0 ? -s->par.mu : 0,
	       along_y = s->par.axis == 1 ? -s->par.mu : 0;

	for (int i = 0; i < count; i++) {
		xz[i] = along_x * (p[i] / s->unit);
		yz[i] = along_y * (p[i] / s->unit);
	}
}

/* Equivalent stresses, in units, of at most ROW nodes of a span, from x on. */
static void equivalent_row(const struct take *t, const struct stress_span *span, int x,
	int count, const double *const number[STRESS_NUMBERS], double *value)
{
	const double *v[STRESS_DEVIATOR];
	double xz[ROW], yz[ROW];

	for (int c = 0; c < (t->on_surface ? (int)SURFACE_NUMBERS : (int)STRESS_DEVIATOR);
		c++)
		v[c] = number[c] + (x - span->begin);
	if (t->on_surface) {
		tractions(t->s, x, span->y, count, xz, yz);
		v[DEV_XZ] = xz;
		v[DEV_YZ] = yz;
	}
	t->s->criterion->row(v, count, value);
}

static void take_equivalent(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS])
{
	const struct take *t = context;
	double *out = t->out + (size_t)span->y * (size_t)t->s->par.nx, value[ROW];

	for (int x = span->begin; x < span->end; x += ROW) {
		int count = lesser_int(ROW, span->end - x);

		equivalent_row(t, span, x, count, number, value);
		for (int i = 0; i < count; i++)
			out[x + i] = t->s->unit * value[i];
	}
}

static void take_above(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS])
{
	struct take *t = context;
	double value[ROW];

	for (int x = span->begin; x < span->end; x += ROW) {
		int count = lesser_int(ROW, span->end - x), above = 0;
		struct stress_node *to;

		equivalent_row(t, span, x, count, number, value);
		for (int i = 0; i < count; i++) {
			value[i] *= t->s->unit;
			above += value[i] > t->limit;
		}
		if (above == 0)
			continue;
		to = t->node + atomic_fetch_add(&t->found, (size_t)above);
		for (int i = 0; i < count; i++)
			if (value[i] > t->limit)
				*to++ = (struct stress_node){ x + i, span->y, value[i] };
	}
}

static void take_tensor(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS])
{
	static const enum stress_component place[STRESS_NUMBERS] = { [DEV_X] = STRESS_XX,
		[DEV_Y] = STRESS_YY,
		[DEV_XY] = STRESS_XY,
		[DEV_XZ] = STRESS_XZ,
		[DEV_YZ] = STRESS_YZ,
		[DEV_ZZ] = STRESS_ZZ };
	const struct take *t = context;
	size_t nx = (size_t)t->s->par.nx, n = nx * (size_t)t->s->par.ny;

	for (int x = span->begin; x < span->end; x++) {
		double v[STRESS_NUMBERS];

		for (int c = 0;
			c < (t->on_surface ? (int)SURFACE_NUMBERS : STRESS_NUMBERS); c++)
			v[c] = number[c][x - span->begin];
		if (t->on_surface) {
			size_t at = (size_t)span->y * nx + (size_t)x;

			tractions(t->s, x, span->y, 1, &v[DEV_XZ], &v[DEV_YZ]);
			v[DEV_ZZ] = -(t->s->given[at] / t->s->unit);
		}
		v[DEV_X] += v[DEV_ZZ];
		v[DEV_Y] += v[DEV_ZZ];
		for (int c = 0; c < STRESS_NUMBERS; c++)
			t->out[place[c] * n + (size_t)span->y * nx + (size_t)x] =
				t->s->unit * v[c];
	}
}

static enum num_status sum(struct stress *s, double z, struct stress_want *want)
{
	struct take *t = want->context;

	for (size_t i = 0; i < want->count; i++)
		s->nodes += want->span[i].end - want->span[i].begin;
	t->on_surface = z == 0;
	if (t->on_surface)
		want->numbers = SURFACE_NUMBERS;
	return s->wave ? wave_sum_at(s->wave, z, want) : free_sum_at(s->free, z, want);
}

static double equivalent(void *context, const double number[STRESS_NUMBERS])
{
	return ((const struct take *)context)->s->criterion->value(number);
}

enum num_status stress_above(struct stress *s, double limit,
	const struct stress_span *span, size_t count, struct stress_node *node,
	size_t *found)
{
	struct take t = { .s = s, .on_surface = 1, .limit = limit, .node = node };
	struct stress_want want = { .span = span,
		.count = count,
		.put = take_above,
		.size = equivalent,
		.limit = limit / s->unit,
		.context = &t };
	enum num_status status =
		count > 0 && s->load_count > 0 ? sum(s, 0, &want) : NUM_OK;

	*found = t.found;
	return status;
}

enum num_status stress_at(struct stress *s, double z, const struct stress_span *span,
	size_t count, double *value)
{
	struct take t = { .s = s, .out = value };
	struct stress_want want = { .span = span,
		.count = count,
		.numbers = STRESS_DEVIATOR,
		.put = take_equivalent,
		.context = &t };

	if (count > 0 && s->load_count > 0)
		return sum(s, z, &want);
	for (size_t i = 0; i < count; i++)
		memset(value + (size_t)span[i].y * (size_t)s->par.nx + span[i].begin, 0,
			(size_t)(span[i].end - span[i].begin) * sizeof *value);
	return NUM_OK;
}

enum num_status stress_tensor(struct stress *s, double z, double *tensor)
{
	size_t rows = (size_t)s->par.ny, n = rows * (size_t)s->par.nx;
	struct stress_span *span = malloc(rows * sizeof *span);
	struct take t = { .s = s, .out = tensor };
	struct stress_want want = { .span = span,
		.count = rows,
		.numbers = STRESS_NUMBERS,
		.put = take_tensor,
		.context = &t };
	enum num_status status = NUM_MEMORY;

	if (!span)
		return NUM_MEMORY;
	for (int y = 0; y < s->par.ny; y++)
		span[y] = (struct stress_span){ y, 0, s->par.nx };
	if (s->load_count > 0)
		status = sum(s, z, &want);
	else {
		memset(tensor, 0, STRESS_COMPONENTS * n * sizeof *tensor);
		status = NUM_OK;
	}
	free(span);
	return status;
}
