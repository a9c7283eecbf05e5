/* window.h - sums over the loads of a rectangle, by Fourier transform
 *
 * Loads and nodes are those of mx times my points; a kernel reaches so many points either
 * way.  Points are padded so that nothing wraps around.
 */
#ifndef STRESS_WINDOW_H
#define STRESS_WINDOW_H

#include "stress/influence.h"
#include <stddef.h>

struct window;

/* NULL when out of memory. */
struct window *window_new(int mx, int my, int reach_x, int reach_y);
void window_free(struct window *w);

/* Takes loads of the points, rows of stride. */
void window_load(struct window *w, const double *load, size_t stride);
/* The sum for one number, rows of stride.  kernel[j * (reach_x + 1) + i] is the influence
 * at the offset (i, j); the others follow by symmetry. */
void window_sum(struct window *w, const struct influence_par *par,
	const struct influence *kernel, enum stress_number number, double *out,
	size_t stride);

#endif
