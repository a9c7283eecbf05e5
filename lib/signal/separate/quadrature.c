/* quadrature.c - see quadrature.h */
#include "signal/separate/quadrature.h"
#include "num/cholesky.h"
#include "num/dot.h"
#include "num/sigmas.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Parameters of a pulse: t, t + delta, a, b; and functions of time on a sensor: the
 * derivatives of a pulse of amplitude 1 by t and by t + delta, and the pulse. */
enum { T1, T2, A, B, PARAMETERS };
enum { BY_T1, BY_T2, PULSE, FUNCTIONS };

/* Position of a pulse on a sensor, its functions, and their products with the basis. */
struct part {
	long first;
	size_t n;
	double *f[FUNCTIONS];
	double *along[FUNCTIONS];
};

struct fit {
	const struct quadrature *q;
	/* Inverse covariance of the noise of x and v, in units of that of x, of each
	 * sensor: of x x, x v and v v. */
	double metric[2][3];
	const struct joint *joint;
	const struct joint_scene *scene;
	const double *x[2], *v[2]; /* sensor: the two components */
	size_t n;
	int m, basis;
	const double *vector[2]; /* of the basis of offset, baseline and tones, ... */
	double taken;            /* ... and the degrees of freedom that it takes */
	size_t support;
	struct part *part;  /* 2 m */
	double *memory;     /* of their functions and products */
	double *rest[2][2]; /* sensor, component: the record without pulses */
	double *left[2][2]; /* their products with the basis */
	double *normal, *gradient;
};

/* Variances of x, v, x + v and x - v in fourth differences, where pulses are small. */
enum num_status quadrature_measure(struct quadrature *q, const double *const x[2],
	const double *const v[2], size_t n)
{
	double *sum = malloc((n ? n : 1) * sizeof *sum),
	       *work = malloc((n ? n : 1) * sizeof *work);
	int enough;

	for (int c = 0; c < 2 && sum && work; c++) {
		double one = robust_noise(x[c], n, work),
		       two = robust_noise(v[c], n, work), plus, minus, r;

		if (!(one > 0) || !(two > 0)) /* too short or without noise */
			one = two = 1;
		for (size_t i = 0; i < n; i++)
			sum[i] = x[c][i] / one + v[c][i] / two;
		plus = robust_noise(sum, n, work);
		for (size_t i = 0; i < n; i++)
			sum[i] = x[c][i] / one - v[c][i] / two;
		minus = robust_noise(sum, n, work);
		r = (plus * plus - minus * minus) / (plus * plus + minus * minus);
		/* limited: the difference of equal components would have no error */
		q->correlation[c] = isfinite(r) ? fmax(fmin(r, 0.99), -0.99) : 0;
		q->noise[c] = two / one;
	}
	enough = sum && work;
	free(sum);
	free(work);
	return enough ? NUM_OK : NUM_MEMORY;
}

static void make_metric(struct fit *f)
{
	for (int c = 0; c < 2; c++) {
		double r = f->q->correlation[c], noise = f->q->noise[c];
		f->metric[c][0] = 1 / (1 - r * r);
		f->metric[c][1] = -r * f->metric[c][0] / noise;
		f->metric[c][2] = f->metric[c][0] / (noise * noise);
	}
}

static void fit_free(struct fit *f)
{
	free(f->part);
	free(f->memory);
	for (int c = 0; c < 2; c++)
		for (int k = 0; k < 2; k++) {
			free(f->rest[c][k]);
			free(f->left[c][k]);
		}
	free(f->normal);
	free(f->gradient);
}

static enum num_status fit_reserve(struct fit *f)
{
	const struct joint_scene *s = f->scene;
	double reach = shape_reach(s->shape), longest = s->delta_max + s->duration;
	size_t m = (size_t)f->m + 1, all = PARAMETERS * m, each,
	       basis = (size_t)f->basis + 1;
	double *at;

