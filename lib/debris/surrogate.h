/* surrogate.h - intervals that hold for volumes estimated from some columns
 *
 * A volume of footprint.h is off by cells left out and by the direct sums below the
 * others, and it states the standard error of both.  The quantiles of the errors over
 * both together come from surfaces of the full model.
 * Intervals are conformal: the stated shares of particles and surfaces not used in the
 * fit lie within them for any distribution of the errors, provided that scenes are drawn
 * like those of the fit.  There is no estimate where a property of the contact is outside
 * the range of the fit.
 *
 *	struct surrogate s;
 *	if (surrogate_fit(sample, n, &s, &report) == SURROGATE_OK)
 *		inside = surrogate_guess(&s, footprint, count, &contact, 0.9,
 *			guess, &total);
 */
#ifndef DEBRIS_SURROGATE_H
#define DEBRIS_SURROGATE_H

#include "debris/footprint.h"

enum {
	SURROGATE_SCORES = 512 /* at most of each kind; of more, as many quantiles */
};

/* Properties of a contact: the share of its loaded cells that are at the hardness; the
 * traceless part of its mean product of pressure gradients over their mean square, along
 * (1) or across (-1) the direction of sliding, and at 45 degrees to it (1); friction
 * and Poisson's ratio. */
enum surrogate_property {
	SURROGATE_FLOW,
	SURROGATE_LAY,
	SURROGATE_OBLIQUE,
	SURROGATE_FRICTION,
	SURROGATE_POISSON,
	SURROGATE_PROPERTIES
};
extern const char *const surrogate_property_names[SURROGATE_PROPERTIES];

struct surrogate_contact {
	double property[SURROGATE_PROPERTIES];
};

/* Ascending: |ln(true / estimated volume)| / deviation. */
struct surrogate_scores {
	int count;
	double score[SURROGATE_SCORES];
};

/* Errors by cells left out and by the sums alone have other distributions. */
enum surrogate_class { SURROGATE_MEASURED, SURROGATE_SAMPLED, SURROGATE_CLASSES };

struct surrogate {
	double least[SURROGATE_PROPERTIES], most[SURROGATE_PROPERTIES]; /* of the fit */
	/* Of particles and surfaces of which all cells were measured, or some. */
	struct surrogate_scores particle[SURROGATE_CLASSES], total[SURROGATE_CLASSES];
};

/* A particle of the full model. */
struct surrogate_sample {
	long surface; /* number; those of one stand together */
	struct footprint footprint;
	double volume;                    /* m3 */
	struct surrogate_contact contact; /* of the surface */
};

/* Of the surfaces held back. */
struct surrogate_report {
	long fitted, checked; /* surfaces */
	long within;          /* of the checked, whose total the 90 % interval holds */
	double rms, most;     /* of ln of true over guessed totals */
	double width;         /* mean half width of ln of those intervals */
};

struct surrogate_guess {
	double volume, low, high; /* m3 */
};

enum surrogate_status {
	SURROGATE_OK,
	SURROGATE_FEW, /* fewer than 100 surfaces */
	SURROGATE_MEMORY
};

/* Of five surfaces that follow each other four make ranges and intervals, and one is
 * checked. */
enum surrogate_status surrogate_fit(const struct surrogate_sample *sample, size_t n,
	struct surrogate *s, struct surrogate_report *report);

/* The highest level for which there is a score. */
double surrogate_highest_level(const struct surrogate *s);

/* stress: loaded with the pressure; hardness 0: none. */
struct surrogate_contact surrogate_contact(const struct stress_par *par,
	const struct stress *stress, const double *pressure, double hardness);

/* Volumes of the particles of a surface and of all of them, with intervals of this level
 * (the logarithm as far up as down).  0 where the contact lies outside the range of the
 * fit, a volume is not known, or the level is above the highest: nothing is said then. */
int surrogate_guess(const struct surrogate *s, const struct footprint *footprint,
	size_t count, const struct surrogate_contact *contact, double level,
	struct surrogate_guess *guess, struct surrogate_guess *total);

#endif
