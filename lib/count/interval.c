#include "count/interval.h"
#include <gsl/gsl_cdf.h>
#include <math.h>

void weighted_add(struct weighted *s, double w)
{
	s->n++;
	s->sum += w;
	s->squares += w * w;
	s->largest = fmax(s->largest, w);
}

/* Quantile of the gamma distribution of this mean and variance, by bisection: GSL's own
 * inverse fails for some shapes beyond 1e4, and its distribution function for some beyond
 * 1e6.  The expansion of Cornish and Fisher is exact to 1e-10 from 1e5 on. */
static double quantile(double p, double mean, double variance)
{
	double shape = mean * mean / variance, low = 0, high = shape;

	if (shape > 1e5) {
		double z = gsl_cdf_ugaussian_Pinv(p), root = sqrt(shape);

		return (shape + z * root + (z * z - 1) / 3 +
			       (z * z - 7) * z / (36 * root)) *
		       (variance / mean);
	}
	while (gsl_cdf_gamma_P(high, shape, 1) < p) {
		low = high;
		high *= 2;
	}
	/* A shape much below 1 has quantiles down to the smallest number, 2^-1074. */
	for (int k = 0; k < 1100 && high - low > 1e-14 * high; k++) {
		double middle = 0.5 * (low + high);

		if (gsl_cdf_gamma_P(middle, shape, 1) < p)
			low = middle;
		else
			high = middle;
	}
	return 0.5 * (low + high) * (variance / mean);
}

void weighted_interval(const struct weighted *s, double largest, double confidence,
	double *low, double *high)
{
	double tail = 0.5 * (1 - confidence), w = fmax(largest, s->largest);

	/* Weights whose square overflows have no interval. */
	if (!isfinite(s->squares))
		*low = 0;
	else
		*low = s->sum > 0 ? quantile(tail, s->sum, s->squares) : 0;
	if (!isfinite(w * w) || !isfinite(s->squares))
		*high = INFINITY;
	else
		*high = w > 0 ? quantile(1 - tail, s->sum + w, s->squares + w * w) : 0;
}
