/* spectrum.h - rough surfaces with a prescribed power spectrum
 *
 * The digital filter in Fourier space (Hu and Tonder, Int. J. Mach. Tools Manuf. 32,
 * 1992; Garcia and Stoll, Phys. Rev. Lett. 52, 1984): the coefficient of every wave is
 * the square root of its power times a complex normal deviate.  The surface is periodic,
 * its height distribution normal, its mean zero.
 *
 * The deviate of the wave with kx periods along x and ky along y is a function of (seed,
 * realisation, kx, ky) alone, and the waves are evaluated at the cell centres ((ix +
 * 1/2) dx, (iy + 1/2) dy).  A finer grid on the same area therefore samples the same
 * waves and adds shorter ones, and the work can be divided in any way.
 *
 *	struct spectrum_par par = { .nx = 512, .ny = 512, .lx = 1e-3, .ly = 1e-3,
 *		.kind = SPECTRUM_GAUSS, .corr_x = 1e-4, .corr_y = 1e-4 };
 *	struct spectrum *s;
 *	if (spectrum_make(&par, &s) == SPECTRUM_OK)
 *		spectrum_surface(s, NULL, seed, realisation, RNG_SURFACE, z, NULL);
 *	spectrum_free(s);
 *
 * Heights are row-major, z[iy * nx + ix], and have the expected variance 1 less the
 * power of the mean; the caller scales them.
 */
#ifndef SURFACE_SPECTRUM_H
#define SURFACE_SPECTRUM_H

#include "num/philox.h"
#include "num/pool.h"
#include "num/status.h"

enum spectrum_kind {
	SPECTRUM_GAUSS, /* autocorrelation exp(-(x/corr_x)^2 - (y/corr_y)^2) */
	SPECTRUM_EXP,   /* autocorrelation exp(-sqrt((x/corr_x)^2 + (y/corr_y)^2)) */
	SPECTRUM_AFFINE /* power q^-2(1+H) below the roll-off wavelength, constant above
			 */
};

struct spectrum_par {
	int nx, ny;    /* points, any sizes >= 1 */
	double lx, ly; /* sides of the area, m */
	enum spectrum_kind kind;
	double corr_x, corr_y; /* 1/e correlation lengths, m (GAUSS, EXP) */
	double hurst;          /* H (AFFINE) */
	double rolloff; /* wavelength, m; 0: none, self-affine up to the longest wave */
	double longest; /* no waves longer than this, m; 0: no such bound (AFFINE) */
	double cutoff;  /* no waves shorter than this, m; 0: all the grid carries */
};

enum spectrum_status {
	SPECTRUM_OK,
	SPECTRUM_MEMORY,
	SPECTRUM_DOMAIN, /* a parameter is not positive and finite, or H not in [0, 2] */
	SPECTRUM_TOO_LONG, /* a correlation length exceeds the side of the area */
	SPECTRUM_EMPTY     /* no wave of the grid lies between the bounds */
};

struct spectrum;

/* *made is NULL if that fails.  On the sampled periodic grid the two correlation
 * functions hold exactly: the power is the discrete transform of their periodic sums,
 * for the exponential one written as a mixture of Gaussians. */
enum spectrum_status spectrum_make(
	const struct spectrum_par *par, struct spectrum **made);
void spectrum_free(struct spectrum *s);

/* Fills z (nx * ny).  pool may be NULL.  slope, unless NULL, receives the rms slope
 * of the waves, sqrt(sum q^2 |z_q|^2), in units of z per metre. */
void spectrum_surface(struct spectrum *s, struct pool *pool, uint64_t seed,
	uint32_t realisation, enum rng_purpose purpose, double *z, double *slope);

/* The same rms slope of any heights on the grid (one transform). */
enum num_status spectrum_slope(struct spectrum *s, const double *z, double *slope);

/* Expected power of the wave (kx, ky), |kx| <= nx / 2, |ky| <= ny / 2; all of them and
 * the power of the mean, which is not drawn and 0 here, sum to 1. */
double spectrum_power(const struct spectrum *s, int kx, int ky);

/* Number of waves drawn, and of waves excluded by the bounds. */
long spectrum_waves(const struct spectrum *s);
long spectrum_waves_skipped(const struct spectrum *s);

/* Gives heights z the sorted values and, as nearly as these allow, the magnitudes of
 * the Fourier coefficients z came with: the two are imposed in turn (Schreiber and
 * Schmitz, Phys. Rev. Lett. 77, 1996; for surfaces Perez-Rafols and Almqvist, Tribol.
 * Int. 131, 2019) until the magnitudes stop improving; the sorted values always hold.
 * *error is the rms error of the magnitudes relative to their rms, *iterations counts the
 * turns. */
enum num_status spectrum_impose(struct spectrum *s, const double *sorted, double *z,
	int *iterations, double *error);

#endif
