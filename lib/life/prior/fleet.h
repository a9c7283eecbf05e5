/* fleet.h - the paths of earlier units as coordinates of a bank
 *
 * Each earlier unit is reduced to the ages at which it first reached the levels of a
 * grid, by running medians of three rows; values between rows are linear.  A unit that
 * has not reached the threshold is extrapolated to it along the median ages that its own
 * bank predicts.  In the coordinate of a path, a unit that wears like it is a straight
 * line with a slope near 1.
 *
 *	struct fleet *f = fleet_new(threshold, direction);
 *	fleet_add(f, unit, t, y);     (unit: 0, 1, ... in any order, t rising for each)
 *	fleet_build(f);
 *	par.more = fleet_shapes(f, &par.n_more);
 */
#ifndef LIFE_FLEET_H
#define LIFE_FLEET_H

#include "life/trend/bank.h"
#include "num/status.h"

struct fleet;

struct fleet *fleet_new(double threshold, int direction); /* NULL: no memory */
void fleet_free(struct fleet *f);
/* A row whose t is that of the last one is ignored; NUM_DOMAIN: t decreases. */
enum num_status fleet_add(struct fleet *f, int unit, double t, double y);
/* Call after the last row.  Of the units that become coordinates, failed have reached the
 * threshold and carried_on have been extrapolated to it. */
enum num_status fleet_build(struct fleet *f, int *failed, int *carried_on);
const struct bank_shape *fleet_shapes(const struct fleet *f, int *n);
/* Which of them, from 1, is the path of a unit; 0: none. */
int fleet_shape_of(const struct fleet *f, int unit);

#endif
