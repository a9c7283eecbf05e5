/* Preconditioned bound-constrained conjugate gradients, one application of the
 * half-space per iteration.
 *
 * Active are the cells under pressure and those that overlap.  The gap there is
 * preconditioned with the inverse of the periodic half-space, E* |q| / 2 in Fourier
 * space, and made conjugate to the last step (Vollebregt, JOTA 2014).
 *
 * The half-space is applied not to the direction but to the step that is left of it
 * when pressures are kept within their bounds, with a step length carried over from
 * the iterations before.  This step is taken as it is, so the gap follows the pressure
 * exactly, whatever cells come and go.  The line search along it tells how much farther
 * or less far it should have gone, which the next direction makes up for; only a step so
 * long that the energy would rise is cut.
 *
 * What the bounds cut off is restored close by, in the blocks of blocks.h.
 *
 * The inverse of the half-space restricted to the contact is not the restricted
 * inverse: that needs a residual continued beyond the contact so that its image there
 * vanishes, see extension.h. */
#include "contact/state.h"
#include "num/fft.h"
#include "num/lanes.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the load, in the sum of the pressures of the step.  0.003 to 0.03 take 53 to 55
 * transforms (scenes as below), 0.1 and 0.3 60 and 66; each factor of ten takes about one
 * more sweep over the cells per step. */
static const double load_slack = 0.03;

/* Step length to begin with, and after a gradient step.  In tests/unit/exact.c,
 * contact_random.c and on 256 x 256 cells 0.25 to 1 take as many iterations within a
 * third, 0.5 the fewest of all together, 0.1 and 2 up to 40 % more. */
static const double FIRST_STEP = 0.5;

/* Step length below which one that leads uphill is replaced by a gradient step.  From
 * 1e-6 to 0.03 iterations are the same on the scenes of tests/unit/exact.c, and within a
 * tenth where such a step is cut to 1/2 or 1/16 in place of 1/4. */
static const double least_length = 1e-3;

/* Greatest length of a step, in its predicted length (beyond a bounded step the slope is
 * another), and the power of the length that the next prediction takes over: 2 to 3 and
 * 0.5 to 0.75 take 53 to 56 transforms alike over periodic and free surfaces of 256 and
 * 512 cells a side, 1.3 takes 66, 0 and 1 200 and 58; of the scenes of tests/unit/exact.c
 * strips take twice as many iterations with 2 and 0.5. */
static const double longest = 2.5, learned = 0.6;

/* Part of the active cells that a step may take to a bound without blocks: of 132
 * surfaces and three of 1024 and 2048 cells a side, 0 and 0.01 take as many iterations,
 * and 0.05 up to 21 in place of 15. */
static const double few = 0.01;

struct box {
	const struct contact_kernel *body;
	double lx, ly;
};

static double stiffness(const void *context, size_t kx, size_t ky)
{
	const struct box *b = context;
	double q = 2 * M_PI * hypot((double)kx / b->lx, (double)ky / b->ly);

	/* Only to begin with, see match_mean(). */
	if (kx == 0 && ky == 0)
		return 8 / b->body->wave(b->body->context, 2 * M_PI / fmax(b->lx, b->ly));
	return 1 / b->body->wave(b->body->context, q);
}

enum num_status contact_make_preconditioner(
	struct contact *c, const struct contact *lender)
{
	const struct convolve *scratch = lender ? lender->periodic : c->plane;
	struct box box = { .body = &c->body };
	size_t mx, my;

	/* Its levels are in use before the preconditioned residual is written there. */
	c->extension = extension_new(
		&c->par, lender ? lender->extension : NULL, c->residual, c->n);
	if (!c->extension)
		return NUM_MEMORY;
	extension_size(c->extension, &mx, &my);
	c->periodic = convolve_frame(
		(size_t)c->par.nx, (size_t)c->par.ny, mx, my, c->par.pool, scratch);
	if (!c->periodic)
		return NUM_MEMORY;
	c->inverse = convolve_alloc(c->periodic);
	c->active = malloc(c->n);
	if (!c->inverse || !c->active)
		return NUM_MEMORY;
	box.lx = (double)mx * c->par.dx;
	box.ly = (double)my * c->par.dy;
	return convolve_spectrum(c->periodic, c->inverse, stiffness, &box);
}

/* Pass over two cells at a time; sums are kept lane by lane. */
struct pass {
	lanes sum[SWEEP_SUMS], max;
};

static void add_pass(struct sweep *s, const struct pass *t)
{
	for (int k = 0; k < SWEEP_SUMS; k++)
		s->sum[k] += t->sum[k][0] + t->sum[k][1];
	s->max = fmax(s->max, fmax(t->max[0], t->max[1]));
}

