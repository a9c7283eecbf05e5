#include "contact/state.h"
#include "num/fft.h"
#include "num/lanes.h"
#include <float.h>
#include <math.h>

/* What summation leaves uncertain of the load: equal terms may all be rounded one way. */
static double load_rounding(const struct contact *c)
{
	return DBL_EPSILON * sweep_terms(c->n) * c->target * (double)c->n;
}

struct sweep contact_sweep(struct contact *c, contact_pass *pass)
{
	return sweep_run(c->par.pool, c->n, pass, c);
}

/* y = K x, added to the counters, and a pass over y; y must not be x. */
static struct sweep multiply(
	struct contact *c, const double *x, double *y, contact_pass *pass)
{
	const struct convolve_passes passes = {
		.x = x, .y = y, .pass = pass, .context = c
	};

	if (c->mlms) {
		mlms_apply(c->mlms, x, y);
		return contact_sweep(c, pass);
	}
	c->result.transforms += 2;
	c->result.work += 2;
	return convolve_run(c->plane, c->kernel, &passes);
}

static void multiply_step(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact *c = context;
	lanes sum = lanes_all(0);
	size_t i = begin;

	for (; i + 2 <= end; i += 2)
		sum += lanes_load(c->step + i, 2) * lanes_load(c->image + i, 2);
	if (i < end)
		lanes_add(&sum, lanes_all(c->step[i] * c->image[i]), 1);
	s->sum[0] += sum[0] + sum[1];
}

double contact_multiply_step(struct contact *c)
{
	return multiply(c, c->step, c->image, multiply_step).sum[0];
}

/* The gap at first contact from the displacement, which it replaces: its sum and count
 * over free cells, the work of the pressure, and the least displacement. */
static void subtract_height(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double u = c->gap[i], gap = u - (c->h[i] - c->top);
		int is = is_free(c, c->p[i]);

		t.sum[0] += is ? gap : 0;
		t.sum[1] += is;
		t.sum[2] += c->p[i] * u;
		t.min = u < t.min ? u : t.min;
		c->gap[i] = gap;
	}
	*s = t;
}

static void sum_free(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact *c = context;

	for (size_t i = begin; i < end; i++) {
		int is = is_free(c, c->p[i]);

		s->sum[0] += is ? c->gap[i] : 0;
		s->sum[1] += is;
	}
}

/* The least gap of the cells without contact, negative. */
static void least_empty(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact *c = context;

	for (size_t i = begin; i < end; i++)
		if (c->p[i] <= 0 && -c->gap[i] > s->max)
			s->max = -c->gap[i];
}

/* Cells with a gap up to c->shift; the greatest of those gaps, the least of the others.
 */
static void count_below(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact *c = context;

	for (size_t i = begin; i < end; i++) {
		double g = c->gap[i];

		if (g <= c->shift) {
			s->sum[0] += 1;
			s->max = g > s->max ? g : s->max;
		} else if (g < s->min) {
			s->min = g;
		}
	}
}

/* The gap that has the given rank among all, counted from 1: bisection between gaps that
 * occur. */
static double gap_of_rank(struct contact *c, double rank)
{
	struct sweep s;
	double low, high;

	c->shift = -INFINITY;
	low = contact_sweep(c, count_below).min;
	c->shift = INFINITY;
	high = contact_sweep(c, count_below).max;
	while (low < high) {
		double middle = low + (high - low) / 2;

		c->shift = middle < high ? middle : low;
		s = contact_sweep(c, count_below);
		if (s.sum[0] >= rank)
			high = s.max;
		else
			low = s.min;
	}
	return low;
}

/* The approach that minimises the duality gap where every cell is empty or at the
 * hardness: as many cells as carry the load have a gap below it.  Where that number is
 * whole, the middle of the interval that serves. */
static double approach_of_load(struct contact *c)
{
	double cells = c->target / c->cap * (double)c->n;
	/* Of the load, the hardness, their ratio and the product: four, and as many of
	 * the numbers that they were computed from. */
	double rounding = 8 * DBL_EPSILON * cells;
	double first = fmax(ceil(cells - rounding), 1);
	double last = fmin(floor(cells + rounding) + 1, (double)c->n);

	return (gap_of_rank(c, first) + gap_of_rank(c, fmax(first, last))) / 2;
}

