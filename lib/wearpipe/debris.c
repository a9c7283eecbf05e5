#include "debris/debris.h"
#include "num/pool.h"
#include "report.h"
#include <stdlib.h>
#include <wearpipe/debris.h>

struct wp_debris {
	struct pool *pool;
	struct debris *debris;
	struct wp_particle *particle;
	size_t room;
	double beyond;
};

struct wp_debris *wp_debris_new(const struct wp_debris_par *par, enum wp_status *status)
{
	struct debris_par wanted = { .yield = par->yield,
		.cell = par->cell,
		.rule = par->potential ? WEAR_POTENTIAL : WEAR_COLUMN };
	struct wp_debris *d;
	enum wp_status why;

	if (par->threads < 1)
		return report(status, WP_DOMAIN);
	d = calloc(1, sizeof *d);
	if (!d)
		return report(status, WP_NO_MEMORY);
	d->pool = pool_new(par->threads);
	wanted.stress = (struct stress_par){ .nx = par->nx,
		.ny = par->ny,
		.dx = par->dx,
		.dy = par->dy,
		.nu = par->poisson,
		.mu = par->friction,
		.periodic = par->periodic,
		.pool = d->pool };
	d->debris = d->pool ? debris_new(&wanted) : NULL;
	if (!d->debris) {
		why = d->pool ? status_of_errno() : WP_NO_MEMORY;
		wp_debris_free(d);
		return report(status, why);
	}
	report(status, WP_OK);
	return d;
}

void wp_debris_free(struct wp_debris *d)
{
	if (!d)
		return;
	debris_free(d->debris);
	pool_free(d->pool);
	free(d->particle);
	free(d);
}

static enum wp_status translated(enum debris_status status)
{
	switch (status) {
	case DEBRIS_OK:
		return WP_OK;
	case DEBRIS_PULL:
		return WP_DOMAIN;
	case DEBRIS_NUMBERS:
		return WP_NUMBERS;
	case DEBRIS_DEEP:
	case DEBRIS_FINE:
		return WP_IMPOSSIBLE;
	case DEBRIS_MEMORY:
		break;
	}
	return WP_NO_MEMORY;
}

enum wp_status wp_debris_wear(struct wp_debris *d, double *height, const double *pressure,
	const struct wp_particle **particle, size_t *count)
{
	struct debris_step step;
	enum wp_status status =
		translated(debris_step(d->debris, height, pressure, &step));

	*particle = NULL;
	*count = 0;
	d->beyond = status == WP_OK ? step.beyond : 0;
	if (status != WP_OK)
		return status;
	if (step.count > d->room) {
		struct wp_particle *more =
			realloc(d->particle, step.count * sizeof *more);

		if (!more)
			return WP_NO_MEMORY;
		d->particle = more;
		d->room = step.count;
	}
	for (size_t i = 0; i < step.count; i++) {
		const struct particle *p = &step.particle[i];

		d->particle[i] = (struct wp_particle){ (double)p->columns, p->volume,
			p->diameter, p->length, p->width, p->solidity, p->x, p->y, p->z };
	}
	*particle = d->particle;
	*count = step.count;
	return step.beyond > DEBRIS_BEYOND * step.volume ? WP_CUT_OFF : WP_OK;
}

double wp_debris_beyond(const struct wp_debris *d)
{
	return d->beyond;
}
