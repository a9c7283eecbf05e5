#include "num/convolve.h"
#include "num/fft.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/status.h"
#include <complex.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum {
	/* Rows in one job: on 1024 x 1024 points 16 take 7.5 ms, 8 and 32 up to a
	 * third and a tenth more; on 512 x 512 all the same. */
	ROWS = 16,
	COLUMNS = 8 /* columns in one job; 4 take the same time */
};

struct convolve {
	size_t nx, ny;  /* field */
	size_t fx, fy;  /* what is given of x: the field, or it and a frame */
	size_t mx, my;  /* transform: periodic fx, fy; padded at least twice that */
	int wrapped;    /* periodic, but in a padded direction */
	size_t lx;      /* kept coefficients of a row, mx / 2 + 1 */
	size_t stride;  /* coefficients from row to row of a scratch buffer */
	size_t column;  /* coefficients from column to column of work */
	size_t scratch; /* doubles per thread */
	struct pool *pool;
	struct fft *row;       /* real, mx points */
	struct fft_line *line; /* complex, my points */
	size_t room;           /* coefficients that fit in work */
	int borrowed;          /* work belongs to a lender */
	double complex *work;  /* lx columns of fy coefficients */
	double *buffers;       /* scratch of all threads */
	const double *kernel;  /* of the call in progress */
	const struct convolve_passes *passes;
	struct sweep *part; /* of each job of rows */
};

/* Rounds up to whole cache lines of complex numbers, and off large powers of two,
 * whose strides would share a few cache sets. */
static size_t pad_stride(size_t n)
{
	n = (n + 3) / 4 * 4;
	return n % 64 == 0 ? n + 4 : n;
}

/* Doubles of a row in a scratch buffer. */
static size_t row_room(const struct convolve *c)
{
	return (c->mx + 7) / 8 * 8;
}

static size_t row_jobs(const struct convolve *c)
{
	return (c->ny + ROWS - 1) / ROWS;
}

static size_t given_jobs(const struct convolve *c)
{
	return (c->fy + ROWS - 1) / ROWS;
}

struct convolve *convolve_new(
	size_t nx, size_t ny, enum convolve_kind kind, struct pool *pool)
{
	return convolve_borrow(nx, ny, kind, pool, NULL);
}

/* 1 if a transform of n points takes longer than a padded one: FFTW 3.3 does from the
 * prime factor 37 on (992 = 31 * 32: 0.9, 962 = 26 * 37: 1.3, 1021: 2.8 times as long).
 */
static int is_awkward(size_t n)
{
	for (size_t p = 2; p <= 31; p++)
		while (n % p == 0 && n > 1)
			n /= p;
	return n > 1;
}

static size_t larger(size_t a, size_t b)
{
	return a > b ? a : b;
}

size_t convolve_good_period(size_t n)
{
	return is_awkward(n) ? fft_fast_size(n) : n;
}

/* Points of a transform of n. */
static size_t points(size_t n, int padded)
{
	return padded ? fft_fast_size(2 * n - 1) : n;
}

/* Memory and plans for the sizes that are set. */
static struct convolve *prepare(struct convolve *c, const struct convolve *lender)
{
	c->lx = c->mx / 2 + 1;
	c->stride = pad_stride(c->lx);
	c->column = pad_stride(c->fy);
	c->scratch = larger(row_room(c) + 2 * ROWS * c->stride, 4 * pad_stride(c->my));
	c->room = c->lx * c->column;
	c->borrowed = lender && lender->room >= c->room;
	c->work = c->borrowed ? lender->work : fft_alloc_complex(c->room);
	c->buffers = fft_alloc((size_t)pool_threads(c->pool) * c->scratch);
	c->part = calloc(row_jobs(c), sizeof *c->part);
	c->row = fft_new(c->mx, 1);
	c->line = fft_line_new(c->my);
	if (!c->work || !c->buffers || !c->part || !c->row || !c->line) {
		convolve_free(c);
		return NULL;
	}
	return c;
}

struct convolve *convolve_borrow(size_t nx, size_t ny, enum convolve_kind kind,
	struct pool *pool, const struct convolve *lender)
{
	struct convolve *c = calloc(1, sizeof *c);
	int padded_x = kind == CONVOLVE_PADDED || is_awkward(nx);
	int padded_y = kind == CONVOLVE_PADDED || is_awkward(ny);

