#include "contact/extension.h"
#include "contact/transfer.h"
#include "num/convolve.h"
#include "num/fft.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 5, 10 and 20 steps on 1024 coarsest cells take 809, 797 and 827 iterations on the
 * scenes of tests/long/exact.c, and 10 steps on 256 cells 801, but up to half as many
 * more on a single one; on 15 surfaces of 128 to 1024 cells a side all take 167 to 173.
 * 128 x 128 cells take 8.7, 6.8 and 5.7 ms with 20 steps, with 10 and with 10 on 256
 * cells. */
enum {
	LEVELS = 30,
	COARSEST = 1024, /* cells to solve on */
	STEPS = 10,      /* of conjugate gradients there */
	ROWS = 16        /* rows in one job: 4 to 64 take the same time within 3 %
			  * (1024 x 1024, periodic and free) */
};

struct level {
	struct contact_par par;
	size_t nx, ny;
	struct transfer from; /* the next finer grid */
	double *value;        /* weighted residual, then what becomes of it */
	double *weight;       /* part of the cell that is active */
};

struct extension {
	struct contact_par par;           /* of the cells that the levels cover */
	size_t nx, ny;                    /* the grid */
	size_t mx, my;                    /* and its frame */
	struct level own[LEVELS], *level; /* level[0]: of half as many cells each way */
	int levels, borrowed;
	double *memory;         /* of the levels, unless lent */
	double *scratch;        /* 2 rows for each thread */
	size_t row;             /* doubles in one of them */
	struct convolve *plane; /* of the coarsest level */
	double *stiffness;
	double *gradient, *step, *image, *ties; /* there */

	/* of the call in progress */
	int now;
	const unsigned char *active;
	const double *gap;
	double approach;
};

/* |q| */
static double wave_number(const void *context, size_t kx, size_t ky)
{
	const struct contact_par *par = context;

	return 2 * M_PI *
	       hypot((double)kx / (par->nx * par->dx), (double)ky / (par->ny * par->dy));
}

/* On a free boundary opposite edges must not be neighbours.  Where surfaces of rms slope
 * 0.4 touch the edges at 20 %, 512 x 512 cells take 33 iterations without a frame, 20
 * with 8 cells, and 17, 16 and 15 with 1/16, 1/8 and 1/4 of the side; a free strip of 3 x
 * 10000 takes 191 without one, and 98, 69 and 52 with 4, 8 and 16 cells. */
static size_t framed(size_t n)
{
	return fft_fast_size(n + (n > 8 * 16 ? n / 16 : 8));
}

void extension_size(const struct extension *e, size_t *mx, size_t *my)
{
	*mx = e->mx;
	*my = e->my;
}

static enum num_status make_coarsest(struct extension *e)
{
	struct level *l = &e->level[e->levels - 1];

	e->plane = convolve_new(l->nx, l->ny, CONVOLVE_PERIODIC, NULL);
	if (!e->plane)
		return NUM_MEMORY;
	e->stiffness = convolve_alloc(e->plane);
	e->gradient = fft_alloc(4 * l->nx * l->ny);
	if (!e->stiffness || !e->gradient)
		return NUM_MEMORY;
	e->step = e->gradient + l->nx * l->ny;
	e->image = e->step + l->nx * l->ny;
	e->ties = e->image + l->nx * l->ny;
	return convolve_spectrum(e->plane, e->stiffness, wave_number, &l->par);
}

/* Doubles of an array, whole cache lines. */
static size_t array_room(const struct level *l)
{
	return (l->nx * l->ny + 7) / 8 * 8;
}

static enum num_status make_levels(struct extension *e, double *memory, size_t most)
{
	const struct contact_par *fine = &e->par;
	size_t cells = 0;

	e->level = e->own;
	while (e->levels < LEVELS) {
		struct level *l = &e->own[e->levels];

		if ((size_t)fine->nx * (size_t)fine->ny <= COARSEST ||
			!transfer_coarsen(fine, &l->par))
			break;
		e->levels++;
		l->nx = (size_t)l->par.nx;
		l->ny = (size_t)l->par.ny;
		cells += array_room(l);
		if (transfer_make(&l->from, fine, &l->par) != 0)
			return NUM_MEMORY;
		fine = &l->par;
	}
	if (2 * cells > most) {
		memory = e->memory = fft_alloc(2 * cells);
		if (!memory)
			return NUM_MEMORY;
	}
	for (int k = 0; k < e->levels; k++) {
		struct level *l = &e->own[k];

		l->value = memory;
		l->weight = l->value + array_room(l);
		memory = l->weight + array_room(l);
	}
	return e->levels > 0 ? make_coarsest(e) : 0;
}

