#include "num/convolve.h"
#include "num/fft.h"
#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	ROWS = 16,  /* rows in one job */
	COLUMNS = 8 /* columns in one job: two cache lines of each row, and few enough
		     * to stay in the second-level cache */
};

struct convolve {
	enum convolve_kind kind;
	size_t nx, ny;  /* field */
	size_t mx, my;  /* transform: periodic nx, ny; padded at least twice that */
	size_t lx, ly;  /* kept coefficients mx / 2 + 1; length of column transforms */
	size_t stride;  /* coefficients from row to row of work */
	size_t column;  /* coefficients from column to column of a scratch buffer */
	size_t scratch; /* doubles per thread */
	struct pool *pool;
	struct fft *row;       /* real, mx points */
	struct fft_line *line; /* complex, ly points */
	size_t room;           /* coefficients that fit in work */
	int borrowed;          /* work belongs to a lender */
	double complex *work;  /* ny rows of lx coefficients */
	double complex *twist; /* exp(-i pi j / ly), padded only */
	double *buffers;       /* scratch of all threads */
	const double *kernel;  /* of the call in progress */
	const double *x;
	double *y;
	double *products; /* x y of each job of rows; wanted only for x other than y */
};

/* Rounds up to whole cache lines of complex numbers, and off large powers of two,
 * whose strides would share a few cache sets. */
static size_t pad_stride(size_t n)
{
	n = (n + 3) / 4 * 4;
	return n % 64 == 0 ? n + 4 : n;
}

struct convolve *convolve_new(
	size_t nx, size_t ny, enum convolve_kind kind, struct pool *pool)
{
	return convolve_borrow(nx, ny, kind, pool, NULL);
}

struct convolve *convolve_borrow(size_t nx, size_t ny, enum convolve_kind kind,
	struct pool *pool, const struct convolve *lender)
{
	struct convolve *c = calloc(1, sizeof(*c));
	int padded = kind == CONVOLVE_PADDED;
	size_t columns;

	if (!c)
		return NULL;
	c->kind = kind;
	c->nx = nx;
	c->ny = ny;
	c->ly = padded ? fft_good_size(ny) : ny;
	c->mx = padded ? 2 * fft_good_size(nx) : nx;
	c->my = padded ? 2 * c->ly : ny;
	c->lx = c->mx / 2 + 1;
	c->stride = pad_stride(c->lx);
	c->column = pad_stride(c->ly);
	columns = 2 * (COLUMNS + 2) * c->column;
	c->scratch = columns > c->mx ? columns : (c->mx + 7) / 8 * 8;
	c->pool = pool;
	c->room = ny * c->stride;
	c->borrowed = lender && lender->room >= c->room;
	c->work = c->borrowed ? lender->work : fft_alloc_complex(c->room);
	c->buffers = fft_alloc((size_t)pool_threads(pool) * c->scratch);
	if (padded)
		c->twist = fft_alloc_complex(c->ly);
	c->products = fft_alloc((ny + ROWS - 1) / ROWS);
	c->row = fft_new(c->mx, 1);
	c->line = fft_line_new(c->ly);
	if (!c->work || !c->buffers || !c->products || (padded && !c->twist) || !c->row ||
		!c->line) {
		convolve_free(c);
		return NULL;
	}
	for (size_t j = 0; padded && j < c->ly; j++)
		c->twist[j] = cexp(-I * M_PI * (double)j / (double)c->ly);
	return c;
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
	fft_free(c->twist);
	fft_free(c->products);
	free(c);
}

/* Kernels are stored column by column, ky = 0..my / 2.  Padded ones hold the even ky
 * first, then the odd ones, as the two transforms of a column want them. */
static size_t kernel_column(const struct convolve *c)
{
	return c->my / 2 + 1;
}

static size_t kernel_place(const struct convolve *c, size_t ky)
{
	if (c->kind == CONVOLVE_PERIODIC)
		return ky;
	return ky % 2 == 0 ? ky / 2 : c->ly / 2 + 1 + ky / 2;
}

double *convolve_alloc(const struct convolve *c)
{
	return fft_alloc(c->lx * kernel_column(c));
}

void convolve_spectrum(const struct convolve *c, double *kernel,
	double (*factor)(const void *context, size_t kx, size_t ky), const void *context)
{
	size_t height = kernel_column(c);
	double scale = 1 / ((double)c->mx * (double)c->my);

	for (size_t kx = 0; kx < c->lx; kx++)
		for (size_t ky = 0; ky < height; ky++)
			kernel[kx * height + kernel_place(c, ky)] =
				scale * factor(context, kx, ky);
}

struct quarter {
	const double *spectrum;
	size_t stride;
};

static double quarter_factor(const void *context, size_t kx, size_t ky)
{
	const struct quarter *q = context;

	return q->spectrum[ky * q->stride + kx];
}

/* The spectrum of an even kernel: rows and columns are transformed one by one, each
 * spread to its full length, and the half that symmetry gives back is left out. */
