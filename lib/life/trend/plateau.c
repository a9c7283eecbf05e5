/* plateau.c - see plateau.h */
#include "life/trend/plateau.h"
#include "num/running.h"
#include <math.h>

/* See "Single constants" in doc/trends.md. */
enum {
	LEVEL = 10, /* the last means that lie on a line, at least */
	HALF = LEVEL / 2
};
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

/* The most that HALF means together have reached before number k: a single one is at
 * times that high by its noise. */
static double most_before(const struct plateau *p, int k, double threshold)
{
	double most = 0;

	for (; k >= HALF; k--) {
		double sum = 0;

		for (int j = k - HALF; j < k; j++)
			sum += p->block[j].y - p->block[0].y;
		most = fmax(most, sum / HALF / (threshold - p->block[0].y));
	}
	return most;
}

int plateau_reached(const struct plateau *p, double threshold, double since, int clean)
{
	const struct block *first = &p->block[0];
	struct regression line = { 0 };

	for (int k = p->n - 1; k >= HALF && p->block[k].t >= since; k--) {
		double way, rate, slope, error, left;

		regression_add(&line, p->block[k].t,
			(p->block[k].y - first->y) / (threshold - first->y));
		if (line.n < LEVEL)
			continue;
		way = line.mean_y;
		if (clean)
			way = fmax(way, most_before(p, k, threshold));
		rate = way / (p->block[k].t - first->t);
		slope = regression_slope(&line) / rate;
		left = fmax(0, line.yy - regression_slope(&line) * line.xy);
		error = sqrt(left / (line.n - 2) / line.xx) / rate;
		if (way > WORN && line.mean_y < 1 && slope < 2 * error &&
			(clean || slope > -2 * error) && slope + 3 * error < SLOW)
			return 1;
	}
	return 0;
}