/* 1 if the levels of the next finer grid, but its first, are those of this one. */
static int shares(const struct contact_par *par, const struct extension *finer)
{
	if (!finer || finer->levels < 2)
		return 0;
	/* Frames of two grids must end in the same place. */
	return par->boundary == CONTACT_PERIODIC ||
	       (finer->nx == 2 * (size_t)par->nx && finer->mx % 2 == 0 &&
		       finer->ny == 2 * (size_t)par->ny && finer->my % 2 == 0);
}

struct extension *extension_new(const struct contact_par *par,
	const struct extension *finer, double *memory, size_t room)
{
	struct extension *e = calloc(1, sizeof *e);
	int shared = shares(par, finer);

	if (!e)
		return NULL;
	if (shared)
		*e = *finer;
	e->par = *par;
	e->nx = (size_t)par->nx;
	e->ny = (size_t)par->ny;
	if (par->boundary == CONTACT_PERIODIC) {
		e->mx = convolve_good_period(e->nx);
		e->my = convolve_good_period(e->ny);
	} else {
		e->mx = shared ? finer->mx / 2 : framed(e->nx);
		e->my = shared ? finer->my / 2 : framed(e->ny);
		e->par.nx = (int)e->mx;
		e->par.ny = (int)e->my;
		e->par.boundary = CONTACT_PERIODIC;
	}
	if (shared) {
		e->level = finer->level + 1;
		e->levels = finer->levels - 1;
		e->borrowed = 1;
		return e;
	}
	e->row = e->mx + TRANSFER_TAPS;
	e->scratch = fft_alloc(2 * (size_t)pool_threads(par->pool) * e->row);
	if (e->scratch && make_levels(e, memory, room) == 0)
		return e;
	extension_free(e);
	return NULL;
}

void extension_free(struct extension *e)
{
	if (e && !e->borrowed) {
		for (int k = 0; k < e->levels; k++)
			transfer_done(&e->own[k].from);
		convolve_free(e->plane);
		fft_free(e->stiffness);
		fft_free(e->gradient);
		fft_free(e->memory);
		fft_free(e->scratch);
	}
	free(e);
}

static inline void add_cells(double *to, double w, lanes x, int n)
{
	lanes_store(to, lanes_load(to, n) + w * x, n);
}

/* Adds w times a fine row of the residual, 0 where it is not active, and w where it is.
 */
static void add_residual(const struct extension *e, size_t row, double w, double *value,
	double *weight, size_t n)
{
	const double *g = e->gap + row * n;
	const unsigned char *a = e->active + row * n;

	for (size_t x = 0; x < n; x += 2) {
		int k = x + 1 < n ? 2 : 1;
		lane_mask active = lanes_flags(a + x, k);

		add_cells(value + x, w,
			lanes_if(active, lanes_load(g + x, k) - e->approach), k);
		add_cells(weight + x, w, lanes_if(active, lanes_all(1)), k);
	}
}

/* The same for a level. */
static void add_level(const struct level *l, size_t row, double w, double *value,
	double *weight, size_t n)
{
	const double *v = l->value + row * n, *u = l->weight + row * n;

	for (size_t x = 0; x < n; x += 2) {
		int k = x + 1 < n ? 2 : 1;

		add_cells(value + x, w, lanes_load(v + x, k), k);
		add_cells(weight + x, w, lanes_load(u + x, k), k);
	}
}

static void add_row(const struct extension *e, size_t row, double w, double *value,
	double *weight, size_t n)
{
	if (e->now == 0) {
		if (row < e->ny)
			add_residual(e, row, w, value, weight, e->nx);
	} else
		add_level(&e->level[e->now - 1], row, w, value, weight, n);
}

static double cover(const double *part, const double *fine)
{
	return part[0] * fine[0] + part[1] * fine[1] + part[2] * fine[2];
}