static inline lanes within_bounds(const struct contact *c, lanes p)
{
	p = lanes_max(p, lanes_all(0));
	return lanes_pick(p < c->near_cap, p, lanes_all(c->cap));
}

static inline lane_mask are_free(const struct contact *c, lanes p)
{
	return lanes_and(p > 0.0, p < c->cap);
}

/* Runs a pass for cells begin to end in pairs and a last single one. */
#define PAIRS(cells)                                                        \
	const struct contact copy = *(struct contact *)context, *c = &copy; \
	struct pass t = { .max = lanes_all(-INFINITY) };                    \
	size_t i = begin;                                                   \
                                                                            \
	for (; i + 2 <= end; i += 2)                                        \
		cells(c, i, 2, &t);                                         \
	if (i < end)                                                        \
		cells(c, i, 1, &t);                                         \
	add_pass(s, &t)

/* The active cells, which are free or should become free because of their gap, and the
 * sums of contact_optimality_sums(), but for their number in place of the squares. */
static inline void find_cells(const struct contact *c, size_t i, int n, struct pass *t)
{
	lanes p = lanes_load(c->p + i, n);
	lanes g = lanes_load(c->gap + i, n) - c->result.approach;
	lanes below = lanes_min(g, lanes_all(0));
	lane_mask active =
		lanes_and(lanes_or(p > 0.0, g < 0.0), lanes_or(g > 0.0, p < c->cap));

	lanes_add(&t->sum[0], p * g, n);
	lanes_add(&t->sum[1], p, n);
	lanes_add(&t->sum[2], lanes_if(active, lanes_all(1)), n);
	lanes_add(&t->sum[3], p * below, n);
	lanes_add(&t->sum[4], below, n);
	t->max = lanes_max(t->max, -g);
	c->active[i] = (unsigned char)-active[0];
	c->active[i + (size_t)n - 1] = (unsigned char)-active[n - 1];
}

static void find_active(void *context, size_t begin, size_t end, struct sweep *s)
{
	PAIRS(find_cells);
}

/* Sums over the active cells for beta and the means. */
static inline void sum_cells(const struct contact *c, size_t i, int n, struct pass *t)
{
	lane_mask active = lanes_flags(c->active + i, n);
	lanes z = lanes_if(active, lanes_load(c->residual + i, n));
	lanes image = lanes_load(c->image + i, n);

	lanes_add(&t->sum[0], z, n);
	lanes_add(&t->sum[1], lanes_if(active, image), n);
	lanes_add(&t->sum[2], z * image, n);
	lanes_add(&t->sum[3], lanes_if(active, lanes_load(c->step + i, n)), n);
	lanes_add(&t->sum[4], lanes_if(active, lanes_all(1)), n);
}

static void sum_residual(void *context, size_t begin, size_t end, struct sweep *s)
{
	PAIRS(sum_cells);
}

/* The step of active cells along their direction, shifted, as far as the bounds let it;
 * sums it with the gap, itself, its size, the cells it leaves free. */
static inline void bound_cells(
	const struct contact *c, size_t i, int n, lanes direction, struct pass *t)
{
	lane_mask active = lanes_flags(c->active + i, n);
	lanes p = lanes_load(c->p + i, n);
	lanes g = lanes_load(c->gap + i, n) - c->result.approach;
	lanes next = within_bounds(c, p + c->tau * (direction + c->shift));
	lanes step = lanes_if(active, next - p);

	lanes_add(&t->sum[0], step * g, n);
	lanes_add(&t->sum[1], step, n);
	lanes_add(&t->sum[2], lanes_abs(step), n);
	lanes_add(&t->sum[3],
		lanes_if(lanes_and(active, are_free(c, next)), lanes_all(1)), n);
	lanes_store(c->step + i, step, n);
}

/* New direction, left in image, and its bounded step. */
static inline void turn_cells(const struct contact *c, size_t i, int n, struct pass *t)
{
	lanes direction =
		c->beta * lanes_load(c->step + i, n) - lanes_load(c->residual + i, n);

	lanes_store(c->image + i, direction, n);
	bound_cells(c, i, n, direction, t);
}

static void turn_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	PAIRS(turn_cells);
}

/* The same step for another shift. */
static inline void shift_cells(const struct contact *c, size_t i, int n, struct pass *t)
{
	bound_cells(c, i, n, lanes_load(c->image + i, n), t);
}

static void shift_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	PAIRS(shift_cells);
}

/* Takes the step; sums it, the pressure, the gap over free cells and their number, and
 * the work of the old pressure along the step. */
