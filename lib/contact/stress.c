#include "contact/stress.h"
#include "contact/influence.h"
#include "contact/window.h"
#include "num/fft.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 8, BLOCKS_SIDE = 64, TABLE_STEP = 16, LAYERS_KEPT = 4096, WINDOWS = 8 };

/* Kernel of one layer, as far as it was needed. */
struct layer {
	int wx, wy;              /* offsets below these are in the table */
	double *table;           /* influence_table() */
	int sx, sy;              /* the window of the spectra */
	int count;               /* of them */
	size_t bytes;            /* they take */
	double complex *spectra; /* window_spectra() */
};

/* A part of the grid and its transform. */
struct part {
	int x0, y0, wx, wy;
	struct window *window; /* NULL: the place is free */
	int loaded;            /* with the present pressure, from (x0, y0) on */
	long used;             /* when last */
};

struct load {
	int x, y;
	double pressure;
};

struct block {
	int x0, x1, y0, y1; /* loaded cells within, inclusive */
	double load;        /* in units times m2; 0: none */
};

struct stress {
	struct stress_par par;
	/* Pressures are held in this unit, a power of two near the largest, so that
	 * squares neither overflow nor vanish. */
	double unit;
	double *pressure;
	struct load *loads;
	size_t nloads;
	int x0, x1, y0, y1; /* of the loads, inclusive */
	double total;       /* N */
	int side, bx, by;   /* cells to a block's side, blocks */
	struct block *blocks;
	double point;         /* largest von Mises stress times distance^2 */
	struct layer *layers; /* LAYERS_KEPT, some filled */
	struct layer spare;   /* for those that are not kept */
	size_t used;          /* bytes of kept kernels */
	struct part part[WINDOWS];
	long clock;
	double *sums; /* TENSOR_NUMBERS fields of nx * ny, for the transform */
	struct stress_work work;
};

/* Largest von Mises stress, times distance squared, of a point load with friction, over
 * all directions; 2 % are added for the steps of the search. */
static double largest_point_stress(double nu, double mu)
{
	double most = 0;

	for (int i = 0; i <= 90; i++)
		for (int j = 0; j < 360; j += 2) {
			double up = i * 0.017453292519943295,
			       turn = j * 0.017453292519943295;
			double s[STRESS_COMPONENTS];

			stress_point(nu, mu, cos(up) * cos(turn), cos(up) * sin(turn),
				sin(up), s);
			most = fmax(most, stress_von_mises(s));
		}
	return 1.02 * most;
}

static int par_ok(const struct stress_par *p)
{
	return p->nx > 0 && p->ny > 0 && p->nx <= 1 << 20 && p->ny <= 1 << 20 &&
	       p->ax > 0 && p->ay > 0 && p->dz > 0 && p->offset >= 0 && p->nu >= 0 &&
	       p->nu <= 0.5 && p->mu >= 0 &&
	       isfinite(p->ax + p->ay + p->dz + p->offset + p->mu);
}

struct stress *stress_new(const struct stress_par *par)
{
	struct stress *s;
	size_t n = (size_t)par->nx * par->ny;

	if (!par_ok(par)) {
		errno = EDOM;
		return NULL;
	}
	s = calloc(1, sizeof(*s));
	if (!s)
		return NULL;
	s->par = *par;
	s->side = (par->nx > par->ny ? par->nx : par->ny) / BLOCKS_SIDE;
	s->side = s->side < BLOCK ? BLOCK : s->side;
	s->bx = (par->nx + s->side - 1) / s->side;
	s->by = (par->ny + s->side - 1) / s->side;
	s->blocks = calloc((size_t)s->bx * s->by, sizeof(*s->blocks));
	s->loads = malloc(n * sizeof(*s->loads));
	s->pressure = malloc(n * sizeof(*s->pressure));
	s->layers = calloc(LAYERS_KEPT, sizeof(*s->layers));
	if (!s->blocks || !s->loads || !s->pressure || !s->layers) {
		stress_free(s);
		errno = ENOMEM;
		return NULL;
	}
	s->point = largest_point_stress(par->nu, par->mu);
	return s;
}

static void layer_free(struct layer *l)
{
	free(l->table);
	fft_free(l->spectra);
	memset(l, 0, sizeof(*l));
}