/* Rows of a level from those of the next finer one. */
static void gather(void *context, size_t job, int worker)
{
	struct extension *e = context;
	struct level *l = &e->level[e->now];
	const struct axis *ax = &l->from.x, *ay = &l->from.y;
	double *value = e->scratch + 2 * (size_t)worker * e->row,
	       *weight = value + e->row;

	for (size_t y = job * ROWS; y < lesser((job + 1) * ROWS, l->ny); y++) {
		memset(value, 0, e->row * sizeof *value);
		memset(weight, 0, e->row * sizeof *weight);
		for (size_t k = 0; k < TRANSFER_TAPS; k++)
			if (ay->cover[TRANSFER_TAPS * y + k] > 0)
				add_row(e, ay->first[y] + k,
					ay->cover[TRANSFER_TAPS * y + k], value, weight,
					ax->n);
		for (size_t x = 0; x < l->nx; x++) {
			const double *part = ax->cover + TRANSFER_TAPS * x;
			size_t first = ax->first[x], i = y * l->nx + x;

			l->value[i] = cover(part, value + first);
			l->weight[i] = cover(part, weight + first);
		}
	}
}

/* Share of a cell's own contact in its potential, the rest being what is around. */
static double own_share(double weight)
{
	/* Resistance times mean |q| of the added waves: 2 asinh(1) / pi and
	 * 7 / 18 (sqrt(2) + asinh(1)) pi over the width. */
	const double product = 7. / 9 * asinh(1) * (M_SQRT2 + asinh(1));
	double root = sqrt(weight);

	return root / (root + product * (1 - root));
}

/* A row of the next finer cells interpolated from a level: cell x, or that and the next.
 */
struct between {
	const struct axis *axis;
	const double *row;
};

/* The rows of a level between which a row of finer cells lies, interpolated. */
static struct between rows_between(
	const struct extension *e, const struct level *l, size_t y, int worker)
{
	const struct axis *ax = &l->from.x, *ay = &l->from.y;
	double *row = e->scratch + 2 * (size_t)worker * e->row, share = ay->share[y];
	const double *low = l->value + ay->low[y] * ax->m;
	const double *high = l->value + ay->high[y] * ax->m;

	for (size_t x = 0; x < ax->m; x++)
		row[x] = low[x] + share * (high[x] - low[x]);
	return (struct between){ ax, row };
}

static inline lanes around(const struct between *b, size_t x, int n)
{
	const struct axis *a = b->axis;
	size_t last = x + (size_t)n - 1;
	lanes low = { b->row[a->low[x]], b->row[a->low[last]] };
	lanes high = { b->row[a->high[x]], b->row[a->high[last]] };

	return low + lanes_load(a->share + x, n) * (high - low);
}

/* Rows of a level from the next coarser one and the cells' own. */
static void spread(void *context, size_t job, int worker)
{
	struct extension *e = context;
	const struct level *coarse = &e->level[e->now], *fine = coarse - 1;

	for (size_t y = job * ROWS; y < lesser((job + 1) * ROWS, fine->ny); y++) {
		struct between between = rows_between(e, coarse, y, worker);
		double *value = fine->value + y * fine->nx;
		const double *weight = fine->weight + y * fine->nx;

		for (size_t x = 0; x < fine->nx; x++) {
			double w = weight[x], rest = around(&between, x, 1)[0];

			value[x] = w > 0 ? rest + own_share(w) * (value[x] / w - rest)
					 : rest;
		}
	}
}

static void extend_row(const struct extension *e, size_t y, double *row, int worker)
{
	const double *gap = e->gap + y * e->nx;
	const unsigned char *active = e->active + y * e->nx;
	size_t nx = y < e->ny ? e->nx : 0, all = (size_t)e->par.nx;
	struct between between = { 0 };

	if (e->levels > 0)
		between = rows_between(e, &e->level[0], y, worker);
	for (size_t x = 0; x < nx; x += 2) {
		int n = x + 1 < nx ? 2 : 1;
		lanes own = lanes_load(gap + x, n) - e->approach;
		lanes rest = e->levels > 0 ? around(&between, x, n) : lanes_all(0);

		lanes_store(
			row + x, lanes_pick(lanes_flags(active + x, n), own, rest), n);
	}
	for (size_t x = nx; x < all; x++)
		row[x] = e->levels > 0 ? around(&between, x, 1)[0] : 0;
}