static void set_approach(struct contact *c, double sum, double count)
{
	if (c->control == CONTACT_APPROACH)
		c->result.approach = c->target;
	else if (count > 0)
		c->result.approach = sum / count;
	else if (c->cap < INFINITY)
		c->result.approach = approach_of_load(c);
	else
		c->result.approach = -contact_sweep(c, least_empty).max;
}

void contact_find_approach(struct contact *c)
{
	struct sweep s = contact_sweep(c, sum_free);

	set_approach(c, s.sum[0], s.sum[1]);
}

void contact_gap(struct contact *c)
{
	struct sweep s = multiply(c, c->p, c->gap, subtract_height);

	c->work = s.sum[2];
	c->least = fmin(s.min, 0);
	set_approach(c, s.sum[0], s.sum[1]);
}

static void sum_optimality(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		double p = c->p[i], g = gap_at(c, i), below = g < 0 ? g : 0;

		t.sum[0] += p * g;
		t.sum[1] += p;
		t.sum[2] += is_free(c, p) * (g * g);
		t.sum[3] += p * below;
		t.sum[4] += below;
		t.max = -g > t.max ? -g : t.max;
	}
	*s = t;
}

struct sweep contact_optimality_sums(struct contact *c)
{
	return contact_sweep(c, sum_optimality);
}

/* Approximate displacement by a uniform pressure on the grid: pi times that of a wave as
 * long as the grid. */
static double sinking(const struct contact *c, double pressure)
{
	double length = fmax(c->par.nx * c->par.dx, c->par.ny * c->par.dy);

	return pressure * M_PI * c->body.wave(c->body.context, 2 * M_PI / length);
}

double contact_optimality_gap(struct contact *c, const struct sweep *s)
{
	double sum = s->sum[1], work = c->work - sum * c->least, excess, rounding;
	double plastic = s->sum[4] < 0 ? -c->cap * s->sum[4] : 0;

	if (sum <= 0)
		return s->max > 0 ? INFINITY : 0;
	if (!isfinite(work))
		return INFINITY;
	/* The gap at the approach that is, and at the highest that lets nothing overlap.
	 */
	if (c->control == CONTACT_PRESSURE)
		excess = fmin(s->sum[0] + sum * s->max, s->sum[0] + plastic);
	else if (c->cap < INFINITY)
		excess = s->sum[0] + plastic;
	else
		excess = s->sum[0] - s->sum[3] + sum * fmax(s->max, 0);
	/* A flat surface in full periodic contact stores no energy at all. */
	rounding = 16 * DBL_EPSILON * sum *
		   (fabs(c->result.approach) + sinking(c, sum / (double)c->n));
	if (excess <= 0 || (excess <= rounding && work <= rounding))
		return 0;
	return work > 0 ? excess / work : INFINITY;
}

double contact_cell_stiffness(const struct contact *c)
{
	double width = sqrt(c->par.dx * c->par.dy);

	/* Approximated by half the largest wavenumber that the cell resolves: 2 / width
	 * gives the stiffness E* / width. */
	return 1 / c->body.wave(c->body.context, 2 / width);
}

double contact_energy(const struct contact *c, const struct sweep *s)
{
	double free_work = s->sum[0] - c->work / 2;

	return c->control == CONTACT_APPROACH
		       ? free_work
		       : free_work + c->result.approach * s->sum[1];
}

int contact_carries(const struct contact *c, double sum)
{
	return fabs(sum - c->target * (double)c->n) <= load_rounding(c);
}

int contact_stalls(struct contact *c, double optimality_gap)
{
	/* Four rounds of gradient.c.  With no limit, the solves that converge wait at
	 * most 25 iterations for a fall by a tenth, and 60 for one by a half: both
	 * solvers on 1500 problems as in tests/unit/contact_random.c, half of them with a
	 * hardness, 1100 as in hardness.c, tests/unit/exact.c and contact.c, and the
	 * scenes of tests/bench/contact.c to 512 x 512 and 1e-12, of up to 428
	 * iterations. */
	const double fall = 0.9;
	const long patience = 4 * GRADIENT_ROUND;

	/* The gap falls geometrically, from about 1. */
	if (c->par.progress)
		c->par.progress(c->par.context,
			fmin(fmax(log(optimality_gap) / log(c->tolerance), 0), 1));
	if (optimality_gap < fall * c->best) {
		c->best = optimality_gap;
		c->since = 0;
	}
	return c->since++ >= patience;
}