void stress_free(struct stress *s)
{
	if (!s)
		return;
	for (int i = 0; s->layers && i < LAYERS_KEPT; i++)
		layer_free(&s->layers[i]);
	layer_free(&s->spare);
	for (int i = 0; i < WINDOWS; i++)
		window_free(s->part[i].window);
	free(s->sums);
	free(s->layers);
	free(s->blocks);
	free(s->loads);
	free(s->pressure);
	free(s);
}

static void add_to_block(struct stress *s, int x, int y, double load)
{
	struct block *b = &s->blocks[(size_t)(y / s->side) * s->bx + x / s->side];

	if (b->load == 0) {
		b->x0 = b->x1 = x;
		b->y0 = b->y1 = y;
	}
	b->x0 = x < b->x0 ? x : b->x0;
	b->x1 = x > b->x1 ? x : b->x1;
	b->y1 = y;
	b->load += load;
}

/* Power of two at or below the largest magnitude; 0 where a value is not finite. */
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

int stress_load(struct stress *s, const double *pressure)
{
	int nx = s->par.nx, ny = s->par.ny;
	double area = s->par.ax * s->par.ay, unit = unit_of(pressure, (size_t)nx * ny);

	if (unit == 0) {
		errno = EDOM;
		return -1;
	}
	s->unit = unit;
	for (int i = 0; i < WINDOWS; i++)
		s->part[i].loaded = 0;
	s->nloads = 0;
	s->total = 0;
	memset(s->blocks, 0, (size_t)s->bx * s->by * sizeof(*s->blocks));
	s->x0 = nx, s->x1 = -1, s->y0 = ny, s->y1 = -1;
	for (int y = 0; y < ny; y++)
		for (int x = 0; x < nx; x++) {
			double p = pressure[(size_t)y * nx + x] / unit;

			s->pressure[(size_t)y * nx + x] = p;
			if (p == 0)
				continue;
			s->loads[s->nloads++] = (struct load){ x, y, p };
			s->x0 = x < s->x0 ? x : s->x0;
			s->x1 = x > s->x1 ? x : s->x1;
			s->y0 = y < s->y0 ? y : s->y0;
			s->y1 = y;
			s->total += p * area * unit;
			add_to_block(s, x, y, fabs(p) * area);
		}
	return 0;
}

struct stress_work stress_work(const struct stress *s)
{
	return s->work;
}

static double depth(const struct stress *s, long layer)
{
	return (layer + s->par.offset) * s->par.dz;
}

/* What nodes can fail */

/* Distance between two ranges of cells, from node centre to the edge of a loaded cell. */
static double apart(int a0, int a1, int b0, int b1, double size)
{
	int cells = b0 > a1 ? b0 - a1 : a0 > b1 ? a0 - b1 : 0;

	return cells ? (cells - 0.5) * size : 0;
}

static int block_may_fail(const struct stress *s, int bx, int by, double z, double limit)
{
	int x0 = bx * s->side, y0 = by * s->side, last = s->side - 1;
	double sum = 0;

	for (size_t i = 0; i < (size_t)s->bx * s->by; i++) {
		const struct block *b = &s->blocks[i];
		double dx, dy;

		if (b->load == 0)
			continue;
		dx = apart(x0, x0 + last, b->x0, b->x1, s->par.ax);
		dy = apart(y0, y0 + last, b->y0, b->y1, s->par.ay);
		/* Infinite (and so true) where the node may lie on the load. */
		sum += b->load * s->point / (dx * dx + dy * dy + z * z);
		if (sum > limit)
			return 1;
	}
	return 0;
}

size_t stress_spans_max(const struct stress *s)
{
	return (size_t)s->bx * s->par.ny;
}

/* Direct sums */

struct direct {
	struct stress *s;
	const struct stress_span *span;
	size_t count;
	const double *table;
	int wx, wy;
	const ptrdiff_t *place; /* of the loads in the table, against a node's */
	double *mises;
};

static void sum_span(void *context, size_t job, int worker)
{
	const struct direct *d = context;
	const struct stress_span *r = &d->span[job];
	const struct stress *s = d->s;
	ptrdiff_t stride = 2 * (ptrdiff_t)d->wx - 1;

	(void)worker;
	for (int x = r->begin; x < r->end; x++) {
		const double *node =
			d->table +
			((r->y + d->wy - 1) * stride + x + d->wx - 1) * MISES_NUMBERS;
		double v[MISES_NUMBERS] = { 0 };

		for (size_t i = 0; i < s->nloads; i++) {
			const double *k = node - d->place[i];
			double p = s->loads[i].pressure;

			for (int c = 0; c < MISES_NUMBERS; c++)
				v[c] += p * k[c];
		}
		d->mises[(size_t)r->y * s->par.nx + x] = s->unit * influence_mises(v);
	}
}

