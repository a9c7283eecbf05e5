/* running.h - mean, variance and regression of values given one by one */
#ifndef NUM_RUNNING_H
#define NUM_RUNNING_H

struct running {
	double n, mean;
	double square; /* sum of the squares about the mean */
};

void running_add(struct running *r, double x);
/* Adds the same value several times; adds nothing if times <= 0. */
void running_repeat(struct running *r, double x, double times);
double running_variance(const struct running *r); /* over n - 1; NAN below two values */

/* y on x by least squares, about the means.  Zero it to start. */
struct regression {
	double n, mean_x, mean_y, xx, xy, yy;
};

static inline void regression_add(struct regression *r, double x, double y)
{
	double dx = x - r->mean_x, dy = y - r->mean_y;

	r->n++;
	r->mean_x += dx / r->n;
	r->mean_y += dy / r->n;
	r->xx += dx * (x - r->mean_x);
	r->xy += dx * (y - r->mean_y);
	r->yy += dy * (y - r->mean_y);
}

/* Not finite without two different x. */
static inline double regression_slope(const struct regression *r)
{
	return r->xy / r->xx;
}

#endif
