/* stress_state.h - what the two ways to sum stress share; for lib/contact only */
#ifndef CONTACT_STRESS_STATE_H
#define CONTACT_STRESS_STATE_H

#include "stress/stress.h"
#include <complex.h>

enum { LAYERS_KEPT = 4096, WINDOWS = 8 };

/* Kernel of one layer, as far as it was needed. */
struct layer {
	int wx, wy;              /* offsets below these are in the table */
	double *table;           /* influence_table() */
	int sx, sy;              /* the window of the spectra */
	int count;               /* of them */
	size_t bytes;            /* they take */
	double complex *spectra; /* window_spectra() */
};

/* A part of the grid and its transform. */
struct part {
	int x0, y0, wx, wy;
	struct window *window; /* NULL: the place is free */
	int loaded;            /* with the present pressure, from (x0, y0) on */
	long used;             /* when last */
};

struct load {
	int x, y;
	double pressure;
};

struct block {
	int x0, x1, y0, y1; /* loaded cells within, inclusive */
	double load;        /* in units times m2; 0: none */
};

struct stress {
	struct stress_par par;
	/* Pressures are held in this unit, a power of two near the largest, so that
	 * squares neither overflow nor vanish. */
	double unit;
	double *pressure;
	struct load *loads;
	size_t nloads;
	int x0, x1, y0, y1; /* of the loads, inclusive */
	double total;       /* N */
	int side, bx, by;   /* cells to a block's side, blocks */
	struct block *blocks;
	double point;         /* largest von Mises stress times distance^2 */
	struct layer *layers; /* LAYERS_KEPT, some filled */
	struct layer spare;   /* for one that is not kept */
	size_t used;          /* bytes of kept kernels */
	struct part part[WINDOWS];
	long clock;
	double *sums; /* TENSOR_NUMBERS fields of nx * ny, for the transform */
	struct stress_work work;
};

static inline double stress_depth(const struct stress *s, long layer)
{
	return (layer + s->par.offset) * s->par.dz;
}

static inline int larger(int a, int b)
{
	return a > b ? a : b;
}

/* stress.c: memory of the kernels */

/* Takes bytes of the memory for kernels that are kept; 0 where there are not so many. */
int stress_claim(struct stress *s, size_t bytes);
void stress_layer_free(struct layer *l);

/* stress_direct.c */

/* stress_mises() by a sum over loads for each node. */
int stress_mises_direct(struct stress *s, long layer, const struct stress_span *span,
	size_t count, double *mises);

/* stress_fourier.c */

/* The smallest window of the few sizes there are that holds all loads and spans; the
 * whole grid where there is no load. */
struct part stress_part(
	const struct stress *s, const struct stress_span *span, size_t count);
/* stress_mises() on the whole of a part, by transform. */
int stress_mises_fourier(struct stress *s, long layer, struct part want, double *mises);
/* Could the waves of the pressure exceed the limit at a depth, in units? */
int stress_waves_may_fail(struct stress *s, double z, double limit);

#endif
