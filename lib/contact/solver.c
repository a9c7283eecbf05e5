#include "contact/kernel.h"
#include "contact/state.h"
#include "num/fft.h"
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Displacements to about 5e-8 of the largest: see tests/bench/contact.sh. */
enum { mlms_order = 8, mlms_reach = 18 };

static double free_kernel(const void *context, size_t ix, size_t iy)
{
	const struct contact_par *par = context;
	double patch = kernel_patch(
		par->dx, par->dy, (double)ix * par->dx, (double)iy * par->dy);

	return patch / (M_PI * par->estar);
}

static double periodic_kernel(const void *context, size_t kx, size_t ky)
{
	const struct contact_par *par = context;
	double qx = 2 * M_PI * (double)kx / (par->nx * par->dx);
	double qy = 2 * M_PI * (double)ky / (par->ny * par->dy);

	return kernel_periodic(par->estar, qx, qy);
}

static int positive(double x)
{
	return x > 0 && x <= DBL_MAX;
}

static int valid(const struct contact_par *par)
{
	return par->nx > 0 && par->ny > 0 && positive(par->dx) && positive(par->dy) &&
	       positive(par->estar) && par->hardness >= 0 && par->tolerance > 0 &&
	       par->max_iterations > 0 &&
	       (par->multiply == CONTACT_FFT || par->boundary == CONTACT_FREE);
}

static int make_kernel(struct contact *c, const struct contact *lender)
{
	int is_free = c->par.boundary == CONTACT_FREE;

	if (c->par.multiply == CONTACT_MLMS) {
		c->mlms = mlms_new((size_t)c->par.nx, (size_t)c->par.ny, mlms_order,
			mlms_reach, free_kernel, &c->par, c->par.pool);
		return c->mlms ? 0 : -1;
	}
	c->plane = convolve_borrow((size_t)c->par.nx, (size_t)c->par.ny,
		is_free ? CONVOLVE_PADDED : CONVOLVE_PERIODIC, c->par.pool,
		lender ? lender->plane : NULL);
	if (!c->plane)
		return -1;
	c->kernel = convolve_alloc(c->plane);
	if (!c->kernel)
		return -1;
	if (is_free)
		return convolve_kernel(c->plane, c->kernel, free_kernel, &c->par);
	convolve_spectrum(c->plane, c->kernel, periodic_kernel, &c->par);
	return 0;
}

/* Each array starts on a cache line. */
static size_t padded(size_t n)
{
	return (n + 7) / 8 * 8;
}

static int make_coarse(struct contact *c);

/* Room for all arrays, and for what padding adds to two halves of the last. */
static size_t room(const struct contact_par *par, size_t n)
{
	return (par->solver == CONTACT_BCCG ? 4 : 3) * padded(n) + 16;
}

/* lender: a finer grid whose memory is free to use, or NULL. */
static struct contact *new_grid(
	const struct contact_par *par, const struct contact *lender)
{
	struct contact *c;

	if (!valid(par)) {
		errno = EDOM;
		return NULL;
	}
	c = calloc(1, sizeof(*c));
	if (!c)
		return NULL;
	c->par = *par;
	c->n = (size_t)par->nx * (size_t)par->ny;
	c->cap = par->hardness > 0 ? par->hardness : INFINITY;
	c->tolerance = par->tolerance;
	c->memory = lender ? NULL : fft_alloc(room(par, c->n));
	c->gap = lender ? lender->gap : c->memory;
	if (c->gap) {
		c->step = c->gap + padded(c->n);
		c->image = c->step + padded(c->n);
		c->residual = c->image + padded(c->n);
	}
	if (!c->gap || make_kernel(c, lender) != 0 ||
		(par->solver == CONTACT_BCCG &&
			(contact_make_preconditioner(c, lender) != 0 ||
				make_coarse(c) != 0))) {
		contact_free(c);
		errno = ENOMEM;
		return NULL;
	}
	return c;
}

/* While the coarser grid is at work this one needs none of its own arrays, and lends
 * them: four of its arrays fit into one, or on a strip into two and a bit. */
static int make_coarse(struct contact *c)
{
	struct contact_par par = c->par;

	if (!contact_can_halve(&par))
		return 0;
	if (par.nx > 1) {
		par.nx /= 2;
		par.dx *= 2;
	}
	if (par.ny > 1) {
		par.ny /= 2;
		par.dy *= 2;
	}
	c->coarse = new_grid(&par, c);
	if (!c->coarse)
		return -1;
	c->coarse_height = c->residual;
	c->coarse_pressure = c->residual + padded(c->coarse->n);
	return 0;
}

struct contact *contact_new(const struct contact_par *par)
{
	return new_grid(par, NULL);
}

