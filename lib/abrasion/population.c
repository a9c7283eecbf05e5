#include "abrasion/population.h"
#include "num/philox.h"
#include "num/room.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>

/* Exponent of N between point k and k + 1. */
static double slope(const struct population *p, int k)
{
	return log(p->number[k] / p->number[k + 1]) /
	       log(p->diameter[k + 1] / p->diameter[k]);
}

/* The value of the line through all points, which includes the particles beyond largest.
 */
static double line(const struct population *p, double d)
{
	int k = d > p->diameter[1];

	return p->number[k] * pow(d / p->diameter[k], -slope(p, k));
}

double population_larger(const struct population *p, double d)
{
	return d < p->largest ? line(p, d) - line(p, p->largest) : 0;
}

double population_diameter(const struct population *p, double n)
{
	double all = n + line(p, p->largest);
	int k = all < p->number[1];
	double s = slope(p, k);

	return s > 0 ? p->diameter[k] * pow(all / p->number[k], -1 / s) : p->diameter[k];
}

enum num_status population_draw(const struct population *p, double volume, double least,
	uint64_t seed, uint32_t realisation, size_t most, double **list, size_t *n)
{
	double all, sum = 0;
	size_t room = 0;

	*list = NULL;
	*n = 0;
	all = volume * population_larger(p, fmax(least, p->diameter[0]));
	if (all > (double)most)
		return NUM_DOMAIN;
	for (;;) {
		sum -= log(philox_uniform(seed, realisation, RNG_ABRASION, *n));
		if (!(sum < all))
			return NUM_OK;
		if (*n == most || room_for(list, &room, *n + 1, sizeof **list)) {
			free(*list);
			*list = NULL;
			return *n == most ? NUM_DOMAIN : NUM_MEMORY;
		}
		(*list)[(*n)++] = population_diameter(p, sum / volume);
	}
}

/* The particles of one class of ln d: N falls by their number from end to end. */
static void add_class(const struct population *p, const struct abrasion_par *par,
	double low, double high, struct population_mean *m)
{
	double number = par->gap * (line(p, exp(low)) - line(p, exp(high)));
	struct abrasion a;

	abrasion_particle(par, exp(0.5 * (low + high)), 1, &a);
	if (!isnan(a.load))
		m->pressure += number * a.load;
	if (a.mode == ABRASION_YIELDS || a.mode == ABRASION_BURIED)
		m->undescribed += number;
	for (int k = 0; k < 2; k++)
		if (!isnan(a.section[k]))
			m->section[k] += number * a.section[k];
}

static enum abrasion_mode mode_at(const struct abrasion_par *par, double ln)
{
	struct abrasion a;

	abrasion_particle(par, exp(ln), 1, &a);
	return a.mode;
}

/* Between low and high, where the mode is another one: from where on. */
static double mode_ends(const struct abrasion_par *par, double low, double high)
{
	enum abrasion_mode first = mode_at(par, low);

	for (int k = 0; k < 40; k++) {
		double middle = 0.5 * (low + high);

		if (mode_at(par, middle) == first)
			low = middle;
		else
			high = middle;
	}
	return high;
}

/* By midpoints.  Loads and sections jump with the mode. */
void population_mean(const struct population *p, const struct abrasion_par *par, size_t n,
	struct population_mean *m)
{
	double from = log(fmax(par->gap, p->diameter[0])), to = log(p->largest);
	double low = from;
	enum abrasion_mode mode = mode_at(par, low), next;

	*m = (struct population_mean){ 0 };
	for (size_t i = 0; i < n && from < to; i++) {
		double high = from + (to - from) * (double)(i + 1) / (double)n;

		next = mode_at(par, high);
		if (mode != next) {
			double jump = mode_ends(par, low, high);

			add_class(p, par, low, jump, m);
			low = jump;
		}
		add_class(p, par, low, high, m);
		low = high;
		mode = next;
	}
}

struct oil {
	const struct population *population;
	struct abrasion_par par;
	size_t classes;
};

static double pressure_at(void *all, double gap)
{
	struct oil *oil = all;
	struct population_mean m;

	oil->par.gap = gap;
	population_mean(oil->population, &oil->par, oil->classes, &m);
	return m.pressure;
}

double population_gap(const struct population *p, const struct abrasion_par *par,
	double pressure, size_t n, double *carried)
{
	struct oil oil = { p, *par, n };

	return abrasion_widest(pressure_at, NULL, &oil, p->largest, pressure, carried);
}
