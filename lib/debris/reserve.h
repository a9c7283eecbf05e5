/* reserve.h - the depth at which a stress known at some depths falls to the yield stress
 *
 * Interpolated in the square root of strength over stress, the reserve, which grows in
 * proportion to the depth below a distant load and is nearly linear therefore.
 */
#ifndef DEBRIS_RESERVE_H
#define DEBRIS_RESERVE_H

/* Increasing depths, m, the last one first, and the reserves there; below 1: failure. */
struct reserve {
	int depths; /* 2 or 3 */
	double z[3], g[3];
};

/* Square root of strength over stress.  Bounded, far above the 1 of failure, where there
 * is no stress. */
double reserve(double yield, double stress);
/* Where it passes 1 between the last two depths: on the parabola through all three, or
 * the line through two. */
double reserve_crossing(const struct reserve *r);
/* Where it first does on the parabola through three depths at which it is below 1; < 0:
 * nowhere. */
double reserve_dip(const struct reserve *r);
/* The largest reserve on the parabola through three depths, and its depth, if that is
 * between them; else -INFINITY. */
double reserve_peak(const struct reserve *r, double *z);
/* Its slope at z, on the line or parabola through the depths. */
double reserve_slope(const struct reserve *r, double z);

#endif
