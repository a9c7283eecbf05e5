/* sketch.h - positive values of a sample of any size in bounded memory
 *
 * All values are kept until there are more than most; then neighbours whose ratio is
 * nearly 1 are replaced by their mean, with the weight of all of them.  The ratio is
 * the least that halves their number: of a million values over a decade, kept as 65536,
 * it is 1 + 7e-5, and a sum of k-th powers changes by less than (7e-5 k)^2 / 8.
 *
 *	struct sketch s = { 0 };
 *	sketch_add(&s, x, SKETCH_MOST);
 *	sketch_sort(&s);
 *	... s.value[i], s.weight[i], i < s.n ...
 *	sketch_free(&s);
 */
#ifndef STATS_SKETCH_H
#define STATS_SKETCH_H

#include "num/status.h"
#include <stddef.h>

enum { SKETCH_MOST = 1 << 17 };

struct sketch {
	size_t n, room;
	double *value, *weight;
	double ratio; /* largest ratio of values that were joined; 1: none were */
};

/* x > 0; most >= 4. */
enum num_status sketch_add(struct sketch *s, double x, size_t most);
/* Ascending values. */
enum num_status sketch_sort(struct sketch *s);
void sketch_free(struct sketch *s);

#endif