	if (!c)
		return NULL;
	c->wrapped = kind == CONVOLVE_PERIODIC && (padded_x || padded_y);
	c->nx = c->fx = nx;
	c->ny = c->fy = ny;
	c->mx = points(nx, padded_x);
	c->my = points(ny, padded_y);
	c->pool = pool;
	return prepare(c, lender);
}

struct convolve *convolve_frame(size_t nx, size_t ny, size_t mx, size_t my,
	struct pool *pool, const struct convolve *lender)
{
	struct convolve *c = calloc(1, sizeof *c);

	if (!c)
		return NULL;
	c->nx = nx;
	c->ny = ny;
	c->mx = c->fx = mx;
	c->my = c->fy = my;
	c->pool = pool;
	return prepare(c, lender);
}

void convolve_free(struct convolve *c)
{
	if (!c)
		return;
	fft_done(c->row);
	fft_line_done(c->line);
	if (!c->borrowed)
		fft_free(c->work);
	fft_free(c->buffers);
	free(c->part);
	free(c);
}

/* Kernels are stored column by column, ky = 0..my / 2. */
static size_t kernel_column(const struct convolve *c)
{
	return c->my / 2 + 1;
}

double *convolve_alloc(const struct convolve *c)
{
	return fft_alloc(c->lx * kernel_column(c));
}

/* Values of an even field in its quarter, rows of mx / 2 + 1. */
struct even {
	double *quarter;
	size_t mx, my, lx, ly;
	double (*value)(const void *context, size_t ix, size_t iy);
	const void *context;
	const struct fft *rows, *columns;
	double *lines; /* of each thread a line and its transform */
	size_t room;   /* doubles of both */
};

static void fill_row(void *context, size_t y, int worker)
{
	const struct even *e = context;

	(void)worker;
	for (size_t x = 0; x < e->lx; x++)
		e->quarter[y * e->lx + x] = e->value(e->context, x, y);
}

/* A line of the quarter spread to its full length, transformed, and the half of it that
 * symmetry does not give put back. */
static void transform_line(const struct even *e, const struct fft *fft, double *from,
	size_t stride, size_t n, int worker)
{
	double *line = e->lines + (size_t)worker * e->room;
	double complex *out = (double complex *)(line + (n + 7) / 8 * 8);

	for (size_t i = 0; i < n; i++)
		line[i] = from[(i <= n / 2 ? i : n - i) * stride];
	fft_forward(fft, line, out);
	for (size_t i = 0; i <= n / 2; i++)
		from[i * stride] = creal(out[i]);
}

static void transform_row(void *context, size_t y, int worker)
{
	const struct even *e = context;

	transform_line(e, e->rows, e->quarter + y * e->lx, 1, e->mx, worker);
}

static void transform_column(void *context, size_t x, int worker)
{
	const struct even *e = context;

	transform_line(e, e->columns, e->quarter + x, e->lx, e->my, worker);
}

/* The transform of an even field from its values, rows and columns one by one; its
 * quarter, to be freed, or NULL. */
static double *transform_even(size_t mx, size_t my, struct pool *pool,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context)
{
	struct even e = { .mx = mx,
		.my = my,
		.lx = mx / 2 + 1,
		.ly = my / 2 + 1,
		.value = value,
		.context = context };
	struct fft *rows = fft_new(mx, 1), *columns = fft_new(my, 1);

	e.rows = rows;
	e.columns = columns;
	e.room = 2 * ((larger(mx, my) + 7) / 8 * 8) + 8;
	e.quarter = fft_alloc(e.lx * e.ly);
	e.lines = fft_alloc((size_t)pool_threads(pool) * e.room);
	if (e.quarter && e.lines && rows && columns) {
		pool_run(pool, e.ly, fill_row, &e);
		pool_run(pool, e.ly, transform_row, &e);
		pool_run(pool, e.lx, transform_column, &e);
	} else {
		fft_free(e.quarter);
		e.quarter = NULL;
	}
	fft_done(rows);
	fft_done(columns);
	fft_free(e.lines);
	return e.quarter;
}

/* A kernel from its values at wave numbers or from the quarter that holds them, one
 * column a job. */
struct columns {
	const struct convolve *c;
	double *kernel;
	double (*factor)(const void *context, size_t kx, size_t ky);
	const void *context;
	const double *quarter;
};

