#include "num/passage.h"
#include <gsl/gsl_randist.h>
#include <math.h>

/* Largest shape: the relative scatter of the passage is 1e-7 there, and beyond it is
 * neglected. */
static const double shape_max = 1e14;

double gamma_passage(double left, double mean, double variance, gsl_rng *rng)
{
	double shape, scale, low = 0, high, worn = 0, next;

	if (!(left > 0))
		return 0;
	if (!(mean > 0))
		return INFINITY;
	shape = mean * mean / variance; /* of one unit of time */
	scale = variance / mean;
	high = left / mean;
	if (!(variance > 0) || !(shape * high < shape_max))
		return high;
	if (!(shape > 0) || !isfinite(scale))
		return INFINITY; /* all wear comes in jumps that almost never happen */
	/* next: wear at time high */
	next = gsl_ran_gamma(rng, shape * high, scale);
	while (next < left) {
		if (!isfinite(2 * high))
			return INFINITY;
		worn = next;
		next += gsl_ran_gamma(rng, shape * high, scale);
		low = high;
		high *= 2;
	}
	/* wear at low is below left, wear at high (next) is not */
	while (high - low > 1e-6 * high) {
		double half = (high - low) / 2;
		double part = gsl_ran_beta(rng, shape * half, shape * half);
		double middle = worn + (next - worn) * part;

		if (middle < left) {
			worn = middle;
			low += half;
		} else {
			next = middle;
			high -= half;
		}
	}
	return high;
}