static int larger(int a, int b)
{
	return a > b ? a : b;
}

/* Offsets a table must hold: between all nodes of the spans and all loads. */
static void table_extent(const struct stress *s, const struct stress_span *span,
	size_t count, int *wx, int *wy)
{
	int x = 0, y = 0;

	for (size_t i = 0; i < count; i++) {
		x = larger(x, larger(s->x1 - span[i].begin, span[i].end - 1 - s->x0));
		y = larger(y, larger(s->y1 - span[i].y, span[i].y - s->y0));
	}
	x = (x / TABLE_STEP + 1) * TABLE_STEP;
	y = (y / TABLE_STEP + 1) * TABLE_STEP;
	*wx = x < s->par.nx ? x : s->par.nx;
	*wy = y < s->par.ny ? y : s->par.ny;
}

static size_t table_bytes(int wx, int wy)
{
	return (2 * (size_t)wx - 1) * (2 * (size_t)wy - 1) * MISES_NUMBERS *
	       sizeof(double);
}

static double *table_new(struct stress *s, double z, int wx, int wy)
{
	double *table = malloc(table_bytes(wx, wy));
	struct influence f;

	if (!table || influence_new(&f, &s->par, z, wx, wy)) {
		free(table);
		return NULL;
	}
	influence_table(&f, table);
	influence_free(&f);
	s->work.kernel_cells += (double)wx * wy;
	return table;
}

static int claim(struct stress *s, size_t bytes)
{
	if (s->used + bytes > s->par.memory)
		return 0;
	s->used += bytes;
	return 1;
}

/* The layer's kernel for direct sums, kept if there is room. */
static struct layer *layer_table(struct stress *s, long layer, int wx, int wy)
{
	struct layer *l = layer < LAYERS_KEPT ? &s->layers[layer] : &s->spare;

	if (l->table && (l->wx < wx || l->wy < wy)) {
		wx = larger(wx, l->wx);
		wy = larger(wy, l->wy);
		s->used -= table_bytes(l->wx, l->wy);
		free(l->table);
		l->table = NULL;
	}
	if (l->table)
		return l;
	if (l == &s->spare || !claim(s, table_bytes(wx, wy))) {
		l = &s->spare;
		layer_free(l);
	}
	l->table = table_new(s, depth(s, layer), wx, wy);
	l->wx = wx;
	l->wy = wy;
	return l->table ? l : NULL;
}

static int mises_direct(struct stress *s, long layer, const struct stress_span *span,
	size_t count, double *mises)
{
	struct direct d = { .s = s, .span = span, .count = count, .mises = mises };
	ptrdiff_t *place = malloc((s->nloads + 1) * sizeof(*place));
	struct layer *l;
	int wx, wy;

	table_extent(s, span, count, &wx, &wy);
	l = place ? layer_table(s, layer, wx, wy) : NULL;
	if (!l) {
		free(place);
		return -1;
	}
	for (size_t i = 0; i < s->nloads; i++)
		place[i] = (s->loads[i].y * (2 * (ptrdiff_t)l->wx - 1) + s->loads[i].x) *
			   MISES_NUMBERS;
	d.table = l->table;
	d.wx = l->wx;
	d.wy = l->wy;
	d.place = place;
	pool_run(s->par.pool, count, sum_span, &d);
	free(place);
	if (l == &s->spare)
		layer_free(l);
	s->work.direct_layers++;
	return 0;
}

/* Fourier sums */

static int round_up(int n, int step, int most)
{
	n = (n + step - 1) / step * step;
	return n < most ? n : most;
}

/* The smallest window of the few sizes there are that holds all loads and spans. */
static struct part part_for(
	const struct stress *s, const struct stress_span *span, size_t count)
{
	int nx = s->par.nx, ny = s->par.ny;
	int x0 = s->x0, x1 = s->x1, y0 = s->y0, y1 = s->y1;
	struct part p = { 0 };

	for (size_t i = 0; i < count; i++) {
		x0 = span[i].begin < x0 ? span[i].begin : x0;
		x1 = larger(x1, span[i].end - 1);
		y0 = span[i].y < y0 ? span[i].y : y0;
		y1 = larger(y1, span[i].y);
	}
	p.wx = s->par.periodic ? nx : round_up(x1 - x0 + 1, larger(nx / 8, 8), nx);
	p.wy = s->par.periodic ? ny : round_up(y1 - y0 + 1, larger(ny / 8, 8), ny);
	p.x0 = x0 + p.wx < nx ? x0 : nx - p.wx;
	p.y0 = y0 + p.wy < ny ? y0 : ny - p.wy;
	return p;
}

