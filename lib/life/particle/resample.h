/* resample.h - selection of ancestors by weight
 *
 * All schemes are unbiased: the expected number of copies of particle i is n w[i].
 * Ancestors are in ascending order.  Systematic uses one uniform number, stratified one
 * per particle, residual keeps floor(n w) copies and draws the rest independently from
 * the remainders, multinomial draws all of them independently. Douc, Cappe, Moulines,
 * "Comparison of resampling schemes for particle filtering", ISPA 2005.
 */
#ifndef LIFE_RESAMPLE_H
#define LIFE_RESAMPLE_H

#include "life/particle/draw.h"
#include <stddef.h>
#include <stdint.h>

enum resampling {
	RESAMPLE_SYSTEMATIC,
	RESAMPLE_STRATIFIED,
	RESAMPLE_RESIDUAL,
	RESAMPLE_MULTINOMIAL
};

/* weight[n] >= 0 with the given sum > 0; fills ancestor[n]. */
void resample(enum resampling scheme, struct draw *draw, const double *weight, double sum,
	size_t n, uint32_t *ancestor);

#endif
