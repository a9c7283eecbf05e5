/* pair.h - a sliding pair: the gap for an observed value, and the gap at failure
 *
 *	struct pair p = { .leakage = leakage_thesis(), .area = 2346.3e-6,
 *		.gap_new = 10e-6, .threshold_gap = NAN, .threshold_leakage = 2.8e-3 / 60,
 *		.threshold_volume = NAN };
 *	left = p.area * (pair_limit(&p) - pair_gap(&p, PAIR_LEAKAGE, flow));
 */
#ifndef LIFE_PAIR_H
#define LIFE_PAIR_H

#include "life/pair/leakage.h"

enum pair_quantity {
	PAIR_AUTO, /* not known yet */
	PAIR_LEAKAGE,
	PAIR_GAP,
	PAIR_VOLUME, /* volume worn since the pair was new */
	PAIR_DEBRIS  /* that volume as the sum of particles */
};

/* SI units.  Thresholds are NAN where there is none; the first one reached counts. */
struct pair {
	struct leakage leakage;
	double area;    /* nominal contact area */
	double gap_new; /* NAN: not known */
	double threshold_gap, threshold_leakage, threshold_volume;
};

/* Gap for a value; volumes count from gap 0 if the new gap is unknown. */
double pair_gap(const struct pair *p, enum pair_quantity quantity, double value);
/* Value for a gap: the inverse of pair_gap(). */
double pair_value(const struct pair *p, enum pair_quantity quantity, double gap);

/* Gap at failure; INFINITY without a threshold. */
double pair_limit(const struct pair *p);

#endif
