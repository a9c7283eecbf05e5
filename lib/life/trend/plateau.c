/* plateau.c - see plateau.h */
#include "life/trend/plateau.h"
#include "num/running.h"
#include <math.h>

/* See "Single constants" in doc/trends.md. */
enum { LEVEL = 10 }; /* the last means that lie on a line, at least */
static const double SLOW = 0.1;
/* Damage at which a unit, at the rate so far, would fail within ten times its age, the
 * default horizon: below it lives are not known anyway, and run-in has just ended. */
static const double WORN = 1. / 11;

void plateau_add(struct plateau *p, double t, double y)
{
	p->each = p->each > 0 ? p->each : 1;
	p->next.t += t / (double)p->each;
	p->next.y += y / (double)p->each;
	if (++p->rows < p->each)
		return;
	p->block[p->n++] = p->next;
	p->next = (struct block){ 0, 0 };
	p->rows = 0;
	if (p->n < PLATEAU_BLOCKS)
		return;
	for (int k = 0; 2 * k < PLATEAU_BLOCKS; k++) {
		const struct block *pair = &p->block[2 * k];

		p->block[k] = (struct block){ 0.5 * pair[0].t + 0.5 * pair[1].t,
			0.5 * pair[0].y + 0.5 * pair[1].y };
	}
	p->n /= 2;
	p->each *= 2;
}

int plateau_reached(const struct plateau *p, double threshold)
{
	const struct block *first = &p->block[0];
	struct regression line = { 0 };

	for (int k = p->n - 1; k >= LEVEL / 2; k--) {
		double rate, slope, error, left;

		regression_add(&line, p->block[k].t,
			(p->block[k].y - first->y) / (threshold - first->y));
		if (line.n < LEVEL)
			continue;
		rate = line.mean_y / (p->block[k].t - first->t);
		slope = regression_slope(&line) / rate;
		left = fmax(0, line.yy - regression_slope(&line) * line.xy);
		error = sqrt(left / (line.n - 2) / line.xx) / rate;
		if (line.mean_y > WORN && line.mean_y < 1 && fabs(slope) < 2 * error &&
			slope + 3 * error < SLOW)
			return 1;
	}
	return 0;
}
