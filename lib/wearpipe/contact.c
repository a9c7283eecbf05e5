#include "contact/kernel.h"
#include "contact/patches.h"
#include "contact/solver.h"
#include "num/pool.h"
#include "report.h"
#include <stdlib.h>
#include <wearpipe/contact.h>

/* More than any contact needs that converges. */
enum { MAX_ITERATIONS = 10000 };

struct wp_contact {
	struct pool *pool;
	struct contact *contact;
	struct patch_grid grid;
};

struct wp_contact *wp_contact_new(
	const struct wp_contact_par *par, enum wp_status *status)
{
	struct contact_par wanted = { .nx = par->nx,
		.ny = par->ny,
		.dx = par->dx,
		.dy = par->dy,
		.estar = par->estar,
		.hardness = par->hardness,
		.boundary = par->periodic ? CONTACT_PERIODIC : CONTACT_FREE,
		.tolerance = par->tolerance,
		.max_iterations = MAX_ITERATIONS };
	struct wp_contact *c;
	enum wp_status why;

	if (par->threads < 1 || par->tolerance > CONTACT_LOOSEST)
		return report(status, WP_DOMAIN);
	c = calloc(1, sizeof *c);
	if (!c)
		return report(status, WP_NO_MEMORY);
	c->grid = (struct patch_grid){ par->nx, par->ny, par->dx, par->dy,
		wanted.boundary == CONTACT_PERIODIC };
	c->pool = wanted.pool = pool_new(par->threads);
	c->contact = c->pool ? contact_new(&wanted) : NULL;
	if (!c->contact) {
		why = c->pool ? status_of_errno() : WP_NO_MEMORY;
		wp_contact_free(c);
		return report(status, why);
	}
	report(status, WP_OK);
	return c;
}

void wp_contact_free(struct wp_contact *c)
{
	if (!c)
		return;
	contact_free(c->contact);
	pool_free(c->pool);
	free(c);
}

static enum wp_status solve(struct wp_contact *c, const double *height,
	enum contact_control control, double target, double *p, double *gap,
	struct wp_contact_result *result)
{
	enum contact_status status =
		contact_solve(c->contact, height, control, target, p, gap);
	const struct contact_result *found = contact_result(c->contact);
	double edge_load;

	switch (status) {
	case CONTACT_OVERLOAD:
	case CONTACT_TOO_DEEP:
		return WP_IMPOSSIBLE;
	case CONTACT_NUMBERS:
		return WP_NUMBERS;
	case CONTACT_OK:
	case CONTACT_NOCONV:
		break;
	}
	edge_load = contact_edge_load(&c->grid, p);
	if (result)
		*result = (struct wp_contact_result){ found->pressure, found->load,
			found->approach, found->indentation, found->area, found->energy,
			found->optimality_gap, found->iterations, edge_load };
	if (status != CONTACT_OK)
		return WP_NOT_CONVERGED;
	return edge_load > CONTACT_EDGE_MOST ? WP_CUT_OFF : WP_OK;
}

enum wp_status wp_contact_press(struct wp_contact *c, const double *height,
	double pressure, double *p, double *gap, struct wp_contact_result *result)
{
	if (!(pressure >= 0))
		return WP_DOMAIN;
	return solve(c, height, CONTACT_PRESSURE, pressure, p, gap, result);
}

enum wp_status wp_contact_approach(struct wp_contact *c, const double *height,
	double approach, double *p, double *gap, struct wp_contact_result *result)
{
	return solve(c, height, CONTACT_APPROACH, approach, p, gap, result);
}

double wp_contact_modulus(double young1, double poisson1, double young2, double poisson2)
{
	return kernel_modulus(young1, poisson1, young2, poisson2);
}
