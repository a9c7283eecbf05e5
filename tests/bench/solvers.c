/* solvers - the joint fit's own Levenberg-Marquardt against those of GSL
 *
 * usage: solvers [SCENES]
 *
 * Scenes of M pulses, 0.5 to 1.5 V and at least 10 samples apart in 50 samples each, cut
 * as duet cuts them: 90 samples are kept on either side of the outermost.  All solvers
 * begin at the same guesses, off by up to 2 samples and a fifth of the amplitude, take
 * derivatives from shape_sample(), give covariances, and stop after a step that lowered
 * chi-square by less than 1e-4, or 50 steps.  GSL's memory is allocated beforehand.
 *
 * Solvers: joint is joint_refine(); multifit is gsl_multifit_nlinear, with the whole
 * Jacobian, by Levenberg-Marquardt (lm) or with geodesic acceleration (lmaccel), steps
 * solved by Cholesky or QR; multilarge is gsl_multilarge_nlinear, which is given J^T J,
 * made from the pulses that touch.  (Its acceleration wants second derivatives.)
 *
 * us and ratio: processor time of a fit, and over that of joint; medians.  steps: mean
 * number; GSL does not count rejected ones.  excess: median of chi-square above the
 * lowest minimum found, iterated to the end.  off, most: distance from there of the
 * farthest parameter in standard errors, median and largest; the sine ends in kinks, so
 * that chi-square has minima side by side, and every solver sometimes ends in another. */
#include "num/dot.h"
#include "num/philox.h"
#include "num/robust.h"
#include "signal/fit/joint.h"
#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_multilarge_nlinear.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PAR = 3, MOST = 12, EDGE = 90, N = MOST * 50 + 2 * EDGE + 10, SUPPORT = 160 };
enum { STEPS = 50, SCENES_MAX = 1000, SOLVERS_MAX = 8 };

/* The contribution of a pulse to a channel: derivatives by t1, t2 and a, the last being
 * its shape. */
struct column {
	long first;
	size_t n;
	double d[PAR][SUPPORT];
};

struct problem {
	const struct joint_scene *scene;
	int m;
	size_t n;
	double y[2][N];
	struct joint_pulse guess[MOST];
	struct column column[MOST][2];
};

struct outcome {
	double x[PAR * MOST], chi2, seconds;
	long steps;
};

