/* running.c - see running.h */
#include "num/running.h"
#include <math.h>

void running_repeat(struct running *r, double x, double times)
{
	double all = r->n + times, d = x - r->mean;

	if (!(times > 0))
		return;
	r->cube +=
		d * times / all * (d * d * r->n * (r->n - times) / all - 3 * r->square);
	r->square += d * d * r->n * times / all;
	r->mean += d * times / all;
	r->n = all;
}

void running_add(struct running *r, double x)
{
	running_repeat(r, x, 1);
}

double running_variance(const struct running *r)
{
	return r->n > 1 ? r->square / (r->n - 1) : NAN;
}

double running_skewness(const struct running *r)
{
	double n = r->n;

	if (n < 3 || !(r->square > 0))
		return 0;
	return r->cube / (r->square * sqrt(r->square)) * sqrt(n * (n - 1)) / (n - 2);
}
