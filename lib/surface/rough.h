/* rough.h - an ensemble of rough surfaces of given roughness
 *
 * Realisation k is a function of the parameters and k alone.  Its heights come from the
 * spectrum, receive non-Gaussian moments on request, and are scaled to a roughness
 * that is exact or drawn; a second, independent surface may be added, which makes the
 * equivalent surface of a pair (Greenwood and Tripp, Proc. Inst. Mech. Eng. 185, 1970).
 *
 *	struct rough_par par = { .spectrum = { ... }, .kind = ROUGH_SQ,
 *		.target = { 78e-6, 82e-6 }, .kurtosis = 3, .seed = 1 };
 *	struct rough *r;
 *	if (rough_make(&par, &r) != ROUGH_OK)
 *		...
 *	for (uint32_t k = 0; k < 100; k++)
 *		rough_surface(r, k, z, NULL);
 *	rough_free(r);
 */
#ifndef SURFACE_ROUGH_H
#define SURFACE_ROUGH_H

#include "num/status.h"
#include "surface/spectrum.h"

enum rough_kind {
	ROUGH_SQ,   /* root mean square height, m */
	ROUGH_SA,   /* mean absolute height, m */
	ROUGH_SLOPE /* root mean square slope of the waves */
};

/* Drawn uniformly; low = high: exact. */
struct rough_range {
	double low, high;
};

struct rough_par {
	struct spectrum_par spectrum;
	enum rough_kind kind;
	struct rough_range target; /* of the surface */
	struct rough_range pair;   /* of the second surface; { 0, 0 }: there is none */
	double skewness, kurtosis; /* of each; 0 and 3: normal heights */
	uint64_t seed;
	struct pool *pool; /* borrowed; may be NULL */
};

enum rough_status {
	ROUGH_OK,
	ROUGH_MEMORY,
	ROUGH_DOMAIN,     /* the spectrum's parameters are out of range */
	ROUGH_TOO_LONG,   /* a correlation length exceeds the side */
	ROUGH_EMPTY,      /* no wave of the grid is within the bounds */
	ROUGH_IMPOSSIBLE, /* kurtosis <= skewness^2 + 1 */
	ROUGH_TOO_FEW     /* too few points for this skewness and kurtosis */
};

/* Work done for one surface, added to what the struct holds. */
struct rough_work {
	long transforms, iterations;
	double spectrum_error; /* largest, of spectrum_impose() */
};

struct rough;

/* *made is NULL if that fails. */
enum rough_status rough_make(const struct rough_par *par, struct rough **made);
void rough_free(struct rough *r);

/* Fills z (nx * ny), mean 0.  work may be NULL. */
enum rough_status rough_surface(
	struct rough *r, uint32_t realisation, double *z, struct rough_work *work);

/* Its spectrum, NULL if all surfaces are flat. */
const struct spectrum *rough_spectrum(const struct rough *r);

/* The roughness of a realisation; index: 0 first surface, 1 second. */
double rough_draw(const struct rough_range *range, uint64_t seed, uint32_t realisation,
	uint64_t index);

/* Scales heights from roughness have to want; NUM_DOMAIN where have is 0 but want is not.
 */
enum num_status rough_scale(int nx, int ny, double *z, double have, double want);

#endif
