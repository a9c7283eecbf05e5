/* noise.h - the scale of white noise on a smooth series, from its second differences
 *
 * Each observation is compared with the line between its neighbours; the scale is
 * 1.4826 times the median of the absolute residuals of the last rows, so that outliers
 * and slow changes have no influence.  Gaps may differ.
 */
#ifndef LIFE_NOISE_H
#define LIFE_NOISE_H

/* Residuals kept: see "Single constants" in doc/trends.md. */
enum { NOISE_WINDOW = 256 };

/* All 0 at first. */
struct noise {
	double y[2], gap; /* the two last observations and the gap between them */
	long rows;
	double residual[NOISE_WINDOW];
	double scale; /* standard deviation; 0 below three rows or for an exact line */
};

/* Adds the observation made gap > 0 after the last one. */
void noise_add(struct noise *n, double y, double gap);

#endif
