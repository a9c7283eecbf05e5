#include "alignment.h"
#include "cli/msg.h"
#include "net/cnn.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct alignment {
	size_t step;   /* samples that are summed */
	size_t most;   /* delays sought, in steps */
	double *sum;   /* products at these */
	size_t delays; /* of them that have a sum so far */
};

struct alignment *alignment_new(double duration, double longest)
{
	struct alignment *a = xcalloc(1, sizeof *a);

	a->step = (size_t)fmax(1, floor(2 * duration / CNN_PER_PULSE));
	a->most = (size_t)ceil(longest / (double)a->step) + 2;
	return a;
}

void alignment_free(struct alignment *a)
{
	if (a)
		free(a->sum);
	free(a);
}

size_t alignment_reach(const struct alignment *a, size_t n)
{
	return n + a->most * a->step;
}

/* Sums of step samples each, fresh memory. */
static double *sum_steps(const double *y, size_t n, size_t step)
{
	double *sum = xcalloc(n / step + 1, sizeof *sum);

	for (size_t i = 0; i < n / step * step; i++)
		sum[i / step] += y[i];
	return sum;
}

/* Makes room for the products at so many delays. */
static void extend(struct alignment *a, size_t delays)
{
	if (delays <= a->delays)
		return;
	a->sum = xrealloc(a->sum, delays, sizeof *a->sum);
	memset(a->sum + a->delays, 0, (delays - a->delays) * sizeof *a->sum);
	a->delays = delays;
}

void alignment_add(struct alignment *a, const double *y1, size_t n, const double *y2,
	size_t available)
{
	size_t steps = n / a->step, most = available / a->step;
	double *first = sum_steps(y1, n, a->step),
	       *second = sum_steps(y2, available, a->step);

	extend(a, most < a->most ? most : a->most);
	for (size_t l = 0; l < a->delays; l++)
		for (size_t i = 0; i < steps && i + l < most; i++)
			a->sum[l] += first[i] * second[i + l];
	free(first);
	free(second);
}

double alignment_delay(const struct alignment *a)
{
	size_t best = 0;
	double before, at, after;

	for (size_t l = 1; l < a->delays; l++)
		best = a->sum[l] > a->sum[best] ? l : best;
	if (a->delays == 0 || !(a->sum[best] > 0))
		return NAN;
	at = a->sum[best];
	before = best > 0 ? a->sum[best - 1] : at;
	after = best + 1 < a->delays ? a->sum[best + 1] : at;
	if (before - 2 * at + after == 0)
		return (double)(best * a->step);
	return ((double)best + 0.5 * (before - after) / (before - 2 * at + after)) *
	       (double)a->step;
}
