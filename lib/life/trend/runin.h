/* runin.h - separation of the run-in of a machine from its wear
 *
 * A run-in is an early excursion that returns: the mean of eight rows falls, against the
 * direction of damage, by more than half of the rise from the first such mean to the
 * highest, and by more than four standard errors.  Life is counted from the
 * lowest mean after that.  A series that only rises has no run-in, however it bends.
 */
#ifndef LIFE_RUNIN_H
#define LIFE_RUNIN_H

enum { RUNIN_BLOCK = 8 };

/* Zero it and set direction to start. */
struct runin {
	int direction;
	int rows;   /* in the unfinished block */
	double sum; /* over it */
	int blocks;
	double first, highest; /* first and highest block mean, times direction */
	double since;          /* lowest one since the highest, if that ended a run-in */
};

/* Adds an observation with the standard deviation of the noise.  Returns 1 if the rows
 * before this one have turned out to be run-in. */
int runin_add(struct runin *r, double y, double noise);

#endif
