/* fft.h - Fourier transforms with reproducible bits
 *
 * Thin wrapper of FFTW plans made with FFTW_ESTIMATE (measured planning picks other
 * algorithms from run to run).  Planning is serialised inside.  Transforms are not
 * normalised: forward then inverse multiplies by the number of points.
 */
#ifndef NUM_FFT_H
#define NUM_FFT_H

#include "num/status.h"
#include <complex.h>
#include <stddef.h>

/* re + i im, as CMPLX() of C11, which glibc does not offer to clang. */
static inline double complex fft_complex(double re, double im)
{
	union {
		double part[2];
		double complex z;
	} u = { { re, im } };

	return u.z;
}

/* Memory for transforms, zeroed; NULL when out of memory.  A transform may use any
 * address in it that FFT_ALIGNMENT divides. */
enum { FFT_ALIGNMENT = 64 };
double *fft_alloc(size_t count);
double *fft_alloc_unset(size_t count); /* not zeroed */
double complex *fft_alloc_complex(size_t count);
void fft_free(void *p);

/* Smallest size >= n whose prime factors are 2, 3, 5 and 7 only. */
size_t fft_good_size(size_t n);
/* Smallest size >= n that is a power of two times at most two of 3, 5 and 7, and 3 at
 * most once: half the time a point of other such sizes. */
size_t fft_fast_size(size_t n);

/* Real transform of ny rows of nx points (ny = 1: one-dimensional) to and from
 * ny rows of nx / 2 + 1 coefficients.  The inverse destroys its input. */
struct fft;
struct fft *fft_new(size_t nx, size_t ny);
/* Of one row, without the inverse: a plan takes longer than a short transform. */
struct fft *fft_new_forward(size_t n);
void fft_forward(const struct fft *fft, const double *x, double complex *spectrum);
void fft_inverse(const struct fft *fft, double complex *spectrum, double *x);
void fft_done(struct fft *fft);

/* The real transform, at n frequencies, of an even sequence of 2 (n - 1) points, of which
 * x holds the first n; in place, n > 1.  Twice: x times 2 (n - 1).  NUM_MEMORY. */
enum num_status fft_even(double *x, size_t n);

/* Real transform of ny rows of nx points, rows fft_plane_stride() apart, to and from
 * nx / 2 + 1 columns of coefficients, one after another.  Rows and columns are
 * transformed one by one, which FFTW's own plan for small planes takes up to twice as
 * long for, and rows that are zero or not wanted are left out.  work has room for a
 * spectrum, fft_plane_size() coefficients; the inverse destroys its input. */
struct fft_plane;
struct fft_plane *fft_plane_new(size_t nx, size_t ny);
size_t fft_plane_stride(const struct fft_plane *plane);
size_t fft_plane_size(const struct fft_plane *plane);
/* Rows [first, end) of x; the others are taken as zero, and zero rows cost nothing. */
void fft_plane_forward(const struct fft_plane *plane, double *x, size_t first, size_t end,
	double complex *spectrum, double complex *work);
/* Only the rows of x with a flag; ny of these. */
void fft_plane_inverse(const struct fft_plane *plane, double complex *spectrum, double *x,
	const unsigned char *wanted, double complex *work);
void fft_plane_done(struct fft_plane *plane);

/* Complex transform of one line of n points, from one array to another, each from
 * fft_alloc_complex() or a multiple of four points into such memory. */
struct fft_line;
struct fft_line *fft_line_new(size_t n);
void fft_line_forward(
	const struct fft_line *line, double complex *in, double complex *out);
void fft_line_inverse(
	const struct fft_line *line, double complex *in, double complex *out);
void fft_line_done(struct fft_line *line);

#endif
