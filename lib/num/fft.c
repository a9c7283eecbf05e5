#include "num/fft.h"
#include <fftw3.h>
#include <limits.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* FFTW's planner is its only part that is not thread-safe. */
static pthread_mutex_t planner = PTHREAD_MUTEX_INITIALIZER;

struct fft {
	fftw_plan forward, inverse;
};

double *fft_alloc(size_t count)
{
	double *p = fftw_malloc((count ? count : 1) * sizeof *p);

	return p ? memset(p, 0, count * sizeof *p) : NULL;
}

double complex *fft_alloc_complex(size_t count)
{
	return (double complex *)fft_alloc(2 * count);
}

void fft_free(void *p)
{
	fftw_free(p);
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

struct fft *fft_new(size_t nx, size_t ny)
{
	struct fft *fft = calloc(1, sizeof *fft);
	double *x = fft_alloc(nx * ny);
	double complex *spectrum = fft_alloc_complex((nx / 2 + 1) * ny);

	if (fft && x && spectrum && planner_fits(nx, ny)) {
		pthread_mutex_lock(&planner);
		fft->forward = fftw_plan_dft_r2c_2d(
			(int)ny, (int)nx, x, spectrum, FFTW_ESTIMATE);
		fft->inverse = fftw_plan_dft_c2r_2d(
			(int)ny, (int)nx, spectrum, x, FFTW_ESTIMATE);
		pthread_mutex_unlock(&planner);
	}
	fft_free(x);
	fft_free(spectrum);
	if (fft && fft->forward && fft->inverse)
		return fft;
	fft_done(fft);
	return NULL;
}

void fft_forward(const struct fft *fft, double *x, double complex *spectrum)
{
	fftw_execute_dft_r2c(fft->forward, x, spectrum);
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
