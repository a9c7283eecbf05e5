/* Preconditioned bound-constrained conjugate gradients, one application of the
 * half-space per iteration.
 *
 * Active are the cells under pressure and those that overlap.  The gap there is
 * preconditioned with the inverse of the periodic half-space, E* |q| / 2 in Fourier
 * space, and made conjugate to the last step (Vollebregt, JOTA 2014).
 *
 * The half-space is applied not to the direction but to the step that is left of it
 * when pressures are kept within their bounds, with a step length carried over from
 * the iterations before.  So the gap follows the pressure exactly, whatever cells come
 * and go, and the line search along the step is exact as well; only the cells whose
 * pressure meets a bound between the guessed and the found step length leave a trace,
 * and the gap is recomputed when those add up.
 *
 * The inverse of the half-space restricted to the contact is not the restricted
 * inverse: that needs a residual continued beyond the contact so that its image there
 * vanishes, see extension.h. */
#include "contact/state.h"
#include "num/fft.h"
#include <math.h>
#include <stdlib.h>

static const double drift_limit = 0.02; /* of the step, in the sum of pressures */
static const double load_slack = 0.03;  /* of the step, in the same */

struct box {
	double estar, lx, ly;
};

static double stiffness(const void *context, size_t kx, size_t ky)
{
	const struct box *b = context;
	double q = hypot((double)kx / b->lx, (double)ky / b->ly);

	/* The mean counts only where the approach is given; about half the least
	 * wave number is right for it. */
	if (kx == 0 && ky == 0)
		q = 0.5 / fmax(b->lx, b->ly);
	return b->estar * M_PI * q;
}

int contact_make_preconditioner(struct contact *c, const struct contact *lender)
{
	const struct convolve *scratch = lender ? lender->periodic : c->plane;
	struct box box = { .estar = c->par.estar };
	size_t mx, my, room;
	double *memory;

	c->periodic = convolve_borrow((size_t)c->par.nx, (size_t)c->par.ny,
		c->par.boundary == CONTACT_FREE ? CONVOLVE_BRIDGED_FAR : CONVOLVE_BRIDGED,
		c->par.pool, scratch);
	if (!c->periodic)
		return -1;
	memory = convolve_scratch(c->periodic, &room);
	c->extension =
		extension_new(&c->par, lender ? lender->extension : NULL, memory, room);
	c->inverse = convolve_alloc(c->periodic);
	c->active = malloc(c->n);
	if (!c->extension || !c->inverse || !c->active)
		return -1;
	convolve_size(c->periodic, &mx, &my);
	box.lx = (double)mx * c->par.dx;
	box.ly = (double)my * c->par.dy;
	return convolve_spectrum(c->periodic, c->inverse, stiffness, &box);
}

/* The residual of the active cells, and the sums of the certificate. */
static void set_residual(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double p = c->p[i], g = gap_at(c, i);
		int active = is_active(c, p, g);

		certify_cell(c, p, g, &t);
		c->active[i] = (unsigned char)active;
		c->residual[i] = active * g;
	}
	*s = t;
}

/* Sums over the active cells for beta and the means. */
static void sum_residual(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double active = c->active[i];
		double z = active * c->residual[i];

		t.sum[0] += z;
		t.sum[1] += active * c->image[i];
		t.sum[2] += z * c->image[i];
		t.sum[3] += active * c->step[i];
		t.sum[4] += active;
	}
	*s = t;
}

/* Sums over a bounded step: with the gap, itself, its size, the cells it leaves free. */
static inline void sum_bounded(
	const struct contact *c, size_t i, double g, double step, struct sweep *s)
{
	s->sum[0] += step * g;
	s->sum[1] += step;
	s->sum[2] += fabs(step);
	s->sum[3] += is_free(c, c->p[i] + step);
}

/* The step of an active cell along its direction, shifted, as far as the bounds let it.
 */
static inline double bounded_step(const struct contact *c, size_t i, double d)
{
	double p = c->p[i];

	return c->active[i] * (within(c, p + c->tau * (d + c->shift)) - p);
}

/* New direction, left in image, and its bounded step. */
static void turn_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double d = c->beta * c->step[i] - c->residual[i];
		double step = bounded_step(c, i, d);

		c->image[i] = d;
		c->step[i] = step;
		sum_bounded(c, i, gap_at(c, i), step, &t);
	}
	*s = t;
}

/* The same step for another shift. */
static void shift_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double step = bounded_step(c, i, c->image[i]);

		c->step[i] = step;
		sum_bounded(c, i, gap_at(c, i), step, &t);
	}
	*s = t;
}

/* Takes the stretched step, but cells that had come to a bound stay there; sums what
 * that and the bounds changed, the step, the pressure, the gap over free cells and their
 * number, and the work of the old pressure along the step. */
static void take_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;
	double a = c->stretch;

	for (size_t i = begin; i < end; i++) {
		double step = c->step[i], bound = c->p[i] + step;
		double wanted = c->p[i] + a * step, next = within(c, wanted);
		double gap = c->gap[i] + a * c->image[i];

		next = is_free(c, bound) ? next : within(c, bound);
		t.sum[0] += fabs(next - wanted);
		t.sum[1] += fabs(a * step);
		t.sum[2] += next;
		t.sum[3] += is_free(c, next) * gap;
		t.sum[4] += is_free(c, next);
		t.sum[5] += c->p[i] * c->image[i];
		c->gap[i] = gap;
		c->p[i] = next;
	}
	*s = t;
}