static double now(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void sample_pulse(const struct problem *q, const double *x, int c,
	struct column *col, int derivatives)
{
	const struct joint_scene *s = q->scene;
	double T = s->duration * (1 + (x[1] - x[0]) / s->transit), t = x[c];
	double a = x[2] * (c ? s->gain : 1), stretch = s->duration / s->transit;
	double *by_t = col->d[c], *by_T = col->d[1 - c];
	size_t n;
	long first = shape_support(s->shape, t, T, &n), last = first + (long)n;

	first = first < 0 ? 0 : first;
	last = last > (long)q->n ? (long)q->n : last;
	col->first = first;
	col->n = last > first ? (size_t)(last - first) : 0;
	col->n = col->n < SUPPORT ? col->n : SUPPORT;
	shape_sample(s->shape, t, T, first, col->n, col->d[2], derivatives ? by_t : NULL,
		derivatives ? by_T : NULL);
	for (size_t k = 0; derivatives && k < col->n; k++) {
		double lengthen = by_T[k] * stretch;

		by_t[k] = a * (by_t[k] + (c ? lengthen : -lengthen));
		by_T[k] = a * (c ? -lengthen : lengthen);
		col->d[2][k] *= c ? s->gain : 1;
	}
}

static void make_columns(struct problem *q, const gsl_vector *x)
{
	for (int i = 0; i < q->m; i++)
		for (int c = 0; c < 2; c++)
			sample_pulse(q, x->data + PAR * i, c, &q->column[i][c], 1);
}

static int residual(const gsl_vector *x, void *params, gsl_vector *f)
{
	struct problem *q = params;

	for (int c = 0; c < 2; c++) {
		double *r = f->data + (size_t)c * q->n;

		for (size_t k = 0; k < q->n; k++)
			r[k] = -q->y[c][k];
		for (int i = 0; i < q->m; i++) {
			struct column *col = &q->column[i][c];
			double a = x->data[PAR * i + 2] * (c ? q->scene->gain : 1);

			sample_pulse(q, x->data + PAR * i, c, col, 0);
			for (size_t k = 0; k < col->n; k++)
				r[(size_t)col->first + k] += a * col->d[2][k];
		}
	}
	return GSL_SUCCESS;
}

static int jacobian(const gsl_vector *x, void *params, gsl_matrix *J)
{
	struct problem *q = params;

	gsl_matrix_set_zero(J);
	make_columns(q, x);
	for (int i = 0; i < q->m; i++)
		for (int c = 0; c < 2; c++) {
			const struct column *col = &q->column[i][c];
			size_t row = (size_t)c * q->n + (size_t)col->first;
			double *at = J->data + row * J->tda + PAR * i;

			for (size_t k = 0; k < col->n; k++, at += J->tda)
				for (int u = 0; u < PAR; u++)
					at[u] = col->d[u][k];
		}
	return GSL_SUCCESS;
}

/* Lower triangle of J^T J. */
static void make_normal(const struct problem *q, gsl_matrix *JTJ)
{
	gsl_matrix_set_zero(JTJ);
	for (int i = 0; i < q->m; i++)
		for (int k = 0; k <= i; k++)
			for (int c = 0; c < 2; c++) {
				const struct column *x = &q->column[i][c],
						    *y = &q->column[k][c];
				long first = x->first > y->first ? x->first : y->first;
				long xend = x->first + (long)x->n,
				     yend = y->first + (long)y->n,
				     end = xend < yend ? xend : yend;

				for (int u = 0; end > first && u < PAR; u++)
					for (int v = 0; v < (i == k ? u + 1 : PAR); v++)
						*gsl_matrix_ptr(JTJ,
							(size_t)(PAR * i + u),
							(size_t)(PAR * k + v)) +=
							dot(x->d[u] + (first - x->first),
								y->d[v] +
									(first -
										y->first),
								(size_t)(end - first));
			}
}

static int products(CBLAS_TRANSPOSE_t transpose, const gsl_vector *x, const gsl_vector *u,
	void *params, gsl_vector *v, gsl_matrix *JTJ)
{
	struct problem *q = params;

	make_columns(q, x);
	if (transpose != CblasTrans)
		return GSL_EINVAL;
	gsl_vector_set_zero(v);
	for (int i = 0; i < q->m; i++)
		for (int c = 0; c < 2; c++) {
			const struct column *col = &q->column[i][c];
			size_t row = (size_t)c * q->n + (size_t)col->first;

			for (int k = 0; k < PAR; k++)
				v->data[PAR * i + k] +=
					dot(col->d[k], u->data + row, col->n);
		}
	if (JTJ)
		make_normal(q, JTJ);
	return GSL_SUCCESS;
}

static double chi_square(const gsl_vector *f)
{
	return dot(f->data, f->data, f->size);
}

static void start(const struct problem *q, gsl_vector *x)
{
	for (int i = 0; i < q->m; i++) {
		x->data[PAR * i] = q->guess[i].t;
		x->data[PAR * i + 1] = q->guess[i].t + q->guess[i].delta;
		x->data[PAR * i + 2] = q->guess[i].a;
	}
}

static void run_multifit(struct problem *q, gsl_multifit_nlinear_parameters par,
	int to_end, struct outcome *out)
{
	size_t p = (size_t)(PAR * q->m);
	gsl_multifit_nlinear_workspace *w =
		gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &par, 2 * q->n, p);
	gsl_multifit_nlinear_fdf fdf = {
		.f = residual, .df = jacobian, .n = 2 * q->n, .p = p, .params = q
	};
	gsl_vector *x = gsl_vector_alloc(p);
	gsl_matrix *covariance = gsl_matrix_alloc(p, p);
	double begin, before;

	start(q, x);
	if (to_end)
		memcpy(x->data, out->x, p * sizeof(double));
	begin = now();
	gsl_multifit_nlinear_init(x, &fdf, w);
	out->chi2 = chi_square(w->f);
	for (out->steps = 0; out->steps < STEPS; out->steps++) {
		before = out->chi2;
		if (gsl_multifit_nlinear_iterate(w) != GSL_SUCCESS)
			break;
		out->chi2 = chi_square(w->f);
		if (before - out->chi2 < (to_end ? 1e-12 : 1e-4))
			break;
	}
	gsl_multifit_nlinear_covar(w->J, 0, covariance);
	out->seconds = now() - begin;
	memcpy(out->x, w->x->data, p * sizeof(double));
	gsl_matrix_free(covariance);
	gsl_vector_free(x);
	gsl_multifit_nlinear_free(w);
}

