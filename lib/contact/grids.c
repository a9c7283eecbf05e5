/* Nested iteration: a rough solution on a grid of half as many cells in each direction is
 * the initial guess, recursively. */
#include "contact/state.h"
#include <math.h>
#include <string.h>

/* Down to 256 cells saves nothing; from 4096 on small grids take up to half as many more
 * iterations (tests/unit/exact.c). */
enum { CELLS_MIN = 1024 };

int contact_can_coarsen(const struct contact_par *par, struct contact_par *coarse)
{
	return transfer_coarsen(par, coarse) &&
	       (long)coarse->nx * coarse->ny >= CELLS_MIN;
}

/* Mean height of the cells that a coarse one covers. */
static void average_height(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;
	const struct axis *ax = &c->transfer.x, *ay = &c->transfer.y;

	(void)s;
	for (size_t i = begin; i < end; i++) {
		size_t x = i % ax->m, y = i / ax->m;
		double sum = 0;

		for (size_t j = 0; j < TRANSFER_TAPS; j++)
			for (size_t k = 0; k < TRANSFER_TAPS; k++) {
				double part = ay->cover[TRANSFER_TAPS * y + j] *
					      ax->cover[TRANSFER_TAPS * x + k];

				if (part > 0)
					sum += part * c->h[(ay->first[y] + j) * ax->n +
							      ax->first[x] + k];
			}
		c->coarse_height[i] = sum;
	}
}

void contact_average_height(struct contact *c)
{
	sweep_run(c->par.pool, c->coarse->n, average_height, c);
}

static void square_pressure(void *context, size_t begin, size_t end, struct sweep *s)
{
	double *p = ((struct contact *)context)->coarse_pressure;

	(void)s;
	for (size_t i = begin; i < end; i++)
		p[i] *= p[i];
}

/* Bilinear in p^2, which decreases to zero linearly at the edge of a contact. */
static void interpolate_pressure(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;
	size_t nx = (size_t)c->par.nx;

	for (size_t i = begin; i < end; i++) {
		c->p[i] = sqrt(fmax(
			transfer_at(&c->transfer, c->coarse_pressure, i % nx, i / nx),
			0));
		s->sum[0] += c->p[i];
	}
}

double contact_interpolate_pressure(struct contact *c)
{
	sweep_run(c->par.pool, c->coarse->n, square_pressure, c);
	return contact_sweep(c, interpolate_pressure).sum[0];
}
