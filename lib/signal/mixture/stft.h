/* stft.h - short-time Fourier transform (3-6) with a Hamming window, and its inverse
 *
 * Frame f covers samples f hop .. f hop + window - 1.  The inverse adds the frames up
 * and divides by the sum of the windows, so that an untouched transform gives back
 * every sample that a frame covers.
 */
#ifndef SIGNAL_STFT_H
#define SIGNAL_STFT_H

#include <complex.h>
#include <stddef.h>

struct stft;

/* window even, 4 or more; 1 <= hop <= window.  NULL with errno EDOM or ENOMEM. */
struct stft *stft_new(size_t window, size_t hop);
void stft_free(struct stft *stft);

size_t stft_bins(const struct stft *stft);             /* window / 2 + 1 */
size_t stft_frames(const struct stft *stft, size_t n); /* that cover all n samples */

/* x[0..n) to y[frame * bins + bin]; samples beyond n count as zero. */
void stft_forward(const struct stft *stft, const double *x, size_t n, double complex *y);
void stft_inverse(const struct stft *stft, const double complex *y, size_t n, double *x);

#endif
