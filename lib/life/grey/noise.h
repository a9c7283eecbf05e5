/* noise.h - the scale of white noise on a smooth series, from its second differences
 *
 * Each observation is compared with the line between its neighbours; the scale is
 * 1.4826 times the median of the absolute residuals of the last rows, so that outliers
 * and slow changes have no influence.  Gaps may differ.
 */
#ifndef LIFE_NOISE_H
#define LIFE_NOISE_H

/* Residuals kept.  Over those of the observations, the errors of the filtered states of
 * ten simulated kinds are .618, .616 and .614 with 20, 40 and 256; over those of the last
 * value, the errors of the predictions of 31 measured series are .234, .231 and .231. */
enum { NOISE_WINDOW = 40 };

/* All 0 at first. */
struct noise {
	double y[2], gap; /* the two last observations and the gap between them */
	long rows;
	double residual[NOISE_WINDOW];
	double scale; /* standard deviation; 0 below three rows or for an exact line */
};

/* Adds the observation made gap after the last one. */
void noise_add(struct noise *n, double y, double gap);

#endif
