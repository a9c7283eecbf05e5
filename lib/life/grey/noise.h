/* noise.h - the scale of white noise on a smooth series, from its second differences
 *
 * Each observation is compared with the line between its neighbours; the scale is
 * 1.4826 times the median of the absolute residuals of the last rows, so that outliers
 * and slow changes have no influence.  Gaps may differ.
 */
#ifndef LIFE_NOISE_H
#define LIFE_NOISE_H

#include "num/state.h"

struct noise;

struct noise *noise_new(void); /* NULL when out of memory */
void noise_free(struct noise *n);
void noise_pass(struct noise *n, struct state *s);
/* Adds the observation made gap after the last one. */
void noise_add(struct noise *n, double y, double gap);
/* Standard deviation; 0 below three observations or for an exact line. */
double noise_scale(const struct noise *n);

#endif
