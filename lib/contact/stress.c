#include "contact/stress.h"
#include "contact/stress_kernel.h"
#include "num/fft.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is summed: the five numbers the von Mises stress needs, and the sixth that makes
 * them the tensor. */
enum { DEV_X, DEV_Y, DEV_XY, DEV_XZ, DEV_YZ, MISES, ZZ = MISES, TENSOR };

enum { BLOCK = 8, BLOCKS_SIDE = 64, TABLE_STEP = 16, LAYERS_KEPT = 4096 };

static const double TWO_PI = 6.283185307179586476925286766559;

/* Kernel of one layer, as far as it was needed. */
struct layer {
	int wx, wy;               /* offsets below these are in the table */
	double *table;            /* [(wy-1 + j)(2 wx - 1) + wx-1 + i][MISES] */
	double complex *spectrum; /* MISES spectra of the padded grid */
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
	size_t px, py, points, half; /* transform, its points and coefficients */
	struct fft *fft;
	/* Pressures are held in this unit, a power of two near the largest, so that
	 * squares neither overflow nor vanish. */
	double unit;
	double *pressure;
	double complex *image; /* of the pressure; valid if imaged */
	int imaged;
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
	double *sums;         /* TENSOR fields of nx * ny, for the transform */
	double *plane;        /* padded grid */
	double complex *product;
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
	s->px = par->periodic ? (size_t)par->nx : fft_good_size(2 * (size_t)par->nx - 1);
	s->py = par->periodic ? (size_t)par->ny : fft_good_size(2 * (size_t)par->ny - 1);
	s->points = s->px * s->py;
	s->half = (s->px / 2 + 1) * s->py;
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
	fft_free(l->spectrum);
	memset(l, 0, sizeof(*l));
}