static void fill_column(void *context, size_t kx, int worker)
{
	const struct columns *f = context;
	const struct convolve *c = f->c;
	size_t height = kernel_column(c);
	double *column = f->kernel + kx * height;
	double scale = 1 / ((double)c->mx * (double)c->my);

	(void)worker;
	for (size_t ky = 0; ky < height; ky++)
		column[ky] = scale * (f->quarter ? f->quarter[ky * c->lx + kx]
						 : f->factor(f->context, kx, ky));
}

static enum num_status set_kernel(const struct convolve *c, double *kernel,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context)
{
	double *quarter = transform_even(c->mx, c->my, c->pool, value, context);
	struct columns columns = { .c = c, .kernel = kernel, .quarter = quarter };

	if (!quarter)
		return NUM_MEMORY;
	pool_run(c->pool, c->lx, fill_column, &columns);
	fft_free(quarter);
	return NUM_OK;
}

/* An even kernel of one period, at any offset. */
struct period {
	size_t nx, ny;
	double (*value)(const void *context, size_t ix, size_t iy);
	const void *context;
};

static double periodic_value(const void *context, size_t ix, size_t iy)
{
	const struct period *p = context;
	size_t x = ix % p->nx, y = iy % p->ny;

	return p->value(
		p->context, x < p->nx - x ? x : p->nx - x, y < p->ny - y ? y : p->ny - y);
}

enum num_status convolve_kernel(const struct convolve *c, double *kernel,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context)
{
	const struct period period = { c->nx, c->ny, value, context };

	return c->wrapped ? set_kernel(c, kernel, periodic_value, &period)
			  : set_kernel(c, kernel, value, context);
}

struct quarter {
	const double *value;
	size_t stride;
	double scale;
};

static double quarter_value(const void *context, size_t ix, size_t iy)
{
	const struct quarter *q = context;

	return q->scale * q->value[iy * q->stride + ix];
}

/* From the values of one period. */
static enum num_status wrapped_spectrum(const struct convolve *c, double *kernel,
	double (*factor)(const void *context, size_t kx, size_t ky), const void *context)
{
	double *value = transform_even(c->nx, c->ny, c->pool, factor, context);
	struct quarter quarter = { value, c->nx / 2 + 1,
		1 / ((double)c->nx * (double)c->ny) };
	enum num_status status = NUM_MEMORY;

	if (value)
		status = convolve_kernel(c, kernel, quarter_value, &quarter);
	fft_free(value);
	return status;
}

enum num_status convolve_spectrum(const struct convolve *c, double *kernel,
	double (*factor)(const void *context, size_t kx, size_t ky), const void *context)
{
	struct columns columns = {
		.c = c, .kernel = kernel, .factor = factor, .context = context
	};

	if (c->wrapped)
		return wrapped_spectrum(c, kernel, factor, context);
	pool_run(c->pool, c->lx, fill_column, &columns);
	return NUM_OK;
}

/* A complex number as two lanes. */
static inline lanes get(const double complex *z)
{
	return lanes_load((const double *)z, 2);
}

static inline void put(double complex *z, lanes value)
{
	lanes_store((double *)z, value, 2);
}

/* Scratch memory of a thread, and the spectra of a job's rows in it. */
static double *buffer(const struct convolve *c, int worker)
{
	return c->buffers + (size_t)worker * c->scratch;
}

static double complex *spectra(const struct convolve *c, int worker)
{
	return (double complex *)(buffer(c, worker) + row_room(c));
}

/* 1 if a row can be transformed where it is: of the full length, and aligned as the plans
 * were made for. */
static int in_place(const struct convolve *c, size_t n, const double *row)
{
	return c->mx == n && (uintptr_t)row % FFT_ALIGNMENT == 0;
}

