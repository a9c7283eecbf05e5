#include "surface/ratio.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double window = 0.4; /* of ISO 13565-2 */

static int descending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x < y) - (x > y);
}

/* The first position where m steps descend least. */
static size_t flattest(const double *z, size_t n, size_t m)
{
	size_t best = 0;

	for (size_t i = 1; i + m < n; i++)
		if (z[i] - z[i + m] < z[best] - z[best + m])
			best = i;
	return best;
}

/* Area of the curve above a level, and the share at which it reaches the level; z
 * descends, each point represents 1/n of the surface, and the curve is linear between the
 * middles of the points. */
static double above(const double *z, size_t n, double level, int sign, double *share)
{
	double area = 0;
	size_t k = 0;

	/* from below: the same curve upside down */
	for (; k < n; k++) {
		double h = sign * ((sign > 0 ? z[k] : z[n - 1 - k]) - level);

		if (!(h > 0))
			break;
		area += h / (double)n;
	}
	*share = (double)k / (double)n;
	if (k > 0 && k < n) {
		double last = sign * ((sign > 0 ? z[k - 1] : z[n - k]) - level);
		double next = -sign * ((sign > 0 ? z[k] : z[n - 1 - k]) - level);
		/* from the middle of the last one to the crossing, half a step less */
		double t = last / (last + next);

		*share += (t - 0.5) / (double)n;
		area += last * (t - 1) / 2 / (double)n;
	}
	return area;
}

enum num_status surface_core(size_t n, const double *z, struct core *core)
{
	double *sorted, sx, sy = 0, xx = 0, xy = 0, slope, top, bottom, area, middle;
	size_t m = (size_t)(window * (double)n + 0.5), from;

	*core = (struct core){ NAN, NAN, NAN, NAN, NAN };
	if (n < 5)
		return NUM_OK;
	sorted = malloc(n * sizeof *sorted);
	if (!sorted)
		return NUM_MEMORY;
	memcpy(sorted, z, n * sizeof *sorted);
	qsort(sorted, n, sizeof *sorted, descending);
	from = flattest(sorted, n, m);
	middle = sorted[from + m / 2];
	sx = (double)from + 0.5 * (double)m;
	for (size_t i = from; i <= from + m; i++) {
		double x = (double)i - sx, y = sorted[i] - middle;

		sy += y / (double)(m + 1);
		xx += x * x;
		xy += x * y;
	}
	slope = xy / xx;
	/* the line at the shares 0 and 1; point i stands at (i + 1/2) / n */
	top = middle + sy - slope * (sx + 0.5);
	bottom = top + slope * (double)n;
	core->sk = top - bottom;
	area = above(sorted, n, top, 1, &core->smr1);
	core->spk = core->smr1 > 0 ? 2 * area / core->smr1 : 0;
	area = above(sorted, n, bottom, -1, &core->smr2);
	core->svk = core->smr2 > 0 ? 2 * area / core->smr2 : 0;
	core->smr2 = 1 - core->smr2;
	free(sorted);
	return NUM_OK;
}
