/* partition.h - wear of a whole component from fragments under several pressures
 *
 * The contact face is cut into classes of equal nominal pressure and a zone in which
 * the pressure runs linearly from the lowest to the highest class.  Each class has an
 * ensemble of simulated fragments: volume worn, particles and large particles for
 * every realisation and step (Li's thesis, 4.2.1: partition and integration).
 *
 * Wear per unit time of the component, one step of the fragments being the unit:
 *
 *	mean = sum_c A_c / a m_c + A_t / a <m(p)>,  a the area of a fragment,
 *
 * with m(p) a power of p between neighbouring classes.  The mean of each class is
 * uncertain because its ensemble is finite: with K realisations (whole ones, since the
 * steps of one surface are not independent), mean volume M and standard error s,
 *
 *	ln m = ln M - t e,  e = s / M,  t a draw of Student's t with K - 1 degrees,
 *
 * and for t < 0, where the volumes not seen are the large ones, 1.2 (t e)^2 more; never
 * less than M / 100, so that a mean life exists.  The square is the next term of the
 * expansion in 1/sqrt(K) for volumes whose skewness is 7.2 times their coefficient of
 * variation; the factor is a sixth of that.  The inverse Gaussian law has 3 times, the
 * lognormal law of sigma 1 has 4.7 and that of sigma 1.5 has 11.5.  An interval of 90 %
 * holds the mean in 88 to 94 % of the ensembles of 3 to 30 realisations, for normal,
 * uniform, gamma (shape 0.5 to 4) and lognormal (sigma 1) volumes, in 83 to 89 % for
 * sigma 1.5 and in 78 to 87 % for sigma 2; resampling them with replacement gives 50 to
 * 64 % with three (tests/unit/partition.c).  A tail as heavy as that of a Pareto law of
 * index 1.5 is not seen in a few volumes: 68 to 73 %.
 *
 * A step of the component, and one unit against the next, scatter about the mean because
 * a component is a sum of parts that wear independently: as many as fragments fit,
 * unless told fewer.
 *
 *	struct partition *p = partition_new(2346.3e-6, 1, 0);
 *	int c;
 *	partition_class(p, 0, 21e6, -1, &c);
 *	partition_fragment(p, c, realisation, step, volume, count, large);
 *	...
 *	if (partition_close(p, 1e-8, 0.1) == PARTITION_OK)
 *		partition_estimate(p, 0, &wear);
 *	partition_free(p);
 */
#ifndef LIFE_PARTITION_H
#define LIFE_PARTITION_H

#include <gsl/gsl_rng.h>
#include <stddef.h>

enum { PARTITION_CLASSES_MAX = 64 };

struct partition;

enum partition_status {
	PARTITION_OK,
	PARTITION_MEMORY,
	PARTITION_MANY,     /* more than PARTITION_CLASSES_MAX classes */
	PARTITION_EMPTY,    /* a class without fragments */
	PARTITION_AREA,     /* classes cover more than the component */
	PARTITION_PRESSURE, /* several classes need different pressures above 0 */
	PARTITION_TWICE,    /* a realisation gave the same step twice */
	PARTITION_APART     /* a realisation's rows stand too far apart: sort the table */
};

/* area: of the component, m2, > 0.  first_step: earlier ones (running-in) count for the
 * large particles but not for the rate.  sizes: partition_large() will be asked for. NULL
 * when out of memory, which does not grow with the number of rows or of realisations. */
struct partition *partition_new(double area, long first_step, int sizes);
void partition_free(struct partition *p);

/* A class; *index is what the caller names it by from here on.  sparse: steps and
 * realisations that are not told of, up to the largest told of, shed nothing (particle
 * tables); otherwise they were not simulated.  pressure: nominal, Pa, NAN for "the one
 * there is".  area: m2, < 0 for "as the default has it": when no class has an area, the
 * lowest and the highest share what the zone leaves; otherwise a class without one only
 * guides the zone. */
enum partition_status partition_class(
	struct partition *p, int sparse, double pressure, double area, int *index);

/* What one realisation did in one step (from 1): volume worn (m3), particles, and those
 * of at least the critical size.  Calls for the same realisation and step add up when
 * they follow one another (particle tables) and are PARTITION_TWICE otherwise. */
enum partition_status partition_fragment(struct partition *p, int class, long realisation,
	long step, double volume, double count, double large);

/* Once, after the last fragment.  fragment_area: m2, > 0; transition: share of the area
 * in the linear zone when no class has an area. */
enum partition_status partition_close(
	struct partition *p, double fragment_area, double transition);
/* Of the class a status of partition_close() or partition_fragment() is about. */
int partition_culprit(const struct partition *p);
/* The realisation a PARTITION_TWICE or PARTITION_APART is about. */
long partition_realisation(const struct partition *p);
/* Realisations of a class as the caller numbered it, those that shed nothing counted in,
 * and their mean volume per step, m3; of a closed partition. */
double partition_count(const struct partition *p, int class, double *mean);

/* Wear of the component per step. */
struct partition_wear {
	double mean;          /* m3 */
	double step_variance; /* of one step about the mean, m6 */
	double life_variance; /* of the mean over all steps from unit to unit, m6 */
};

/* From all fragments.  parts: independently wearing parts per class and zone, 0 for as
 * many as fragments fit; 1 lets every class wear as one fragment. */
void partition_estimate(struct partition *p, double parts, struct partition_wear *wear);
/* From means drawn by rng as above, the scatter in proportion to them; sizes, where they
 * were asked for, are resampled by whole realisations (from 4096 on in groups)
 * and kept for partition_large(). */
void partition_replicate(
	struct partition *p, double parts, gsl_rng *rng, struct partition_wear *wear);

/* First step whose share of large particles, by number, reaches probability in the
 * replicate drawn last (or in all, after partition_estimate()): of the particles shed
 * in that step, or with cumulative != 0 of all shed so far.  0 if none does. */
long partition_large(struct partition *p, double probability, int cumulative);

/* Mean of y over p uniform in [p0, p1], y a power of p through (p0, y0), (p1, y1);
 * linear where one of y0, y1 is 0. */
double partition_power_mean(double p0, double y0, double p1, double y1);

#endif
