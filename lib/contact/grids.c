/* Nested iteration: a loose solution on a grid of half as many cells each way is the
 * first guess for this one, and so on down. */
#include "contact/state.h"
#include <math.h>
#include <string.h>

enum { CELLS_MIN = 1024 };

/* Pressures need to be no better than what interpolation loses. */
static const double coarse_tolerance = 1e-2;

static int factor(int n)
{
	return n > 1 ? 2 : 1;
}

int contact_can_halve(const struct contact_par *par)
{
	int fx = factor(par->nx), fy = factor(par->ny);

	return par->nx % fx == 0 && par->ny % fy == 0 &&
	       (long)(par->nx / fx) * (par->ny / fy) >= CELLS_MIN;
}

/* Mean height of the cells that make up a coarse one. */
static void average_height(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;
	size_t nx = (size_t)c->coarse->par.nx;
	size_t fx = (size_t)factor(c->par.nx), fy = (size_t)factor(c->par.ny);

	(void)s;
	for (size_t i = begin; i < end; i++) {
		const double *h = c->h + i / nx * fy * (size_t)c->par.nx + i % nx * fx;
		double sum = 0;

		for (size_t ky = 0; ky < fy; ky++)
			for (size_t kx = 0; kx < fx; kx++)
				sum += h[ky * (size_t)c->par.nx + kx];
		c->coarse_height[i] = sum / (double)(fx * fy);
	}
}

/* The coarse neighbour of a fine cell on the side where it lies. */
static size_t neighbour(size_t fine, size_t coarse, size_t n, int f, int periodic)
{
	if (f == 1)
		return coarse;
	if (fine % 2 == 0)
		return coarse > 0 ? coarse - 1 : periodic ? n - 1 : 0;
	return coarse + 1 < n ? coarse + 1 : periodic ? 0 : n - 1;
}

/* Bilinear in p^2, which falls to zero linearly at the rim of a contact. */
static void interpolate_pressure(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;
	size_t nx = (size_t)c->par.nx, mx = (size_t)c->coarse->par.nx;
	size_t my = (size_t)c->coarse->par.ny;
	int fx = factor(c->par.nx), fy = factor(c->par.ny);
	int periodic = c->par.boundary == CONTACT_PERIODIC;
	const double *q = c->coarse_pressure;

	for (size_t i = begin; i < end; i++) {
		size_t x = i % nx, y = i / nx, cx = x / (size_t)fx, cy = y / (size_t)fy;
		size_t ox = neighbour(x, cx, mx, fx, periodic);
		size_t oy = neighbour(y, cy, my, fy, periodic);
		double p00 = q[cy * mx + cx], p01 = q[cy * mx + ox];
		double p10 = q[oy * mx + cx], p11 = q[oy * mx + ox];

		c->p[i] = sqrt(
			(9 * p00 * p00 + 3 * p01 * p01 + 3 * p10 * p10 + p11 * p11) / 16);
		s->sum[0] += c->p[i];
	}
}

int contact_guess(struct contact *c)
{
	struct contact *coarse = c->coarse;
	enum contact_status status;
	struct sweep s;

	if (!coarse)
		return 0;
	sweep_run(c->par.pool, coarse->n, average_height, c);
	memset(c->coarse_pressure, 0, coarse->n * sizeof(*c->coarse_pressure));
	coarse->tolerance = fmax(coarse_tolerance, c->tolerance);
	status = contact_solve(coarse, c->coarse_height, c->control, c->target,
		c->coarse_pressure, NULL);
	c->result.work += coarse->result.work * (double)coarse->n / (double)c->n;
	if (status != CONTACT_OK && status != CONTACT_NOCONV)
		return 0;
	s = contact_sweep(c, interpolate_pressure);
	return s.sum[0] > 0;
}