static void forward_rows(void *context, size_t job, int worker)
{
	const struct convolve *c = context;
	const struct convolve_passes *p = c->passes;
	double *row = buffer(c, worker);
	double complex *spectrum = spectra(c, worker), *work = c->work + job * ROWS;
	size_t nx = c->fx, rows = lesser(ROWS, c->fy - job * ROWS), stride = c->stride;

	for (size_t k = 0; k < rows; k++) {
		const double *x = p->x ? p->x + (job * ROWS + k) * nx : row;

		if (!p->x)
			p->load(p->context, job * ROWS + k, row, worker);
		if (lanes_next(x, 0, nx) == nx) {
			memset(spectrum + k * stride, 0, c->lx * sizeof *spectrum);
			continue;
		}
		if (in_place(c, nx, x)) {
			fft_forward(c->row, x, spectrum + k * stride);
			continue;
		}
		if (p->x)
			memcpy(row, x, nx * sizeof *row);
		/* The inverse transform of an earlier row may have written there. */
		memset(row + nx, 0, (c->mx - nx) * sizeof *row);
		fft_forward(c->row, row, spectrum + k * stride);
	}
	for (size_t kx = 0; kx < c->lx; kx++)
		for (size_t k = 0; k < rows; k++)
			put(&work[kx * c->column + k], get(&spectrum[k * stride + kx]));
}

static void inverse_rows(void *context, size_t job, int worker)
{
	const struct convolve *c = context;
	const struct convolve_passes *p = c->passes;
	double *row = buffer(c, worker);
	double complex *spectrum = spectra(c, worker);
	const double complex *work = c->work + job * ROWS;
	size_t nx = c->nx, rows = lesser(ROWS, c->ny - job * ROWS), stride = c->stride;
	size_t begin = job * ROWS * nx;
	double *y;

	for (size_t kx = 0; kx < c->lx; kx++)
		for (size_t k = 0; k < rows; k++)
			put(&spectrum[k * stride + kx], get(&work[kx * c->column + k]));
	for (size_t k = 0; k < rows; k++) {
		if (p->wants && !p->wants(p->context, job * ROWS + k))
			continue;
		y = in_place(c, nx, p->y + begin + k * nx) ? p->y + begin + k * nx : row;
		fft_inverse(c->row, spectrum + k * stride, y);
		if (y == row)
			memcpy(p->y + begin + k * nx, row, nx * sizeof *row);
	}
	c->part[job] = sweep_start();
	if (p->pass)
		p->pass(p->context, begin, begin + rows * nx, &c->part[job]);
}

static inline void scale(double complex *z, double factor)
{
	put(z, factor * get(z));
}

/* Spectrum times a kernel that is even: k[i] serves i and n - i. */
static void multiply(double complex *s, const double *k, size_t n)
{
	scale(&s[0], k[0]);
	for (size_t i = 1; i < (n + 1) / 2; i++) {
		scale(&s[i], k[i]);
		scale(&s[n - i], k[i]);
	}
	if (n % 2 == 0)
		scale(&s[n / 2], k[n / 2]);
}

/* One column in place; f and e are scratch. */
static void convolve_column(const struct convolve *c, const double *k, double complex *a,
	double complex *f, double complex *e)
{
	size_t n = c->fy, gap = c->my - n;

	if (gap > 0) {
		memcpy(e, a, n * sizeof *a);
		memset(e + n, 0, gap * sizeof *e);
	}
	fft_line_forward(c->line, gap > 0 ? e : a, f);
	multiply(f, k, c->my);
	fft_line_inverse(c->line, f, gap > 0 ? e : a);
	if (gap > 0)
		memcpy(a, e, n * sizeof *a);
}

static void convolve_columns(void *context, size_t job, int worker)
{
	const struct convolve *c = context;
	double complex *f = (double complex *)buffer(c, worker);
	double complex *e = f + pad_stride(c->my);

	for (size_t kx = job * COLUMNS; kx < lesser((job + 1) * COLUMNS, c->lx); kx++)
		convolve_column(c, c->kernel + kx * kernel_column(c),
			c->work + kx * c->column, f, e);
}

struct sweep convolve_run(
	struct convolve *c, const double *kernel, const struct convolve_passes *passes)
{
	struct sweep all = sweep_start();

	c->kernel = kernel;
	c->passes = passes;
	pool_run(c->pool, given_jobs(c), forward_rows, c);
	pool_run(c->pool, (c->lx + COLUMNS - 1) / COLUMNS, convolve_columns, c);
	pool_run(c->pool, row_jobs(c), inverse_rows, c);
	for (size_t job = 0; job < row_jobs(c); job++)
		sweep_add(&all, &c->part[job]);
	return all;
}

void convolve_apply(struct convolve *c, const double *kernel, const double *x, double *y)
{
	const struct convolve_passes passes = { .x = x, .y = y };

	convolve_run(c, kernel, &passes);
}