static inline void take_cells(const struct contact *c, size_t i, int n, struct pass *t)
{
	lanes p = lanes_load(c->p + i, n), image = lanes_load(c->image + i, n);
	lanes step = c->stretch * lanes_load(c->step + i, n);
	lanes next = within_bounds(c, p + step);
	lanes gap = lanes_load(c->gap + i, n) + c->stretch * image;
	lane_mask is = are_free(c, next);

	lanes_add(&t->sum[0], lanes_abs(step), n);
	lanes_add(&t->sum[1], next, n);
	lanes_add(&t->sum[2], lanes_if(is, gap), n);
	lanes_add(&t->sum[3], lanes_if(is, lanes_all(1)), n);
	lanes_add(&t->sum[4], p * image, n);
	lanes_store(c->gap + i, gap, n);
	lanes_store(c->p + i, next, n);
}

static void take_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	PAIRS(take_cells);
}

/* What an iteration hands to the next. */
struct state {
	double sum;       /* of the pressures */
	double curvature; /* step times image; 0: nothing to be conjugate to */
	double rest;      /* what the last step lacks, as a part of it */
	double moved;     /* sum of the last step; 0: it led nowhere */
	double bounded;   /* cells that the step takes to a bound */
	int plain;        /* steps along the gradient to go */
	int forced;       /* the step is to restore the load, whatever the energy */
	int crowded;      /* the active cells cannot carry more, or less */
	int exact;        /* gap and load have just been computed */
};

static void load_residual(void *context, size_t row, double *residual, int worker)
{
	const struct contact *c = context;

	extension_row(c->extension, row, residual, worker);
}

static int has_active(void *context, size_t row)
{
	const struct contact *c = context;
	size_t nx = (size_t)c->par.nx;

	return memchr(c->active + row * nx, 1, nx) != NULL;
}

/* The residual, extended and preconditioned, and the sums of sum_residual(). */
static struct sweep precondition(struct contact *c)
{
	const struct convolve_passes passes = { .load = load_residual,
		.y = c->residual,
		.wants = has_active,
		.pass = sum_residual,
		.context = c };

	c->result.work +=
		extension_solve(c->extension, c->active, c->gap, c->result.approach);
	c->result.transforms += 2;
	/* Two of the grid, which is a quarter of the padded one on a free boundary. */
	c->result.work += c->par.boundary == CONTACT_FREE ? 0.5 : 2;
	return convolve_run(c->periodic, c->inverse, &passes);
}

/* Of the active cells: their number, the sums of the preconditioned residual and of the
 * last step, and the load that the next is to bring. */
struct turn {
	double active, residual, step, missing;
};

/* Direction with beta times the last step, and its bounded step. */
static struct sweep turn(struct contact *c, const struct turn *t, double beta)
{
	c->beta = beta;
	c->shift = 0;
	if (c->control == CONTACT_PRESSURE)
		c->shift =
			(t->missing / c->tau + t->residual - beta * t->step) / t->active;
	return contact_sweep(c, turn_step);
}

/* The bounded step along the direction in image that carries what is missing; the last
 * pass is that of s.  Returns the load that is still missing. */
static double share_step(struct contact *c, double missing, struct sweep *s)
{
	if (c->control != CONTACT_PRESSURE)
		return 0;
	return contact_share_load(c, shift_step, missing, c->tau, load_slack, s);
}

/* The same, in blocks of cells as well. */
static double balance_blocks(
	struct contact *c, const struct turn *t, double missing, struct sweep *s)
{
	double rest;

	if (s->sum[3] >= (1 - few) * t->active)
		return share_step(c, missing, s);
	contact_keep_load(c);
	*s = contact_sweep(c, shift_step);
	rest = share_step(c, missing, s);
	if (s->sum[0] < 0)
		return rest;
	/* The last step is lost, so without it. */
	*s = turn(c, t, 0);
	return share_step(c, missing, s);
}

/* Direction and bounded step from the residual.  The direction is made conjugate to
 * the last step; with a given load the step makes up for what is missing.  Returns the
 * slope of the energy along the step. */
static double find_step(struct contact *c, struct state *state)
{
	int load_given = c->control == CONTACT_PRESSURE;
	double missing = c->target * (double)c->n - state->sum;
	double beta, mean, limit, rest;
	struct sweep s = precondition(c);
	struct turn t = { fmax(s.sum[4], 1), s.sum[0], s.sum[3], missing };

	mean = load_given ? s.sum[0] / t.active : 0;
	beta = state->curvature > 0 ? (s.sum[2] - mean * s.sum[1]) / state->curvature : 0;
	s = turn(c, &t, beta + state->rest / c->tau);
	rest = balance_blocks(c, &t, missing, &s);
	state->bounded = t.active - s.sum[3];
	/* No less than the rounding of the load. */
	limit = fmax(load_slack * s.sum[2], 1e-12 * c->target * (double)c->n);
	state->crowded = c->cap < INFINITY && fabs(rest) > limit;
	state->forced = load_given && fabs(missing) > s.sum[2] / 2;
	return s.sum[0];
}