	f->support = (size_t)(2 * reach * joint_duration(s, fmax(longest, 0))) + 4;
	each = FUNCTIONS * (f->support + basis);
	f->part = malloc(2 * m * sizeof *f->part);
	f->memory = malloc(2 * m * each * sizeof *f->memory);
	f->normal = malloc(2 * all * all * sizeof *f->normal);
	f->gradient = malloc(2 * all * sizeof *f->gradient);
	for (int c = 0; c < 2; c++)
		for (int k = 0; k < 2; k++) {
			f->rest[c][k] = malloc(f->n * sizeof *f->rest[c][k]);
			f->left[c][k] = malloc(basis * sizeof *f->left[c][k]);
			if (!f->rest[c][k] || !f->left[c][k])
				return NUM_MEMORY;
		}
	if (!f->part || !f->memory || !f->normal || !f->gradient)
		return NUM_MEMORY;
	at = f->memory;
	for (size_t i = 0; i < 2 * m; i++)
		for (int k = 0; k < FUNCTIONS; k++, at += f->support + basis) {
			f->part[i].f[k] = at;
			f->part[i].along[k] = at + f->support;
		}
	return NUM_OK;
}

/* Functions of pulse i for the parameters p on sensor c.  Its duration grows with the
 * second arrival and decreases with the first. */
static void make_part(struct fit *f, int i, int c, const struct quadrature_pulse *p)
{
	const struct joint_scene *s = f->scene;
	struct part *part = &f->part[2 * i + c];
	double t0 = p->t + (c ? p->delta : 0), T = joint_duration(s, p->delta);
	double stretch = s->duration / s->transit, gain = c ? s->gain : 1;
	long first, last;

	first = shape_support(s->shape, t0, T, &part->n);
	last = first + (long)part->n;
	first = first < 0 ? 0 : first;
	last = last > (long)f->n ? (long)f->n : last;
	part->first = first;
	part->n = last > first ? (size_t)(last - first) : 0;
	if (part->n > f->support)
		part->n = f->support;
	shape_sample(s->shape, t0, T, first, part->n, part->f[PULSE], part->f[c],
		part->f[1 - c]);
	for (size_t k = 0; k < part->n; k++) {
		double by_t0 = part->f[c][k], by_T = part->f[1 - c][k] * stretch;

		part->f[BY_T1][k] = gain * (c ? -by_T : by_t0 - by_T);
		part->f[BY_T2][k] = gain * (c ? by_t0 + by_T : by_T);
		part->f[PULSE][k] *= gain;
	}
	for (int k = 0; k < FUNCTIONS; k++) {
		joint_hide(f->joint, c, first, part->n, part->f[k]);
		for (int b = 0; b < f->basis; b++)
			part->along[k][b] = dot(part->f[k],
				f->vector[c] + (size_t)b * f->n + first, part->n);
	}
}

/* Makes the parts of these pulses and subtracts them from the record; returns
 * chi-square. */
static double chi_square(struct fit *f, const struct quadrature_pulse *p)
{
	double chi2 = 0;

	for (int c = 0; c < 2; c++) {
		memcpy(f->rest[c][0], f->x[c], f->n * sizeof(double));
		for (size_t i = 0; i < f->n; i++)
			f->rest[c][1][i] = f->q->noise[c] * f->v[c][i];
		for (int i = 0; i < f->m; i++) {
			const struct part *part = &f->part[2 * i + c];

			make_part(f, i, c, &p[i]);
			for (size_t k = 0; k < part->n; k++) {
				double value = part->f[PULSE][k];

				f->rest[c][0][(size_t)part->first + k] -= p[i].a * value;
				f->rest[c][1][(size_t)part->first + k] -= p[i].b * value;
			}
		}
		for (int k = 0; k < 2; k++) {
			joint_hide(f->joint, c, 0, f->n, f->rest[c][k]);
			for (int b = 0; b < f->basis; b++)
				f->left[c][k][b] = dot(f->rest[c][k],
					f->vector[c] + (size_t)b * f->n, f->n);
		}
		for (int k = 0; k < 2; k++)
			for (int l = 0; l < 2; l++) {
				double product = dot(f->rest[c][k], f->rest[c][l], f->n);

				for (int b = 0; b < f->basis; b++)
					product -= f->left[c][k][b] * f->left[c][l][b];
				chi2 += f->metric[c][k + l] * product;
			}
	}
	return chi2;
}

