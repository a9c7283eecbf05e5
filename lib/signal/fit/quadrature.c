/* quadrature.c - see quadrature.h */
#include "signal/fit/quadrature.h"
#include "num/cholesky.h"
#include "num/sigmas.h"
#include "signal/fit/joint_state.h"
#include "signal/noise/robust.h"
#include <stdlib.h>
#include <string.h>

/* Parameters of a pulse: t, t + delta, a, b.  The columns of the joint fit for a pulse of
 * amplitude 1 are the functions of time by which the first two, and either amplitude,
 * change it. */
enum { T1, T2, A, B, PARAMETERS };

struct fit {
	const struct quadrature *q;
	/* Inverse covariance of the noise of x and v, in units of that of x, of each
	 * sensor: of x x, x v and v v. */
	double metric[2][3];
	const struct joint_scene *scene; /* with the present range of delays */
	struct joint *joint; /* with the columns; the record without pulses, x in e */
	const double *const *x, *const *v; /* and v in r */
	double left[2][2][BASIS_MAX]; /* sensor, component: its products with the basis */
	double *normal, *gradient;
};

/* Variances of x, v, x + v and x - v in fourth differences, where pulses are small. */
enum num_status quadrature_measure(struct quadrature *q, const double *const x[2],
	const double *const v[2], size_t n)
{
	double *sum = malloc((2 * n + 1) * sizeof *sum), *work;

	if (!sum)
		return NUM_MEMORY;
	work = sum + n;
	for (int c = 0; c < 2; c++) {
		double one = robust_noise(x[c], NULL, n, work),
		       two = robust_noise(v[c], NULL, n, work), plus, minus, r;

		if (!(one > 0) || !(two > 0)) /* too short or without noise */
			one = two = 1;
		for (size_t i = 0; i < n; i++)
			sum[i] = x[c][i] / one + v[c][i] / two;
		plus = robust_noise(sum, NULL, n, work);
		for (size_t i = 0; i < n; i++)
			sum[i] = x[c][i] / one - v[c][i] / two;
		minus = robust_noise(sum, NULL, n, work);
		r = (plus * plus - minus * minus) / (plus * plus + minus * minus);
		/* limited: the difference of equal components would have no error */
		q->correlation[c] = isfinite(r) ? fmax(fmin(r, 0.99), -0.99) : 0;
		q->noise[c] = two / one;
	}
	free(sum);
	return NUM_OK;
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

/* What is left of a component, 0 or 1, of sensor c. */
static struct piece rest_of(const struct fit *f, int c, int component)
{
	const struct joint *j = f->joint;

	return (struct piece){ 0, j->n, component ? j->r[c] : j->e[c],
		f->left[c][component] };
}

static void make_columns(struct joint *j, int i, const struct quadrature_pulse *p)
{
	j->pulse[i] = (struct joint_pulse){ .t = p->t, .delta = p->delta, .a = 1 };
	joint_make_columns(j, i);
	for (int c = 0; c < 2; c++)
		for (int k = 0; k < PAR; k++)
			joint_along(j, c, j->basis->vectors, j->col[i][c].first,
				j->col[i][c].d[k], j->col[i][c].n,
				joint_row(j, PAR * i + k, c));
}

/* Makes the columns of these pulses and subtracts them from the record; returns
 * chi-square. */
static double chi_square(struct fit *f, const struct quadrature_pulse *p)
{
	struct joint *j = f->joint;
	double chi2 = 0;

	for (int i = 0; i < j->m; i++)
		make_columns(j, i, &p[i]);
	for (int c = 0; c < 2; c++) {
		double *rest[2] = { j->e[c], j->r[c] };

		memcpy(rest[0], f->x[c], j->n * sizeof(double));
		for (size_t i = 0; i < j->n; i++)
			rest[1][i] = f->q->noise[c] * f->v[c][i];
		for (int i = 0; i < j->m; i++) {
			const struct column *col = &j->col[i][c];

			add_scaled(rest[0] + col->first, -p[i].a, col->d[A], col->n);
			add_scaled(rest[1] + col->first, -p[i].b, col->d[A], col->n);
		}
		for (int k = 0; k < 2; k++) {
			joint_hide(j, c, 0, j->n, rest[k]);
			joint_along(
				j, c, j->basis->vectors, 0, rest[k], j->n, f->left[c][k]);
		}
		for (int k = 0; k < 2; k++)
			for (int l = 0; l < 2; l++)
				chi2 += f->metric[c][k + l] * joint_inner(j,
								      rest_of(f, c, k),
								      rest_of(f, c, l));
	}
	return chi2;
}

/* Effect of parameter k of a pulse on its two components: the column that is returned,
 * times weight. */
static int component_of(const struct quadrature_pulse *p, int k, double weight[2])
{
	weight[0] = k == A ? 1 : k == B ? 0 : p->a;
	weight[1] = k == A ? 0 : k == B ? 1 : p->b;
	return k < A ? k : A;
}

static double form(const double metric[3], const double u[2], const double w[2])
{
	return u[0] * metric[0] * w[0] + (u[0] * w[1] + u[1] * w[0]) * metric[1] +
	       u[1] * metric[2] * w[1];
}

static void make_gradient(struct fit *f, const struct quadrature_pulse *p, int i)
{
	const struct joint *j = f->joint;

	for (int k = 0; k < PARAMETERS; k++) {
		double weight[2], sum = 0;
		int column = component_of(&p[i], k, weight);

		for (int c = 0; c < 2; c++) {
			double part[2];

			for (int l = 0; l < 2; l++)
				part[l] = joint_inner(j, joint_column(j, i, i, column, c),
					rest_of(f, c, l));
			sum += form(f->metric[c], weight, part);
		}
		f->gradient[PARAMETERS * i + k] = sum;
	}
}

static void make_block(struct fit *f, const struct quadrature_pulse *p, int i, int o)
{
	const struct joint *j = f->joint;
	int all = PARAMETERS * j->m;
	double of[2][PAR][PAR];

	for (int c = 0; c < 2; c++)
		for (int k = 0; k < PAR; k++)
			for (int l = 0; l < PAR; l++)
				of[c][k][l] = joint_inner(j, joint_column(j, i, i, k, c),
					joint_column(j, o, o, l, c));
	for (int k = 0; k < PARAMETERS; k++)
		for (int l = 0; l < PARAMETERS; l++) {
			double u[2], w[2], sum = 0;
			int fu = component_of(&p[i], k, u),
			    fw = component_of(&p[o], l, w);

			for (int c = 0; c < 2; c++)
				sum += form(f->metric[c], u, w) * of[c][fu][fw];
			f->normal[(PARAMETERS * i + k) * all + PARAMETERS * o + l] = sum;
		}
}

/* Normal matrix, factorised, and gradient of the columns as they are; NUM_DOMAIN:
 * singular. */
static enum num_status make_normal(struct fit *f, const struct quadrature_pulse *p)
{
	size_t all = PARAMETERS * (size_t)f->joint->m;

	for (int i = 0; i < f->joint->m; i++) {
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
	size_t all = PARAMETERS * (size_t)f->joint->m;

	for (int step = 0; step < STEPS; step++) {
		double after = INFINITY, gain;

		if (make_normal(f, p) != NUM_OK)
			return NUM_DOMAIN;
		cholesky_solve(f->normal, all, all, f->gradient);
		for (int k = 0; k < HALVES && !(after < *chi2); k++) {
			for (int i = 0; i < f->joint->m; i++)
				trial[i] = moved(f, &p[i], f->gradient + PARAMETERS * i,
					ldexp(1, -k));
			after = chi_square(f, trial);
		}
		gain = *chi2 - after;
		if (gain > 0) {
			memcpy(p, trial, (size_t)f->joint->m * sizeof *p);
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
	size_t all = PARAMETERS * (size_t)f->joint->m;
	double *x = f->gradient;

	for (int i = 0; i < f->joint->m; i++)
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
	const struct joint *j = f->joint;
	double of_x = 0, dof = -j->basis->taken - j->m, v;

	for (int c = 0; c < 2; c++) {
		dof += (double)joint_visible(j, c, 0, j->n) * (1 - j->scene.lost);
		of_x += joint_inner(j, rest_of(f, c, 0), rest_of(f, c, 0));
	}
	dof = fmax(dof, 1);
	v = (all - of_x) / dof;
	return v >
	       1 + CHI_SQUARE_MORE + 2 * fmax(chi2 - 1, 0) + SIGMAS_NEVER * sqrt(2 / dof);
}

enum num_status quadrature_fit(const struct quadrature *q, struct joint *joint,
	const struct joint_scene *scene, const double *const x[2],
	const double *const v[2], const struct joint_pulse *pulse, int m, double chi2,
	struct quadrature_pulse *out, int *doubt)
{
	struct fit f = { .q = q, .joint = joint, .scene = scene, .x = x, .v = v };
	size_t all = PARAMETERS * (size_t)m;
	enum num_status status = NUM_OK;
	double total;

	*doubt = 0;
	f.normal = malloc((all * all + all + 1) * sizeof *f.normal);
	if (!f.normal || joint_reserve_columns(joint, scene) != JOINT_OK) {
		free(f.normal);
		return NUM_MEMORY;
	}
	f.gradient = f.normal + all * all;
	make_metric(&f);
	joint->m = m;
	for (int i = 0; i < m; i++)
		out[i] = (struct quadrature_pulse){
			.t = pulse[i].t, .delta = pulse[i].delta, .a = pulse[i].a
		};
	total = chi_square(&f, out);
	if (m > 0)
		status = improve(&f, out, &total);
	if (status == NUM_OK) {
		fill_covariance(&f, out);
		*doubt = is_doubtful(&f, total, chi2);
	}
	free(f.normal);
	return status;
}
