/* draw.h - many normal deviates at a time from one Philox stream
 *
 * Stream (seed, realisation, purpose) as in num/rng.h; each block of 128 bits makes two
 * candidates of the ziggurat with rejection-free layer choice and 53-bit abscissas
 * (Marsaglia & Tsang 2000 in the form of Doornik 2005).
 */
#ifndef LIFE_DRAW_H
#define LIFE_DRAW_H

#include "num/philox.h"
#include <stddef.h>

struct draw;

struct draw *draw_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose);
void draw_free(struct draw *draw);
void draw_normals(struct draw *draw, double *z, size_t n);
double draw_normal(struct draw *draw);
double draw_uniform(struct draw *draw); /* in (0, 1) */

#endif
