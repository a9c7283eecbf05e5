/* stress.h - stress below a surface loaded by pressure and friction
 *
 * Fields are row-major; tension is positive, depth counts down from the surface.
 *
 *	struct wp_stress_par par = { 32, 32, 8e-6, 8e-6, 0, 0.3, 0.3, 1 };
 *	struct wp_stress *s = wp_stress_new(&par, NULL);
 *	static double p[32 * 32], mises[32 * 32], tensor[6 * 32 * 32];
 *	p[500] = 2e9;
 *	if (!s || wp_stress_load(s, p) != WP_OK ||
 *		wp_stress_mises(s, 4e-6, mises) != WP_OK ||
 *		wp_stress_tensor(s, 4e-6, tensor) != WP_OK)
 *		return 1;
 *	printf("%g Pa\n", mises[500]);
 *	wp_stress_free(s);
 */
#ifndef WEARPIPE_STRESS_H
#define WEARPIPE_STRESS_H

#include <wearpipe/status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct wp_stress;

struct wp_stress_par {
	int nx, ny;      /* cells */
	double dx, dy;   /* cell size, m */
	int periodic;    /* as the contact was solved */
	double poisson;  /* of the body */
	double friction; /* coefficient; shear along +x */
	int threads;     /* >= 1 */
};

WP_API struct wp_stress *wp_stress_new(
	const struct wp_stress_par *par, enum wp_status *status);
WP_API void wp_stress_free(struct wp_stress *s);

/* Takes a pressure of nx * ny cells (Pa, finite), which must not change until the next
 * load. */
WP_API enum wp_status wp_stress_load(struct wp_stress *s, const double *pressure);
/* The von Mises stress (Pa) at a depth (m, >= 0) below the cell centres. */
WP_API enum wp_status wp_stress_mises(struct wp_stress *s, double depth, double *mises);
/* xx yy zz xy xz yz there: six fields, one after another. */
WP_API enum wp_status wp_stress_tensor(struct wp_stress *s, double depth, double *tensor);

#ifdef __cplusplus
}
#endif
#endif
