#include "life/slope.h"

void slope_add(struct slope *s, double t, double y)
{
	double dt = t - s->mean_t, dy = y - s->mean_y;

	s->n++;
	s->mean_t += dt / (double)s->n;
	s->mean_y += dy / (double)s->n;
	s->tt += dt * (t - s->mean_t);
	s->ty += dt * (y - s->mean_y);
}

double slope_get(const struct slope *s)
{
	return s->ty / s->tt;
}