void contact_free(struct contact *c)
{
	if (!c)
		return;
	contact_free(c->coarse);
	if (c->periodic != c->plane)
		convolve_free(c->periodic);
	mlms_free(c->mlms);
	convolve_free(c->plane);
	fft_free(c->kernel);
	fft_free(c->inverse);
	fft_free(c->memory);
	free(c->active);
	free(c);
}

const struct contact_result *contact_result(const struct contact *c)
{
	return &c->result;
}

struct sweep contact_sweep(struct contact *c,
	void (*pass)(void *context, size_t begin, size_t end, struct sweep *s))
{
	return sweep_run(c->par.pool, c->n, pass, c);
}

static void multiply_pairs(void *context, size_t begin, size_t end, struct sweep *s)
{
	const double *const *pair = context;

	for (size_t i = begin; i < end; i++)
		s->sum[0] += pair[0][i] * pair[1][i];
}

double contact_multiply(struct contact *c, const double *x, double *y)
{
	if (c->mlms) {
		const double *pair[2] = { x, y };

		mlms_apply(c->mlms, x, y);
		return sweep_run(c->par.pool, c->n, multiply_pairs, pair).sum[0];
	}
	c->result.transforms += 2;
	c->result.work += 2;
	return convolve_product(c->plane, c->kernel, x, y);
}

void contact_displacement(struct contact *c, const double *pressure, double *displacement)
{
	if (c->mlms)
		mlms_apply(c->mlms, pressure, displacement);
	else
		convolve_apply(c->plane, c->kernel, pressure, displacement);
}

static void subtract_height(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	(void)s;
	for (size_t i = begin; i < end; i++)
		c->gap[i] -= c->h[i];
}

/* Sum of the gap and count over free cells; least gap of the cells without contact
 * (as a maximum of -g), for when nothing is free. */
static void sum_free(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++) {
		int is = is_free(c, c->p[i]);

		t.sum[0] += is ? c->gap[i] : 0;
		t.sum[1] += is;
		if (c->p[i] <= 0 && -c->gap[i] > t.max)
			t.max = -c->gap[i];
	}
	*s = t;
}

static void find_approach(struct contact *c)
{
	struct sweep s;

	c->result.approach = c->target;
	if (c->control == CONTACT_APPROACH)
		return;
	s = contact_sweep(c, sum_free);
	c->result.approach = s.sum[1] > 0 ? s.sum[0] / s.sum[1] : -s.max;
}

void contact_gap(struct contact *c)
{
	contact_multiply(c, c->p, c->gap);
	contact_sweep(c, subtract_height);
	find_approach(c);
}

static void certify(void *context, size_t begin, size_t end, struct sweep *s)
{
	const struct contact copy = *(struct contact *)context, *c = &copy;
	struct sweep t = *s;

	for (size_t i = begin; i < end; i++)
		certify_cell(c, c->p[i], gap_at(c, i), &t);
	*s = t;
}

struct sweep contact_certify(struct contact *c)
{
	return contact_sweep(c, certify);
}

double contact_certificate(struct contact *c, const struct sweep *s)
{
	double sum = s->sum[1], excess;

	if (sum <= 0)
		return s->max > 0 ? INFINITY : 0;
	if (c->cap < INFINITY)
		excess = s->sum[3] + s->sum[4];
	else if (c->control == CONTACT_PRESSURE)
		excess = s->sum[0] + sum * s->max;
	else
		excess = s->sum[3] + sum * fmax(s->max, 0);
	return fmax(excess, 0) / (sum * c->scale);
}

