/* window.h - sums over the loads of a rectangle, by Fourier transform
 *
 * Loads and nodes are on mx times my points; a kernel extends reach_x and reach_y points
 * in either direction.  Points are zero-padded against wrap-around.
 */
#ifndef STRESS_WINDOW_H
#define STRESS_WINDOW_H

#include "stress/influence.h"
#include <stddef.h>

struct window;

/* NULL when out of memory. */
struct window *window_new(int mx, int my, int reach_x, int reach_y);
void window_free(struct window *w);

/* Sets the loads of the points, rows of stride. */
void window_load(struct window *w, const double *load, size_t stride);
/* Computes the sum for one stress component, rows of stride.  kernel[j * (reach_x + 1) +
 * i] is the influence at the offset (i, j); the others follow by symmetry. */
void window_sum(struct window *w, const struct influence_par *par,
	const struct influence *kernel, enum stress_number number, double *out,
	size_t stride);

#endif