static struct part whole_grid(const struct stress *s)
{
	return (struct part){ .wx = s->par.nx, .wy = s->par.ny };
}

/* The window of this size, from those kept or in place of the one not used for longest,
 * with the pressure loaded; NULL when out of memory. */
static struct part *open_part(struct stress *s, struct part want)
{
	struct part *p = &s->part[0];

	if (!s->sums)
		s->sums = malloc((size_t)s->par.nx * s->par.ny * TENSOR_NUMBERS *
				 sizeof(*s->sums));
	if (!s->sums)
		return NULL;
	for (int i = 0; i < WINDOWS; i++) {
		struct part *q = &s->part[i];

		if (q->window && q->wx == want.wx && q->wy == want.wy) {
			p = q;
			break;
		}
		if (q->used < p->used)
			p = q;
	}
	if (!p->window || p->wx != want.wx || p->wy != want.wy) {
		window_free(p->window);
		*p = want;
		p->window = window_new(&s->par, p->wx, p->wy);
	}
	if (p->window && !(p->loaded && p->x0 == want.x0 && p->y0 == want.y0)) {
		window_load(p->window, s->pressure, want.x0, want.y0);
		p->x0 = want.x0;
		p->y0 = want.y0;
		p->loaded = 1;
		s->work.transforms++;
	}
	p->used = ++s->clock;
	return p->window ? p : NULL;
}

static double complex *spectra_new(
	struct stress *s, const struct part *p, long layer, int count)
{
	double complex *out = fft_alloc_complex(count * window_size(p->window));

	if (out && window_spectra(p->window, depth(s, layer), count, out)) {
		fft_free(out);
		return NULL;
	}
	if (!s->par.periodic) {
		s->work.transforms += count;
		s->work.kernel_cells += (double)p->wx * p->wy;
	}
	return out;
}

/* Spectra of the first count numbers of a layer for this window, kept if there is room.
 */
static struct layer *layer_spectra(
	struct stress *s, const struct part *p, long layer, int count)
{
	struct layer *l = layer < LAYERS_KEPT ? &s->layers[layer] : &s->spare;
	size_t bytes = count * window_size(p->window) * sizeof(*l->spectra);

	if (l->spectra && l->sx == p->wx && l->sy == p->wy && l->count >= count)
		return l;
	if (l->spectra) {
		s->used -= l->bytes;
		fft_free(l->spectra);
		l->spectra = NULL;
	}
	if (l == &s->spare || !claim(s, bytes)) {
		l = &s->spare;
		layer_free(l);
	}
	l->spectra = spectra_new(s, p, layer, count);
	l->sx = p->wx;
	l->sy = p->wy;
	l->count = count;
	l->bytes = bytes;
	return l->spectra ? l : NULL;
}

static void sum_numbers(
	struct stress *s, const struct part *p, const double complex *spectra, int count)
{
	size_t n = (size_t)p->wx * p->wy;

	for (int c = 0; c < count; c++)
		window_sum(p->window, spectra, c, s->sums + c * n);
	s->work.transforms += count;
	s->work.fourier_layers++;
}

static int mises_fourier(struct stress *s, long layer, struct part want, double *mises)
{
	struct part *p = open_part(s, want);
	struct layer *l = p ? layer_spectra(s, p, layer, MISES_NUMBERS) : NULL;
	size_t n = (size_t)want.wx * want.wy;

	if (!l)
		return -1;
	sum_numbers(s, p, l->spectra, MISES_NUMBERS);
	if (l == &s->spare)
		layer_free(l);
	for (size_t i = 0; i < n; i++) {
		size_t x = p->x0 + i % p->wx, y = p->y0 + i / p->wx;
		double v[MISES_NUMBERS];

		for (int c = 0; c < MISES_NUMBERS; c++)
			v[c] = s->sums[c * n + i];
		mises[y * s->par.nx + x] = s->unit * influence_mises(v);
	}
	return 0;
}

