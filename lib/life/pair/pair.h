/* pair.h - a sliding pair: the gap for an observed value, and the gap at failure
 *
 * The leakage between valve plate and cylinder block is laminar radial flow through the
 * sealing lands of a kidney-shaped port, over the angle alpha0, between parallel faces at
 * a distance h (Li's thesis, eq. 4-30), and Q_bv = ratio Q of the whole pump:
 *
 *	Q_bv = alpha0 h^3 dP / (12 mu) [1 / ln(r2/r1) + 1 / ln(r4/r3)]
 *
 * SI units throughout.
 *
 *	struct pair p = { .leakage = leakage_thesis(), .area = 2346.3e-6,
 *		.gap_new = 10e-6, .threshold_gap = NAN, .threshold_leakage = 2.8e-3 / 60,
 *		.threshold_volume = NAN };
 *	left = p.area * (pair_limit(&p) - pair_gap(&p, PAIR_LEAKAGE, flow));
 */
#ifndef LIFE_PAIR_H
#define LIFE_PAIR_H

struct leakage {
	double radius[4]; /* r1 < r2 of the inner land, r3 < r4 of the outer, m */
	double alpha0;    /* angle of the ports under pressure, rad */
	double drop;      /* outlet less inlet pressure, Pa */
	double viscosity; /* dynamic, Pa s */
	double ratio;     /* share of this pair in the pump's leakage, (0, 1] */
};

/* The pump of the thesis (tables 10 and 11).  alpha0 = 2.59706 rad is not printed
 * there: with it, 70 % of 2.8 L/min give the printed gap of 16.79 um. */
struct leakage leakage_thesis(void);

/* A phrase that names the parameter out of range, or NULL. */
const char *leakage_check(const struct leakage *l);

/* Pump leakage at a gap, m3/s, and its inverse, m; both odd functions. */
double leakage_flow(const struct leakage *l, double gap);
double leakage_gap(const struct leakage *l, double flow);

enum pair_quantity {
	PAIR_AUTO, /* not known yet */
	PAIR_LEAKAGE,
	PAIR_GAP,
	PAIR_VOLUME, /* volume worn since the pair was new */
	PAIR_DEBRIS  /* that volume as the sum of particles */
};

/* Thresholds are NAN where there is none; the first one reached counts. */
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
