/* running.h - mean, variance, skewness and regression of values given one by one */
#ifndef NUM_RUNNING_H
#define NUM_RUNNING_H

struct running {
	double n, mean;
	double square, cube; /* sums of the squares and cubes about the mean */
};

void running_add(struct running *r, double x);
/* Adds the same value several times; adds nothing if times <= 0. */
void running_repeat(struct running *r, double x, double times);
double running_variance(const struct running *r); /* over n - 1; NAN below two values */
/* Skewness over the largest that n values can have, (n - 2) / sqrt(n - 1), which they
 * have where all but one are equal; 0 below three values. */
double running_skewness(const struct running *r);

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
