#include "debris/reserve.h"
#include "num/lesser.h"

#include <math.h>

double reserve(double yield, double stress)
{
	return sqrt(yield / larger_double(stress, 1e-6 * yield));
}

/* Between two depths, the last one after so many. */
static double slope_before(const struct reserve *r, int ago)
{
	return (r->g[ago] - r->g[ago + 1]) / (r->z[ago] - r->z[ago + 1]);
}

/* Half the second derivative. */
static double bend_of(const struct reserve *r)
{
	return r->depths < 3
		       ? 0
		       : (slope_before(r, 0) - slope_before(r, 1)) / (r->z[0] - r->z[2]);
}

double reserve_slope(const struct reserve *r, double z)
{
	return slope_before(r, 0) + bend_of(r) * (2 * z - r->z[0] - r->z[1]);
}

double reserve_crossing(const struct reserve *r)
{
	double z1 = r->z[1], step = r->z[0] - z1;
	double slope = slope_before(r, 0), bend = bend_of(r), b, c = r->g[1] - 1, q, s;

	/* bend s^2 + b s + c = 0 has one root in [0, step]. */
	b = slope - bend * step;
	q = -0.5 * (b + copysign(sqrt(fmax(0, b * b - 4 * bend * c)), b));
	s = c / q;
	if (!(s >= 0 && s <= step))
		s = q / bend;
	return z1 + fmin(fmax(s, 0), step);
}

/* Whether the parabola stays below 1.  It exceeds the reserves at the ends of a step h by
 * at most h^2 / 4 times half its second derivative, which for steps of ratios up to 2.5
 * is less than half of the sum of both changes. */
static int is_far(const struct reserve *r)
{
	double most = larger_double(larger_double(r->g[0], r->g[1]), r->g[2]);

	return most + 0.5 * (fabs(r->g[0] - r->g[1]) + fabs(r->g[1] - r->g[2])) < 1;
}

double reserve_peak(const struct reserve *r, double *z)
{
	double bend = bend_of(r), b, top;

	if (!(bend < 0))
		return -INFINITY;
	b = slope_before(r, 1) - bend * (r->z[1] - r->z[2]);
	top = -b / (2 * bend);
	*z = r->z[2] + top;
	return top > 0 && *z < r->z[0] ? r->g[2] - b * b / (4 * bend) : -INFINITY;
}

double reserve_dip(const struct reserve *r)
{
	double z0 = r->z[2], z1 = r->z[1], z2 = r->z[0], bend, b, c, most;

	if (r->depths < 3 || is_far(r))
		return -1;
	bend = bend_of(r);
	/* g0 + b s + bend s^2 - 1 */
	b = slope_before(r, 1) - bend * (z1 - z0);
	c = r->g[2] - 1;
	most = -b / (2 * bend);
	if (!(bend < 0 && most > 0 && most < z2 - z0 && b * b > 4 * bend * c))
		return -1;
	return z0 + 2 * c / (-b - sqrt(b * b - 4 * bend * c));
}
