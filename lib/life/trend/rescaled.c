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

/* Courses are told apart by a largest step of AWAY times the steps along each of them,
 * with TURNS changes between them and as many values on each: see "Single constants" in
 * doc/trends.md. */
static const double AWAY = 8;
enum { TURNS = 5 };

/* Rounded values scatter by at least half of the smallest step, over one row or two. */
static int takes_turns(const struct rescaled *r)
{
	const double *y = r->y;
	double most = 0, least = INFINITY, squares = 0, last[2] = { 0 };
	int n[2] = { 0 }, course = 0, turns = 0;

	for (int i = 2; i < 2 * RESCALED_HALF; i++) {
		most = fmax(most, fabs(y[i] - y[i - 1]));
		for (int k = 1; k < 3; k++)
			if (y[i] != y[i - k])
				least = fmin(least, fabs(y[i] - y[i - k]));
	}
	for (int i = 0; i < 2 * RESCALED_HALF; i++) {
		if (i > 0 && fabs(y[i] - y[i - 1]) > most / 2) {
			course = !course;
			turns++;
		}
		if (n[course]++ > 0)
			squares += pow(y[i] - last[course], 2) + least * least / 4;
		last[course] = y[i];
	}
	return turns >= TURNS && fmin(n[0], n[1]) >= TURNS &&
	       (2 * RESCALED_HALF - 2) * most * most > AWAY * AWAY * squares;
}

double rescaled_add(struct rescaled *r, double y)
{
	double *middle = r->y + RESCALED_HALF, steps, factor;

	memmove(r->y, r->y + 1, sizeof r->y - sizeof *r->y);
	r->y[2 * RESCALED_HALF - 1] = y;
	if (++r->rows < 2 * RESCALED_HALF)
		return 0;
	r->turns += takes_turns(r);
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

/* A machine of two states may be measured in turn for a while. */
int rescaled_alternates(const struct rescaled *r)
{
	return r->turns > 0 && 4 * r->turns > r->rows - 2 * RESCALED_HALF + 1;
}
