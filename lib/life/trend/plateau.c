/* plateau.c - see plateau.h */
#include "life/trend/plateau.h"
#include "num/running.h"
#include <math.h>

/* The last means that lie on a line, at least.  With 8, 10 and 12 of them, 93, 83 and 73
 * of 160 ceilings are found at 95 % of the life, and 3, 3 and 2 of 3600 records of units
 * without any fault seem to have stopped, and 28 and 14 (8, 10) of 1800 rounded ones.
 * With SLOW .05 and .15, 73 and 84 ceilings are found, and 0 and 5 of the records. */
enum { LEVEL = 10 };
static const double SLOW = 0.1;
/* Damage at which a unit, at the rate so far, would fail within ten times its age, the
 * default horizon: below it lives are not known anyway, and run-in has just ended. */
static const double WORN = 1. / 11;

int plateau_reached(const struct blocks *p, double threshold)
{
	const struct block *first = &p->mean[0];
	struct regression line = { 0 };

	for (int k = p->n - 1; k >= LEVEL / 2; k--) {
		double rate, slope, error, left;

		regression_add(&line, p->mean[k].t,
			(p->mean[k].y - first->y) / (threshold - first->y));
		if (line.n < LEVEL)
			continue;
		rate = line.mean_y / (p->mean[k].t - first->t);
		slope = regression_slope(&line) / rate;
		left = fmax(0, line.yy - regression_slope(&line) * line.xy);
		error = sqrt(left / (line.n - 2) / line.xx) / rate;
		if (line.mean_y > WORN && line.mean_y < 1 && fabs(slope) < 2 * error &&
			slope + 3 * error < SLOW)
			return 1;
	}
	return 0;
}
