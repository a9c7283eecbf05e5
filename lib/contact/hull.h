/* hull.h - convex hull of points of a cubic lattice, in exact integer arithmetic
 *
 * Because an affine map takes hulls to hulls, cells of any shape may be counted in
 * whole steps and scaled afterwards.  Coordinates within +-2^20 cannot overflow.
 */
#ifndef CONTACT_HULL_H
#define CONTACT_HULL_H

#include <stddef.h>
#include <stdint.h>

struct hull_point {
	int32_t v[3];
};

/* Moves the corners of the hull to the front of point[] and returns their number; in
 * *volume6 six times the volume in lattice cells (0 where all points lie in a plane:
 * then no point is dropped but repeated ones).  0 with *volume6 < 0 when out of
 * memory. */
size_t hull_reduce(struct hull_point *point, size_t count, double *volume6);

#endif
