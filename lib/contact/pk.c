/* Polonsky and Keer, Wear 231 (1999) 206-219: conjugate gradients on the cells in
 * contact, a set updated from pressure and gap; two applications of the half-space per
 * iteration.  A cell at the hardness is out of the iteration until its gap opens. */
#include "contact/state.h"
#include "num/fft.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

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

/* Steps that are watched: with a hardness they can end in a cycle, in which most cells
 * change from one bound to the other; with a given approach no load limits the pressure
 * of cells that come into contact, and steps can grow without bound.  A step that raises
 * the energy is shortened to the least energy along it. */
struct watch {
	struct contact *c;
	double *before;       /* pressure before the last step, NULL if not watched */
	int known;            /* of the last step: */
	double energy, slope; /* before it, and along it */
};

/* Without memory for it the steps stay unwatched. */
static void watch_steps(struct watch *w)
{
	if (!w->before)
		w->before = calloc(w->c->n, sizeof *w->before);
}

static void step_begins(struct watch *w, const struct sweep *s)
{
	w->energy = contact_energy(w->c, s);
	if (w->before)
		memcpy(w->before, w->c->p, w->c->n * sizeof *w->before);
}

static void step_ends(struct watch *w)
{
	w->known = w->before != NULL;
	w->slope = 0;
	for (size_t i = 0; w->known && i < w->c->n; i++)
		w->slope += gap_at(w->c, i) * (w->c->p[i] - w->before[i]);
}

/* Returns 1 if the step raised the energy; the gap is then that of a shorter one. */
static int step_rises(struct watch *w, struct sweep *s)
{
	/* Of sums over as many cells as there are. */
	const double rounding = 1e-12;
	double rise = contact_energy(w->c, s) - w->energy, part;

	if (!w->known || !(rise > rounding * w->c->work))
		return 0;
	part = w->slope < 0 ? w->slope / (2 * (w->slope - rise)) : 0;
	for (size_t i = 0; i < w->c->n; i++)
		w->c->p[i] = w->before[i] + part * (w->c->p[i] - w->before[i]);
	contact_gap(w->c);
	*s = contact_optimality_sums(w->c);
	return 1;
}

static enum contact_status iterate(struct contact *c, struct watch *watch)
{
	double last_moment = 1;
	int conjugate = 0, plain = 0;

	c->tau = contact_cell_stiffness(c);
	if (c->control == CONTACT_APPROACH)
		watch_steps(watch);
	for (long k = 0;; k++) {
		double moment, tau;
		struct sweep s;

		contact_gap(c);
		s = contact_optimality_sums(c);
		if (step_rises(watch, &s)) {
			conjugate = 0;
			plain += watch->slope >= 0;
		}
		moment = s.sum[2];
		c->result.optimality_gap = contact_optimality_gap(c, &s);
		if (c->result.optimality_gap <= c->tolerance &&
			(c->control == CONTACT_APPROACH || contact_carries(c, s.sum[1])))
			return CONTACT_OK;
		if (k == c->par.max_iterations ||
			contact_stalls(c, c->result.optimality_gap))
			return CONTACT_NOCONV;
		c->result.iterations++;
		if (c->cap < INFINITY && contact_lingers(c)) {
			plain = contact_gradient_due(c, &s);
			watch_steps(watch);
		}
		step_begins(watch, &s);
		if (plain > 0) {
			plain--;
			conjugate = 0;
			tau = c->tau;
			contact_gradient_step(c);
			c->tau = tau;
			step_ends(watch);
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
		step_ends(watch);
	}
}

enum contact_status contact_solve_pk(struct contact *c)
{
	struct watch watch = { .c = c };
	enum contact_status status = iterate(c, &watch);

	free(watch.before);
	return status;
}
