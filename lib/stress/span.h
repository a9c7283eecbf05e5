/* span.h - the nodes at which stress is requested, and the callback that receives it */
#ifndef STRESS_SPAN_H
#define STRESS_SPAN_H

#include "stress/criterion.h"
#include <stddef.h>

/* Cells x0 to x1 of the rows y0 to y1, inclusive; none if x1 < x0. */
struct stress_box {
	int x0, x1, y0, y1;
};

/* Nodes [begin, end) of row y. */
struct stress_span {
	int y, begin, end;
};

/* Receives the stress components of a span or of a part of one, number[c][x - begin], in
 * any order and from any thread; the parts cover every span once, but for nodes that are
 * known not to exceed a limit. */
typedef void stress_put(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS]);

/* Equivalent stress of these numbers. */
typedef double stress_size(void *context, const double number[STRESS_NUMBERS]);

/* The request: count spans, row by row and in each from left to right, and the first
 * numbers components of STRESS_NUMBERS. */
struct stress_want {
	const struct stress_span *span;
	size_t count;
	int numbers;
	stress_put *put;
	stress_size *size; /* NULL: all nodes are received */
	double limit;      /* of their equivalent stress; others need not be received */
	void *context;
};

/* The first span of row y or of one after it; span + count if there is none. */
const struct stress_span *span_first(const struct stress_want *want, int y);

/* Sums at a rectangle of nodes, number[c][(y - y0) * stride + x - x0]; number NULL: all
 * are zero. */
struct stress_part {
	int x0, y0, x1, y1; /* x1 and y1 exclusive */
	const double *const *number;
	size_t stride;
};

#endif
