/* tones.h - interference by lines: mains, their harmonics, the pump
 *
 * A tone is a frequency; its amplitude and phase are found by least squares over a
 * stretch of record, together with the others and a constant.
 */
#ifndef SIGNAL_TONES_H
#define SIGNAL_TONES_H

#include "num/status.h"
#include <stddef.h>

enum { TONES_MAX = 16, TONES_SIDE = 64 };

/* Frequencies, rad per sample, ascending, that exceed the summed periodogram of both
 * channels (n samples each, n >= 1024, Hann window): lines at least 40 times the median
 * of the bins on either side, at most TONES_SIDE, which white noise exceeds with
 * probability 2^-40 per bin; the strongest max of them, *tones in all.  Samples are
 * clipped to so many times the usual one. */
enum num_status tones_find(const double *y1, const double *y2, size_t n, int side,
	double clip, int max, double *omega, int *tones);

/* Least squares of a constant and tones over x[0..n), whose first sample has index
 * start: coefficient[0] the constant, [1 + 2 k] of cos(omega k t), [2 + 2 k] of sin,
 * with t the index counted from the same origin for all stretches.  Stretches in which
 * the residual is larger than usual are excluded from further passes, so that pulses do
 * not bias it.  *deviation (may be NULL) is the usual root mean square of the residual,
 * variance[k] (may be NULL) that of coefficient k in units of its square.  NUM_DOMAIN:
 * too few samples to resolve the tones. */
enum num_status tones_fit(const double *x, size_t n, double start, int tones,
	const double *omega, double *coefficient, double *deviation, double *variance);

/* Drops tones that a robust fit does not confirm: a regular train of pulses has lines,
 * too, but a fit without the pulses does not see them.  Keeps tones whose power noise of
 * this share of all frequencies exceeds with probability 2e-9; keeps all if the stretch
 * is too short to separate them. */
enum num_status tones_confirm(const double *y1, const double *y2, size_t n, double band,
	int *tones, double *omega);

/* Subtracts tones from x[0..n): coefficients change linearly from those at index at_a
 * (from) to those at index at_b (to), and of tones beyond these. */
void tones_remove(double *x, size_t n, double start, int tones, const double *omega,
	double at_a, const double *from, double at_b, const double *to);

/* Tones followed through a record: their coefficients are fitted around the middle of
 * every hop, to a hop on either side, and change linearly from one of these knots to the
 * next, beyond the first and the last one as well.  The offset is constant there.  The
 * frequency of a tone is that by which its phase turned between the last two knots. */
struct tones_track {
	int tones;
	int keeps_offset;        /* 1: the offset is not subtracted */
	double omega[TONES_MAX]; /* at the last knot */
	long long flat;          /* first sample that still has tones */
	long long hop, first;    /* first: the middle of the first hop */
	/* Indices at which the last two fits hold: with tones the middles of their
	 * samples, of which there are fewer at the ends. */
	double at, before;
	int knots; /* so far; 0: nothing is known */
	int fits;  /* of them, those whose samples resolve the tones */
	/* At the last three knots, with indices counted from the last one. */
	double coefficient[3][1 + 2 * TONES_MAX];
	int clear[TONES_MAX]; /* at the last one: 1: the tone is above the noise */
	/* Sums over the knots of the power of each tone, and of the squares of the first
	 * and second differences of all cosines and sines. */
	double power[TONES_MAX], step, bend;
};

void tones_track_start(struct tones_track *t, int tones, const double *omega,
	long long start, size_t hop);

/* Subtracts tones, and the offset unless it is kept, from the samples that can be cleaned
 * without those from index end on; all, if the record has ended.  x[0] is the sample of
 * index begin. NUM_MEMORY. */
enum num_status tones_track_run(
	struct tones_track *t, double *x, long long begin, long long end, int ended);

/* Mean square change of a coefficient from knot to knot; INFINITY: not known. */
double tones_track_change(const struct tones_track *t);

/* Variance of what the lines between knots leave of a coefficient: half the mean square
 * of the second differences, in which the errors of neighbours, which have half of their
 * samples in common, have 6 - 8 / 2 times their variance.  Of two knots only the change
 * is known.  INFINITY: not known. */
double tones_track_left(const struct tones_track *t);

#endif
