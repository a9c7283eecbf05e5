#include "life/pair/pair.h"
#include <math.h>

double pair_gap(const struct pair *p, enum pair_quantity quantity, double value)
{
	switch (quantity) {
	case PAIR_GAP:
		return value;
	case PAIR_VOLUME:
	case PAIR_DEBRIS:
		return (isnan(p->gap_new) ? 0 : p->gap_new) + value / p->area;
	default:
		return leakage_gap(&p->leakage, value);
	}
}

double pair_value(const struct pair *p, enum pair_quantity quantity, double gap)
{
	switch (quantity) {
	case PAIR_GAP:
		return gap;
	case PAIR_VOLUME:
	case PAIR_DEBRIS:
		return (gap - (isnan(p->gap_new) ? 0 : p->gap_new)) * p->area;
	default:
		return leakage_flow(&p->leakage, gap);
	}
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
