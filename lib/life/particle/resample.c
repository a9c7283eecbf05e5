/* resample.c - see resample.h */
#include "life/particle/resample.h"
#include <string.h>

/* Point k of the comb, k + offset, is compared with the running sum of the weights.  The
 * ancestor of a particle is the number of those whose last copy lies before it; these are
 * counted and summed without a branch, which would be mispredicted. */
void resample(
	struct draw *draw, const double *weight, double sum, size_t n, uint32_t *ancestor)
{
	double scale = (double)n / sum, reached = 0, offset = draw_uniform(draw);
	uint32_t ended = 0;

	memset(ancestor, 0, n * sizeof *ancestor);
	for (size_t i = 0; i + 1 < n; i++) {
		size_t end;

		reached += weight[i];
		end = (size_t)(reached * scale + (1 - offset));
		if (end < n)
			ancestor[end]++;
	}
	for (size_t k = 0; k < n; k++)
		ancestor[k] = ended += ancestor[k];
}
