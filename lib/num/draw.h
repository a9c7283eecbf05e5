/* draw.h - normal deviates from one Philox stream, many at a time
 *
 * Stream (seed, realisation, purpose) as in num/rng.h, by the ziggurat (num/ziggurat.h).
 * Each deviate uses one 32-bit word: seven bits for the layer, the others for the
 * position in it.  Numbers are drawn in sequence; num/normals.h draws them by address.
 */
#ifndef NUM_DRAW_H
#define NUM_DRAW_H

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
