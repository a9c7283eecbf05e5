/* following.h - noise of a channel that changes slowly, relative to that learned
 *
 * The noise of a block of samples is measured in their fourth differences, in which
 * pulses of 20 samples or more vanish.  It is taken to have changed where two blocks in
 * succession deviate from what it is believed to be by four standard errors, and to
 * change evenly over a block.  The standard error is that of white noise, and more where
 * the steps of a converter are as large as the noise.
 */
#ifndef SIGNAL_FOLLOWING_H
#define SIGNAL_FOLLOWING_H

#include <stddef.h>

/* Blocks that are remembered: the longest stretch whose rows are still to be written has
 * far fewer. */
enum { FOLLOWING_KEPT = 256, FOLLOWING_BLOCK = 4096 };

struct following {
	size_t block;     /* samples, at most FOLLOWING_BLOCK; 0: the noise is constant */
	long long begin;  /* of the first block */
	double reference; /* noise where it was learned */
	double last;      /* that of the last block over it */
	double error, known; /* standard error of this, and the blocks it is known from */
	double variance;     /* of the logarithm of what the noise is believed to be */
	double node[FOLLOWING_KEPT]; /* noise at the beginning of the blocks */
	long long blocks;            /* so far; node[blocks % KEPT] is known */
};

/* Standard deviation of the noise in n <= FOLLOWING_BLOCK samples of x, those with a flag
 * left out; 0 if it cannot be told. */
double following_measure(const double *x, const unsigned char *hidden, size_t n);
/* Its relative standard error, of n samples of white noise. */
double following_error(size_t n);

/* first, second: measures of the first two blocks. */
void following_start(struct following *f, long long begin, size_t block, double reference,
	double first, double second);
/* Takes the next block, and divides it by its noise. */
void following_take(struct following *f, double *x, const unsigned char *hidden);
/* Noise at a sample, 1: as learned. */
double following_at(const struct following *f, double sample);

#endif
