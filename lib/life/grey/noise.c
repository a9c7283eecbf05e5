/* noise.c - see noise.h */
#include "life/grey/noise.h"
#include "num/select.h"
#include <math.h>
#include <string.h>

/* Where most residuals are 0, as with rounded values, so is their median; the root mean
 * square is used instead. */
static double spread(const struct noise *n, int count)
{
	double sorted[NOISE_WINDOW], median, sum = 0;
	size_t middle[2] = { (size_t)(count - 1) / 2, (size_t)count / 2 };

	memcpy(sorted, n->residual, (size_t)count * sizeof *sorted);
	select_ranks(sorted, (size_t)count, middle, 2);
	median = 0.5 * (sorted[middle[0]] + sorted[middle[1]]);
	for (int i = 0; i < count; i++)
		sum += n->residual[i] * n->residual[i];
	return median > 0 ? 1.4826 * median : sqrt(sum / count);
}

void noise_add(struct noise *n, double y, double gap)
{
	if (n->rows >= 2) {
		double w = gap / (gap + n->gap);
		double line = w * n->y[0] + (1 - w) * y;
		long k = n->rows - 2;

		n->residual[k % NOISE_WINDOW] =
			fabs(n->y[1] - line) / sqrt(1 + w * w + (1 - w) * (1 - w));
		n->scale = spread(n, k + 1 < NOISE_WINDOW ? (int)k + 1 : NOISE_WINDOW);
	}
	n->y[0] = n->y[1];
	n->y[1] = y;
	n->gap = gap;
	n->rows++;
}
