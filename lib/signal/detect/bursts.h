/* bursts.h - whether a record exceeds its noise anywhere, by a signal of any shape */
#ifndef SIGNAL_BURSTS_H
#define SIGNAL_BURSTS_H

#include <stddef.h>

/* 1 if second differences of the means of 4, 8, 16 ... longest of the samples y[0 .. n)
 * somewhere exceed those of Gaussian noise of the same level nearby.  The noise may be
 * coloured, its level and that of the record may drift, and it may hold steady lines.
 * What lasts longer than a hundredth of n samples is not found.  work holds n. */
int bursts_found(const double *y, size_t n, size_t longest, double *work);

/* Mean squares of these second differences, for the means of 4, 8, 16 ... samples. */
enum { BURSTS_OCTAVES = 32 };
struct bursts_power {
	double square[BURSTS_OCTAVES], count[BURSTS_OCTAVES];
	int octaves;
};

void bursts_measure(const double *y, size_t n, double *work, struct bursts_power *power);

/* 1 if they differ by no more than chance lets those of Gaussian noise of one level and
 * colour differ. */
int bursts_alike(const struct bursts_power *a, const struct bursts_power *b);

#endif