/* Could the waves of the pressure exceed the limit, in units? */
static int waves_may_fail(struct stress *s, double z, double limit)
{
	struct part *p = open_part(s, whole_grid(s));

	/* Out of memory: the layer itself will tell. */
	return !p || window_bound(p->window, z) > limit;
}

size_t stress_reach(struct stress *s, long layer, double limit, struct stress_span *span)
{
	double z = depth(s, layer);
	size_t count = 0;

	limit /= s->unit;
	if (s->nloads == 0 || (s->par.periodic && !waves_may_fail(s, z, limit)))
		return 0;
	for (int by = 0; by < s->by; by++) {
		size_t first = count;
		int y0 = by * s->side,
		    y1 = y0 + s->side < s->par.ny ? y0 + s->side : s->par.ny;

		for (int bx = 0; bx < s->bx; bx++) {
			int x0 = bx * s->side;
			int x1 = x0 + s->side < s->par.nx ? x0 + s->side : s->par.nx;

			if (!s->par.periodic && !block_may_fail(s, bx, by, z, limit))
				continue;
			if (count > first && span[count - 1].end == x0)
				span[count - 1].end = x1;
			else
				span[count++] = (struct stress_span){ y0, x0, x1 };
		}
		size_t width = count - first;

		for (int y = y0 + 1; y < y1; y++)
			for (size_t k = 0; k < width; k++) {
				span[count] = span[first + k];
				span[count++].y = y;
			}
	}
	return count;
}

double stress_deep(const struct stress *s, long layer)
{
	double point[STRESS_COMPONENTS], z = depth(s, layer), v[MISES_NUMBERS];
	double complex mean[TENSOR_NUMBERS];

	if (!s->par.periodic) {
		stress_point(s->par.nu, s->par.mu, 0, 0, 1, point);
		return stress_von_mises(point) * s->total / (z * z);
	}
	influence_wave(&s->par, 0, 0, z, mean);
	for (int c = 0; c < MISES_NUMBERS; c++)
		v[c] = creal(mean[c]);
	return influence_mises(v) * s->total /
	       (s->par.nx * s->par.ax * s->par.ny * s->par.ay);
}

/* Direct sums cost a multiplication per load and node, transforms some per point and
 * doubling; the factor is where both take the same time (tests/bench/stress.sh). */
static int prefer_direct(const struct stress *s, double nodes, const struct part *p)
{
	static const double CROSSOVER = 0.3;
	double points = 4. * p->wx * p->wy;

	if (s->par.periodic || s->par.method == STRESS_FOURIER)
		return 0;
	return s->par.method == STRESS_DIRECT ||
	       nodes * s->nloads < CROSSOVER * points * log2(points);
}

int stress_mises(struct stress *s, long layer, const struct stress_span *span,
	size_t count, double *mises)
{
	struct part want;
	double nodes = 0;

	for (size_t i = 0; i < count; i++)
		nodes += span[i].end - span[i].begin;
	if (nodes == 0)
		return 0;
	s->work.nodes += nodes;
	want = s->nloads ? part_for(s, span, count) : whole_grid(s);
	if (prefer_direct(s, nodes, &want))
		return mises_direct(s, layer, span, count, mises);
	return mises_fourier(s, layer, want, mises);
}

int stress_tensor(struct stress *s, long layer, double *tensor)
{
	static const enum stress_component place[TENSOR_NUMBERS] = { [DEV_X] = STRESS_XX,
		[DEV_Y] = STRESS_YY,
		[DEV_XY] = STRESS_XY,
		[DEV_XZ] = STRESS_XZ,
		[DEV_YZ] = STRESS_YZ,
		[DEV_ZZ] = STRESS_ZZ };
	size_t n = (size_t)s->par.nx * s->par.ny;
	struct part *p = open_part(s, whole_grid(s));
	struct layer *l = p ? layer_spectra(s, p, layer, TENSOR_NUMBERS) : NULL;

	if (!l)
		return -1;
	sum_numbers(s, p, l->spectra, TENSOR_NUMBERS);
	if (l == &s->spare)
		layer_free(l);
	for (int c = 0; c < TENSOR_NUMBERS; c++)
		for (size_t i = 0; i < n; i++) {
			double zz =
				c == DEV_X || c == DEV_Y ? s->sums[DEV_ZZ * n + i] : 0;

			tensor[place[c] * n + i] = s->unit * (s->sums[c * n + i] + zz);
		}
	s->work.nodes += (double)n;
	return 0;
}
