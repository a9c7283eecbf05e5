/* window.h - sums over the loads of a rectangle, by Fourier transform
 *
 * Loads and nodes are on mx times my points; a kernel extends reach_x and reach_y points
 * in either direction.  A rectangle much larger than the reach is cut into tiles, which
 * are transformed with the loads within reach (overlap-save); tiles without loads, or in
 * which nothing is wanted, are left out.
 */
#ifndef STRESS_WINDOW_H
#define STRESS_WINDOW_H

#include "num/pool.h"
#include "num/status.h"
#include "stress/influence.h"
#include "stress/span.h"
#include <stddef.h>

/* Receives the sums of a part of the nodes, from any thread.  Parts without loads within
 * reach come without numbers. */
typedef void window_take(void *context, const struct stress_part *part, int worker);

struct window {
	int mx, my, reach_x, reach_y;
	const struct influence_par *par;
	/* kernel[j * (reach_x + 1) + i] is the influence at the offset (i, j); the others
	 * follow by symmetry. */
	const struct influence *kernel;
	const double *load; /* rows of load_stride */
	size_t load_stride;
	int numbers; /* the first so many of enum stress_number */
	/* Nodes wanted, counted from (x0, y0); NULL: all. */
	const struct stress_want *want;
	int x0, y0;
	window_take *take;
	void *context;
	struct pool *pool;
};

/* Memory and plan of the transforms, kept from one window to the next; all zero at first.
 */
struct window_kept {
	struct fft_plane *fft;
	size_t nx, ny; /* points that it transforms */
	double *memory;
	size_t size; /* doubles */
};

void window_forget(struct window_kept *kept);
/* Computes the sums; *transforms receives how many that took. */
enum num_status window_sum(
	const struct window *w, struct window_kept *kept, double *transforms);

#endif
