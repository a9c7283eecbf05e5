#include "report.h"
#include "surface/areal.h"
#include "surface/rough.h"
#include <math.h>
#include <stdlib.h>
#include <wearpipe/surface.h>

struct wp_surface {
	struct rough *rough;
};

static enum wp_status translated(enum rough_status status)
{
	switch (status) {
	case ROUGH_OK:
		return WP_OK;
	case ROUGH_MEMORY:
		return WP_NO_MEMORY;
	case ROUGH_DOMAIN:
		return WP_DOMAIN;
	case ROUGH_TOO_LONG:
	case ROUGH_EMPTY:
	case ROUGH_IMPOSSIBLE:
	case ROUGH_TOO_FEW:
		break;
	}
	return WP_IMPOSSIBLE;
}

struct wp_surface *wp_surface_new(
	const struct wp_surface_par *par, enum wp_status *status)
{
	static const enum spectrum_kind kinds[] = {
		[WP_SURFACE_GAUSS] = SPECTRUM_GAUSS,
		[WP_SURFACE_EXPONENTIAL] = SPECTRUM_EXP,
		[WP_SURFACE_SELF_AFFINE] = SPECTRUM_AFFINE,
	};
	struct rough_par rough = { .kind = ROUGH_SQ,
		.target = { par->sq, par->sq },
		.kurtosis = 3,
		.seed = par->seed };
	enum rough_status why;
	struct wp_surface *s;

	if ((unsigned)par->kind >= sizeof(kinds) / sizeof *kinds || !(par->sq >= 0))
		return report(status, WP_DOMAIN);
	rough.spectrum = (struct spectrum_par){ .nx = par->nx,
		.ny = par->ny,
		.lx = par->lx,
		.ly = par->ly,
		.kind = kinds[par->kind],
		.corr_x = par->corr_x,
		.corr_y = par->corr_y,
		.hurst = par->hurst,
		.rolloff = par->rolloff,
		.cutoff = par->cutoff };
	s = malloc(sizeof *s);
	if (!s)
		return report(status, WP_NO_MEMORY);
	why = rough_make(&rough, &s->rough);
	if (why != ROUGH_OK) {
		free(s);
		return report(status, translated(why));
	}
	report(status, WP_OK);
	return s;
}

void wp_surface_free(struct wp_surface *s)
{
	if (s)
		rough_free(s->rough);
	free(s);
}

enum wp_status wp_surface_heights(struct wp_surface *s, uint32_t realisation, double *z)
{
	return translated(rough_surface(s->rough, realisation, z, NULL));
}

enum wp_status wp_roughness(int nx, int ny, double dx, double dy, const double *z,
	struct wp_roughness *roughness)
{
	struct surface_parameters p;

	if (nx < 1 || ny < 1 || !(dx > 0) || !(dy > 0))
		return WP_DOMAIN;
	if (surface_measure(nx, ny, dx, dy, z, &p))
		return WP_NO_MEMORY;
	if (!isfinite(p.sq))
		return WP_NUMBERS;
	*roughness = (struct wp_roughness){ p.sa, p.sq, p.ssk, p.sku, p.sp, p.sv, p.sz,
		p.sdq, p.sdr, p.sal, p.str };
	return WP_OK;
}