static void sum_load(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		if (c->p[i] >= c->cap)
			t.sum[0] += c->p[i];
		else
			t.sum[1] += c->p[i];
		t.sum[2] += c->p[i] <= 0;
	}
	*s = t;
}

static void scale_free(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	(void)s;
	for (size_t i = begin; i < end; i++)
		if (c->p[i] < c->cap)
			c->p[i] = fmin(c->p[i] * c->beta, c->cap);
}

static void scale_all(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	(void)s;
	for (size_t i = begin; i < end; i++)
		c->p[i] *= c->beta;
}

static void fill_empty(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	(void)s;
	for (size_t i = begin; i < end; i++)
		if (c->p[i] <= 0)
			c->p[i] = c->beta;
}

void contact_fill_empty(struct contact *c, double pressure)
{
	c->beta = pressure;
	contact_sweep(c, fill_empty);
}

double contact_scale_load(struct contact *c, int gently)
{
	double load = c->target * (double)c->n, fixed = 0, rest = 0;

	/* If cells reach the hardness, the other cells carry the rest. */
	for (int k = 0; k < 100; k++) {
		struct sweep s = contact_sweep(c, sum_load);

		fixed = s.sum[0];
		rest = s.sum[1];
		c->beta = (load - fixed) / rest;
		if (fabs(fixed + rest - load) <= 16 * DBL_EPSILON * load)
			break;
		/* Of 36 contacts at a hardness, limits of 0.05, 0.25, 0.5, 0.8 and 0.95
		 * and their inverses take bccg 324, 324, 324, 322 and 318 iterations and
		 * pk 2042, 2082, 2196, 2587 and 3193; one of pk does not converge from
		 * 0.8 on. */
		if (gently && !(c->beta > 0.5 && c->beta < 2))
			break;
		if (fixed >= load) {
			c->beta = load / (fixed + rest);
			contact_sweep(c, scale_all);
		} else if (rest > 0) {
			contact_sweep(c, scale_free);
		} else {
			contact_fill_empty(c, (load - fixed) / s.sum[2]);
		}
	}
	return fixed + rest;
}

double contact_place_rest(struct contact *c, double sum)
{
	double rest = c->target * (double)c->n - sum;
	size_t best = c->n;

	if (fabs(rest) >= c->cap || fabs(rest) <= load_rounding(c))
		return sum;
	for (size_t i = 0; i < c->n; i++) {
		if (is_free(c, c->p[i]))
			return sum;
		if (rest > 0 ? c->p[i] > 0 : c->p[i] <= 0)
			continue;
		if (best == c->n || (c->gap[i] < c->gap[best]) == (rest > 0))
			best = i;
	}
	if (best == c->n)
		return sum;
	c->p[best] = within(c, c->p[best] + rest);
	return sum + rest;
}

double contact_share_load(struct contact *c, contact_pass *pass, double missing,
	double rate, double slack, struct sweep *s)
{
	double low = -INFINITY, high = INFINITY, wide = 0, rest = missing - s->sum[1];

	for (int k = 0; k < 200 && fabs(rest) > slack * s->sum[2]; k++) {
		double next = NAN;

		*(rest > 0 ? &low : &high) = c->shift;
		if (s->sum[3] > 0)
			next = c->shift + rest / (rate * s->sum[3]);
		if (!(next > low && next < high))
			next = low + (high - low) / 2;
		if (!isfinite(next)) {
			wide = 2 * wide + (s->sum[2] + fabs(rest)) / rate;
			next = c->shift + (rest > 0 ? wide : -wide);
		}
		if (next == c->shift)
			break;
		c->shift = next;
		*s = contact_sweep(c, pass);
		rest = missing - s->sum[1];
	}
	return rest;
}
