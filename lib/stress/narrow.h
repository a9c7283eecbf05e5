/* narrow.h - nodes at which the stress by loads nearby and far away may exceed a limit
 *
 * The equivalent stress is a norm, so that of a sum is at most the sum of those of its
 * parts.  Loads within some cells of a node are added one by one, others within reach by
 * squares of cells, with the largest stress that they may have at this distance, and the
 * stress of all others is bounded by their interpolated field (lattice.h).
 */
#ifndef STRESS_NARROW_H
#define STRESS_NARROW_H

#include "num/status.h"
#include "stress/lattice.h"

struct narrow {
	int wx, wy, x0, y0; /* cells, and those that nodes are counted from */
	const double *load; /* scale times, in rows of stride */
	size_t stride;
	const struct stress_span
		*run; /* of loaded cells, row by row, of the whole grid */
	size_t runs;
	double scale;
	int reach;         /* cells, along either axis */
	const float *size; /* equivalent stress by a unit load, in rows of 2 reach + 1 */
	const struct lattice_gather *far;
	double limit;
};

/* The nodes of the spans that may exceed the limit, and few others.  *span is to be
 * freed. */
enum num_status narrow_spans(const struct narrow *n, const struct stress_span *from,
	size_t count, struct stress_span **span, size_t *number);

#endif
