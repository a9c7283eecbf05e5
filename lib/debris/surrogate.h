/* surrogate.h - volumes of wear particles from their footprints, with intervals that hold
 *
 * The volume is the depth below one cell of a footprint times its area times a factor,
 * whose logarithm is a quadratic function of the features of the footprint
 * (footprint.h), fitted by least squares.  Intervals are conformal: the stated shares of
 * particles and surfaces not used in the fit lie within them for any distribution of the
 * errors, provided that scenes are drawn like those of the fit.  There is no estimate
 * outside the range of the features of the fit, nor outside that of the whole contact's
 * flow, since a limited pressure is more even than its mean and its maximum tell, and
 *lay, since material fails less deep below narrow contacts.
 *
 *	struct surrogate s;
 *	if (surrogate_fit(sample, n, &s, &report) == SURROGATE_OK)
 *		inside = surrogate_guess(&s, footprint, count, contact, 0.9, guess,
 *&total);
 */
#ifndef DEBRIS_SURROGATE_H
#define DEBRIS_SURROGATE_H

#include "debris/footprint.h"

enum {
	SURROGATE_TERMS = 1 + FOOTPRINT_FEATURES +
			  FOOTPRINT_FEATURES * (FOOTPRINT_FEATURES + 1) / 2,
	SURROGATE_CLASSES = 5, /* of footprints, by cells: 1, 2-3, 4-15, 16-63, more */
	SURROGATE_SCORES = 512 /* at most of each kind; of more, as many quantiles */
};

/* Properties of a contact: the share of its loaded cells that are at the hardness, and
 * the traceless part of its mean product of pressure gradients over their mean square:
 * along (1) or across (-1) the direction of sliding, and at 45 degrees to it (1). */
enum surrogate_property {
	SURROGATE_FLOW,
	SURROGATE_LAY,
	SURROGATE_OBLIQUE,
	SURROGATE_PROPERTIES
};
extern const char *const surrogate_property_names[SURROGATE_PROPERTIES];

struct surrogate {
	double low[FOOTPRINT_FEATURES], high[FOOTPRINT_FEATURES]; /* range of the fit */
	double mean[FOOTPRINT_FEATURES], scale[FOOTPRINT_FEATURES];
	double coefficient[SURROGATE_TERMS];
	double deviation[SURROGATE_CLASSES]; /* of the logarithm */
	double factor[SURROGATE_CLASSES];    /* mean over median of a volume */
	double least[SURROGATE_PROPERTIES], most[SURROGATE_PROPERTIES]; /* of the fit */
	double shared; /* deviation that all particles of a surface have in common */
	/* Ascending: ln(true / estimated volume) / deviation, of the particles and
	 * surfaces held back for it. */
	int particles, totals;
	double particle[SURROGATE_SCORES], total[SURROGATE_SCORES];
};

/* A particle of the full model. */
struct surrogate_sample {
	long surface; /* number; those of one stand together */
	struct footprint footprint;
	double volume;                        /* m3 */
	double contact[SURROGATE_PROPERTIES]; /* of the surface */
};

/* Of the surfaces that neither the fit nor its intervals have seen. */
struct surrogate_report {
	long fitted, calibrated, checked; /* surfaces */
	long within;      /* of the checked, whose total the 90 % interval holds */
	double rms, most; /* of ln of true over guessed totals */
	double width;     /* mean half width of ln of those intervals */
};

struct surrogate_guess {
	double volume, low, high; /* m3 */
};

enum surrogate_status {
	SURROGATE_OK,
	SURROGATE_FEW, /* samples: fewer than three for each coefficient, or surfaces:
			* fewer than 100 */
	SURROGATE_MEMORY
};

/* Of five surfaces that follow each other two are fitted to, two make the intervals, and
 * one is checked. */
enum surrogate_status surrogate_fit(const struct surrogate_sample *sample, size_t n,
	struct surrogate *s, struct surrogate_report *report);

/* The highest level for which there is a score beyond either end. */
double surrogate_highest_level(const struct surrogate *s);

/* Properties of a contact; hardness 0: none. */
void surrogate_contact(const struct stress_par *par, const double *pressure,
	double hardness, double property[SURROGATE_PROPERTIES]);

/* Volumes of the particles of a surface and of all of them, with intervals of this level
 * (equal tails).  0 where a footprint lies outside the range of the fit, or the level
 * is above the highest: nothing is said then. */
int surrogate_guess(const struct surrogate *s, const struct footprint *footprint,
	size_t count, const double contact[SURROGATE_PROPERTIES], double level,
	struct surrogate_guess *guess, struct surrogate_guess *total);

#endif
