#include "contact/slip.h"
#include "contact/state.h"
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

double slip_compliance(const struct slip_bodies *b)
{
	double estar =
		kernel_modulus(b->young[0], b->poisson[0], b->young[1], b->poisson[1]);

	return estar / 4 *
	       ((2 - b->poisson[0]) / shear_modulus(b, 0) +
		       (2 - b->poisson[1]) / shear_modulus(b, 1));
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
	double mean_shear, double compliance, double *shear, struct slip_result *result)
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
		.displacement =
			mu * compliance * (normal->indentation - c->result.indentation),
		.stick = s.sum[1] / (double)c->n };
	return status;
}
