/* particles.h - connected bodies among stretches of the columns of a grid
 *
 * A set of material below a surface is given as stretches of its columns, from top to
 * bottom.  Stretches of neighbouring columns that overlap in depth belong to one body (on
 * request, also those of columns that touch along an edge: the patches of a contact
 * map).
 *
 *	struct particles_par par = { .nx = 128, .ny = 128, .ax = 8e-6, .ay = 8e-6 };
 *	struct particles *ps = particles_new(&par);
 *	n = particles_find(ps, stretch, count, &list);
 *
 * Lengths are taken over the bodies as they are, boxes with their corners: a single cube
 *has the largest diameter sqrt(3) times its side.
 */
#ifndef DEBRIS_PARTICLES_H
#define DEBRIS_PARTICLES_H

#include <stddef.h>

struct particles;

struct particles_par {
	int nx, ny;    /* columns */
	double ax, ay; /* m */
	double az;     /* depths are whole multiples of it, m; 0: of nothing */
	int corners;   /* columns that share an edge in depth alone are joined too */
	int periodic;  /* the grid repeats in x and y */
};

/* Of column y * nx + x, from top to bottom > top >= 0, m. */
struct stretch {
	size_t column;
	double top, bottom;
};

struct particle {
	size_t columns;    /* stretches */
	double volume;     /* m3 */
	double diameter;   /* of the sphere of this volume, m (2-14) */
	double length;     /* largest diameter: between the farthest two points, m */
	double width;      /* largest chord of the convex hull at right angles to it, m */
	double aspect;     /* length / width */
	double elongation; /* 1 - sqrt(second / first principal moment): 0 round, 1 needle
			    */
	double convexity;  /* volume / volume of the convex hull */
	double area;       /* of the exposed faces, m2 (1.5 x that of a smooth sphere) */
	/* Longest principal axis: from +x towards +y, (-pi/2, pi/2], and up from the
	 * plane of the layers, [0, pi/2]; nan where the two first moments are equal. */
	double azimuth, dip;
	double x, y, z;         /* centroid, m; z down from the surface */
	double low[3], high[3]; /* bounding box, m */
	int first[2];           /* first column in order of y and x: the address */
	/* On a periodic grid: goes round it and meets itself, a ridge without end.
	 * Columns, volume, diameter and area are those of one period; what would need an
	 * end (length to convexity, direction) is nan, as is the centroid along x or y
	 * where it winds that way. */
	int endless;
};

/* NULL with errno EDOM or ENOMEM. */
struct particles *particles_new(const struct particles_par *par);
void particles_free(struct particles *ps);

/* The bodies of count stretches; those of a column neither overlap nor touch.  *list is
 * valid until the next call: largest first, equal ones by address and depth.  Where az is
 * 0 the hull takes depths in steps of 1/64 of those of its body.  Returns their number,
 * (size_t)-1 when out of memory. */
size_t particles_find(struct particles *ps, const struct stretch *stretch, size_t count,
	const struct particle **list);

#endif
