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
 * and for t < 0, where an ensemble too small to contain large volumes underestimates the
 * mean, ln m is 4.7 q |t| (e / K)^(1/2) + 1.2 (t e)^2 larger, where q is the skewness
 * of the volumes over the largest that K of them can have.  The mean is never less than
 * M / 100, so that a mean life exists.  The first term is less than linear in e: a few
 * volumes from a long tail often lie close together, and then their e tells little of it.
 * What chose the factors, and how often the interval holds the mean: see "Means of few
 * realisations" in doc/trends.md and tests/unit/partition.c.
 *
 * Steps and units scatter about the mean because a component is a sum of parts that wear
 * independently.  There are as many parts as fragments fit, unless parts says otherwise.
 *
 *	struct partition *p = partition_new(2346.3e-6, 1, 0);
 *	int c = partition_class(p, 0, 21e6, -1);
 *	partition_fragment(p, c, &row);
 *	...
 *	if (partition_close(p, 1e-8, 0.1) == PARTITION_OK)
 *		wear = partition_estimate(p, 0);
 *	partition_free(p);
 */
#ifndef LIFE_PARTITION_H
#define LIFE_PARTITION_H

#include "num/realisations.h"
#include <gsl/gsl_rng.h>
#include <stddef.h>

enum { PARTITION_CLASSES_MAX = 64 };

struct partition;

enum partition_status {
	PARTITION_OK,
	PARTITION_MEMORY,
	PARTITION_EMPTY,    /* a class without fragments */
	PARTITION_AREA,     /* classes cover more than the component */
	PARTITION_PRESSURE, /* several classes need different pressures above 0 */
	PARTITION_TWICE,    /* a realisation gave the same step twice */
	PARTITION_APART /* the rows of a realisation are too far apart: sort the table */
};

/* area: of the component, m2, > 0.  first_step: earlier steps are running-in; they count
 * for the large particles but not for the rate.  sizes: 1 if partition_large() will be
 * called.  NULL when out of memory.  The memory in use does not grow with the number of
 * rows or realisations; with sizes it is 4 kB for each step of a class. */
struct partition *partition_new(double area, long first_step, int sizes);
void partition_free(struct partition *p);

/* Adds a class and returns its number in later calls, -1 without memory or beyond
 * PARTITION_CLASSES_MAX of them.  sparse: 1 if steps and realisations missing from the
 * input, up to the largest in it, shed nothing (particle tables); 0 if they were not
 * simulated.  pressure: nominal, Pa; NAN if there is only one class.  area: m2; < 0 if
 * not given.  If no class has an area, the classes of lowest and highest pressure divide
 * what the zone leaves; otherwise a class without an area only determines the wear within
 * the zone. */
int partition_class(struct partition *p, int sparse, double pressure, double area);

/* A sparse class has at least this realisation and this step, though nothing may have
 * been shed. */
void partition_simulated(struct partition *p, int class, long realisation, long step);

/* Adds a row, of count 1: wear of one realisation in one step (from 1); large: 1 for a
 * particle of at least the critical size.  Of a sparse class the rows of a step add up,
 * of another it has one row.  Either is in one part of the table; else the ensembles of
 * two studies have the same numbers. */
enum partition_status partition_fragment(
	struct partition *p, int class, const struct realisation_cell *row);

/* Call once, after the last fragment.  fragment_area: m2, > 0; transition: share of the
 * area in the linear zone if no class has an area. */
enum partition_status partition_close(
	struct partition *p, double fragment_area, double transition);
/* Index of the class that a status of partition_close() or partition_fragment() concerns.
 */
int partition_culprit(const struct partition *p);
/* The realisation that PARTITION_TWICE or PARTITION_APART concerns. */
long partition_realisation(const struct partition *p);
/* Number of realisations of a class, including those that shed nothing, their mean volume
 * per step, m3, and its relative standard error.  The partition must be closed. */
double partition_count(const struct partition *p, int class, double *mean, double *error);

/* Wear of the component per step. */
struct partition_wear {
	double mean;          /* m3 */
	double step_variance; /* of one step about the mean, m6 */
	double life_variance; /* of the mean over all steps from unit to unit, m6 */
};

/* Wear from all fragments.  parts: number of independently wearing parts per class and
 * zone; 0: as many as fragments fit; 1: each class wears as one fragment. */
struct partition_wear partition_estimate(struct partition *p, double parts);
/* Wear from means drawn by rng as above, with scatter in proportion to them.  If sizes
 * was 1, whole realisations (more than 251 of them in groups) are resampled and kept for
 * partition_large(). */
struct partition_wear partition_replicate(
	struct partition *p, double parts, gsl_rng *rng);

/* First step whose share of large particles, by number, reaches probability in the last
 * replicate (after partition_estimate(): in all fragments).  The share is of the
 * particles shed in that step, or if cumulative != 0 of all shed so far.  0 if there is
 * none. */
long partition_large(struct partition *p, double probability, int cumulative);

/* Mean of y over p uniform in [p0, p1], y a power of p through (p0, y0), (p1, y1);
 * linear where one of y0, y1 is 0. */
double partition_power_mean(double p0, double y0, double p1, double y1);

#endif
