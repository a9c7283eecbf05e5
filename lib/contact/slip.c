#include "contact/slip.h"
#include "contact/state.h"
#include "num/fft.h"
#include <string.h>

static double shear_modulus(const struct slip_bodies *b, int i)
{
	return b->young[i] / (2 * (1 + b->poisson[i]));
}

int slip_uncoupled(const struct slip_bodies *b)
{
	double first = (1 - 2 * b->poisson[0]) / shear_modulus(b, 0);
	double second = (1 - 2 * b->poisson[1]) / shear_modulus(b, 1);

	/* Equal but for the rounding of the input. */
	return fabs(first - second) <= 1e-9 * (fabs(first) + fabs(second));
}

double slip_compliance(const struct slip_bodies *b, double along)
{
	double estar =
		kernel_modulus(b->young[0], b->poisson[0], b->young[1], b->poisson[1]);

	return estar / 2 *
	       ((1 - along * b->poisson[0]) / shear_modulus(b, 0) +
		       (1 - along * b->poisson[1]) / shear_modulus(b, 1));
}

struct traction {
	const double *pressure;
	double *shear; /* p' on entry */
	double mu;
};

/* q = mu (p - p'); sums q and the cells that stick. */
static void subtract(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct traction *t = context;

	for (size_t i = begin; i < end; i++) {
		double q = t->mu * (t->pressure[i] - t->shear[i]);

		s->sum[1] += t->shear[i] > 0;
		s->sum[0] += q;
		t->shear[i] = q;
	}
}

enum contact_status contact_slip(struct contact *c, const double *height,
	const double *pressure, const struct contact_result *normal, double mu,
	double mean_shear, double *shear, struct slip_result *result)
{
	struct traction t = { pressure, shear, mu };
	double rest = normal->pressure - (mean_shear > 0 ? mean_shear / mu : 0);
	enum contact_status status;
	struct sweep s;

	/* All of friction, but for rounding. */
	if (fabs(rest) <= 1e-12 * normal->pressure)
		rest = 0;
	if (!(rest >= 0))
		return CONTACT_OVERLOAD;
	memcpy(shear, pressure, c->n * sizeof *shear);
	status = contact_solve(c, height, CONTACT_PRESSURE, rest, shear, NULL);
	if (status != CONTACT_OK && status != CONTACT_NOCONV)
		return status;
	s = sweep_run(c->par.pool, c->n, subtract, &t);
	*result = (struct slip_result){ .load = s.sum[0] * c->par.dx * c->par.dy,
		.displacement = mu * (normal->indentation - c->result.indentation),
		.stick = s.sum[1] / (double)c->n };
	return status;
}

/* As the kernels of the displacement, times cos^2 of the angle of a wave to x, which is
 * y^2 / r^2 in space. */
static double free_along(const void *context, size_t ix, size_t iy)
{
	const struct contact *c = context;
	double dx = c->par.dx, dy = c->par.dy;

	return kernel_patch_along(dy, dx, (double)iy * dy, (double)ix * dx) /
	       (M_PI * c->par.estar);
}

static double periodic_along(const void *context, size_t kx, size_t ky)
{
	const struct contact *c = context;
	double qx = (double)kx / (c->par.nx * c->par.dx);
	double qy = (double)ky / (c->par.ny * c->par.dy), q = hypot(qx, qy);

	return q > 0 ? c->body.wave(c->body.context, 2 * M_PI * q) * qx * qx / (q * q)
		     : 0;
}

struct product {
	const double *shear, *image;
};

/* Twice the energy of a shear whose displacement is in image. */
static void multiply(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct product *p = context;

	for (size_t i = begin; i < end; i++)
		s->sum[0] += p->shear[i] * p->image[i];
}

enum num_status slip_along(struct contact *c, const double *shear, double *along)
{
	int is_free = c->par.boundary == CONTACT_FREE;
	struct product product = { shear, c->image };
	struct convolve *plane = convolve_borrow((size_t)c->par.nx, (size_t)c->par.ny,
		is_free ? CONVOLVE_PADDED : CONVOLVE_PERIODIC, c->par.pool, c->plane);
	double *kernel = plane ? convolve_alloc(plane) : NULL, whole;
	enum num_status status = NUM_MEMORY;

	if (kernel)
		status = is_free ? convolve_kernel(plane, kernel, free_along, c)
				 : convolve_spectrum(plane, kernel, periodic_along, c);
	if (status == NUM_OK) {
		contact_displacement(c, shear, c->image);
		whole = sweep_run(c->par.pool, c->n, multiply, &product).sum[0];
		convolve_apply(plane, kernel, shear, c->image);
		*along = sweep_run(c->par.pool, c->n, multiply, &product).sum[0] / whole;
		if (!(whole > 0))
			*along = 0.5;
	}
	fft_free(kernel);
	convolve_free(plane);
	return status;
}