void stress_free(struct stress *s)
{
	if (!s)
		return;
	for (int i = 0; s->layers && i < LAYERS_KEPT; i++)
		layer_free(&s->layers[i]);
	layer_free(&s->spare);
	if (s->fft)
		fft_done(s->fft);
	fft_free(s->image);
	fft_free(s->plane);
	fft_free(s->product);
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
	s->imaged = 0;
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

/* Kernels */

/* One stress component of pressure and shear together, at an offset with the signs of
 * flipx and flipy, from the coefficients of the quarter plane. */
static double combine(const struct stress *s, const double *normal, const double *shear,
	int flipx, int flipy, enum stress_component c)
{
	int odd = (flipx && stress_odd(c, 0)) ^ (flipy && stress_odd(c, 1));
	int shear_odd = odd ^ (s->par.axis ? flipy : flipx);
	double value = odd ? -normal[c] : normal[c];

	if (shear)
		value += (shear_odd ? -s->par.mu : s->par.mu) * shear[c];
	return value;
}

/* Quarter-plane coefficients of a layer; for shear along y the axes change places. */
struct quarter {
	int wx, wy, turned;
	double *normal, *shear;
};

static void turn(double *t)
{
	double xx = t[STRESS_XX], xz = t[STRESS_XZ];

	t[STRESS_XX] = t[STRESS_YY];
	t[STRESS_YY] = xx;
	t[STRESS_XZ] = t[STRESS_YZ];
	t[STRESS_YZ] = xz;
}

static int quarter_new(struct stress *s, double z, int wx, int wy, struct quarter *q)
{
	const struct stress_par *p = &s->par;
	size_t n = (size_t)wx * wy * STRESS_COMPONENTS;

	q->wx = wx;
	q->wy = wy;
	q->turned = p->mu > 0 && p->axis == 1;
	q->shear = NULL;
	q->normal = malloc(n * (p->mu > 0 ? 2 : 1) * sizeof(*q->normal));
	if (!q->normal)
		return -1;
	if (p->mu > 0)
		q->shear = q->normal + n;
	s->work.kernel_cells += (double)wx * wy;
	if (q->turned ? stress_cells(p->ay, p->ax, p->nu, z, wy, wx, q->normal, q->shear)
		      : stress_cells(
				p->ax, p->ay, p->nu, z, wx, wy, q->normal, q->shear)) {
		free(q->normal);
		return -1;
	}
	for (size_t i = 0; q->turned && q->shear && i < n; i += STRESS_COMPONENTS) {
		turn(q->normal + i);
		turn(q->shear + i);
	}
	return 0;
}

/* Number c (DEV_X ...) of the kernel at an offset. */
static double quarter_at(
	const struct stress *s, const struct quarter *q, int i, int j, int c)
{
	static const enum stress_component first[TENSOR] = { [DEV_X] = STRESS_XX,
		[DEV_Y] = STRESS_YY,
		[DEV_XY] = STRESS_XY,
		[DEV_XZ] = STRESS_XZ,
		[DEV_YZ] = STRESS_YZ,
		[ZZ] = STRESS_ZZ };
	int ai = abs(i), aj = abs(j);
	size_t at = (q->turned ? (size_t)ai * q->wy + aj : (size_t)aj * q->wx + ai) *
		    STRESS_COMPONENTS;
	const double *normal = q->normal + at, *shear = q->shear ? q->shear + at : NULL;
	double value = combine(s, normal, shear, i < 0, j < 0, first[c]);

	if (c == DEV_X || c == DEV_Y)
		value -= combine(s, normal, shear, i < 0, j < 0, STRESS_ZZ);
	return value;
}

/* Table of all offsets |i| < wx, |j| < wy with count numbers each. */
static double *table_new(struct stress *s, double z, int wx, int wy, int count)
{
	struct quarter q;
	size_t rows = 2 * (size_t)wy - 1, cols = 2 * (size_t)wx - 1;
	double *table = malloc(rows * cols * count * sizeof(*table)), *at = table;

	if (!table || quarter_new(s, z, wx, wy, &q)) {
		free(table);
		return NULL;
	}
	for (int j = 1 - wy; j < wy; j++)
		for (int i = 1 - wx; i < wx; i++, at += count) {
			for (int c = 0; c < count; c++)
				at[c] = quarter_at(s, &q, i, j, c);
		}
	free(q.normal);
	return table;
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

static double mises_of(const double v[MISES])
{
	double t = v[DEV_XY] * v[DEV_XY] + v[DEV_XZ] * v[DEV_XZ] + v[DEV_YZ] * v[DEV_YZ];
	double d = v[DEV_X] * v[DEV_X] + v[DEV_Y] * v[DEV_Y] - v[DEV_X] * v[DEV_Y];

	return sqrt(d + 3 * t);
}

static void sum_span(void *context, size_t job, int worker)
{
	const struct direct *d = context;
	const struct stress_span *r = &d->span[job];
	const struct stress *s = d->s;
	ptrdiff_t stride = 2 * (ptrdiff_t)d->wx - 1;

	(void)worker;
	for (int x = r->begin; x < r->end; x++) {
		const double *node =
			d->table + ((r->y + d->wy - 1) * stride + x + d->wx - 1) * MISES;
		double v[MISES] = { 0 };

		for (size_t i = 0; i < s->nloads; i++) {
			const double *k = node - d->place[i];
			double p = s->loads[i].pressure;

			for (int c = 0; c < MISES; c++)
				v[c] += p * k[c];
		}
		d->mises[(size_t)r->y * s->par.nx + x] = s->unit * mises_of(v);
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

static int claim(struct stress *s, size_t bytes)
{
	if (s->used + bytes > s->par.memory)
		return 0;
	s->used += bytes;
	return 1;
}

static size_t table_bytes(int wx, int wy)
{
	return (2 * (size_t)wx - 1) * (2 * (size_t)wy - 1) * MISES * sizeof(double);
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
	l->table = table_new(s, depth(s, layer), wx, wy, MISES);
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
			   MISES;
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

static int fourier_start(struct stress *s)
{
	if (s->fft)
		return 0;
	s->plane = fft_alloc(s->points);
	s->image = fft_alloc_complex(s->half);
	s->product = fft_alloc_complex(s->half);
	s->sums = malloc((size_t)s->par.nx * s->par.ny * TENSOR * sizeof(*s->sums));
	if (!s->plane || !s->image || !s->product || !s->sums)
		return -1;
	s->fft = fft_new(s->px, s->py);
	return s->fft ? 0 : -1;
}

static void image_pressure(struct stress *s)
{
	if (s->imaged)
		return;
	memset(s->plane, 0, s->points * sizeof(*s->plane));
	for (int y = 0; y < s->par.ny; y++)
		memcpy(s->plane + y * s->px, s->pressure + (size_t)y * s->par.nx,
			s->par.nx * sizeof(*s->plane));
	fft_forward(s->fft, s->plane, s->image);
	s->work.transforms++;
	s->imaged = 1;
}

/* Spectra of the cells' influence, wrapped around. */
static int free_spectra(struct stress *s, double z, int count, double complex *out)
{
	int nx = s->par.nx, ny = s->par.ny;
	struct quarter q;

	if (quarter_new(s, z, nx, ny, &q))
		return -1;
	for (int c = 0; c < count; c++) {
		memset(s->plane, 0, s->points * sizeof(*s->plane));
		for (int j = 1 - ny; j < ny; j++)
			for (int i = 1 - nx; i < nx; i++) {
				size_t x = i < 0 ? i + s->px : (size_t)i;
				size_t y = j < 0 ? j + s->py : (size_t)j;

				s->plane[y * s->px + x] = quarter_at(s, &q, i, j, c);
			}
		fft_forward(s->fft, s->plane, out + c * s->half);
		s->work.transforms++;
	}
	free(q.normal);
	return 0;
}

/* Westergaard's harmonic loads.  A wave of pressure gives plane strain along its wave
 * vector (a, b); a wave of shear is split along it (plane strain) and across it
 * (antiplane).  The mean load meets a laterally confined half-space. */
static void harmonic(const struct stress_par *p, double kx, double ky, double z,
	double complex out[TENSOR])
{
	double q = hypot(kx, ky), e = exp(-q * z), nu = p->nu, a, b, along, across;
	double complex ll, tt, zz, lt, lz, tz, xx, yy;

	if (q == 0) {
		out[DEV_X] = out[DEV_Y] = (1 - 2 * nu) / (1 - nu);
		out[DEV_XY] = 0;
		out[DEV_XZ] = p->axis == 0 ? -p->mu : 0;
		out[DEV_YZ] = p->axis == 1 ? -p->mu : 0;
		out[ZZ] = -1;
		return;
	}
	a = kx / q, b = ky / q;
	along = p->mu * (p->axis == 0 ? a : b);
	across = p->mu * (p->axis == 0 ? -b : a);
	q *= z;
	ll = e * (q - 1 + I * along * (2 - q));
	tt = 2 * nu * e * (I * along - 1);
	zz = e * (-1 - q + I * along * q);
	lt = e * I * across;
	lz = e * (I * q - along * (1 - q));
	tz = -e * across;
	xx = a * a * ll + b * b * tt - 2 * a * b * lt;
	yy = b * b * ll + a * a * tt + 2 * a * b * lt;
	out[DEV_X] = xx - zz;
	out[DEV_Y] = yy - zz;
	out[DEV_XY] = a * b * (ll - tt) + (a * a - b * b) * lt;
	out[DEV_XZ] = a * lz - b * tz;
	out[DEV_YZ] = b * lz + a * tz;
	out[ZZ] = zz;
}

static void periodic_spectra(struct stress *s, double z, int count, double complex *out)
{
	int nx = s->par.nx, ny = s->par.ny;
	double ux = TWO_PI / (nx * s->par.ax), uy = TWO_PI / (ny * s->par.ay);

	for (int j = 0; j < ny; j++)
		for (int i = 0; i <= nx / 2; i++) {
			size_t at = (size_t)j * (nx / 2 + 1) + i;
			int edge = (nx % 2 == 0 && i == nx / 2) ||
				   (ny % 2 == 0 && j == ny / 2);
			double complex v[TENSOR];

			harmonic(&s->par, i * ux, (2 * j > ny ? j - ny : j) * uy, z, v);
			/* The shortest wave has no sense of direction. */
			for (int c = 0; c < count; c++)
				out[c * s->half + at] = edge ? creal(v[c]) : v[c];
		}
}

/* Sums of the first count numbers, in s->sums. */
static int sum_fourier(struct stress *s, const double complex *spectrum, int count)
{
	size_t n = (size_t)s->par.nx * s->par.ny;
	double scale = 1. / (double)s->points;

	image_pressure(s);
	for (int c = 0; c < count; c++) {
		for (size_t i = 0; i < s->half; i++)
			s->product[i] = s->image[i] * spectrum[c * s->half + i] * scale;
		fft_inverse(s->fft, s->product, s->plane);
		s->work.transforms++;
		for (int y = 0; y < s->par.ny; y++)
			memcpy(s->sums + c * n + (size_t)y * s->par.nx,
				s->plane + y * s->px, s->par.nx * sizeof(*s->sums));
	}
	return 0;
}

/* Largest von Mises stress of a wave at its depth x = q z, by the norm of its tensor:
 * falls with x for all nu and mu. */
static double wave_bound(const struct stress_par *p, double x)
{
	double normal = 2 + 4 * p->nu * p->nu + 4 * x * x;
	double shear = 10 - 8 * x + 4 * x * x + 4 * p->nu * p->nu;

	return sqrt(1.5) * exp(-x) * (sqrt(normal) + p->mu * sqrt(shear));
}

/* Could the sum over all waves of the pressure exceed the limit? */
static int waves_may_fail(struct stress *s, double z, double limit)
{
	int nx = s->par.nx, ny = s->par.ny, half = nx / 2 + 1;
	double ux = TWO_PI / (nx * s->par.ax), uy = TWO_PI / (ny * s->par.ay), sum;
	double complex mean[TENSOR];
	double v[MISES];

	if (fourier_start(s))
		return 1; /* the layer itself will tell */
	image_pressure(s);
	harmonic(&s->par, 0, 0, z, mean);
	for (int c = 0; c < MISES; c++)
		v[c] = creal(mean[c] * s->image[0]);
	sum = mises_of(v);
	limit *= (double)s->points;
	for (int j = 0; j < ny && sum <= limit; j++)
		for (int i = j == 0; i < half; i++) {
			double q = hypot(i * ux, (2 * j > ny ? j - ny : j) * uy);
			int twice = i > 0 && 2 * i < nx;

			sum += (twice + 1) * cabs(s->image[(size_t)j * half + i]) *
			       wave_bound(&s->par, q * z);
		}
	return sum > limit;
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
	double point[STRESS_COMPONENTS], z = depth(s, layer), v[MISES];
	double complex mean[TENSOR];

	if (!s->par.periodic) {
		stress_point(s->par.nu, s->par.mu, 0, 0, 1, point);
		return stress_von_mises(point) * s->total / (z * z);
	}
	harmonic(&s->par, 0, 0, z, mean);
	for (int c = 0; c < MISES; c++)
		v[c] = creal(mean[c]);
	return mises_of(v) * s->total / (s->par.nx * s->par.ax * s->par.ny * s->par.ay);
}

static double complex *spectra_new(struct stress *s, long layer, int count)
{
	double complex *out = fft_alloc_complex(count * s->half);

	if (!out)
		return NULL;
	if (s->par.periodic) {
		periodic_spectra(s, depth(s, layer), count, out);
	} else if (free_spectra(s, depth(s, layer), count, out)) {
		fft_free(out);
		return NULL;
	}
	return out;
}

static int mises_fourier(struct stress *s, long layer, double *mises)
{
	struct layer *l = layer < LAYERS_KEPT ? &s->layers[layer] : &s->spare;
	size_t n = (size_t)s->par.nx * s->par.ny;

	if (fourier_start(s))
		return -1;
	if (!l->spectrum) {
		if (l == &s->spare || !claim(s, MISES * s->half * sizeof(*l->spectrum)))
			l = &s->spare;
		l->spectrum = spectra_new(s, layer, MISES);
	}
	if (!l->spectrum)
		return -1;
	sum_fourier(s, l->spectrum, MISES);
	if (l == &s->spare)
		layer_free(l);
	for (size_t i = 0; i < n; i++) {
		double v[MISES];

		for (int c = 0; c < MISES; c++)
			v[c] = s->sums[c * n + i];
		mises[i] = s->unit * mises_of(v);
	}
	s->work.fourier_layers++;
	return 0;
}

/* Direct sums cost a multiplication per load and node, transforms some per point and
 * doubling; the factor is where both take the same time (tests/bench/stress.sh). */
static int prefer_direct(const struct stress *s, double nodes)
{
	static const double CROSSOVER = 0.35;

	if (s->par.periodic || s->par.method == STRESS_FOURIER)
		return 0;
	return s->par.method == STRESS_DIRECT ||
	       nodes * s->nloads < CROSSOVER * s->points * log2((double)s->points + 1);
}

int stress_mises(struct stress *s, long layer, const struct stress_span *span,
	size_t count, double *mises)
{
	double nodes = 0;

	for (size_t i = 0; i < count; i++)
		nodes += span[i].end - span[i].begin;
	if (nodes == 0)
		return 0;
	s->work.nodes += nodes;
	if (prefer_direct(s, nodes))
		return mises_direct(s, layer, span, count, mises);
	return mises_fourier(s, layer, mises);
}

int stress_tensor(struct stress *s, long layer, double *tensor)
{
	size_t n = (size_t)s->par.nx * s->par.ny;
	double complex *spectrum;

	if (fourier_start(s))
		return -1;
	spectrum = spectra_new(s, layer, TENSOR);
	if (!spectrum)
		return -1;
	sum_fourier(s, spectrum, TENSOR);
	fft_free(spectrum);
	for (size_t i = 0; i < n; i++) {
		double zz = s->sums[ZZ * n + i];

		tensor[STRESS_XX * n + i] = s->unit * (s->sums[DEV_X * n + i] + zz);
		tensor[STRESS_YY * n + i] = s->unit * (s->sums[DEV_Y * n + i] + zz);
		tensor[STRESS_ZZ * n + i] = s->unit * zz;
		tensor[STRESS_XY * n + i] = s->unit * s->sums[DEV_XY * n + i];
		tensor[STRESS_XZ * n + i] = s->unit * s->sums[DEV_XZ * n + i];
		tensor[STRESS_YZ * n + i] = s->unit * s->sums[DEV_YZ * n + i];
	}
	s->work.fourier_layers++;
	s->work.nodes += n;
	return 0;
}
