/* fir.h - band-pass filters by the window method, and their use on streams
 *
 * The taps are those of the ideal band-pass cut by a window, equal to what scipy's
 * firwin gives to 1e-14:
 *
 *	h[k] = w[k] (sin(2 pi hi m) - sin(2 pi lo m)) / (pi m),   m = k - order / 2
 *
 * with w the symmetric window of order + 1 points.  They are symmetric, so the filter
 * delays every frequency by order / 2 samples.
 */
#ifndef SIGNAL_FIR_H
#define SIGNAL_FIR_H

#include "num/status.h"
#include <stddef.h>

/* Hamming 0.54 0.46; Hann 0.5 0.5; Blackman 0.42 0.5 0.08; Kaiser by beta. */
enum fir_window { FIR_HAMMING, FIR_HANN, FIR_BLACKMAN, FIR_KAISER };

struct fir_band {
	int order;        /* taps less one, >= 1 */
	double low, high; /* band edges over the rate, 0 <= low < high <= 0.5 */
	enum fir_window window;
	double beta; /* of the Kaiser window */
	int scale;   /* 1: gain 1 at the middle of the band (at 0 where low = 0, at
		      * half the rate where high = 0.5); 0: unscaled */
};

/* Fills h[order + 1].  NUM_DOMAIN if the band cannot be scaled: a filter of odd order has
 * a zero at half the rate. */
enum num_status fir_design(const struct fir_band *band, double *h);

/* The band in words, edges in the unit of rate, and back from them: "70:130 200 hamming 0
 * scaled".  Text after " | " is another filter of a chain, whose filters are
 * parsed one by one.  fir_parse() returns the position where it stopped, NULL if the text
 * is not a band. */
enum { FIR_TEXT = 128 };
void fir_print(const struct fir_band *band, double rate, char text[FIR_TEXT]);
const char *fir_parse(const char *text, double rate, struct fir_band *band);

/* Kaiser's beta for an attenuation in the stop band, dB (Kaiser 1974). */
double fir_kaiser_beta(double attenuation);

/* Response of n taps at frequency f over the rate: sum h[k] exp(-2 pi i f (k - shift)).
 * shift = 0 for the filter as it runs, (n - 1) / 2 with its delay removed. */
void fir_response(const double *h, size_t n, double f, double shift, double *real,
	double *imaginary);

/* A filter for interleaved frames, x[frame * channels + c], with zeros before the
 * first.  Long filters run by overlap-save with Fourier transforms, short ones directly,
 * by an estimate of the cost.  Memory and time per frame do not depend on the length of
 * the stream. */
struct fir;

/* block: largest number of frames per call; 0: the fastest.  NULL when
 * out of memory. */
struct fir *fir_new(const double *h, size_t n, int channels, size_t block);
void fir_free(struct fir *fir);

size_t fir_block(const struct fir *fir);
/* Points of its transform; 0 for direct convolution. */
size_t fir_transform(const struct fir *fir);
/* Blocks of one channel filtered so far, and those omitted because input and output
 * are zero. */
double fir_blocks(const struct fir *fir, double *left_out);

/* Filters nframes <= fir_block() frames in place.  The split of a stream into calls
 * changes rounding errors (1e-16 of the largest sample) and nothing else. */
void fir_run(struct fir *fir, double *x, size_t nframes);

#endif
