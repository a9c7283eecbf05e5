#include "debris/reserve.h"

#include <math.h>

double reserve(double yield, double stress)
{
	return sqrt(yield / fmax(stress, 1e-6 * yield));
}

double reserve_crossing(const struct reserve *r)
{
	double z1 = r->z[1], step = r->z[0] - z1;
	double slope = (r->g[0] - r->g[1]) / step, bend = 0, b, c = r->g[1] - 1, q, s;

	if (r->depths > 2)
		bend = (slope - (r->g[1] - r->g[2]) / (z1 - r->z[2])) /
		       (r->z[0] - r->z[2]);
	/* bend s^2 + b s + c = 0 has one root in [0, step]. */
	b = slope - bend * step;
	q = -0.5 * (b + copysign(sqrt(fmax(0, b * b - 4 * bend * c)), b));
	s = c / q;
	if (!(s >= 0 && s <= step))
		s = q / bend;
	return z1 + fmin(fmax(s, 0), step);
}

double reserve_dip(const struct reserve *r)
{
	double z0 = r->z[2], z1 = r->z[1], z2 = r->z[0], slope, bend, b, c, most;

	if (r->depths < 3)
		return -1;
	slope = (r->g[1] - r->g[2]) / (z1 - z0);
	bend = ((r->g[0] - r->g[1]) / (z2 - z1) - slope) / (z2 - z0);
	/* g0 + b s + bend s^2 - 1 */
	b = slope - bend * (z1 - z0);
	c = r->g[2] - 1;
	most = -b / (2 * bend);
	if (!(bend < 0 && most > 0 && most < z2 - z0 && b * b > 4 * bend * c))
		return -1;
	return z0 + 2 * c / (-b - sqrt(b * b - 4 * bend * c));
}
