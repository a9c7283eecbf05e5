/* convolve.h - convolution of plane fields with even kernels, by fast Fourier transform
 *
 * y = k * x for nx * ny real fields and a kernel even in both directions, whose spectrum
 * is then real and even: only its quarter is stored.  Periodic, or linear
 * (CONVOLVE_PADDED: as if x were surrounded by zeros) at any grid size.  Where n has a
 * prime factor above 31, for which FFTW is slow, a periodic convolution is computed as
 * the linear one with the kernel summed over all periods.
 *
 * The rows are transformed first, a few at a time, and stored column by column; then each
 * column is transformed, multiplied and transformed back while it is in cache; then the
 * rows are transformed back.
 *
 *	struct convolve *c = convolve_new(nx, ny, CONVOLVE_PADDED, pool);
 *	double *k = convolve_alloc(c);
 *	convolve_kernel(c, k, value, context);   or convolve_spectrum() in Fourier space
 *	convolve_apply(c, k, x, y);
 *
 * The same bytes for any number of threads.
 */
#ifndef NUM_CONVOLVE_H
#define NUM_CONVOLVE_H

#include "num/pool.h"
#include "num/status.h"
#include "num/sweep.h"
#include <stddef.h>

enum convolve_kind { CONVOLVE_PERIODIC, CONVOLVE_PADDED };

struct convolve;

/* Plans and scratch memory (about nx * ny doubles, padded 2 nx * ny); NULL when out
 * of memory.  pool is borrowed, NULL for one thread. */
struct convolve *convolve_new(
	size_t nx, size_t ny, enum convolve_kind kind, struct pool *pool);
/* The same with most of the scratch memory of another, if that is large enough; the
 * lender must outlive it and must not be used at the same time.  NULL: no lender. */
struct convolve *convolve_borrow(size_t nx, size_t ny, enum convolve_kind kind,
	struct pool *pool, const struct convolve *lender);
/* Periodic over mx * my points, at least as many as those of the field: load() gives the
 * rows of all these points, and y is wanted in the field only. */
struct convolve *convolve_frame(size_t nx, size_t ny, size_t mx, size_t my,
	struct pool *pool, const struct convolve *lender);
void convolve_free(struct convolve *c);

/* The least number of points from n on that is transformed directly. */
size_t convolve_good_period(size_t n);

/* Room for one kernel, to be freed with fft_free(); NULL when out of memory. */
double *convolve_alloc(const struct convolve *c);

/* A kernel by its values at offset (ix, iy), 0 <= ix, iy; periodic: up to half the
 * grid, beyond it follows by symmetry. */
enum num_status convolve_kernel(const struct convolve *c, double *kernel,
	double (*value)(const void *context, size_t ix, size_t iy), const void *context);

/* A kernel by its factors in Fourier space at wavenumber (kx, ky), 0 <= kx <= mx / 2,
 * in cycles per mx points, where mx = nx for periodic ones, or the padded or framed
 * size. */
enum num_status convolve_spectrum(const struct convolve *c, double *kernel,
	double (*factor)(const void *context, size_t kx, size_t ky), const void *context);

/* y = kernel * x; y may be x. */
void convolve_apply(struct convolve *c, const double *kernel, const double *x, double *y);

/* The same with passes over rows that are in cache: x may be made row by row, and y used
 * as soon as it is there. */
struct convolve_passes {
	const double *x; /* or NULL, and load() fills in row iy */
	void (*load)(void *context, size_t iy, double *row, int worker);
	double *y;
	/* 0 for a row of y that is not wanted and may be left as it is; or NULL. */
	int (*wants)(void *context, size_t iy);
	/* Over the cells begin to end - 1 of y, whole rows; each once. */
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s);
	void *context;
};

/* Returns what the passes sum. */
struct sweep convolve_run(
	struct convolve *c, const double *kernel, const struct convolve_passes *passes);

#endif
