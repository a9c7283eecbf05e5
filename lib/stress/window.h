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

/* Makes a kernel: the influence at the offsets (i, j), 0 <= i <= reach_x, 0 <= j <=
 * reach_y, in rows of i; the others follow by symmetry.  Memory to be freed, or NULL. */
typedef struct influence *window_kernel(void *context, int reach_x, int reach_y);

enum { WINDOW_NAMELESS = -1, WINDOW_FEW = 64 };

struct window {
	int mx, my, reach_x, reach_y;
	const struct influence_par *par;
	window_kernel *make;
	void *maker;
	/* Under which the kernel's transforms are kept for later windows that need the
	 * same kernel, or WINDOW_NAMELESS. */
	int name;
	int tiles; /* such transforms are as large as those of tiles, or 2^k times */
	const double *load; /* times scale, rows of load_stride */
	size_t load_stride;
	double scale;
	/* Loads of a tile up to which they are summed one by one if all its nodes are
	 * wanted, and the more the fewer are. */
	int few;
	int numbers; /* the first so many of enum stress_number */
	/* Nodes wanted, counted from (x0, y0); NULL: all. */
	const struct stress_want *want;
	int x0, y0;
	window_take *take;
	void *context;
	struct pool *pool;
};

/* Memory, plans and transformed kernels, kept from one window to the next; all zero at
 * first.  A surface needs some three kernels, whose planes vary with the part of the grid
 * that is loaded. */
enum { WINDOW_KEPT = 12 };

struct window_plan {
	struct fft_plane *fft;
	size_t nx, ny; /* points that it transforms */
	long used;     /* number of the last window that did; 0: none */
};

struct window_spectra {
	double *memory; /* the spectra of all numbers, then the kernels themselves */
	size_t nx, ny;
	int name, numbers, reach_x, reach_y;
	long used;
};

struct window_kept {
	struct window_plan plan[WINDOW_KEPT];
	struct window_spectra spectra[WINDOW_KEPT];
	long windows;
	double *memory;
	size_t size; /* doubles */
};

void window_forget(struct window_kept *kept);
/* Computes the sums; *transforms receives how many that took. */
enum num_status window_sum(
	const struct window *w, struct window_kept *kept, double *transforms);

#endif
