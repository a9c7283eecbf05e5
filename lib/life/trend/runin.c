/* runin.c - see runin.h */
#include "life/trend/runin.h"
#include <math.h>

/* Ends a block; 1 if its mean is the lowest after an excursion. */
static int end_block(struct runin *r, double mean, double error)
{
	double fall;

	if (r->blocks++ == 0)
		r->first = r->highest = mean;
	if (mean >= r->highest) {
		r->highest = mean;
		r->since = INFINITY;
		return 0;
	}
	fall = r->highest - mean;
	if (mean < r->since && fall > 0.5 * (r->highest - r->first) &&
		fall > 4 * sqrt(2) * error) {
		r->since = mean;
		return 1;
	}
	return 0;
}

int runin_add(struct runin *r, double y, double noise)
{
	double mean;

	r->sum += r->direction * y;
	if (++r->rows < RUNIN_BLOCK)
		return 0;
	mean = r->sum / RUNIN_BLOCK;
	r->sum = 0;
	r->rows = 0;
	return end_block(r, mean, noise / sqrt(RUNIN_BLOCK));
}
