#include "layout/traffic.h"
#include <math.h>

enum { RINGS = 256 };                 /* of the section: 1e-5 in probability */
static const double near_wall = 0.99; /* of the radius, as particles are drawn */

double traffic_slowness(const struct traffic *t, double share, double along)
{
	double r = pipe_position(&t->pipe, near_wall * t->pipe.bore / 2, share);

	return (1 + along * t->spread) / pipe_velocity(&t->pipe, r);
}

double traffic_alone(const struct traffic *t, double zone)
{
	double s[RINGS], weight[RINGS], mean = 0, sum = 0;

	if (t->pipe.profile == PIPE_PLUG)
		return exp(-2 * t->arrivals * zone / pipe_mean_velocity(&t->pipe));
	/* Narrow near the wall, where the slowness of laminar flow is almost singular. */
	for (int i = 0; i < RINGS; i++) {
		double rest = 1 - (i + 0.5) / RINGS;

		weight[i] = 2 * rest / RINGS;
		s[i] = traffic_slowness(t, 1 - rest * rest, 0);
		mean += weight[i] * s[i];
	}
	for (int i = 0; i < RINGS; i++)
		sum += weight[i] * exp(-t->arrivals * zone * (s[i] + mean));
	return sum;
}

double traffic_unique(const struct traffic *t, double width)
{
	return exp(-t->arrivals * width);
}
