/* rescaled.h - a series whose values change by a factor from one row to the next
 *
 * A repair or a jump of wear shifts the level and leaves the steps between rows as they
 * were.  A change of the unit, or of the gain of a sensor, multiplies both by the same
 * factor.
 */
#ifndef LIFE_RESCALED_H
#define LIFE_RESCALED_H

enum { RESCALED_HALF = 8 }; /* rows before and after the change */

/* All zero before the first value. */
struct rescaled {
	double y[2 * RESCALED_HALF]; /* the last values, oldest first */
	long rows;
};

/* Adds a value.  The factor if the values before the last RESCALED_HALF rows were in
 * another unit, else 0. */
double rescaled_add(struct rescaled *r, double y);
/* 1 while fewer rows than that, but three or more, may be in another unit: their steps
 * differ from those before rather by the factor of the level than not at all. */
int rescaled_doubtful(const struct rescaled *r);

#endif