int contact_stalls(struct contact *c, double certificate)
{
	const long patience = c->par.solver == CONTACT_PK ? 500 : 100;

	if (certificate < 0.9 * c->best) {
		c->best = certificate;
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

double contact_scale_load(struct contact *c, int gently)
{
	double load = c->target * (double)c->n, fixed = 0, rest = 0;

	/* Cells that reach the hardness on the way leave the rest to the others. */
	for (int k = 0; k < 100; k++) {
		struct sweep s = contact_sweep(c, sum_load);

		fixed = s.sum[0];
		rest = s.sum[1];
		c->beta = (load - fixed) / rest;
		if (fabs(fixed + rest - load) <= 4 * DBL_EPSILON * load)
			break;
		if (gently && !(c->beta > 0.5 && c->beta < 2))
			break;
		if (fixed >= load) {
			c->beta = load / (fixed + rest);
			contact_sweep(c, scale_all);
		} else if (rest > 0) {
			contact_sweep(c, scale_free);
		} else {
			c->beta = (load - fixed) / s.sum[2];
			contact_sweep(c, fill_empty);
		}
	}
	return fixed + rest;
}

static void survey(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	for (size_t i = begin; i < end; i++) {
		double p = c->p[i];

		s->sum[0] += c->h[i];
		if (!(p > 0))
			p = 0;
		if (p > c->cap)
			p = c->cap;
		c->p[i] = p;
		s->sum[1] += p;
		if (c->h[i] > s->max)
			s->max = c->h[i];
	}
}

static void spread(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	for (size_t i = begin; i < end; i++) {
		double d = c->h[i] - c->shift;

		s->sum[0] += d * d;
		s->sum[1] += d;
	}
}

static void final_sums(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;

	for (size_t i = begin; i < end; i++) {
		double p = c->p[i];

		s->sum[0] += p > 0;
		s->sum[1] += p >= c->cap;
		s->sum[2] += p;
		s->sum[3] += p * (c->gap[i] + c->h[i]);
		if (c->h[i] > s->max)
			s->max = c->h[i];
	}
}

/* A pressure that is about right for bodies that come together by depth. */
static double guess_pressure(const struct contact *c, double depth)
{
	double size = fmax(c->par.nx * c->par.dx, c->par.ny * c->par.dy);

	return fmin(c->par.estar * depth / size, c->cap / 2);
}

static enum contact_status prepare(struct contact *c)
{
	struct sweep s = contact_sweep(c, survey);
	double mean = s.sum[0] / (double)c->n, highest = s.max, guess = s.sum[1];
	double touch = -highest;

	if (!isfinite(s.sum[0]) || !isfinite(guess) || !isfinite(c->target))
		return CONTACT_NUMBERS;
	c->shift = mean;
	s = contact_sweep(c, spread);
	/* The second term is the rounding of the mean. */
	c->scale = sqrt(s.sum[0] / (double)c->n - pow(s.sum[1] / (double)c->n, 2));
	if (!isfinite(c->scale))
		return CONTACT_NUMBERS;
	if (c->control == CONTACT_PRESSURE) {
		if (c->target < 0)
			return CONTACT_NUMBERS;
		if (c->target >= c->cap)
			return CONTACT_OVERLOAD;
		c->beta = c->target;
	} else {
		if (c->par.boundary == CONTACT_PERIODIC && c->target >= -mean &&
			c->target > touch)
			return CONTACT_TOO_DEEP;
		c->beta = guess_pressure(c, c->target - touch);
	}
	if (c->scale <= 16 * DBL_EPSILON * fabs(mean)) /* flat: take a displacement */
		c->scale = fmax(c->par.nx * c->par.dx, c->par.ny * c->par.dy) *
			   (c->control == CONTACT_PRESSURE ? c->target : c->beta) /
			   c->par.estar;
	if (guess <= 0 && !contact_guess(c))
		contact_sweep(c, fill_empty);
	if (c->control == CONTACT_PRESSURE)
		contact_scale_load(c, 0);
	return CONTACT_OK;
}

/* Nothing to solve: no load, or an approach that does not reach the surface. */
static int is_apart(struct contact *c)
{
	struct sweep s;

	if (c->control == CONTACT_PRESSURE && c->target != 0)
		return 0;
	s = contact_sweep(c, survey);
	if (c->control == CONTACT_APPROACH && c->target > -s.max)
		return 0;
	memset(c->p, 0, c->n * sizeof(*c->p));
	c->result.approach = c->control == CONTACT_APPROACH ? c->target : -s.max;
	for (size_t i = 0; i < c->n; i++)
		c->gap[i] = -c->h[i];
	return 1;
}

enum contact_status contact_solve(struct contact *c, const double *height,
	enum contact_control control, double target, double *pressure, double *gap)
{
	enum contact_status status;
	struct sweep s;

	memset(&c->result, 0, sizeof(c->result));
	c->h = height;
	c->p = pressure;
	c->control = control;
	c->target = target;
	c->best = INFINITY;
	c->since = 0;
	if (is_apart(c)) {
		status = CONTACT_OK;
	} else {
		status = prepare(c);
		if (status == CONTACT_OK)
			status = c->par.solver == CONTACT_PK ? contact_solve_pk(c)
							     : contact_solve_bccg(c);
	}
	if (status != CONTACT_OK && status != CONTACT_NOCONV)
		return status;
	s = contact_sweep(c, final_sums);
	c->result.area = s.sum[0] / (double)c->n;
	c->result.plastic = s.sum[1] / (double)c->n;
	c->result.pressure = s.sum[2] / (double)c->n;
	c->result.load = s.sum[2] * c->par.dx * c->par.dy;
	c->result.energy = s.sum[3] / 2 * c->par.dx * c->par.dy;
	c->result.indentation = c->result.approach + s.max;
	for (size_t i = 0; gap && i < c->n; i++)
		gap[i] = gap_at(c, i);
	return status;
}
