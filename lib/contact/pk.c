/* Polonsky and Keer, Wear 231 (1999) 206-219: conjugate gradients on the cells in
 * contact, a set updated from pressure and gap; two applications of the half-space per
 * iteration.  A cell at the hardness is out of the iteration until its gap opens. */
#include "contact/pk.h"
#include "contact/gradient.h"
#include "num/fft.h"
#include <math.h>

/* t = g + beta t on the free cells, 0 elsewhere. */
static void turn_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	(void)s;
	for (size_t i = begin; i < end; i++)
		c->step[i] =
			is_free(c, c->p[i]) ? gap_at(c, i) + c->beta * c->step[i] : 0;
}

/* Sums for the step length tau = g t / (r t), r = K t less its mean over the free
 * cells; the mean is taken off the sums instead of off r. */
static void sum_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		if (!is_free(c, c->p[i]))
			continue;
		t.sum[0] += gap_at(c, i) * c->step[i];
		t.sum[1] += c->image[i] * c->step[i];
		t.sum[2] += c->image[i];
		t.sum[3] += c->step[i];
		t.sum[4] += 1;
	}
	*s = t;
}

/* Moves the free cells, keeps them within the bounds, and frees the bounded cells whose
 * gap has the wrong sign; counts those. */
static void move_pressure(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double p = c->p[i], g = gap_at(c, i);

		if (is_free(c, p)) {
			p -= c->tau * c->step[i];
		} else if ((p <= 0 && g < 0) || (p > 0 && g > 0)) {
			p -= c->tau * g;
			t.sum[0] += 1;
		}
		c->p[i] = fmin(fmax(p, 0), c->cap);
	}
	*s = t;
}

/* Step length along the direction.  With one free cell the gap less its mean is zero
 * and the quotient 0/0; the last length is as good as any then, since the cells that
 * overlap decide. */
static double step_length(struct contact *c, double last)
{
	struct sweep s = contact_sweep(c, sum_step);
	double curvature = s.sum[1];

	if (c->control == CONTACT_PRESSURE && s.sum[4] > 0)
		curvature -= s.sum[2] * s.sum[3] / s.sum[4];
	return curvature > 0 && s.sum[0] > 0 ? s.sum[0] / curvature : last;
}

/* Returns 0 if that took more than scaling. */
static int restore_load(struct contact *c)
{
	double sum = contact_scale_load(c, c->cap < INFINITY);

	if (contact_carries(c, sum))
		return 1;
	if (!contact_carries(c, contact_place_rest(c, sum)))
		contact_gradient_step(c);
	return 0;
}

enum contact_status contact_solve_pk(struct contact *c)
{
	double last_moment = 1;
	int conjugate = 0, plain = 0;

	c->tau = contact_cell_stiffness(c);
	for (long k = 0;; k++) {
		double moment, tau;
		struct sweep s;

		contact_gap(c);
		s = contact_optimality_sums(c);
		moment = s.sum[2];
		c->result.optimality_gap = contact_optimality_gap(c, &s);
		if (c->result.optimality_gap <= c->tolerance &&
			(c->control == CONTACT_APPROACH || contact_carries(c, s.sum[1])))
			return CONTACT_OK;
		if (k == c->par.max_iterations ||
			contact_stalls(c, c->result.optimality_gap))
			return CONTACT_NOCONV;
		c->result.iterations++;
		if (c->cap < INFINITY && contact_lingers(c))
			plain = contact_gradient_due(c, &s);
		if (plain > 0) {
			plain--;
			conjugate = 0;
			tau = c->tau;
			contact_gradient_step(c);
			c->tau = tau;
			continue;
		}
		c->beta = conjugate && last_moment > 0 ? moment / last_moment : 0;
		last_moment = moment;
		contact_sweep(c, turn_step);
		contact_multiply_step(c);
		c->tau = step_length(c, c->tau);
		s = contact_sweep(c, move_pressure);
		conjugate = s.sum[0] == 0;
		if (c->control == CONTACT_PRESSURE)
			conjugate &= restore_load(c);
	}
}
