/* One step of the projected gradient: slow, but from any pressure that carries the load
 * it lowers the energy, which is strictly convex, so repeated steps converge whatever the
 * bounds are.  The other methods fall back on it. */
#include "contact/state.h"
#include <math.h>

/* The gradient taken off, shifted, within the bounds: every cell takes part. */
static void project_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double p = c->p[i], g = gap_at(c, i);
		double next = within(c, p - c->tau * g + c->shift), step = next - p;

		c->step[i] = step;
		t.sum[0] += step * g;
		t.sum[1] += step;
		t.sum[2] += fabs(step);
		t.sum[3] += is_free(c, next);
	}
	*s = t;
}

static void apply_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	(void)s;
	for (size_t i = begin; i < end; i++)
		c->p[i] = within(c, c->p[i] + c->stretch * c->step[i]);
}

static void sum_pressure(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact *c = context;

	for (size_t i = begin; i < end; i++)
		s->sum[0] += c->p[i];
}

void contact_gradient_step(struct contact *c)
{
	int load_given = c->control == CONTACT_PRESSURE;
	/* Of a sum of as many steps as there are cells. */
	const double rounding = 1e-14;
	double missing = 0, curvature;
	struct sweep s;

	if (load_given) {
		s = contact_sweep(c, sum_pressure);
		if (!contact_carries(c, s.sum[0]))
			missing = c->target * (double)c->n - s.sum[0];
	}
	c->tau = contact_cell_stiffness(c);
	c->shift = 0;
	s = contact_sweep(c, project_step);
	if (load_given)
		contact_share_load(c, project_step, missing, 1, rounding, &s);
	curvature = contact_multiply_step(c);
	c->stretch = 1;
	/* Without a load to restore, no farther than to the least energy. */
	if (missing == 0 && -s.sum[0] < curvature)
		c->stretch = fmax(-s.sum[0] / curvature, 0);
	contact_sweep(c, apply_step);
}

int contact_lingers(const struct contact *c)
{
	return c->since % GRADIENT_ROUND == 0;
}

int contact_gradient_due(struct contact *c, const struct sweep *s)
{
	double energy = contact_energy(c, s);
	int steps = energy < c->energy ? 1 : GRADIENT_ROUND;

	c->energy = fmin(energy, c->energy);
	return steps;
}
