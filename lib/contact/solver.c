#include "contact/solver.h"
#include "contact/state.h"
#include "num/fft.h"
#include "num/status.h"
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Displacements to about 5e-8 of the largest: see tests/bench/contact.sh. */
enum { mlms_order = 8, mlms_reach = 18 };

static double free_kernel(const void *context, size_t ix, size_t iy)
{
	const struct contact *c = context;
	double dx = c->par.dx, dy = c->par.dy;

	return c->body.patch(c->body.context, dx, dy, (double)ix * dx, (double)iy * dy);
}

static double periodic_kernel(const void *context, size_t kx, size_t ky)
{
	const struct contact *c = context;
	double qx = 2 * M_PI * (double)kx / (c->par.nx * c->par.dx);
	double qy = 2 * M_PI * (double)ky / (c->par.ny * c->par.dy);

	/* The mean displacement is taken as zero. */
	return kx + ky > 0 ? c->body.wave(c->body.context, hypot(qx, qy)) : 0;
}

static int positive(double x)
{
	return x > 0 && x <= DBL_MAX;
}

static int valid(const struct contact_par *par)
{
	return par->nx > 0 && par->ny > 0 && positive(par->dx) && positive(par->dy) &&
	       (par->kernel ? par->kernel->patch || par->boundary == CONTACT_PERIODIC
			    : positive(par->estar)) &&
	       par->hardness >= 0 && par->tolerance > 0 && par->max_iterations > 0 &&
	       (par->multiply == CONTACT_FFT || par->boundary == CONTACT_FREE);
}

static enum num_status make_kernel(struct contact *c, const struct contact *lender)
{
	int is_free = c->par.boundary == CONTACT_FREE;

	if (c->par.multiply == CONTACT_MLMS) {
		c->mlms = mlms_new((size_t)c->par.nx, (size_t)c->par.ny,
			c->par.dy / c->par.dx, mlms_order, mlms_reach, free_kernel, c,
			c->par.pool);
		return c->mlms ? NUM_OK : NUM_MEMORY;
	}
	c->plane = convolve_borrow((size_t)c->par.nx, (size_t)c->par.ny,
		is_free ? CONVOLVE_PADDED : CONVOLVE_PERIODIC, c->par.pool,
		lender ? lender->plane : NULL);
	if (!c->plane)
		return NUM_MEMORY;
	c->kernel = convolve_alloc(c->plane);
	if (!c->kernel)
		return NUM_MEMORY;
	if (is_free)
		return convolve_kernel(c->plane, c->kernel, free_kernel, c);
	return convolve_spectrum(c->plane, c->kernel, periodic_kernel, c);
}

/* Each array starts on a cache line. */
static size_t padded(size_t n)
{
	return (n + 7) / 8 * 8;
}

static enum num_status make_coarse(struct contact *c);

/* Each thread writes to what it will work on.  Pages of zeros that are read first would
 * be copied at their first write, for which the system stops the other threads. */
static void clear_cells(void *context, size_t begin, size_t end, struct sweep *s)
{
	struct contact *c = context;
	size_t size = (end - begin) * sizeof *c->gap;

	(void)s;
	memset(c->gap + begin, 0, size);
	memset(c->step + begin, 0, size);
	memset(c->image + begin, 0, size);
	if (c->par.solver == CONTACT_BCCG)
		memset(c->residual + begin, 0, size);
}

