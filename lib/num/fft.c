#include "num/fft.h"
#include "num/lanes.h"
#include "num/pages.h"
#include <fftw3.h>
#include <limits.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* FFTW's planner is its only part that is not thread-safe. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

struct fft {
	fftw_plan forward, inverse;
};

/* The address to free stands before the aligned one. */
static double *allocate(size_t count, int zeroed)
{
	size_t size = count * sizeof(double) + FFT_ALIGNMENT;
	unsigned char *memory = NULL, *aligned;

	if (count < (SIZE_MAX - FFT_ALIGNMENT) / sizeof(double))
		memory = zeroed ? calloc(size, 1) : malloc(size);
	if (!memory)
		return NULL;
	aligned = memory + FFT_ALIGNMENT - (uintptr_t)memory % FFT_ALIGNMENT;
	pages_large(aligned, count * sizeof(double));
	memcpy(aligned - sizeof memory, &memory, sizeof memory);
	return (double *)(void *)aligned;
}

/* Zeros of calloc(), which large memory has without being touched: the threads that work
 * on it share the time that the system needs for its first use. */
double *fft_alloc(size_t count)
{
	return allocate(count, 1);
}

double *fft_alloc_unset(size_t count)
{
	return allocate(count, 0);
}

double complex *fft_alloc_complex(size_t count)
{
	return (double complex *)fft_alloc(2 * count);
}

void fft_free(void *p)
{
	void *memory;

	if (!p)
		return;
	memcpy(&memory, (unsigned char *)p - sizeof memory, sizeof memory);
	free(memory);
}

size_t fft_good_size(size_t n)
{
	static const size_t primes[] = { 2, 3, 5, 7 };

	for (;; n++) {
		size_t rest = n;

		for (size_t i = 0; i < 4; i++)
			while (rest && rest % primes[i] == 0)
				rest /= primes[i];
		if (rest == 1)
			return n;
	}
}

/* Of all even sizes with factors up to 13, those of this form take 1.10 times the best
 * time of padded n x n transforms on average over n = 64 to 1000, with one 11 or 13 1.13,
 * with any 3, 5 and 7 1.41. */
size_t fft_fast_size(size_t n)
{
	static const size_t odd[] = { 1, 3, 5, 7, 15, 21, 25, 35, 49 };
	size_t best = SIZE_MAX;

	for (size_t i = 0; i < sizeof(odd) / sizeof(odd[0]); i++) {
		size_t m = odd[i];

		while (m < n)
			m *= 2;
		best = m < best ? m : best;
	}
	return best;
}

static void destroy(fftw_plan forward, fftw_plan inverse)
{
	pthread_mutex_lock(&planner);
	if (forward)
		fftw_destroy_plan(forward);
	if (inverse)
		fftw_destroy_plan(inverse);
	pthread_mutex_unlock(&planner);
}

/* 1 where a planner for lines of nx and ny points finds memory: FFTW ends the process
 * where it does not.  Its tables for one length take some 64 bytes a point at most
 * (rotations of each factor, and a padded convolution for a large prime), its search some
 * 100 kB. */
static int planner_fits(size_t nx, size_t ny)
{
	void *room;

	if (nx > INT_MAX || ny > INT_MAX)
		return 0;
	room = malloc(((size_t)1 << 20) + 128 * (nx + ny));
	free(room);
	return room != NULL;
}

static struct fft *plan(size_t nx, size_t ny, int both)
{
	struct fft *fft = calloc(1, sizeof *fft);
	double *x = fft_alloc(nx * ny);
	double complex *spectrum = fft_alloc_complex((nx / 2 + 1) * ny);

	if (fft && x && spectrum && planner_fits(nx, ny)) {
		pthread_mutex_lock(&planner);
		fft->forward = fftw_plan_dft_r2c_2d(
			(int)ny, (int)nx, x, spectrum, FFTW_ESTIMATE);
		if (both)
			fft->inverse = fftw_plan_dft_c2r_2d(
				(int)ny, (int)nx, spectrum, x, FFTW_ESTIMATE);
		pthread_mutex_unlock(&planner);
	}
	fft_free(x);
	fft_free(spectrum);
	if (fft && fft->forward && (fft->inverse || !both))
		return fft;
	fft_done(fft);
	return NULL;
}

struct fft *fft_new(size_t nx, size_t ny)
{
	return plan(nx, ny, 1);
}

struct fft *fft_new_forward(size_t n)
{
	return plan(n, 1, 0);
}

void fft_forward(const struct fft *fft, const double *x, double complex *spectrum)
{
	/* FFTW keeps the input of such a transform, but does not say so in the type. */
	fftw_execute_dft_r2c(fft->forward, (double *)(uintptr_t)x, spectrum);
}

void fft_inverse(const struct fft *fft, double complex *spectrum, double *x)
{
	fftw_execute_dft_c2r(fft->inverse, spectrum, x);
}

void fft_done(struct fft *fft)
{
	if (!fft)
		return;
	destroy(fft->forward, fft->inverse);
	free(fft);
}

enum num_status fft_even(double *x, size_t n)
{
	size_t points = 2 * (n - 1);
	struct fft *fft = fft_new(points, 1);
	double *y = fft_alloc(points);
	double complex *spectrum = fft_alloc_complex(n);
	enum num_status status = fft && y && spectrum ? NUM_OK : NUM_MEMORY;

