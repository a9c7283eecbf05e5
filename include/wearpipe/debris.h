/* debris.h - wear particles: material under a sliding contact whose stress exceeds yield
 *
 * One step computes the von Mises stress below the pressure of a contact, removes the
 * material that fails, and returns its connected pieces.  Fields are row-major.
 *
 *	struct wp_debris_par par = { 32, 32, 8e-6, 8e-6, 0, 0, 0.3, 0.3, 355e6, 0, 1 };
 *	struct wp_debris *d = wp_debris_new(&par, NULL);
 *	static double h[32 * 32], p[32 * 32];
 *	const struct wp_particle *particle;
 *	size_t count;
 *	p[500] = 2e9;
 *	if (!d || wp_debris_wear(d, h, p, &particle, &count) != WP_OK)
 *		return 1;
 *	for (size_t i = 0; i < count; i++)
 *		printf("%g m\n", particle[i].diameter);
 *	wp_debris_free(d);
 */
#ifndef WEARPIPE_DEBRIS_H
#define WEARPIPE_DEBRIS_H

#include <stddef.h>
#include <wearpipe/status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct wp_debris;

struct wp_debris_par {
	int nx, ny;      /* cells */
	double dx, dy;   /* cell size, m */
	double cell;     /* height of the removed cells, m; 0: continuous depth */
	int periodic;    /* as the contact was solved */
	double poisson;  /* of the worn body */
	double friction; /* coefficient; shear along +x */
	double yield;    /* Pa */
	int potential;   /* 1: all failed material; 0: from the surface down only */
	int threads;     /* >= 1 */
};

struct wp_particle {
	double columns, volume; /* number of columns of the grid, m3 */
	double diameter;        /* of the sphere of this volume, m */
	double length, width;   /* Feret diameters, m: the largest, and the largest
				   perpendicular to it */
	double solidity;        /* volume over that of the convex hull */
	double x, y, z;         /* centroid, m; z down from the surface */
};

WP_API struct wp_debris *wp_debris_new(
	const struct wp_debris_par *par, enum wp_status *status);
WP_API void wp_debris_free(struct wp_debris *d);

/* Lowers height (m) where material is removed under the pressure (Pa, >= 0).  *particle
 * is valid until the next call; largest first.  WP_CUT_OFF, with height and particles as
 * for WP_OK, where wp_debris_beyond() is above 5 % of the volume of the particles. */
WP_API enum wp_status wp_debris_wear(struct wp_debris *d, double *height,
	const double *pressure, const struct wp_particle **particle, size_t *count);

/* Bound of the volume that the last call would have removed beyond the border of the
 * grid, m3; 0 if periodic. */
WP_API double wp_debris_beyond(const struct wp_debris *d);

#ifdef __cplusplus
}
#endif
#endif
