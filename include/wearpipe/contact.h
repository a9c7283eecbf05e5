/* contact.h - frictionless contact of a rough surface with a flat on a half-space
 *
 * Solves g >= 0, p >= 0, p g = 0 per cell for the gap g = K p - h - approach of two
 * elastic half-spaces with combined height h (row-major, m); with a hardness the
 * pressure is limited to it.  Pressure is in Pa, positive in compression.  The result is
 * byte-identical for any number of threads; plans and memory are kept between calls.
 *
 *	struct wp_contact_par par = { 32, 32, 1e-6, 1e-6, 115e9, 0, 0, 1e-8, 1 };
 *	struct wp_contact *c = wp_contact_new(&par, NULL);
 *	static double h[32 * 32], p[32 * 32];
 *	struct wp_contact_result r;
 *	h[500] = 1e-9;
 *	if (!c || wp_contact_press(c, h, 21e6, p, NULL, &r) != WP_OK)
 *		return 1;
 *	printf("contact area ratio %g\n", r.area);
 *	wp_contact_free(c);
 *
 * Vollebregt, J. Optim. Theory Appl. 162 (2014) 931-953; Stanley and Kato, J. Tribol. 119
 * (1997) 481-485 (periodic).
 */
#ifndef WEARPIPE_CONTACT_H
#define WEARPIPE_CONTACT_H

#include <wearpipe/status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct wp_contact;

struct wp_contact_par {
	int nx, ny;       /* cells, >= 1 */
	double dx, dy;    /* cell size, m */
	double estar;     /* contact modulus, Pa */
	double hardness;  /* largest pressure, Pa; 0: none */
	int periodic;     /* 1: periodic; 0: no load outside the grid */
	double tolerance; /* relative duality gap at which the iteration stops, <= 0.1 */
	int threads;      /* >= 1 */
};

struct wp_contact_result {
	double pressure;    /* mean, Pa */
	double load;        /* N */
	double approach;    /* of the flat past height 0, m */
	double indentation; /* approach from first contact, m */
	double area;        /* loaded cells over all cells */
	double energy;      /* elastic, J */
	double gap; /* relative duality gap of the result: bounds the excess energy */
	long iterations;
	double edge_load; /* share of the load on the outermost cells of a free grid */
};

WP_API struct wp_contact *wp_contact_new(
	const struct wp_contact_par *par, enum wp_status *status);
WP_API void wp_contact_free(struct wp_contact *c);

/* Solves the contact for a mean pressure (Pa). p (nx * ny): on entry an initial guess of
 * any scale, or zeros; on return the pressure.  gap (nx * ny, m) and result may be NULL.
 * WP_CUT_OFF if the outermost cells of a free grid carry most of the load. */
WP_API enum wp_status wp_contact_press(struct wp_contact *c, const double *height,
	double pressure, double *p, double *gap, struct wp_contact_result *result);

/* The same for a given approach, m. */
WP_API enum wp_status wp_contact_approach(struct wp_contact *c, const double *height,
	double approach, double *p, double *gap, struct wp_contact_result *result);

/* 1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2 */
WP_API double wp_contact_modulus(
	double young1, double poisson1, double young2, double poisson2);

#ifdef __cplusplus
}
#endif
#endif
