/* unrest.h - how uneven the course of a series has been
 *
 * Trends learn from one row to the next, and the Wiener processes among them follow a
 * load that swings, shocks or a noise that lasts for many rows as if nothing else would
 * come.  The means of the rows (plateau.h) tell over which times the rate has changed so
 * far, and which part of what looks like wander has returned.
 */
#ifndef LIFE_UNREST_H
#define LIFE_UNREST_H

#include "life/trend/plateau.h"

enum { UNREST_STEPS = 5 }; /* distances of 1, 2, 4, 8, 16 means */

/* In units of the range to the threshold, of which y is the share since the start. */
struct unrest {
	int n;                      /* distances with enough means, 0: too few rows */
	double between;             /* time from one mean to the next */
	long each;                  /* rows of a mean */
	double swing[UNREST_STEPS]; /* squares of the usual change of the rate from one
				     * such distance to the next, over the rate */
	double way[UNREST_STEPS];   /* usual damage over twice the distance */
	double common; /* variance of a noise that lasts longer than a mean, or of
			* swings that are back within the longest distance */
};

struct unrest unrest_of(const struct plateau *p, double range);
/* Variance of the logarithm of the time to a passage, which would be this, by changes of
 * the rate; noise: variance of a reading. */
double unrest_swing(const struct unrest *u, double time, double noise);
/* Variance of the level by what is common to successive readings, beyond that noise. */
double unrest_common(const struct unrest *u, double noise);

#endif