/* Effect of parameter k of a pulse on its two components: the function of time that is
 * returned, times weight. */
static int component_of(const struct quadrature_pulse *p, int k, double weight[2])
{
	weight[0] = k == A ? 1 : k == B ? 0 : p->a;
	weight[1] = k == A ? 0 : k == B ? 1 : p->b;
	return k < A ? k : PULSE;
}

/* Product of function k of x and l of y, without what lies in the basis. */
static double product(
	const struct fit *f, const struct part *x, int k, const struct part *y, int l)
{
	double sum = dot_within(x->f[k], x->n, y->f[l], y->n, x->first - y->first);

	for (int b = 0; b < f->basis; b++)
		sum -= x->along[k][b] * y->along[l][b];
	return sum;
}

static double form(const double metric[3], const double u[2], const double w[2])
{
	return u[0] * metric[0] * w[0] + (u[0] * w[1] + u[1] * w[0]) * metric[1] +
	       u[1] * metric[2] * w[1];
}

static void make_gradient(struct fit *f, const struct quadrature_pulse *p, int i)
{
	for (int k = 0; k < PARAMETERS; k++) {
		double weight[2], sum = 0;
		int function = component_of(&p[i], k, weight);

		for (int c = 0; c < 2; c++) {
			const struct part *part = &f->part[2 * i + c];
			double along[2];

			for (int l = 0; l < 2; l++) {
				along[l] = dot(part->f[function],
					f->rest[c][l] + part->first, part->n);
				for (int b = 0; b < f->basis; b++)
					along[l] -= part->along[function][b] *
						    f->left[c][l][b];
			}
			sum += form(f->metric[c], weight, along);
		}
		f->gradient[PARAMETERS * i + k] = sum;
	}
}

static void make_block(struct fit *f, const struct quadrature_pulse *p, int i, int j)
{
	int all = PARAMETERS * f->m;
	double of[2][FUNCTIONS][FUNCTIONS];

	for (int c = 0; c < 2; c++)
		for (int k = 0; k < FUNCTIONS; k++)
			for (int l = 0; l < FUNCTIONS; l++)
				of[c][k][l] = product(f, &f->part[2 * i + c], k,
					&f->part[2 * j + c], l);
	for (int k = 0; k < PARAMETERS; k++)
		for (int l = 0; l < PARAMETERS; l++) {
			double u[2], w[2], sum = 0;
			int fu = component_of(&p[i], k, u),
			    fw = component_of(&p[j], l, w);

			for (int c = 0; c < 2; c++)
				sum += form(f->metric[c], u, w) * of[c][fu][fw];
			f->normal[(PARAMETERS * i + k) * all + PARAMETERS * j + l] = sum;
		}
}

/* Normal matrix, factorised, and gradient of the parts as they are; NUM_DOMAIN:
 * singular. */
static enum num_status make_normal(struct fit *f, const struct quadrature_pulse *p)
{
	size_t all = PARAMETERS * (size_t)f->m;

	for (int i = 0; i < f->m; i++) {
		make_gradient(f, p, i);
		for (int j = 0; j <= i; j++)
			make_block(f, p, i, j);
	}
	return cholesky_factor(f->normal, all, all, 1e-13);
}

/* A step, limited as in the joint fit (joint_step.c). */
static struct quadrature_pulse moved(const struct fit *f,
	const struct quadrature_pulse *old, const double *step, double scale)
{
	const struct joint_scene *s = f->scene;
	double most = JOINT_STEP * s->duration,
	       span = JOINT_BEYOND * (s->delta_max - s->delta_min);
	struct quadrature_pulse p = *old;

	p.t += fmax(fmin(scale * step[T1], most), -most);
	p.delta += old->t - p.t + fmax(fmin(scale * step[T2], most), -most);
	p.delta = fmax(fmin(p.delta, s->delta_max + span), s->delta_min - span);
	p.a += scale * step[A];
	p.b += scale * step[B];
	return p;
}

