/* classify.c - see classify.h */
#include "signal/pulse/classify.h"
#include "num/sigmas.h"
#include <math.h>

int classify_is_ferrous(const struct material *m)
{
	return m->mu >= 4; /* 2 (mu - 1) / (mu + 2) = 1, half of 2 */
}

double classify_equivalent(const struct material *m, double d, double f)
{
	struct polarisability r = material_response(m, d, f);

	return d * cbrt(hypot(r.re, r.im));
}

double classify_diameter(const struct material *m, double size, double f)
{
	double low = size, high = 2 * size;

	while (classify_equivalent(m, high, f) < size && high < 1e6 * size)
		high *= 2;
	if (classify_equivalent(m, low, f) >= size)
		return low;
	while (high - low > 1e-9 * low) {
		double middle = 0.5 * (low + high);

		if (classify_equivalent(m, middle, f) < size)
			low = middle;
		else
			high = middle;
	}
	return low;
}

double classify_ferrous(const struct material *const *material, const double *share,
	int n, double size, double phase, double phase_se, double frequency)
{
	double sum[2] = { 0 }, nearest = INFINITY;

	if (!(size > 0) || !isfinite(size) || !isfinite(phase) || !(phase_se > 0))
		return NAN;
	for (int i = 0; i < n; i++) {
		const struct material *m = material[i];
		struct polarisability r = material_response(
			m, classify_diameter(m, size, frequency), frequency);
		double off = remainder(phase - atan2(r.im, r.re), 2 * M_PI) / phase_se;

		if (share[i] > 0)
			nearest = fmin(nearest, fabs(off));
		sum[classify_is_ferrous(m)] += share[i] * exp(-0.5 * off * off);
	}
	return nearest < SIGMAS_RARELY ? sum[1] / (sum[0] + sum[1]) : NAN;
}
