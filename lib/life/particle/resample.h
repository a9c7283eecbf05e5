/* resample.h - selection of ancestors by weight
 *
 * Systematic: n points at equal distances from one uniform number on, so that particle
 * i has n w[i] copies on average, rounded up or down.  Ancestors are in ascending order.
 * Douc, Cappe, Moulines, "Comparison of resampling schemes for particle filtering", ISPA
 * 2005.
 */
#ifndef LIFE_RESAMPLE_H
#define LIFE_RESAMPLE_H

#include "life/particle/draw.h"
#include <stddef.h>
#include <stdint.h>

/* weight[n] >= 0 with the given sum > 0; fills ancestor[n]. */
void resample(struct draw *draw, const double *weight, double sum, size_t n,
	uint32_t *ancestor);

#endif