/* Position of cell i across n cells, from 0 to 1. */
static double across(size_t i, size_t n)
{
	return (double)(i + 1) / (double)(n + 1);
}

void extension_row(const struct extension *e, size_t y, double *row, int worker)
{
	size_t nx = (size_t)e->par.nx, ny = (size_t)e->par.ny;
	double *other = e->scratch + (2 * (size_t)worker + 1) * e->row, share;

	if (y < ny) {
		extend_row(e, y, row, worker);
	} else {
		share = across(y - ny, e->my - ny);
		extend_row(e, y - ny, row, worker);
		extend_row(e, y + ny - e->my, other, worker);
		for (size_t x = 0; x < nx; x++)
			row[x] += share * (other[x] - row[x]);
	}
	for (size_t x = nx; x < e->mx; x++)
		row[x] = row[x - nx] +
			 across(x - nx, e->mx - nx) * (row[x + nx - e->mx] - row[x - nx]);
}

/* Conductance by which a coarsest cell is tied to its contact, for its area. */
static double tie(double width, double weight)
{
	double root = sqrt(weight);

	/* A cell that is all contact: tied as if a fiftieth of its width were not.  A
	 * tenth to a two-hundredth takes as many iterations within one. */
	return root / (2 * asinh(1) / M_PI * width * fmax(1 - root, 0.02));
}

/* |q| r + tie (r - own) = 0 on the coarsest level, by conjugate gradients preconditioned
 * with its diagonal. */
static double solve_coarsest(struct extension *e)
{
	struct level *l = &e->level[e->levels - 1];
	double width = sqrt(l->par.dx * l->par.dy), mean = 0, all = 0, last = 0;
	double diagonal = M_PI * (M_SQRT2 + asinh(1)) / 3 / width; /* mean |q| */
	size_t n = l->nx * l->ny;
	int k = 0;

	for (size_t i = 0; i < n; i++) {
		mean += l->value[i];
		all += l->weight[i];
	}
	mean /= all > 0 ? all : 1;
	for (size_t i = 0; i < n; i++) {
		double w = l->weight[i], own = w > 0 ? l->value[i] / w - mean : 0;

		l->value[i] = own_share(w) * own;
		e->ties[i] = tie(width, w);
		e->gradient[i] = e->ties[i] * (l->value[i] - own);
	}
	convolve_apply(e->plane, e->stiffness, l->value, e->image);
	for (size_t i = 0; i < n; i++)
		e->gradient[i] += e->image[i];
	for (; k < STEPS; k++) {
		double moment = 0, curvature = 0, slope = 0, length;

		for (size_t i = 0; i < n; i++)
			moment +=
				e->gradient[i] * e->gradient[i] / (diagonal + e->ties[i]);
		if (!(moment > 0))
			break;
		for (size_t i = 0; i < n; i++)
			e->step[i] = (k ? moment / last * e->step[i] : 0) -
				     e->gradient[i] / (diagonal + e->ties[i]);
		last = moment;
		convolve_apply(e->plane, e->stiffness, e->step, e->image);
		for (size_t i = 0; i < n; i++) {
			e->image[i] += e->ties[i] * e->step[i];
			curvature += e->step[i] * e->image[i];
			slope += e->step[i] * e->gradient[i];
		}
		if (!(curvature > 0))
			break;
		length = -slope / curvature;
		for (size_t i = 0; i < n; i++) {
			l->value[i] += length * e->step[i];
			e->gradient[i] += length * e->image[i];
		}
	}
	for (size_t i = 0; i < n; i++)
		l->value[i] += mean;
	return 2 * (k + 1) * (double)n;
}

static void run_rows(struct extension *e, size_t rows,
	void (*job)(void *context, size_t i, int worker))
{
	pool_run(e->par.pool, (rows + ROWS - 1) / ROWS, job, e);
}

double extension_solve(struct extension *e, const unsigned char *active,
	const double *gap, double approach)
{
	double work;

	e->active = active;
	e->gap = gap;
	e->approach = approach;
	if (e->levels == 0)
		return 0;
	for (e->now = 0; e->now < e->levels; e->now++)
		run_rows(e, e->level[e->now].ny, gather);
	work = solve_coarsest(e);
	for (e->now = e->levels - 1; e->now > 0; e->now--)
		run_rows(e, e->level[e->now].from.y.n, spread);
	return work / ((double)e->nx * (double)e->ny);
}
