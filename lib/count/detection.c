#include "count/detection.h"
#include <gsl/gsl_cdf.h>
#include <math.h>

double detection_probability(const struct detection *d, double diameter)
{
	if (!(d->d50 > 0))
		return 1;
	return gsl_cdf_ugaussian_P(
		d->threshold * (pow(diameter / d->d50, d->exponent) - 1));
}

double detection_diameter(const struct detection *d, double p)
{
	double x = 1 + gsl_cdf_ugaussian_Pinv(p) / d->threshold;

	return x > 0 ? d->d50 * pow(x, 1 / d->exponent) : 0;
}

double detection_threshold(double duration, double rate)
{
	double x = -2 * log(rate * duration);

	return x > 0 ? sqrt(x) : NAN;
}
