/* span.c - see span.h */
#include "stress/span.h"

const struct stress_span *span_first(const struct stress_want *want, int y)
{
	size_t low = 0, high = want->count;

	while (low < high) {
		size_t middle = (low + high) / 2;

		if (want->span[middle].y < y)
			low = middle + 1;
		else
			high = middle;
	}
	return want->span + low;
}
