/* sweep.h - one pass over long arrays that also sums, the same for any number of threads
 *
 * The range is cut into at most SWEEP_CHUNKS chunks by its length alone; partial sums
 * are added in the order of the chunks.
 */
#ifndef NUM_SWEEP_H
#define NUM_SWEEP_H

#include "num/pool.h"
#include <stddef.h>

enum { SWEEP_CHUNKS = 256, SWEEP_SUMS = 6 };

/* Results of one pass; a pass adds to the sums and updates maximum and minimum. */
struct sweep {
	double sum[SWEEP_SUMS];
	double max; /* -INFINITY at the start */
	double min; /* INFINITY at the start */
};

/* Sums of nothing, and sums of two parts together. */
struct sweep sweep_start(void);
void sweep_add(struct sweep *all, const struct sweep *part);

struct sweep sweep_run(struct pool *pool, size_t n,
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s),
	void *context);

/* Number of terms added sequentially in such a sum. */
double sweep_terms(size_t n);

#endif
