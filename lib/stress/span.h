/* span.h - the nodes at which stress is requested, and the callback that receives it */
#ifndef STRESS_SPAN_H
#define STRESS_SPAN_H

#include "stress/criterion.h"
#include <stddef.h>

/* Nodes [begin, end) of row y. */
struct stress_span {
	int y, begin, end;
};

/* Receives the stress components of a span, number[c][x - begin].  Called once for each
 * span, in any order and from any thread. */
typedef void stress_put(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS]);

/* The request: count spans, the first numbers components of STRESS_NUMBERS. */
struct stress_want {
	const struct stress_span *span;
	size_t count;
	int numbers;
	stress_put *put;
	void *context;
};

#endif