/* Applies the half-space to the step, finds how far to go along it, and goes. */
static void follow_step(struct contact *c, struct state *state, double slope)
{
	double length;
	struct sweep s;

	state->moved = state->curvature = state->rest = 0;
	if (!(slope < 0 || state->forced))
		return;
	state->curvature = contact_multiply_step(c);
	if (!(state->curvature > 0)) {
		state->curvature = 0;
		return;
	}
	length = state->forced ? 1 : fmin(-slope / state->curvature, longest);
	/* Beyond twice the length that is best the energy rises. */
	c->stretch = length < 0.5 ? length : 1;
	state->rest = length < 0.5 ? 0 : length - 1;
	s = contact_sweep(c, take_step);
	c->tau *= pow(length, learned);
	state->moved = s.sum[0];
	state->sum = s.sum[1];
	state->exact = 0;
	c->work += c->stretch * (2 * s.sum[4] + c->stretch * state->curvature);
	if (c->control == CONTACT_PRESSURE && s.sum[3] > 0)
		c->result.approach = s.sum[2] / s.sum[3];
	else
		contact_find_approach(c);
}

/* The gap from the pressure, after correction of the load. */
static void renew_gap(struct contact *c, struct state *state)
{
	state->exact = 1;
	if (c->control == CONTACT_PRESSURE) {
		state->sum = contact_scale_load(c, c->cap < INFINITY);
		state->sum = contact_place_rest(c, state->sum);
		state->exact = contact_carries(c, state->sum);
	}
	contact_gap(c);
	state->rest = 0;
}

/* The preconditioner for the mean residual, which counts only where the approach is
 * given.  The load that corrects an error d of the approach depends on the arrangement of
 * the contacts, not on the length of the grid.  Of all multiples of the pressure, d F /
 * sum p u times it lowers the energy most; its load F, spread over the active cells, is
 * the step of the mean.  Forty contacts of 256 x 256 cells and of strips take 1.2 times
 * as many iterations as with the load, and 1.1 to 3.7 times with 8 times the stiffness of
 * the longest wave.
 */
static void match_mean(struct contact *c, const struct sweep *s)
{
	double load = s->sum[1], active = s->sum[2], mean;
	size_t mx, my;

	if (c->control != CONTACT_APPROACH || !(active > 0 && c->work > 0))
		return;
	mean = load / c->work * (load / active);
	extension_size(c->extension, &mx, &my);
	if (mean > 0 && isfinite(mean))
		c->inverse[0] = mean / ((double)mx * (double)my);
}

static double optimality_gap(struct contact *c)
{
	struct sweep s = contact_sweep(c, find_active);

	match_mean(c, &s);
	return c->result.optimality_gap = contact_optimality_gap(c, &s);
}

/* A step along the gradient, and from then on as from the start. */
static void step_plainly(struct contact *c, struct state *state)
{
	contact_gradient_step(c);
	renew_gap(c, state);
	state->curvature = 0;
	c->tau = FIRST_STEP;
	state->plain -= state->plain > 0;
}

enum contact_status contact_solve_bccg(struct contact *c)
{
	struct state state = { 0 };

	c->tau = FIRST_STEP;
	renew_gap(c, &state);
	for (long k = 0;; k++) {
		double relative = optimality_gap(c), slope;

		if (relative <= c->tolerance && !state.exact) {
			renew_gap(c, &state);
			relative = optimality_gap(c);
		}
		if (relative <= c->tolerance && state.exact)
			return CONTACT_OK;
		if (k == c->par.max_iterations || contact_stalls(c, relative))
			break;
		c->result.iterations++;
		if (contact_lingers(c)) {
			struct sweep s;

			renew_gap(c, &state);
			s = contact_sweep(c, find_active);
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
		/* A step bounded in one metric and preconditioned in another may lead
		 * uphill, the less the shorter it is; a plain one never does. */
		if (state.moved <= 0 && state.bounded > 0 && c->tau > least_length)
			c->tau /= 4;
		else
			state.plain = state.moved <= 0;
		if (state.moved <= 0)
			renew_gap(c, &state);
	}
	renew_gap(c, &state);
	return optimality_gap(c) <= c->tolerance && state.exact ? CONTACT_OK
								: CONTACT_NOCONV;
}