static void run_multilarge(
	struct problem *q, gsl_multilarge_nlinear_parameters par, struct outcome *out)
{
	size_t p = (size_t)(PAR * q->m);
	gsl_multilarge_nlinear_workspace *w = gsl_multilarge_nlinear_alloc(
		gsl_multilarge_nlinear_trust, &par, 2 * q->n, p);
	gsl_multilarge_nlinear_fdf fdf = {
		.f = residual, .df = products, .n = 2 * q->n, .p = p, .params = q
	};
	gsl_vector *x = gsl_vector_alloc(p);
	gsl_matrix *covariance = gsl_matrix_alloc(p, p);
	double begin, before;

	start(q, x);
	begin = now();
	gsl_multilarge_nlinear_init(x, &fdf, w);
	out->chi2 = chi_square(w->f);
	for (out->steps = 0; out->steps < STEPS; out->steps++) {
		before = out->chi2;
		if (gsl_multilarge_nlinear_iterate(w) != GSL_SUCCESS)
			break;
		out->chi2 = chi_square(w->f);
		if (before - out->chi2 < 1e-4)
			break;
	}
	gsl_multilarge_nlinear_covar(covariance, w);
	out->seconds = now() - begin;
	memcpy(out->x, w->x->data, p * sizeof(double));
	gsl_matrix_free(covariance);
	gsl_vector_free(x);
	gsl_multilarge_nlinear_free(w);
}

/* Gives the pulses with their covariances too. */
static void run_joint(struct joint *joint, struct problem *q, struct joint_pulse *pulse,
	struct outcome *out)
{
	struct joint_result r;
	double begin;

	memcpy(pulse, q->guess, sizeof q->guess);
	begin = now();
	joint_refine(joint, q->scene, q->y[0], q->y[1], q->n, pulse, q->m, &r);
	out->seconds = now() - begin;
	out->chi2 = r.chi2;
	out->steps = r.steps;
	for (int i = 0; i < q->m; i++) {
		out->x[PAR * i] = pulse[i].t;
		out->x[PAR * i + 1] = pulse[i].t + pulse[i].delta;
		out->x[PAR * i + 2] = pulse[i].a;
	}
}

static void make_problem(
	struct problem *q, const struct joint_scene *scene, int m, double snr, uint32_t k)
{
	double free = 50.0 * m - 10.0 * (m - 1), arrival[MOST] = { 0 }, z[2];
	uint64_t at = 0;

	q->scene = scene;
	q->m = m;
	for (int i = 0; i < m; i++) {
		double t = free * philox_uniform(1, k, RNG_PARTICLE, at++);
		int place = i;

		for (; place > 0 && arrival[place - 1] > t; place--)
			arrival[place] = arrival[place - 1];
		arrival[place] = t;
	}
	memset(q->y, 0, sizeof q->y);
	q->n = (size_t)(arrival[m - 1] - arrival[0] + 10 * (m - 1)) + 2 * EDGE;
	for (int i = 0; i < m; i++) {
		double u[6];
		struct joint_pulse *g = &q->guess[i];

		for (int l = 0; l < 6; l++)
			u[l] = philox_uniform(1, k, RNG_PARTICLE, at++);
		*g = (struct joint_pulse){ .t = EDGE + arrival[i] - arrival[0] + 10 * i,
			.delta = 2 + 3 * u[0],
			.a = pow(10, snr / 20) * (0.5 + u[1]) };
		joint_add(scene, g, 1, q->y[0], q->y[1], q->n);
		g->t += 4 * u[2] - 2;
		g->delta += 4 * u[3] - 2;
		g->a *= 0.8 + 0.4 * u[4];
	}
	for (size_t i = 0; i < q->n; i++) {
		philox_normal2(1, k, RNG_NOISE, i, z);
		q->y[0][i] += z[0];
		q->y[1][i] += z[1];
	}
}

struct solver {
	const char *name;
	const gsl_multifit_nlinear_trs *small;
	const gsl_multifit_nlinear_solver *factor;
};

struct tally {
	double seconds[SCENES_MAX], ratio[SCENES_MAX], excess[SCENES_MAX],
		off[SCENES_MAX];
	double steps, most;
};

static void solve(const struct solver *s, struct problem *q, struct outcome *out)
{
	gsl_multifit_nlinear_parameters small = gsl_multifit_nlinear_default_parameters();
	gsl_multilarge_nlinear_parameters large =
		gsl_multilarge_nlinear_default_parameters();

	if (s->small) {
		small.trs = s->small;
		small.solver = s->factor;
		run_multifit(q, small, 0, out);
	} else {
		large.trs = gsl_multilarge_nlinear_trs_lm;
		large.solver = gsl_multilarge_nlinear_solver_cholesky;
		run_multilarge(q, large, out);
	}
}