/* Room for all arrays; two coarse ones fit into the last or nearly so. */
static size_t room(const struct contact_par *par, size_t n)
{
	struct contact_par coarse;
	size_t two = 0;

	if (par->solver != CONTACT_BCCG)
		return 3 * padded(n);
	if (contact_can_coarsen(par, &coarse))
		two = 2 * padded((size_t)coarse.nx * (size_t)coarse.ny);
	return 3 * padded(n) + (two > padded(n) ? two : padded(n));
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
	c = calloc(1, sizeof *c);
	if (!c)
		return NULL;
	c->par = *par;
	c->body = par->kernel ? *par->kernel : kernel_halfspace(&c->par.estar);
	c->n = (size_t)par->nx * (size_t)par->ny;
	c->cap = par->hardness > 0 ? par->hardness : INFINITY;
	c->near_cap = c->cap * (1 - 4 * DBL_EPSILON);
	c->tolerance = par->tolerance;
	c->memory = lender ? NULL : fft_alloc(room(par, c->n));
	c->gap = lender ? lender->gap : c->memory;
	if (c->gap) {
		c->step = c->gap + padded(c->n);
		c->image = c->step + padded(c->n);
		c->residual = c->image + padded(c->n);
	}
	if (c->memory)
		contact_sweep(c, clear_cells);
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

/* While the coarser grid is in use this one does not need its arrays and lends them: four
 * arrays of the coarser grid fit into one, or for elongated grids into slightly more than
 * two. */
static enum num_status make_coarse(struct contact *c)
{
	struct contact_par par;

	if (!contact_can_coarsen(&c->par, &par))
		return NUM_OK;
	par.progress = NULL;
	c->coarse = new_grid(&par, c);
	if (!c->coarse || transfer_make(&c->transfer, &c->par, &par) != 0)
		return NUM_MEMORY;
	c->coarse_height = c->residual;
	c->coarse_pressure = c->residual + padded(c->coarse->n);
	return NUM_OK;
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
	transfer_done(&c->transfer);
	extension_free(c->extension);
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

void contact_displacement(struct contact *c, const double *pressure, double *displacement)
{
	if (c->mlms)
		mlms_apply(c->mlms, pressure, displacement);
	else
		convolve_apply(c->plane, c->kernel, pressure, displacement);
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
		s->max = c->h[i] > s->max ? c->h[i] : s->max;
		s->min = c->h[i] < s->min ? c->h[i] : s->min;
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
	}
}

/* Gaps of that size times pressures that make them must be within the numbers. */
static int is_in_range(const struct contact *c, double size)
{
	double narrow = fmin(c->par.dx, c->par.dy);
	double stiffest = 1 / c->body.wave(c->body.context, 2 / narrow);

	return isfinite(size * size * stiffest * (double)c->n);
}

/* Pressures need to be no better than what interpolation loses: 0.1 to 1e-3 take 60 to 70
 * transforms alike (256 x 256 at 5 to 60 %, free at 9 %), 1e-3 the most. */
static const double coarse_tolerance = 1e-2;

/* An initial guess from the coarser grids; 0 if they have none. */
static int guess_pressure(struct contact *c)
{
	struct contact *coarse = c->coarse;
	enum contact_status status;

	if (!coarse)
		return 0;
	contact_average_height(c);
	memset(c->coarse_pressure, 0, coarse->n * sizeof *c->coarse_pressure);
	coarse->tolerance = fmax(coarse_tolerance, c->tolerance);
	status = contact_solve(coarse, c->coarse_height, c->control,
		c->control == CONTACT_APPROACH ? c->target - c->top : c->target,
		c->coarse_pressure, NULL);
	c->result.work += coarse->result.work * (double)coarse->n / (double)c->n;
	if (status != CONTACT_OK && status != CONTACT_NOCONV)
		return 0;
	return contact_interpolate_pressure(c) > 0;
}

static enum contact_status prepare(struct contact *c, const struct sweep *s)
{
	double mean = s->sum[0] / (double)c->n, guess = s->sum[1];
	int load_given = c->control == CONTACT_PRESSURE;

	if (!isfinite(s->sum[0]) || !isfinite(guess) || !isfinite(c->target) ||
		!is_in_range(c, fmax(s->max, -s->min)))
		return CONTACT_NUMBERS;
	if (load_given && c->target < 0)
		return CONTACT_NUMBERS;
	if (load_given && c->target >= c->cap)
		return CONTACT_OVERLOAD;
	if (!load_given && c->par.boundary == CONTACT_PERIODIC &&
		c->target >= c->top - mean)
		return CONTACT_TOO_DEEP;
	/* At a given approach the cells that overlap tell where pressure is needed. */
	if (guess <= 0 && !guess_pressure(c) && load_given)
		contact_fill_empty(c, c->target);
	if (load_given)
		contact_scale_load(c, 0);
	return CONTACT_OK;
}

/* Nothing to solve: no load, or an approach that does not reach the surface. */
static int is_apart(struct contact *c)
{
	if (c->control == CONTACT_PRESSURE ? c->target != 0 : !(c->target <= 0))
		return 0;
	memset(c->p, 0, c->n * sizeof *c->p);
	c->work = 0;
	c->result.approach = c->control == CONTACT_APPROACH ? c->target : 0;
	for (size_t i = 0; i < c->n; i++)
		c->gap[i] = c->top - c->h[i];
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
	s = contact_sweep(c, survey);
	c->top = s.max;
	c->target = control == CONTACT_APPROACH ? target + c->top : target;
	c->best = INFINITY;
	c->energy = INFINITY;
	c->since = 0;
	if (is_apart(c)) {
		status = CONTACT_OK;
	} else {
		status = prepare(c, &s);
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
	/* Of the last contact_gap(): heights far from 0 would take digits off p u. */
	c->result.energy = fmax(c->work, 0) / 2 * c->par.dx * c->par.dy;
	for (size_t i = 0; gap && i < c->n; i++)
		gap[i] = gap_at(c, i);
	c->result.indentation = c->result.approach;
	c->result.approach =
		control == CONTACT_APPROACH ? target : c->result.indentation - c->top;
	return status;
}
