#include "num/convolve.h"
#include "num/fft.h"
#include "num/status.h"
#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	ROWS = 16,  /* rows in one job: 4 to 64 take the same time, for grids of 128 to
		     * 1024  points, with one and two threads */
	COLUMNS = 8 /* columns in one job: two cache lines of each row, and few enough
		     * to stay in the second-level cache */
};

struct convolve {
	size_t nx, ny; /* field */
	size_t mx, my; /* transform: periodic nx, ny; padded at least twice that */
	int padded_y;  /* columns are padded */
	int wrapped;   /* periodic, but in a padded direction */
	int bridged; /* beyond the field x is interpolated linearly back to its beginning
		      */
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

struct convolve *convolve_borrow(size_t nx, size_t ny, enum convolve_kind kind,
	struct pool *pool, const struct convolve *lender)
{
	struct convolve *c = calloc(1, sizeof *c);
	int bridged = kind == CONVOLVE_BRIDGED;
	int padded = kind == CONVOLVE_PADDED;
	int padded_x = padded || (!bridged && is_awkward(nx));
	size_t columns;

	if (!c)
		return NULL;
	padded = padded || (!bridged && is_awkward(ny));
	c->padded_y = padded;
	c->wrapped = kind == CONVOLVE_PERIODIC && (padded_x || padded);
	c->bridged = bridged;
	c->nx = nx;
	c->ny = ny;
	c->ly = padded || bridged ? fft_good_size(ny) : ny;
	c->mx = padded_x || bridged ? fft_good_size(nx) : nx;
	c->mx *= padded_x ? 2 : 1;
	c->my = padded ? 2 * c->ly : c->ly;
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
	if (!c->padded_y)
		return ky;
	return ky % 2 == 0 ? ky / 2 : c->ly / 2 + 1 + ky / 2;
}

void convolve_size(const struct convolve *c, size_t *mx, size_t *my)
{
	*mx = c->mx;
	*my = c->my;
}

double *convolve_scratch(const struct convolve *c, size_t *room)
{
	*room = 2 * c->room;
	return (double *)c->work;
}

double *convolve_alloc(const struct convolve *c)
{
	return fft_alloc(c->lx * kernel_column(c));
}

/* Transforms an even field given by its quarter, rows of mx / 2 + 1, in place: rows and
 * columns one by one, each spread to its full length, and the half that symmetry gives
 * back is left out. */
static enum num_status transform_quarter(double *quarter, size_t mx, size_t my)
{
	size_t lx = mx / 2 + 1, ly = my / 2 + 1, longest = mx > my ? mx : my;
	double *line = fft_alloc(longest);
	double complex *out = fft_alloc_complex(longest / 2 + 1);
	struct fft *rows = fft_new(mx, 1), *columns = fft_new(my, 1);
	enum num_status status = line && out && rows && columns ? NUM_OK : NUM_MEMORY;

	for (size_t y = 0; status == 0 && y < ly; y++) {
		for (size_t x = 0; x < mx; x++)
			line[x] = quarter[y * lx + (x < lx ? x : mx - x)];
		fft_forward(rows, line, out);
		for (size_t x = 0; x < lx; x++)
			quarter[y * lx + x] = creal(out[x]);
	}
	for (size_t x = 0; status == 0 && x < lx; x++) {
		for (size_t y = 0; y < my; y++)
			line[y] = quarter[(y < ly ? y : my - y) * lx + x];
		fft_forward(columns, line, out);
		for (size_t y = 0; y < ly; y++)
			quarter[y * lx + x] = creal(out[y]);
	}
	fft_done(rows);
	fft_done(columns);
	fft_free(line);
	fft_free(out);
	return status;
}

static enum num_status set_kernel(const struct convolve *c, double *kernel,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context)
{
	size_t height = kernel_column(c);
	double scale = 1 / ((double)c->mx * (double)c->my);
	double *quarter = fft_alloc(height * c->lx);
	enum num_status status = NUM_MEMORY;

	if (quarter) {
		for (size_t iy = 0; iy < height; iy++)
			for (size_t ix = 0; ix < c->lx; ix++)
				quarter[iy * c->lx + ix] = value(context, ix, iy);
		status = transform_quarter(quarter, c->mx, c->my);
	}
	for (size_t kx = 0; status == 0 && kx < c->lx; kx++)
		for (size_t ky = 0; ky < height; ky++)
			kernel[kx * height + kernel_place(c, ky)] =
				scale * quarter[ky * c->lx + kx];
	fft_free(quarter);
	return status;
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
	size_t lx = c->nx / 2 + 1, ly = c->ny / 2 + 1;
	double *value = fft_alloc(lx * ly);
	struct quarter quarter = { value, lx, 1 / ((double)c->nx * (double)c->ny) };
	enum num_status status = NUM_MEMORY;

	if (value) {
		for (size_t i = 0; i < lx * ly; i++)
			value[i] = factor(context, i % lx, i / lx);
		status = transform_quarter(value, c->nx, c->ny);
	}
	if (status == 0)
		status = convolve_kernel(c, kernel, quarter_value, &quarter);
	fft_free(value);
	return status;
}

enum num_status convolve_spectrum(const struct convolve *c, double *kernel,
	double (*factor)(const void *context, size_t kx, size_t ky), const void *context)
{
	size_t height = kernel_column(c);
	double scale = 1 / ((double)c->mx * (double)c->my);

	if (c->wrapped)
		return wrapped_spectrum(c, kernel, factor, context);
	for (size_t kx = 0; kx < c->lx; kx++)
		for (size_t ky = 0; ky < height; ky++)
			kernel[kx * height + kernel_place(c, ky)] =
				scale * factor(context, kx, ky);
	return 0;
}

static size_t smaller(size_t a, size_t b)
{
	return a < b ? a : b;
}

/* Position of cell i across a bridge of n cells, from 0 to 1. */
static double bridge(size_t i, size_t n)
{
	return (double)(i + 1) / (double)(n + 1);
}

static void forward_rows(void *context, size_t job, int worker)
{
	struct convolve *c = context;
	double *row = c->buffers + (size_t)worker * c->scratch;
	size_t end = smaller((job + 1) * ROWS, c->ny);

	for (size_t iy = job * ROWS; iy < end; iy++) {
		double first = c->x[iy * c->nx], last = c->x[(iy + 1) * c->nx - 1];

		memcpy(row, c->x + iy * c->nx, c->nx * sizeof *row);
		/* The inverse transform of an earlier row may have written there. */
		for (size_t ix = c->nx; ix < c->mx; ix++)
			row[ix] = c->bridged
					  ? last + (first - last) * bridge(ix - c->nx,
									    c->mx - c->nx)
					  : 0;
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
		memcpy(c->y + iy * c->nx, row, c->nx * sizeof *row);
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
	if (!c->padded_y) {
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
		double complex *column = a + j * c->column, last = column[c->ny - 1];

		for (size_t iy = c->ny; iy < c->ly; iy++)
			column[iy] = c->bridged ? last + (column[0] - last) *
								  bridge(iy - c->ny,
									  c->ly - c->ny)
						: 0;
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
