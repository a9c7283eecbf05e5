/* particles.h - connected bodies of removed material, and their sizes and shapes
 *
 * A set of material below a surface is given as stretches of grid columns, from top to
 * bottom.  Stretches of neighbouring columns that overlap in depth belong to one body
 * (optionally also those of columns that share only an edge).
 *
 *	struct particles_par par = { .nx = 128, .ny = 128, .dx = 8e-6, .dy = 8e-6 };
 *	struct particles *ps = particles_new(&par);
 *	n = particles_find(ps, stretch, count, &list);
 *
 * Lengths are those of the boxes, including their corners: the largest diameter of a
 * single cube is sqrt(3) times its side.
 */
#ifndef DEBRIS_PARTICLES_H
#define DEBRIS_PARTICLES_H

#include "num/status.h"
#include <stddef.h>

struct particles;

struct particles_par {
	int nx, ny;    /* columns */
	double dx, dy; /* m */
	double dz;     /* depths are integer multiples of it, m; 0: any depth */
	int corners;   /* 1: columns that share only a vertical edge are joined */
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
	double length;     /* largest Feret diameter, m */
	double width;      /* longest chord of the convex hull perpendicular to it, m */
	double aspect;     /* length / width */
	double elongation; /* 1 - sqrt(second / first principal moment): 0 round, 1 needle
			    */
	double solidity;   /* ISO 9276-6: volume / volume of the convex hull */
	double area;       /* of the exposed faces, m2 (1.5 x that of a smooth sphere) */
	/* Longest principal axis: from +x towards +y, (-pi/2, pi/2], and up from the
	 * plane of the layers, [0, pi/2]; nan if the two first moments are equal. */
	double azimuth, dip;
	double x, y, z;         /* centroid, m; z down from the surface */
	double low[3], high[3]; /* bounding box, m */
	int first[2];           /* first column in order of y and x: the address */
	/* 1 if the body connects to itself across a periodic grid (an infinite ridge).
	 * Columns, volume, diameter and area are then those of one period; length to
	 * solidity, the direction, and the centroid along the infinite axis are nan. */
	int endless;
};

/* NULL with errno EDOM or ENOMEM. */
struct particles *particles_new(const struct particles_par *par);
void particles_free(struct particles *ps);

/* Finds the bodies of count stretches; stretches of one column must neither overlap nor
 * touch.  *list is valid until the next call: largest first, equal ones by first column
 * and depth.  If dz is 0 the hull resolves the depth of a body in 64 steps.
 * *n receives the number of bodies. */
enum num_status particles_find(struct particles *ps, const struct stretch *stretch,
	size_t count, const struct particle **list, size_t *n);

#endif
