/* rough.c - an ensemble of rough surfaces of given roughness */
#include "surface/rough.h"
#include "num/grid.h"
#include "num/status.h"
#include "surface/heights.h"
#include "surface/surface.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct rough {
	struct rough_par par;
	struct spectrum *spectrum; /* NULL: every surface is flat */
	double *sorted;            /* heights to impose; NULL: normal ones */
	double *second; /* memory for the second surface; NULL: there is none */
};

static size_t points(const struct rough *r)
{
	return grid_size(r->par.spectrum.nx, r->par.spectrum.ny);
}

static enum rough_status make_spectrum(struct rough *r)
{
	switch (spectrum_make(&r->par.spectrum, &r->spectrum)) {
	case SPECTRUM_OK:
		return ROUGH_OK;
	case SPECTRUM_DOMAIN:
		return ROUGH_DOMAIN;
	case SPECTRUM_TOO_LONG:
		return ROUGH_TOO_LONG;
	case SPECTRUM_EMPTY:
		return ROUGH_EMPTY;
	case SPECTRUM_MEMORY:
		break;
	}
	return ROUGH_MEMORY;
}

static enum rough_status make_heights(struct rough *r)
{
	if (r->par.skewness == 0 && r->par.kurtosis == 3)
		return ROUGH_OK;
	r->sorted = malloc(points(r) * sizeof *r->sorted);
	if (!r->sorted)
		return ROUGH_MEMORY;
	switch (heights_sorted(points(r), r->par.skewness, r->par.kurtosis, r->sorted)) {
	case HEIGHTS_OK:
		return ROUGH_OK;
	case HEIGHTS_IMPOSSIBLE:
		return ROUGH_IMPOSSIBLE;
	case HEIGHTS_TOO_FEW:
		return ROUGH_TOO_FEW;
	case HEIGHTS_MEMORY:
		break;
	}
	return ROUGH_MEMORY;
}

static enum rough_status build(struct rough *r)
{
	enum rough_status status;

	if (r->par.target.high == 0 && r->par.pair.high == 0)
		return ROUGH_OK;
	status = make_spectrum(r);
	if (status != ROUGH_OK)
		return status;
	if (r->par.pair.high > 0) {
		r->second = malloc(points(r) * sizeof *r->second);
		if (!r->second)
			return ROUGH_MEMORY;
	}
	return make_heights(r);
}

enum rough_status rough_make(const struct rough_par *par, struct rough **made)
{
	struct rough *r = calloc(1, sizeof *r);
	enum rough_status status;

	*made = NULL;
	if (!r)
		return ROUGH_MEMORY;
	r->par = *par;
	status = build(r);
	if (status != ROUGH_OK)
		rough_free(r);
	else
		*made = r;
	return status;
}

void rough_free(struct rough *r)
{
	if (!r)
		return;
	spectrum_free(r->spectrum);
	free(r->sorted);
	free(r->second);
	free(r);
}

const struct spectrum *rough_spectrum(const struct rough *r)
{
	return r->spectrum;
}

double rough_draw(const struct rough_range *range, uint64_t seed, uint32_t realisation,
	uint64_t index)
{
	if (range->low == range->high)
		return range->low;
	return range->low + (range->high - range->low) * philox_uniform(seed, realisation,
								 RNG_ROUGHNESS, index);
}

enum num_status rough_scale(int nx, int ny, double *z, double have, double want)
{
	double factor = have > 0 ? want / have : 0;

	for (size_t i = 0; i < grid_size(nx, ny); i++)
		z[i] *= factor;
	return have > 0 || want == 0 ? NUM_OK : NUM_DOMAIN;
}

/* One surface of roughness want into z. */
static enum rough_status make_surface(struct rough *r, uint32_t realisation,
	enum rng_purpose purpose, double want, double *z, struct rough_work *work)
{
	int nx = r->par.spectrum.nx, ny = r->par.spectrum.ny, turns = 0;
	int by_slope = r->par.kind == ROUGH_SLOPE;
	double have = 0, error;

	if (want == 0) {
		memset(z, 0, points(r) * sizeof *z);
		return ROUGH_OK;
	}
	spectrum_surface(r->spectrum, r->par.pool, r->par.seed, realisation, purpose, z,
		by_slope ? &have : NULL);
	work->transforms++;
	if (r->sorted) {
		if (spectrum_impose(r->spectrum, r->sorted, z, &turns, &error))
			return ROUGH_MEMORY;
		work->spectrum_error = fmax(work->spectrum_error, error);
		work->iterations += turns;
		work->transforms += 2 + 2 * turns;
		if (by_slope) {
			if (spectrum_slope(r->spectrum, z, &have))
				return ROUGH_MEMORY;
			work->transforms++;
		}
	}
	if (!by_slope)
		have = r->par.kind == ROUGH_SA ? surface_sa(nx, ny, z)
					       : surface_sq(nx, ny, z);
	return rough_scale(nx, ny, z, have, want) ? ROUGH_EMPTY : ROUGH_OK;
}

enum rough_status rough_surface(
	struct rough *r, uint32_t realisation, double *z, struct rough_work *work)
{
	struct rough_work unused = { 0, 0, 0 };
	enum rough_status status;
	double want = rough_draw(&r->par.target, r->par.seed, realisation, 0);

	if (!work)
		work = &unused;
	status = make_surface(r, realisation, RNG_SURFACE, want, z, work);
	if (status != ROUGH_OK || !r->second)
		return status;
	want = rough_draw(&r->par.pair, r->par.seed, realisation, 1);
	status = make_surface(r, realisation, RNG_SURFACE_2, want, r->second, work);
	for (size_t i = 0; status == ROUGH_OK && i < points(r); i++)
		z[i] += r->second[i];
	return status;
}
