#include "points.h"
#include "cli/msg.h"
#include "num/select.h"
#include <math.h>
#include <stdlib.h>

/* Heights are taken for positions where pairs of random ones that do not repeat are rarer
 * than this, as eight of a grid of eight are. */
static const double SELDOM = 0.01;

struct axis {
	double low, step;
	size_t count;
};

/* The positions of a column; 0 if they are not equally spaced. */
static int axis_of(const double *row, size_t n, size_t columns, struct axis *a)
{
	double *x = xcalloc(n, sizeof *x), widest = 0;
	int even = 1;

	for (size_t i = 0; i < n; i++) {
		x[i] = row[columns * i];
		even &= isfinite(x[i]) != 0;
	}
	if (even)
		sort_numbers(x, n);
	for (size_t i = 1; even && i < n; i++)
		widest = fmax(widest, x[i] - x[i - 1]);
	*a = (struct axis){ x[0], 0, 1 };
	for (size_t i = 1; even && i < n; i++)
		a->count += x[i] - x[i - 1] > 0.5 * widest;
	a->step = (x[n - 1] - x[0]) / (double)(a->count - 1);
	even &= a->count > 1;
	for (size_t i = 0; even && i < n; i++) {
		double k = (x[i] - a->low) / a->step;

		even = fabs(k - floor(k + 0.5)) <= 0.02;
	}
	free(x);
	return even;
}

static size_t place(const struct axis *a, double x)
{
	return (size_t)((x - a->low) / a->step + 0.5);
}

/* The chance that n pairs, each one of so many, do not repeat. */
static double chance(size_t n, double pairs)
{
	double p = 1;

	for (size_t i = 0; i < n && p > 0; i++)
		p *= fmax(1 - (double)i / pairs, 0);
	return p;
}

enum points points_find(const double *row, size_t n, size_t columns, struct grid *grid)
{
	struct axis x, y;
	double all, luck;
	char *seen;
	long repeated = 0;

	if (!axis_of(row, n, columns, &x) || !axis_of(row + 1, n, columns, &y))
		return POINTS_NONE;
	all = (double)x.count * (double)y.count;
	if (all > 2 * (double)n)
		return POINTS_NONE;
	seen = xcalloc(x.count * y.count, 1);
	*grid = (struct grid){ x.count, y.count, x.step, y.step,
		xcalloc(n, sizeof *grid->at) };
	for (size_t i = 0; i < n; i++) {
		const double *at_row = row + columns * i;
		size_t at = place(&y, at_row[1]) * x.count + place(&x, at_row[0]);

		repeated += seen[at];
		seen[at] = 1;
		grid->at[i] = at;
	}
	free(seen);
	luck = chance(n, all);
	if (!repeated && (all == (double)n || luck < SELDOM))
		return all > (double)n ? POINTS_PART
		       : luck < SELDOM ? POINTS_FULL
				       : POINTS_FEW;
	free(grid->at);
	return POINTS_NONE;
}
