/* particles.h - connected particles of a set of cells, found layer by layer
 *
 * Cells that share a face belong together (on request, also cells of one layer that
 * share a corner: the patches of a contact map).  Layers are handed in from the
 * surface down; memory is that of two layers and of the corners of open particles.
 *
 *	struct particles_par par = { .nx = 128, .ny = 128, .ax = 8e-6, .ay = 8e-6,
 *		.az = 8e-6 };
 *	struct particles *ps = particles_new(&par);
 *	particles_begin(ps);
 *	for (m = 0; m < layers; m++)
 *		particles_layer(ps, failed[m]);
 *	n = particles_end(ps, &list);
 *
 * Lengths are taken over the cells as bodies, corners included: a single cube has the
 * largest diameter sqrt(3) times its side.
 */
#ifndef CONTACT_PARTICLES_H
#define CONTACT_PARTICLES_H

#include <stddef.h>

struct particles;

struct particles_par {
	int nx, ny;        /* cells */
	double ax, ay, az; /* m */
	int corners;       /* cells of a layer that share a corner are joined too */
	int periodic;      /* the grid repeats in x and y */
};

struct particle {
	double nodes;      /* cells, N */
	double volume;     /* N ax ay az, m3 */
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
	/* First cell in order of layer, y, x: the address. */
	int first[3];
	/* On a periodic grid: goes round it and meets itself, a ridge without end. Cells,
	 * volume, diameter and area are those of one period; what would need an end
	 * (length to convexity, direction) is nan, as is the centroid along x or y where
	 * it winds that way. */
	int endless;
};

/* NULL with errno EDOM or ENOMEM. */
struct particles *particles_new(const struct particles_par *par);
void particles_free(struct particles *ps);

void particles_begin(struct particles *ps);
/* The next layer: mask[y * nx + x] is 1 where a cell belongs to the set, else 0.  -1 when
 * out of memory. */
int particles_layer(struct particles *ps, const unsigned char *mask);
/* Closes all; *list is valid until the next particles_begin().  Largest first, equal
 * ones by address.  Returns their number, (size_t)-1 when out of memory. */
size_t particles_end(struct particles *ps, const struct particle **list);

#endif
