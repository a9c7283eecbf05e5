#include "grid_error.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "surface/surface.h"
#include <math.h>
#include <stdlib.h>

/* Orders of convergence accepted for an extrapolation: the stress is of second order, the
 * edge of a contact of about first order. */
static const double LEAST = 0.5, MOST = 3;

static int wear_coarser(const struct worn_surface *c, struct contact_par pressing,
	struct debris_par wear, int factor, enum contact_control control, double target,
	double *volume, double *particles)
{
	const struct record *r = c->r;
	size_t n = (size_t)(r->nx / factor) * (size_t)(r->ny / factor);
	double *h = xcalloc(n, sizeof *h), *p = xcalloc(n, sizeof *p);
	struct debris_step lost;
	struct contact *contact;
	struct debris *debris;
	enum debris_status worn = DEBRIS_NUMBERS;
	enum contact_status status;

	pressing.nx = wear.stress.nx = r->nx / factor;
	pressing.ny = wear.stress.ny = r->ny / factor;
	pressing.dx = wear.stress.dx = r->dx * factor;
	pressing.dy = wear.stress.dy = r->dy * factor;
	contact = contact_new(&pressing);
	debris = debris_new(&wear);
	if (!contact || !debris ||
		surface_resample(r->nx, r->ny, c->h, pressing.nx, pressing.ny, h))
		die(EXIT_RUN, "no memory for a grid of %dx%d cells", pressing.nx,
			pressing.ny);
	*volume = *particles = NAN;
	status = contact_solve(contact, h, control, target, p, NULL);
	if (status == CONTACT_OK || status == CONTACT_NOCONV)
		worn = debris_step(debris, h, p, &lost);
	if (worn == DEBRIS_MEMORY)
		die(EXIT_RUN, "out of memory");
	if (worn == DEBRIS_OK) {
		*volume = lost.volume;
		*particles = (double)lost.count;
	}
	stats_add("grids", 1);
	contact_free(contact);
	debris_free(debris);
	free(h);
	free(p);
	return status == CONTACT_OK;
}

int grid_error_find(const struct worn_surface *c, const struct contact_par *pressing,
	const struct debris_par *wear, enum contact_control control, double target,
	double volume, struct grid_error *found)
{
	int solved = 1;
	double fine, coarse;

	for (int k = 0; k < 2; k++)
		solved &= wear_coarser(c, *pressing, *wear, 2 << k, control, target,
			&found->volume[k], &found->particles[k]);
	fine = found->volume[0] - volume;
	coarse = found->volume[1] - found->volume[0];
	found->order = fine * coarse > 0 ? log2(coarse / fine) : NAN;
	if (!(found->order >= LEAST && found->order <= MOST))
		found->order = NAN;
	found->extrapolated = volume - fine / (exp2(found->order) - 1);
	found->error = fabs(found->extrapolated - volume);
	return solved;
}
