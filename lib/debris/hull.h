/* hull.h - convex hull of points of a cubic lattice, in exact integer arithmetic
 *
 * Affine maps preserve convex hulls, so cells of any shape can be described by integers
 * and scaled afterwards.  All products are products of differences of coordinates.  With
 * differences up to D a normal has components up to 2 D^2, and its product with a
 * difference is at most 6 D^3, which is below 2^63 for D = HULL_SPAN.
 *
 *	struct hull *h = hull_new();
 *	if (hull_build(h, point, count) == HULL_OK)
 *		volume = hull_volume6(h) / 6;
 *	hull_free(h);
 */
#ifndef CONTACT_HULL_H
#define CONTACT_HULL_H

#include "num/status.h"
#include <stddef.h>
#include <stdint.h>

struct hull;

#define HULL_SPAN (1 << 20)

enum hull_status {
	HULL_OK,
	HULL_FLAT,  /* all points lie in one plane */
	HULL_LARGE, /* coordinates differ by more than HULL_SPAN */
	HULL_MEMORY
};

struct hull_point {
	int32_t v[3];
};

struct hull_edge {
	int from, to; /* indices into hull_points() */
};

struct hull *hull_new(void); /* NULL when out of memory */
void hull_free(struct hull *h);

/* Drops points that cannot be corners of the hull; the rest is sorted. */
enum num_status hull_thin(struct hull *h, struct hull_point *point, size_t *count);
/* Builds the hull of the points, and sorts them. */
enum hull_status hull_build(struct hull *h, struct hull_point *point, size_t count);

/* Of the last hull: its corners, the edges between them (with some diagonals of flat
 * faces), and six times its volume in lattice cells. */
const struct hull_point *hull_points(const struct hull *h, size_t *count);
const struct hull_edge *hull_edges(const struct hull *h, size_t *count);
double hull_volume6(const struct hull *h);

#endif
