#include "life/pair/pair.h"
#include <math.h>
#include <stddef.h>

struct leakage leakage_thesis(void)
{
	return (struct leakage){ .radius = { 0.0386, 0.0436, 0.0564, 0.0614 },
		.alpha0 = 2.59706,
		.drop = 20.85e6,
		.viscosity = 0.013065,
		.ratio = 0.7 };
}

const char *leakage_check(const struct leakage *l)
{
	const double *r = l->radius;

	if (!(r[0] > 0 && r[0] < r[1] && r[2] > 0 && r[2] < r[3]))
		return "radii must satisfy 0 < r1 < r2 and 0 < r3 < r4";
	if (!(l->alpha0 > 0 && l->alpha0 <= 6.2831853071795865))
		return "the angle must lie within (0, 360] deg";
	if (!(l->drop > 0))
		return "the outlet pressure must be above the inlet pressure";
	if (!(l->viscosity > 0))
		return "the viscosity must be positive";
	if (!(l->ratio > 0 && l->ratio <= 1))
		return "the leakage ratio must lie within (0, 1]";
	return NULL;
}

/* Q / h^3 of the whole pump, 1/(m s). */
static double flow_per_cube(const struct leakage *l)
{
	const double *r = l->radius;
	double lands = 1 / log(r[1] / r[0]) + 1 / log(r[3] / r[2]);

	return l->alpha0 * l->drop / (12 * l->viscosity) * lands / l->ratio;
}

double leakage_flow(const struct leakage *l, double gap)
{
	return flow_per_cube(l) * gap * gap * gap;
}

double leakage_gap(const struct leakage *l, double flow)
{
	return cbrt(flow / flow_per_cube(l));
}

double pair_gap(const struct pair *p, enum pair_quantity quantity, double value)
{
	if (quantity == PAIR_GAP)
		return value;
	if (quantity >= PAIR_VOLUME)
		return (isnan(p->gap_new) ? 0 : p->gap_new) + value / p->area;
	return leakage_gap(&p->leakage, value);
}

double pair_value(const struct pair *p, enum pair_quantity quantity, double gap)
{
	if (quantity == PAIR_GAP)
		return gap;
	if (quantity >= PAIR_VOLUME)
		return (gap - (isnan(p->gap_new) ? 0 : p->gap_new)) * p->area;
	return leakage_flow(&p->leakage, gap);
}

double pair_limit(const struct pair *p)
{
	double limit = INFINITY;

	if (!isnan(p->threshold_gap))
		limit = p->threshold_gap;
	if (!isnan(p->threshold_leakage))
		limit = fmin(limit, leakage_gap(&p->leakage, p->threshold_leakage));
	if (!isnan(p->threshold_volume))
		limit = fmin(limit, p->gap_new + p->threshold_volume / p->area);
	return limit;
}
