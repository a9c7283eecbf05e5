/* rescaled.c - see rescaled.h */
#include "life/trend/rescaled.h"
#include <math.h>
#include <string.h>

/* The variance ratio F of 7 and 7 steps is beyond 25 or below 1/25 in 4 of 10 000 series
 * whose steps are the same before and after, and within a factor of 8 of its mean in 98
 * of 100 whose steps are not. */
static const double OTHER = 25, SAME = 8;

struct half {
	double sum, squares; /* of the values, of the steps between them */
	double least, most;
};

static struct half half_of(const double *y)
{
	struct half h = { 0, 0, INFINITY, -INFINITY };

	for (int i = 0; i < RESCALED_HALF; i++) {
		h.sum += y[i];
		h.least = fmin(h.least, y[i]);
		h.most = fmax(h.most, y[i]);
		if (i > 0)
			h.squares += (y[i] - y[i - 1]) * (y[i] - y[i - 1]);
	}
	return h;
}

double rescaled_add(struct rescaled *r, double y)
{
	const int n = RESCALED_HALF;
	struct half old, new;
	double ratio, between, steps;

	memmove(r->y, r->y + 1, sizeof r->y - sizeof *r->y);
	r->y[2 * n - 1] = y;
	if (++r->rows < 2 * n || r->y[n] == r->y[n - 1])
		return 0;
	old = half_of(r->y);
	new = half_of(r->y + n);
	ratio = new.sum / old.sum;
	between = r->y[n] - r->y[n - 1];
	/* one step, of which the spread of either half is a small part */
	if (!(ratio > 0) ||
		fmax(old.most - old.least, new.most - new.least) > 0.25 * fabs(between))
		return 0;
	steps = log(new.squares / old.squares);
	if (fabs(steps) > log(OTHER) && fabs(steps - 2 * log(ratio)) < log(SAME))
		return ratio;
	return 0;
}
