/* fleet.h - remaining life from earlier units that were run to their threshold
 *
 * Each earlier unit is reduced to its passage times: the age at which its damage first
 * reached a level (observations as they are below twenty rows, running medians of three
 * from there on, linear between rows).  For a unit whose highest level so far was first
 * reached at some age, the log of the time that was left to the earlier ones when they
 * passed that level is regressed on the log of their age there:
 *
 *	ln left = mean + b (ln age - mean age) + s t_(n - 2)
 *
 * so that level, age, and how little the ages at a level vary, all have their say.  The
 * slope is drawn towards 1 (a unit that takes twice as long so far has twice as long to
 * go) by a prior as wide as one.  Units that never reach the threshold are left out.
 *
 *	struct fleet *f = fleet_new(threshold, direction);
 *	fleet_add(f, unit, t, y);     (unit: 0, 1, ... in any order, t rising for each)
 *	fleet_build(f);
 *	if (fleet_life(f, level, age, z, life, n)) ...
 */
#ifndef LIFE_FLEET_H
#define LIFE_FLEET_H

enum { FLEET_MIN = 3 }; /* units that must have passed a level */

struct fleet;

struct fleet *fleet_new(double threshold, int direction); /* NULL: no memory */
void fleet_free(struct fleet *f);
int fleet_add(struct fleet *f, int unit, double t, double y); /* 0: no memory */
/* After the last row.  Returns the number of units that failed, -1: no memory. */
int fleet_build(struct fleet *f);
int fleet_units(const struct fleet *f); /* all of them */

/* Draws n times left from the moment at which level was first reached, at that age; with
 * age 0, whole lives.  z: 2 n standard normal deviates.  Returns 0 where fewer than
 * FLEET_MIN units are there to compare. */
int fleet_life(const struct fleet *f, double level, double age, const double *z,
	double *life, int n);

/* The highest level of a unit so far, and the age at which it was first reached. */
struct climb {
	int rows, direction;
	double first;      /* time of the first row */
	double t[3], y[3]; /* last rows, newest first */
	double level, age;
};

/* Takes a row of a unit; zero c and set direction to start. */
void climb_add(struct climb *c, double t, double y);

#endif