/* Distance of the farthest parameter, in standard errors. */
static double distance(const struct outcome *out, const struct outcome *least,
	const struct joint_pulse *pulse, int m)
{
	static const int diagonal[] = { 0, 2, 5 };
	double most = 0;

	for (int i = 0; i < m; i++)
		for (int u = 0; u < PAR; u++)
			most = fmax(
				most, fabs(out->x[PAR * i + u] - least->x[PAR * i + u]) /
					      sqrt(pulse[i].cov[diagonal[u]]));
	return most;
}

/* All solvers on scene k. */
static void run_scene(struct joint *joint, struct problem *q, const struct solver *solver,
	int solvers, int k, struct tally *tally)
{
	struct joint_pulse pulse[MOST];
	struct outcome out[SOLVERS_MAX], least;
	int best = 0;

	run_joint(joint, q, pulse, &out[0]); /* once more: memory is warm */
	for (int i = 0; i < solvers; i++) {
		struct tally *t = &tally[i];

		if (i == 0)
			run_joint(joint, q, pulse, &out[0]);
		else
			solve(&solver[i], q, &out[i]);
		t->seconds[k] = out[i].seconds;
		t->ratio[k] = out[i].seconds / out[0].seconds;
		t->steps += (double)out[i].steps;
		if (out[i].chi2 < out[best].chi2)
			best = i;
	}
	least = out[best];
	run_multifit(q, gsl_multifit_nlinear_default_parameters(), 1, &least);
	for (int i = 0; i < solvers; i++) {
		struct tally *t = &tally[i];

		t->excess[k] = out[i].chi2 - least.chi2;
		t->off[k] = distance(&out[i], &least, pulse, q->m);
		t->most = fmax(t->most, t->off[k]);
	}
}

int main(int argc, char **argv)
{
	static const int pulses[] = { 1, 2, 4, 6, 12 };
	const struct solver solver[] = { { "joint", NULL, NULL },
		{ "multifit lm cholesky", gsl_multifit_nlinear_trs_lm,
			gsl_multifit_nlinear_solver_cholesky },
		{ "multifit lm qr", gsl_multifit_nlinear_trs_lm,
			gsl_multifit_nlinear_solver_qr },
		{ "multifit lmaccel cholesky", gsl_multifit_nlinear_trs_lmaccel,
			gsl_multifit_nlinear_solver_cholesky },
		{ "multifit lmaccel qr", gsl_multifit_nlinear_trs_lmaccel,
			gsl_multifit_nlinear_solver_qr },
		{ "multilarge lm cholesky", NULL, NULL } };
	enum { SOLVERS = sizeof solver / sizeof *solver };
	static struct tally tally[SOLVERS];
	static struct problem q;
	int scenes = argc > 1 ? atoi(argv[1]) : 20;
	size_t n = (size_t)scenes;
	struct shape *shape = shape_new(PULSE_SINE);
	struct joint *joint = joint_new();
	struct joint_scene scene = { .shape = shape,
		.duration = 100,
		.transit = 196.35,
		.gain = 0.909,
		.width = 1,
		.delta_min = -20,
		.delta_max = 20,
		.max_pulses = MOST,
		.tone_variance = INFINITY };

	if (scenes < 1 || scenes > SCENES_MAX || !shape || !joint) {
		fprintf(stderr, "usage: solvers [SCENES], at most %d\n", SCENES_MAX);
		return 2;
	}
	gsl_set_error_handler_off();
	puts("solver\tm\tsnr\tus\tratio\tsteps\texcess\toff\tmost");
	for (size_t a = 0; a < sizeof pulses / sizeof *pulses; a++)
		for (int snr = 20; snr <= 30; snr += 10) {
			memset(tally, 0, sizeof tally);
			for (int k = 0; k < scenes; k++) {
				make_problem(&q, &scene, pulses[a], snr, (uint32_t)k);
				run_scene(joint, &q, solver, SOLVERS, k, tally);
			}
			for (int i = 0; i < SOLVERS; i++) {
				struct tally *t = &tally[i];

				printf("%s\t%d\t%d\t%.1f\t%.2f\t%.1f\t%.1e\t%.1e\t%.1e\n",
					solver[i].name, pulses[a], snr,
					1e6 * robust_median(t->seconds, n),
					robust_median(t->ratio, n), t->steps / scenes,
					robust_median(t->excess, n),
					robust_median(t->off, n), t->most);
			}
			fflush(stdout);
		}
	joint_free(joint);
	shape_free(shape);
	return 0;
}