	for (size_t k = 0; status == NUM_OK && k < n; k++)
		y[k] = y[k ? points - k : 0] = x[k];
	if (status == NUM_OK)
		fft_forward(fft, y, spectrum);
	for (size_t k = 0; status == NUM_OK && k < n; k++)
		x[k] = creal(spectrum[k]);
	fft_done(fft);
	fft_free(y);
	fft_free(spectrum);
	return status;
}

struct fft_plane {
	size_t nx, ny, columns;       /* columns: nx / 2 + 1 */
	size_t points, width, height; /* strides of rows of points, of coefficients, and
				       * of columns */
	fftw_plan row_forward, row_inverse, columns_forward, columns_inverse;
};

/* Every row and column begins as aligned as the plane. */
static size_t round_up(size_t n, size_t to)
{
	return (n + to - 1) / to * to;
}

size_t fft_plane_stride(const struct fft_plane *p)
{
	return p->points;
}

size_t fft_plane_size(const struct fft_plane *p)
{
	size_t rows = p->ny * p->width, columns = p->columns * p->height;

	return rows > columns ? rows : columns;
}

/* All columns at once, from rows to columns or back. */
static fftw_plan plan_columns(
	const struct fft_plane *p, double complex *from, double complex *to, int inverse)
{
	const int n = (int)p->ny, width = (int)p->width, height = (int)p->height;

	return fftw_plan_many_dft(1, &n, (int)p->columns, from, NULL, inverse ? 1 : width,
		inverse ? height : 1, to, NULL, inverse ? width : 1, inverse ? 1 : height,
		inverse ? FFTW_BACKWARD : FFTW_FORWARD, FFTW_ESTIMATE);
}

struct fft_plane *fft_plane_new(size_t nx, size_t ny)
{
	struct fft_plane *p = calloc(1, sizeof *p);
	double *x = NULL;
	double complex *a = NULL, *b = NULL;

	if (!p)
		return NULL;
	p->nx = nx;
	p->ny = ny;
	p->columns = nx / 2 + 1;
	p->points = round_up(nx, 8);
	p->width = round_up(p->columns, 4);
	p->height = round_up(ny, 4);
	x = fft_alloc(p->points);
	a = fft_alloc_complex(fft_plane_size(p));
	b = fft_alloc_complex(fft_plane_size(p));
	if (x && a && b && planner_fits(nx, ny) && fft_plane_size(p) <= INT_MAX) {
		pthread_mutex_lock(&planner);
		p->row_forward = fftw_plan_dft_r2c_1d((int)nx, x, a, FFTW_ESTIMATE);
		p->row_inverse = fftw_plan_dft_c2r_1d((int)nx, a, x, FFTW_ESTIMATE);
		p->columns_forward = plan_columns(p, a, b, 0);
		p->columns_inverse = plan_columns(p, a, b, 1);
		pthread_mutex_unlock(&planner);
	}
	fft_free(x);
	fft_free(a);
	fft_free(b);
	if (p->row_forward && p->row_inverse && p->columns_forward && p->columns_inverse)
		return p;
	fft_plane_done(p);
	return NULL;
}

void fft_plane_forward(const struct fft_plane *p, double *x, size_t first, size_t end,
	double complex *spectrum, double complex *work)
{
	for (size_t y = 0; y < p->ny; y++) {
		double *row = x + y * p->points;
		double complex *to = work + y * p->width;

		if (y >= first && y < end && lanes_next(row, 0, p->nx) < p->nx)
			fftw_execute_dft_r2c(p->row_forward, row, to);
		else
			memset(to, 0, p->columns * sizeof *to);
	}
	fftw_execute_dft(p->columns_forward, work, spectrum);
}

void fft_plane_inverse(const struct fft_plane *p, double complex *spectrum, double *x,
	const unsigned char *wanted, double complex *work)
{
	fftw_execute_dft(p->columns_inverse, spectrum, work);
	for (size_t y = 0; y < p->ny; y++)
		if (wanted[y])
			fftw_execute_dft_c2r(
				p->row_inverse, work + y * p->width, x + y * p->points);
}

void fft_plane_done(struct fft_plane *p)
{
	if (!p)
		return;
	destroy(p->row_forward, p->row_inverse);
	destroy(p->columns_forward, p->columns_inverse);
	free(p);
}

struct fft_line {
	fftw_plan forward, inverse;
};

struct fft_line *fft_line_new(size_t n)
{
	struct fft_line *line = calloc(1, sizeof *line);
	double complex *a = fft_alloc_complex(n), *b = fft_alloc_complex(n);

	if (line && a && b && planner_fits(n, 0)) {
		pthread_mutex_lock(&planner);
		line->forward =
			fftw_plan_dft_1d((int)n, a, b, FFTW_FORWARD, FFTW_ESTIMATE);
		line->inverse =
			fftw_plan_dft_1d((int)n, a, b, FFTW_BACKWARD, FFTW_ESTIMATE);
		pthread_mutex_unlock(&planner);
	}
	fft_free(a);
	fft_free(b);
	if (line && line->forward && line->inverse)
		return line;
	fft_line_done(line);
	return NULL;
}

void fft_line_forward(
	const struct fft_line *line, double complex *in, double complex *out)
{
	fftw_execute_dft(line->forward, in, out);
}

void fft_line_inverse(
	const struct fft_line *line, double complex *in, double complex *out)
{
	fftw_execute_dft(line->inverse, in, out);
}

void fft_line_done(struct fft_line *line)
{
	if (!line)
		return;
	destroy(line->forward, line->inverse);
	free(line);
}
