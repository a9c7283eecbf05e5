/* rescaled.c - see rescaled.h */
#include "life/trend/rescaled.h"
#include <math.h>
#include <string.h>

/* The variance ratio F of 7 and 7 steps is beyond 25 or below 1/25 in 4 of 10 000 series
 * whose steps are the same before and after, and within a factor of 8 of its mean in 98
 * of 100 whose steps are not. */
static const double OTHER = 25, SAME = 8;

struct part {
	double mean, squares; /* of the values, of the steps between them */
	double spread;
};

static struct part part_of(const double *y, int n)
{
	struct part p = { 0 };
	double least = y[0], most = y[0];

	for (int i = 0; i < n; i++) {
		p.mean += y[i] / n;
		least = fmin(least, y[i]);
		most = fmax(most, y[i]);
		if (i > 0)
			p.squares += (y[i] - y[i - 1]) * (y[i] - y[i - 1]) / (n - 1);
	}
	p.spread = most - least;
	return p;
}

/* The factor by which the n values from y on may differ from those before them, else 0:
 * the level changes in one step, of which the spread on either side is a small part, and
 * the other steps by about as much.  *steps: the logarithm of that of their squares. */
static double factor_at(const double *y, int n, double *steps)
{
	struct part old = part_of(y - RESCALED_HALF, RESCALED_HALF), new = part_of(y, n);
	double ratio = new.mean / old.mean;

	*steps = log(new.squares / old.squares);
	if (!(ratio > 0) || y[0] == y[-1] ||
		fmax(old.spread, new.spread) > 0.25 * fabs(y[0] - y[-1]))
		return 0;
	return ratio;
}

double rescaled_add(struct rescaled *r, double y)
{
	double *middle = r->y + RESCALED_HALF, steps, factor;

	memmove(r->y, r->y + 1, sizeof r->y - sizeof *r->y);
	r->y[2 * RESCALED_HALF - 1] = y;
	if (++r->rows < 2 * RESCALED_HALF)
		return 0;
	factor = factor_at(middle, RESCALED_HALF, &steps);
	if (fabs(steps) > log(OTHER) && fabs(steps - 2 * log(factor)) < log(SAME))
		return factor;
	return 0;
}

/* Largest probability that a repair looks like a counter that wraps.  The highest value
 * before it lies anywhere in the upper half of the range of the counter; in a part of it
 * two spreads of the steps wide, that is, with a probability of 4 spreads / range, the
 * step across the end of the range agrees with those before. */
static const double CHANCE = 1. / 32;

double rescaled_range(const struct rescaled *r, int n, double threshold)
{
	const double *new = r->y + 2 * RESCALED_HALF - n, *old = new - RESCALED_HALF;
	double top = new[-1],
	       range[2] = { exp2(ceil(log2(top))), pow(10, ceil(log10(top))) },
	       least = INFINITY, most = 0, spread, usual;

	if (r->rows < RESCALED_HALF + n)
		return 0;
	for (int i = 1; i < RESCALED_HALF; i++) {
		least = fmin(least, old[i] - old[i - 1]);
		most = fmax(most, old[i] - old[i - 1]);
	}
	spread = most - least;
	usual = 0.5 * (most + least);
	for (int i = 0; i < n; i++)
		if (!(new[i] >= 0 && new[i] <= 2 * most *(i + 1)))
			return 0;
	for (int k = 0; k < 2; k++)
		if (fabs(new[0] + range[k] - top - usual) <= spread + 1e-9 * range[k] &&
			4 * spread <= CHANCE * range[k] && (k == 1 || range[k] >= 256) &&
			range[k] < threshold)
			return range[k];
	return 0;
}

int rescaled_doubtful(const struct rescaled *r, double threshold)
{
	double steps, change;

	for (int n = 3; n < RESCALED_HALF && r->rows >= RESCALED_HALF + n; n++) {
		change = 2 * log(factor_at(r->y + 2 * RESCALED_HALF - n, n, &steps));
		if (rescaled_range(r, n, threshold) > 0 ||
			(fmin(fabs(change), fabs(steps)) > log(SAME) &&
				fabs(steps - change) < fabs(steps)))
			return 1;
	}
	return 0;
}

/* The mean square of the steps over one row is OTHER times that of those over two in none
 * of 200 000 series of white noise. */
int rescaled_alternates(const struct rescaled *r)
{
	double one = 0, two = 0;

	for (int i = 2; i < 2 * RESCALED_HALF; i++) {
		one += (r->y[i] - r->y[i - 1]) * (r->y[i] - r->y[i - 1]);
		two += (r->y[i] - r->y[i - 2]) * (r->y[i] - r->y[i - 2]);
	}
	return r->rows >= 2 * RESCALED_HALF && one > OTHER * two;
}