/* Gauss-Newton steps, halved while chi-square does not decrease; after a fit of x, from
 * b = 0, three or four are enough. */
static enum num_status improve(struct fit *f, struct quadrature_pulse *p, double *chi2)
{
	enum { STEPS = 8, HALVES = 4 };
	struct quadrature_pulse trial[JOINT_PULSES_MAX];
	size_t all = PARAMETERS * (size_t)f->m;

	for (int step = 0; step < STEPS; step++) {
		double after = INFINITY, gain;

		if (make_normal(f, p) != NUM_OK)
			return NUM_DOMAIN;
		cholesky_solve(f->normal, all, all, f->gradient);
		for (int k = 0; k < HALVES && !(after < *chi2); k++) {
			for (int i = 0; i < f->m; i++)
				trial[i] = moved(f, &p[i], f->gradient + PARAMETERS * i,
					ldexp(1, -k));
			after = chi_square(f, trial);
		}
		gain = *chi2 - after;
		if (gain > 0) {
			memcpy(p, trial, (size_t)f->m * sizeof *p);
			*chi2 = after;
		}
		if (!(gain > 1e-4)) /* deviations of 1e-2 at most */
			break;
	}
	*chi2 = chi_square(f, p);
	return make_normal(f, p);
}

static void fill_covariance(struct fit *f, struct quadrature_pulse *p)
{
	size_t all = PARAMETERS * (size_t)f->m;
	double *x = f->gradient;

	for (int i = 0; i < f->m; i++)
		for (int k = 0; k < PARAMETERS; k++) {
			memset(x, 0, all * sizeof *x);
			x[PARAMETERS * i + k] = 1;
			cholesky_solve(f->normal, all, all, x);
			for (int l = 0; l < PARAMETERS; l++)
				p[i].cov[k][l] = x[PARAMETERS * i + l];
		}
}

/* 1 if chi-square of v, given x, exceeds that of noise, as in goodness.h, and by twice
 * the excess in x, whose pulses may be smaller. */
static int is_doubtful(const struct fit *f, double all, double chi2)
{
	double of_x = 0, dof = -f->taken - f->m, v;

	for (int c = 0; c < 2; c++) {
		dof += (double)joint_visible(f->joint, c, 0, f->n) * (1 - f->scene->lost);
		of_x += dot(f->rest[c][0], f->rest[c][0], f->n);
		for (int b = 0; b < f->basis; b++)
			of_x -= f->left[c][0][b] * f->left[c][0][b];
	}
	dof = fmax(dof, 1);
	v = (all - of_x) / dof;
	return v >
	       1 + CHI_SQUARE_MORE + 2 * fmax(chi2 - 1, 0) + SIGMAS_NEVER * sqrt(2 / dof);
}

enum num_status quadrature_fit(const struct quadrature *q, const struct joint *joint,
	const struct joint_scene *scene, const double *const x[2],
	const double *const v[2], size_t n, const struct joint_pulse *pulse, int m,
	double chi2, struct quadrature_pulse *out, int *doubt)
{
	struct fit f = { .q = q,
		.joint = joint,
		.scene = scene,
		.x = { x[0], x[1] },
		.v = { v[0], v[1] },
		.n = n,
		.m = m };
	enum num_status status;
	double all = NAN;

	*doubt = 0;
	make_metric(&f);
	for (int c = 0; c < 2; c++)
		f.vector[c] = joint_basis(joint, c, &f.basis, &f.taken);
	status = fit_reserve(&f);
	if (status == NUM_OK) {
		for (int i = 0; i < m; i++)
			out[i] = (struct quadrature_pulse){
				.t = pulse[i].t, .delta = pulse[i].delta, .a = pulse[i].a
			};
		all = chi_square(&f, out);
	}
	if (status == NUM_OK && m > 0)
		status = improve(&f, out, &all);
	if (status == NUM_OK) {
		fill_covariance(&f, out);
		*doubt = is_doubtful(&f, all, chi2);
	}
	fit_free(&f);
	return status;
}
