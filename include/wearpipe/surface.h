/* surface.h - rough surfaces with a given spectrum, and areal parameters of heights
 *
 * Heights are row-major, z[iy * nx + ix], in metres, positive towards the other body.
 * Realisation k depends only on the parameters and k.
 *
 *	struct wp_surface_par par = { 64, 64, 1e-3, 1e-3, WP_SURFACE_GAUSS, 0.8e-6,
 *		1e-4, 1e-4, 0, 0, 0, 1 };
 *	struct wp_surface *s = wp_surface_new(&par, NULL);
 *	static double z[64 * 64];
 *	struct wp_roughness r;
 *	if (!s || wp_surface_heights(s, 0, z) != WP_OK ||
 *		wp_roughness(64, 64, 1e-3 / 64, 1e-3 / 64, z, &r) != WP_OK)
 *		return 1;
 *	printf("Sq %g m\n", r.sq);
 *	wp_surface_free(s);
 *
 * Spectra: Hu and Tonder, Int. J. Mach. Tools Manuf. 32 (1992) 83; parameters: ISO
 * 25178-2.
 */
#ifndef WEARPIPE_SURFACE_H
#define WEARPIPE_SURFACE_H

#include <stdint.h>
#include <wearpipe/status.h>

#ifdef __cplusplus
extern "C" {
#endif

struct wp_surface;

enum wp_surface_kind {
	WP_SURFACE_GAUSS,       /* autocorrelation exp(-(x/corr_x)^2 - (y/corr_y)^2) */
	WP_SURFACE_EXPONENTIAL, /* exp(-sqrt((x/corr_x)^2 + (y/corr_y)^2)) */
	WP_SURFACE_SELF_AFFINE  /* power q^(-2 - 2 hurst) below the roll-off wavelength */
};

struct wp_surface_par {
	int nx, ny;    /* points, >= 1 */
	double lx, ly; /* sides of the area, m */
	enum wp_surface_kind kind;
	double sq;              /* root mean square height, m */
	double corr_x, corr_y;  /* 1/e correlation lengths, m */
	double hurst;           /* exponent, 0 to 2 (self-affine) */
	double rolloff, cutoff; /* wavelengths, m; 0: none */
	uint64_t seed;
};

/* NULL with WP_DOMAIN, WP_IMPOSSIBLE (no wave of the grid lies between the bounds, or a
 * correlation length exceeds the side) or WP_NO_MEMORY. */
WP_API struct wp_surface *wp_surface_new(
	const struct wp_surface_par *par, enum wp_status *status);
WP_API void wp_surface_free(struct wp_surface *s);

/* Fills z (nx * ny), mean 0. */
WP_API enum wp_status wp_surface_heights(
	struct wp_surface *s, uint32_t realisation, double *z);

/* Parameters of ISO 25178-2; nan if there are too few points. */
struct wp_roughness {
	double sa, sq, ssk, sku, sp, sv, sz; /* heights, m; ssk, sku: 1 */
	double sdq, sdr;                     /* rms slope; developed area ratio */
	double sal, str; /* autocorrelation length, m; texture aspect ratio */
};

/* dx, dy: spacing of the points, m. */
WP_API enum wp_status wp_roughness(int nx, int ny, double dx, double dy, const double *z,
	struct wp_roughness *roughness);

#ifdef __cplusplus
}
#endif
#endif
