#include "stress/stress.h"
#include "num/fft.h"
#include "num/status.h"
#include "stress/free_sum.h"
#include "stress/influence.h"
#include "stress/stress_kernel.h"
#include "stress/wave_sum.h"

#include <errno.h>
#include <math.h>
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
	double *pressure; /* of the last stress_load(), unless lent to wave */
	double total;     /* N */
	int loaded;       /* some cell is */
	int side, bx, by; /* cells to a block's side, blocks */
	struct block *blocks;
	double *row_load, load; /* of each row of blocks, and of all */
	char *held; /* of the blocks: no node can fail at held_depth and below */
	double held_depth, held_limit;
	double point; /* largest equivalent stress times distance^2 */
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

/* The largest over all directions.  Between steps of 1 and 2 degrees it is no more than
 * 1e-4 larger; 2 % are added. */
static double largest_point_stress(const struct stress *s)
{
	double most = 0;

	for (int i = 0; i <= 90; i++)
		for (int j = 0; j < 360; j += 2) {
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
	s->held = calloc((size_t)s->bx * (size_t)s->by, sizeof *s->held);
	s->pressure = fft_alloc(n);
	if (par->periodic)
		s->wave = wave_sum_new(&s->influence, par->nx, par->ny, full, par->pool);
	else
		s->free = free_sum_new(&s->influence, par->nx, par->ny, full, par->pool);
	if (!s->blocks || !s->row_load || !s->held || !s->pressure ||
		(!s->wave && !s->free)) {
		stress_free(s);
		errno = ENOMEM;
		return NULL;
	}
	s->point = largest_point_stress(s);
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
	free(s->held);
	fft_free(s->pressure);
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

/* Power of two at or below the largest magnitude; 0 if a value is not finite. */
static double unit_of(const double *pressure, size_t n)
{
	double most = 0;
	int exponent;

	for (size_t i = 0; i < n; i++) {
		if (!isfinite(pressure[i]))
			return 0;
		most = fmax(most, fabs(pressure[i]));
	}
	frexp(most, &exponent);
	return most > 0 ? ldexp(0.5, exponent) : 1;
}

enum num_status stress_load(struct stress *s, const double *pressure)
{
	size_t nx = (size_t)s->par.nx, ny = (size_t)s->par.ny;
	double area = s->par.dx * s->par.dy, unit = unit_of(pressure, nx * ny);

	if (unit == 0) {
		return NUM_DOMAIN;
	}
	s->unit = unit;
	s->total = 0;
	s->loaded = 0;
	s->held_depth = INFINITY;
	memset(s->blocks, 0, (size_t)s->bx * (size_t)s->by * sizeof *s->blocks);
	for (size_t y = 0; y < ny; y++)
		for (size_t x = 0; x < nx; x++) {
			double p = pressure[y * nx + x] / unit;

			s->pressure[y * nx + x] = p;
			if (p == 0)
				continue;
			s->loaded = 1;
			s->total += p * area * unit;
			add_to_block(s, (int)x, (int)y, fabs(p) * area);
		}
	s->load = 0;
	for (int j = 0; j < s->by; j++) {
		s->row_load[j] = 0;
		for (int i = 0; i < s->bx; i++)
			s->row_load[j] +=
				s->blocks[(size_t)j * (size_t)s->bx + (size_t)i].load;
		s->load += s->row_load[j];
	}
	if (s->wave)
		wave_sum_load(s->wave, s->pressure);
	else
		free_sum_load(s->free, s->pressure);
	return NUM_OK;
}

struct stress_work stress_work(const struct stress *s)
{
	struct sum_work w = s->wave ? wave_sum_work(s->wave) : free_sum_work(s->free);

	return (struct stress_work){ w.transforms, w.kernel_cells, w.full_layers,
		w.split_layers, w.coarse_layers, s->nodes };
}

/* Nodes that may fail */

/* Distance between two ranges of cells, from node centre to the edge of the elements of
 * loaded cells, which reach over half of the next. */
static double apart(int a0, int a1, int b0, int b1, double size)
{
	int cells = b0 > a1 ? b0 - a1 : a0 > b1 ? a0 - b1 : 0;

	return cells ? (cells - 1) * size : 0;
}

/* What the loads of row j of the blocks may add in block bx, by. */
static double bound_row(const struct stress *s, int bx, int by, int j, double z)
{
	const struct block *b = &s->blocks[(size_t)j * (size_t)s->bx];
	int x0 = bx * s->side, y0 = by * s->side, last = s->side - 1;
	double sum = 0;

	for (int i = 0; i < s->bx; i++, b++) {
		double away_x, away_y;

		if (b->load == 0)
			continue;
		away_x = apart(x0, x0 + last, b->x0, b->x1, s->par.dx);
		away_y = apart(y0, y0 + last, b->y0, b->y1, s->par.dy);
		/* Infinite where the node may lie on the load. */
		sum += b->load * s->point / (away_x * away_x + away_y * away_y + z * z);
	}
	return sum;
}

/* Adds row by row from the block, until the sum exceeds the limit, or cannot reach it
 * even if the remaining load were all in the next rows. */
static int block_may_fail(const struct stress *s, int bx, int by, double z, double limit)
{
	double sum = 0, rest = s->load;

	for (int d = 0; d < s->by; d++) {
		double away = d * s->side * s->par.dy;

		for (int side = 0; side < (d > 0 ? 2 : 1); side++) {
			int j = side ? by - d : by + d;

			if (j < 0 || j >= s->by)
				continue;
			sum += bound_row(s, bx, by, j, z);
			rest -= s->row_load[j];
		}
		if (sum > limit)
			return 1;
		if (sum + fmax(rest, 0) * s->point / (away * away + z * z) <= limit)
			return 0;
	}
	return 0;
}

size_t stress_spans_max(const struct stress *s)
{
	return (size_t)s->bx * (size_t)s->par.ny;
}

size_t stress_reach(struct stress *s, double z, double limit, struct stress_span *span)
{
	size_t count = 0;

	limit /= s->unit;
	/* A bound that held at a smaller depth still holds: it falls with depth. */
	if (!(z >= s->held_depth && limit >= s->held_limit))
		memset(s->held, 0, (size_t)s->bx * (size_t)s->by * sizeof *s->held);
	s->held_depth = z;
	s->held_limit = limit;
	if (!s->loaded || (s->wave && wave_sum_bound(s->wave, s->criterion, z) <= limit))
		return 0;
	for (int by = 0; by < s->by; by++) {
		size_t first = count, width;
		int y0 = by * s->side,
		    y1 = y0 + s->side < s->par.ny ? y0 + s->side : s->par.ny;

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

struct take {
	const struct stress *s;
	double *out;
};

static void take_equivalent(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS])
{
	const struct take *t = context;
	double *out = t->out + (size_t)span->y * (size_t)t->s->par.nx;

	for (int x = span->begin; x < span->end; x++) {
		double v[STRESS_DEVIATOR];

		for (int c = 0; c < STRESS_DEVIATOR; c++)
			v[c] = number[c][x - span->begin];
		out[x] = t->s->unit * t->s->criterion->value(v);
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

	for (int c = 0; c < STRESS_NUMBERS; c++)
		for (int x = span->begin; x < span->end; x++) {
			int k = x - span->begin;
			double zz = c == DEV_X || c == DEV_Y ? number[DEV_ZZ][k] : 0;

			t->out[place[c] * n + (size_t)span->y * nx + (size_t)x] =
				t->s->unit * (number[c][k] + zz);
		}
}

static enum num_status sum(struct stress *s, double z, const struct stress_want *want)
{
	for (size_t i = 0; i < want->count; i++)
		s->nodes += want->span[i].end - want->span[i].begin;
	return s->wave ? wave_sum_at(s->wave, z, want) : free_sum_at(s->free, z, want);
}

enum num_status stress_at(struct stress *s, double z, const struct stress_span *span,
	size_t count, double *value)
{
	struct take t = { s, value };
	struct stress_want want = { span, count, STRESS_DEVIATOR, take_equivalent, &t };

	if (count > 0 && s->loaded)
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
	struct take t = { s, tensor };
	struct stress_want want = { span, rows, STRESS_NUMBERS, take_tensor, &t };
	enum num_status status = NUM_MEMORY;

	if (!span)
		return NUM_MEMORY;
	for (int y = 0; y < s->par.ny; y++)
		span[y] = (struct stress_span){ y, 0, s->par.nx };
	if (s->loaded)
		status = sum(s, z, &want);
	else {
		memset(tensor, 0, STRESS_COMPONENTS * n * sizeof *tensor);
		status = NUM_OK;
	}
	free(span);
	return status;
}
