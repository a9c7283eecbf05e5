/* rescaled.h - a series whose values change by a factor, or by the range of a counter,
 * from one row to the next
 *
 * A repair or a jump of wear shifts the level and leaves the steps between rows as they
 * were.  A change of the unit, or of the gain of a sensor, multiplies both by the same
 * factor.  A counter that wraps goes on from 0 where it would have reached a power of two
 * or ten.  Rows of two machines, or of two states of one, lie on two courses.
 */
#ifndef LIFE_RESCALED_H
#define LIFE_RESCALED_H

enum { RESCALED_HALF = 8 }; /* rows before and after the change */

/* All zero before the first value. */
struct rescaled {
	double y[2 * RESCALED_HALF]; /* the last values, oldest first */
	long rows, turns;            /* turns: windows of two courses */
};

/* Adds a value.  The factor if the values before the last RESCALED_HALF rows were in
 * another unit, else 0. */
double rescaled_add(struct rescaled *r, double y);
/* The range of a counter that has wrapped before the last n values, else 0.  It is below
 * the threshold: otherwise a unit was replaced at the end of its life. */
double rescaled_range(const struct rescaled *r, int n, double threshold);
/* 1 while fewer rows than RESCALED_HALF, but three or more, may be in another unit,
 * because their steps differ from those before rather by the factor of the level than not
 * at all, or come from a counter that has wrapped. */
int rescaled_doubtful(const struct rescaled *r, double threshold);
/* 1 if, in more than a quarter of all windows of 2 RESCALED_HALF values, they lie on two
 * courses and change between them. */
int rescaled_alternates(const struct rescaled *r);

#endif