int convolve_kernel(const struct convolve *c, double *kernel,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context)
{
	size_t height = kernel_column(c), longest = c->mx > c->my ? c->mx : c->my;
	double *line = fft_alloc(longest);
	double complex *out = fft_alloc_complex(longest / 2 + 1);
	double *quarter = fft_alloc(height * c->lx);
	struct fft *rows = fft_new(c->mx, 1), *columns = fft_new(c->my, 1);
	int status = -1;

	if (line && out && quarter && rows && columns) {
		for (size_t iy = 0; iy < height; iy++) {
			for (size_t ix = 0; ix < c->lx; ix++)
				line[ix] = value(context, ix, iy);
			for (size_t ix = c->lx; ix < c->mx; ix++)
				line[ix] = line[c->mx - ix];
			fft_forward(rows, line, out);
			for (size_t kx = 0; kx < c->lx; kx++)
				quarter[iy * c->lx + kx] = creal(out[kx]);
		}
		for (size_t kx = 0; kx < c->lx; kx++) {
			for (size_t iy = 0; iy < height; iy++)
				line[iy] = quarter[iy * c->lx + kx];
			for (size_t iy = height; iy < c->my; iy++)
				line[iy] = line[c->my - iy];
			fft_forward(columns, line, out);
			for (size_t ky = 0; ky < height; ky++)
				quarter[ky * c->lx + kx] = creal(out[ky]);
		}
		convolve_spectrum(
			c, kernel, quarter_factor, &(struct quarter){ quarter, c->lx });
		status = 0;
	}
	fft_done(rows);
	fft_done(columns);
	fft_free(line);
	fft_free(out);
	fft_free(quarter);
	return status;
}

static size_t smaller(size_t a, size_t b)
{
	return a < b ? a : b;
}

static void forward_rows(void *context, size_t job, int worker)
{
	struct convolve *c = context;
	double *row = c->buffers + (size_t)worker * c->scratch;
	size_t end = smaller((job + 1) * ROWS, c->ny);

	/* The inverse of an earlier job may have left something in the padding. */
	memset(row + c->nx, 0, (c->mx - c->nx) * sizeof(*row));
	for (size_t iy = job * ROWS; iy < end; iy++) {
		memcpy(row, c->x + iy * c->nx, c->nx * sizeof(*row));
		fft_forward(c->row, row, c->work + iy * c->stride);
	}
}

static void inverse_rows(void *context, size_t job, int worker)
{
	struct convolve *c = context;
	double *row = c->buffers + (size_t)worker * c->scratch, sum = 0;
	size_t end = smaller((job + 1) * ROWS, c->ny);

	for (size_t iy = job * ROWS; iy < end; iy++) {
		const double *x = c->x + iy * c->nx;

		fft_inverse(c->row, c->work + iy * c->stride, row);
		memcpy(c->y + iy * c->nx, row, c->nx * sizeof(*row));
		for (size_t ix = 0; c->x != c->y && ix < c->nx; ix++)
			sum += x[ix] * row[ix];
	}
	c->products[job] = sum;
}

/* Spectrum times a kernel that is even about 0: k[i] serves i and n - i. */
static void multiply_even(double complex *s, const double *k, size_t n)
{
	for (size_t i = 0; i <= n / 2; i++)
		s[i] *= k[i];
	for (size_t i = 1; i < (n + 1) / 2; i++)
		s[n - i] *= k[i];
}

/* The same for odd coefficients, 2 i + 1: k[i] serves i and n - 1 - i. */
static void multiply_odd(double complex *s, const double *k, size_t n)
{
	for (size_t i = 0; i < (n + 1) / 2; i++)
		s[i] *= k[i];
	for (size_t i = 0; i < n / 2; i++)
		s[n - 1 - i] *= k[i];
}

/* One column, zero beyond ny, in place; f and e are scratch. */
static void convolve_column(const struct convolve *c, const double *k, double complex *a,
	double complex *f, double complex *e)
{
	size_t n = c->ly;

	fft_line_forward(c->line, a, f);
	multiply_even(f, k, n);
	if (c->kind == CONVOLVE_PERIODIC) {
		fft_line_inverse(c->line, f, a);
		return;
	}
	fft_line_inverse(c->line, f, e);
	for (size_t j = 0; j < c->ny; j++)
		a[j] *= c->twist[j];
	fft_line_forward(c->line, a, f);
	multiply_odd(f, k + n / 2 + 1, n);
	fft_line_inverse(c->line, f, a);
	for (size_t j = 0; j < c->ny; j++)
		a[j] = e[j] + a[j] * conj(c->twist[j]);
}

static void convolve_columns(void *context, size_t job, int worker)
{
	struct convolve *c = context;
	double complex *a = (double complex *)(c->buffers + (size_t)worker * c->scratch);
	double complex *f = a + COLUMNS * c->column, *e = f + c->column;
	size_t kx = job * COLUMNS, n = smaller(COLUMNS, c->lx - kx);

	for (size_t iy = 0; iy < c->ny; iy++)
		for (size_t j = 0; j < n; j++)
			a[j * c->column + iy] = c->work[iy * c->stride + kx + j];
	for (size_t j = 0; j < n; j++) {
		memset(a + j * c->column + c->ny, 0, (c->ly - c->ny) * sizeof(*a));
		convolve_column(c, c->kernel + (kx + j) * kernel_column(c),
			a + j * c->column, f, e);
	}
	for (size_t iy = 0; iy < c->ny; iy++)
		for (size_t j = 0; j < n; j++)
			c->work[iy * c->stride + kx + j] = a[j * c->column + iy];
}

static size_t row_jobs(const struct convolve *c)
{
	return (c->ny + ROWS - 1) / ROWS;
}

void convolve_apply(struct convolve *c, const double *kernel, const double *x, double *y)
{
	c->kernel = kernel;
	c->x = x;
	c->y = y;
	pool_run(c->pool, row_jobs(c), forward_rows, c);
	pool_run(c->pool, (c->lx + COLUMNS - 1) / COLUMNS, convolve_columns, c);
	pool_run(c->pool, row_jobs(c), inverse_rows, c);
}

double convolve_product(
	struct convolve *c, const double *kernel, const double *x, double *y)
{
	double sum = 0;

	convolve_apply(c, kernel, x, y);
	for (size_t job = 0; job < row_jobs(c); job++)
		sum += c->products[job];
	return sum;
}
