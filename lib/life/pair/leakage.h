/* leakage.h - leakage between valve plate and cylinder block, and the gap that causes it
 *
 * Laminar radial flow through the sealing lands of a kidney-shaped port, over the
 * angle alpha0, between parallel faces at a distance h (Li's thesis, eq. 4-30):
 *
 *	Q_bv = alpha0 h^3 dP / (12 mu) [1 / ln(r2/r1) + 1 / ln(r4/r3)]
 *
 * and Q_bv = ratio Q, the share of the whole pump's leakage.  SI units throughout.
 *
 *	struct leakage pump = leakage_thesis();
 *	h = leakage_gap(&pump, 2.8e-3 / 60);	// 16.79 um
 */
#ifndef LIFE_LEAKAGE_H
#define LIFE_LEAKAGE_H

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

#endif