/* What an iteration hands to the next. */
struct state {
	double sum;       /* of the pressures */
	double curvature; /* step times image; 0: nothing to be conjugate to */
	double drift;     /* how far gap and pressure are apart, as a sum of pressures */
	double moved;     /* sum of the last step; 0: it led nowhere */
	double bounded;   /* cells that the step takes to a bound */
	int plain, retreat; /* steps along the gradient to go; last time */
	int forced;         /* the step is to restore the load, whatever the energy */
	int crowded;        /* the active cells cannot bear more, or less */
	int exact;          /* gap and load have just been computed */
};

static void precondition(struct contact *c)
{
	convolve_apply(c->periodic, c->inverse, c->residual, c->residual);
	c->result.transforms += 2;
	c->result.work += c->par.boundary == CONTACT_FREE ? 0.5 : 2;
}

/* Direction and bounded step from the residual.  The direction is made conjugate to
 * the last step; with a given load the step makes up for what is missing.  Returns the
 * slope of the energy along the step. */
static double find_step(struct contact *c, struct state *state)
{
	int load_given = c->control == CONTACT_PRESSURE;
	double missing = c->target * (double)c->n - state->sum;
	double count, mean, limit, rest = 0;
	struct sweep s;

	c->result.work += extension_apply(c->extension, c->active, c->residual);
	precondition(c);
	s = contact_sweep(c, sum_residual);
	count = fmax(s.sum[4], 1);
	mean = load_given ? s.sum[0] / count : 0;
	c->beta = state->curvature > 0 ? (s.sum[2] - mean * s.sum[1]) / state->curvature
				       : 0;
	c->shift = load_given ? (missing / c->tau + s.sum[0] - c->beta * s.sum[3]) / count
			      : 0;
	s = contact_sweep(c, turn_step);
	if (load_given)
		rest = contact_share_load(c, shift_step, missing, c->tau, load_slack, &s);
	state->bounded = count - s.sum[3];
	limit = fmax(load_slack * s.sum[2], 1e-12 * c->target * (double)c->n);
	state->crowded = c->cap < INFINITY && fabs(rest) > limit;
	state->forced = load_given && fabs(missing) > s.sum[2] / 2;
	return s.sum[0];
}

/* Applies the half-space to the step, finds how far to go along it, and goes. */
static void follow_step(struct contact *c, struct state *state, double slope)
{
	struct sweep s;

	state->curvature = contact_multiply(c, c->step, c->image);
	state->moved = 0;
	if (!(state->curvature > 0) || !(slope < 0 || state->forced)) {
		state->curvature = 0;
		return;
	}
	/* Far beyond a bounded step lies something else than what it was made for. */
	c->stretch = fmin(-slope / state->curvature, state->bounded > 0 ? 2 : 10);
	if (state->forced)
		c->stretch = 1;
	s = contact_sweep(c, take_step);
	c->tau = fmin(fmax(c->tau * sqrt(c->stretch), 0.05), 5);
	state->drift += s.sum[0];
	state->moved = s.sum[1];
	state->sum = s.sum[2];
	state->exact = 0;
	c->work += c->stretch * (2 * s.sum[5] + c->stretch * state->curvature);
	if (c->control == CONTACT_PRESSURE && s.sum[4] > 0)
		c->result.approach = s.sum[3] / s.sum[4];
	else
		contact_find_approach(c);
}

/* The gap from the pressure, once what the load is short of has been put right. */
static void renew_gap(struct contact *c, struct state *state)
{
	state->exact = 1;
	if (c->control == CONTACT_PRESSURE) {
		state->sum = contact_scale_load(c, c->cap < INFINITY);
		state->sum = contact_place_rest(c, state->sum);
		state->exact = contact_carries(c, state->sum);
	}
	contact_gap(c);
	state->drift = 0;
}

static double certify(struct contact *c)
{
	struct sweep s = contact_sweep(c, set_residual);

	return c->result.certificate = contact_certificate(c, &s);
}

/* A step along the gradient, and from then on as from the start. */
static void step_plainly(struct contact *c, struct state *state)
{
	contact_gradient_step(c);
	renew_gap(c, state);
	state->curvature = 0;
	c->tau = 0.5;
	state->plain -= state->plain > 0;
}

enum contact_status contact_solve_bccg(struct contact *c)
{
	struct state state = { 0 };

	c->tau = 0.5;
	renew_gap(c, &state);
	for (long k = 0;; k++) {
		double certificate = certify(c), slope;

		if (certificate <= c->tolerance && !state.exact) {
			renew_gap(c, &state);
			certificate = certify(c);
		}
		if (certificate <= c->tolerance && state.exact)
			return CONTACT_OK;
		if (k == c->par.max_iterations || contact_stalls(c, certificate))
			break;
		c->result.iterations++;
		if (contact_lingers(c)) {
			struct sweep s;

			renew_gap(c, &state);
			s = contact_sweep(c, set_residual);
			state.plain = contact_gradient_due(c, &s);
		}
		if (state.plain > 0) {
			step_plainly(c, &state);
			continue;
		}
		slope = find_step(c, &state);
		if (state.crowded) {
			step_plainly(c, &state);
			continue;
		}
		follow_step(c, &state, slope);
		if (state.moved <= 0) {
			/* A step bounded in one metric and preconditioned in another
			 * may lead uphill; a plain one does not. */
			state.retreat = state.retreat < 32 ? 2 * state.retreat + 1 : 63;
			state.plain = state.retreat;
		}
		if (state.moved <= 0 || state.drift > drift_limit * state.moved)
			renew_gap(c, &state);
	}
	renew_gap(c, &state);
	return certify(c) <= c->tolerance && state.exact ? CONTACT_OK : CONTACT_NOCONV;
}
