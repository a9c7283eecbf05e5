/* draw.h - many normal deviates at a time from one Philox stream
 *
 * Stream (seed, realisation, purpose) as in num/rng.h, by the ziggurat (num/ziggurat.h),
 * one 32-bit word each with seven bits for the layer and the rest for the place in it.
 * Numbers come one after another, as a filter draws them; num/normals.h has them by
 * address.
 */
#ifndef LIFE_DRAW_H
#define LIFE_DRAW_H

#include "num/philox.h"
#include "num/state.h"
#include <stddef.h>

struct draw;

struct draw *draw_new(uint64_t seed, uint32_t realisation, enum rng_purpose purpose);
void draw_free(struct draw *draw);
void draw_pass(struct draw *draw, struct state *s);
void draw_normals(struct draw *draw, double *z, size_t n);
double draw_normal(struct draw *draw);
double draw_uniform(struct draw *draw); /* in (0, 1) */

#endif
