#include "abrasion/groove.h"
#include "abrasion/particle.h"
#include <math.h>

/* One groove, seen along its direction. */
struct profile {
	double r, depth, half; /* half: half of its width */
	double ridge;          /* height of the ridges */
};

/* Integral of what the sphere takes away from the middle to u. */
static double groove_integral(const struct profile *p, double u)
{
	double r = p->r, v = fmin(fabs(u), p->half), s;

	s = 0.5 * (v * sqrt(fmax((r - v) * (r + v), 0)) + r * r * asin(fmin(v / r, 1))) -
	    (r - p->depth) * v;
	return u < 0 ? -s : s;
}

/* The same integral of the ridges: parabolas from half to 2 half. */
static double ridge_integral(const struct profile *p, double u)
{
	double w = p->half, t = (fmin(fmax(fabs(u), w), 2 * w) - 1.5 * w) / (0.5 * w);
	double s = p->ridge * 0.5 * w * (t - t * t * t / 3 + 2.0 / 3);

	return u < 0 ? -s : s;
}

/* Length of the groove over the cells of column ix, summed over all periods. */
static double covered(const struct groove *g, double dx, int nx, int ix)
{
	double lap = nx * dx, laps = floor(g->length / lap),
	       rest = g->length - laps * lap;
	double from = fmod(g->x, lap), sum = laps * dx;

	for (int k = -1; k <= 1; k++) {
		double low = fmax(ix * dx + k * lap, from);
		double high = fmin((ix + 1) * dx + k * lap, from + rest);

		sum += fmax(high - low, 0);
	}
	return sum;
}

double groove_cut(int nx, int ny, double dx, double dy, double *z, const struct groove *g)
{
	struct profile p = { .r = g->diameter / 2, .depth = g->depth };
	double section = abrasion_section(g->diameter, g->depth), changed = 0;
	double reach;
	long first, last;

	p.half = sqrt(g->depth * (g->diameter - g->depth));
	/* two ridges of 2/3 height width hold what is not cut */
	p.ridge = p.half > 0 ? 0.75 * (1 - g->cut) * section / p.half : 0;
	reach = g->cut < 1 ? 2 * p.half : p.half;
	first = (long)floor((g->y - reach) / dy);
	last = (long)floor((g->y + reach) / dy);
	for (long j = first; j <= last; j++) {
		double low = (double)j * dy - g->y, high = low + dy;
		double lower =
			(groove_integral(&p, high) - groove_integral(&p, low) -
				ridge_integral(&p, high) + ridge_integral(&p, low)) /
			dy;
		long iy = ((j % ny) + ny) % ny;

		if (lower == 0)
			continue;
		for (int ix = 0; ix < nx; ix++) {
			double share = covered(g, dx, nx, ix) / dx;

			if (!(share > 0))
				continue;
			z[iy * nx + ix] -= lower * share;
			changed++;
		}
	}
	return changed;
}
