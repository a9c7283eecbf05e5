/* joint_step.c - Levenberg-Marquardt fit of some of the pulses; see joint_state.h */
#include "num/cholesky.h"
#include "signal/fit/joint_state.h"
#include <string.h>

/* J_i^T J_k of two pulses, added to block. */
static void add_block(const struct joint *j, int i, int k, double block[PAR][PAR])
{
	for (int c = 0; c < 2; c++) {
		const struct column *x = &j->col[i][c], *y = &j->col[k][c];
		long first = x->first > y->first ? x->first : y->first;
		long xend = x->first + (long)x->n, yend = y->first + (long)y->n;
		long end = xend < yend ? xend : yend;
		const double *xd[PAR], *yd[PAR];
		double part[PAR][PAR];

		if (end <= first)
			continue;
		for (int u = 0; u < PAR; u++) {
			xd[u] = x->d[u] + (first - x->first);
			yd[u] = y->d[u] + (first - y->first);
		}
		dot9(xd, yd, (size_t)(end - first), part);
		for (int u = 0; u < PAR; u++)
			for (int v = 0; v < (i == k ? u + 1 : PAR); v++)
				block[u][v] += part[u][v];
	}
}

/* Normal matrix and gradient of the m pulses in set. */
static void make_normal(struct joint *j, const int *set, int m)
{
	const int np = PAR * m, vectors = j->basis->vectors;

	for (int x = 0; x < m; x++) {
		int i = set[x];
		double *g = j->gradient + PAR * x, part[PAR];

		g[0] = g[1] = g[2] = 0;
		for (int c = 0; c < 2; c++) {
			const struct column *col = &j->col[i][c];
			const double *d[] = { col->d[0], col->d[1], col->d[2] };

			dot3(j->e[c] + col->first, d, col->n, part);
			for (int u = 0; u < PAR; u++)
				g[u] += part[u];
			for (int u = 0; u < PAR; u++) {
				double *row = joint_row(j, PAR * x + u, c);

				joint_along(j, c, vectors, col->first, d[u], col->n, row);
				for (int b = 0; b < vectors; b++)
					g[u] -= row[b] * j->qe[c][b];
			}
		}
		for (int y = 0; y <= x; y++) {
			double block[PAR][PAR] = { { 0 } };

			add_block(j, i, set[y], block);
			for (int u = 0; u < PAR; u++) {
				int row = PAR * x + u;

				for (int v = 0; v < (x == y ? u + 1 : PAR); v++)
					j->h[row * np + PAR * y + v] =
						block[u][v] -
						dot(joint_row(j, row, 0),
							joint_row(j, PAR * y + v, 0),
							2 * (size_t)vectors);
			}
		}
	}
}

/* Cholesky of h + lambda diag(h); NUM_DOMAIN where not positive definite. */
static enum num_status factorise(struct joint *j, size_t np, double lambda)
{
	for (size_t i = 0; i < np; i++) {
		memcpy(j->factor + i * np, j->h + i * np, (i + 1) * sizeof *j->h);
		j->factor[i * np + i] += lambda * j->h[i * np + i];
	}
	return cholesky_factor(j->factor, np, np, 1e-13);
}

void joint_reduce(const struct joint *j, int np, int start, double *const x[3])
{
	const double *from[] = { x[0] + start, x[1] + start, x[2] + start };
	double part[3];

	for (int i = start; i < np; i++) {
		const double *row = j->factor + (size_t)i * (size_t)np;

		dot3(row + start, from, (size_t)(i - start), part);
		for (int k = 0; k < 3; k++)
			x[k][i] = (x[k][i] - part[k]) / row[i];
	}
}

void joint_solve(const struct joint *j, int np, double *x)
{
	for (int i = 0; i < np; i++) {
		const double *row = j->factor + (size_t)i * (size_t)np;

		x[i] = (x[i] - dot(row, x, (size_t)i)) / row[i];
	}
	for (int i = np - 1; i >= 0; i--) {
		const double *row = j->factor + (size_t)i * (size_t)np;

		x[i] /= row[i];
		add_scaled(x, -x[i], row, (size_t)i);
	}
}

struct joint_pulse joint_moved(
	const struct joint *j, const struct joint_pulse *old, const double *move)
{
	const struct joint_scene *s = &j->scene;
	struct joint_pulse p = *old;
	double step = JOINT_STEP * s->duration;
	double beyond = JOINT_BEYOND * (s->delta_max - s->delta_min);
	double t2 = old->t + old->delta + clamp(move[1], -step, step);

	p.t = clamp(old->t + clamp(move[0], -step, step), arrival_limit(j, 0),
		arrival_limit(j, 1));
	p.delta = clamp(t2 - p.t, s->delta_min - beyond, s->delta_max + beyond);
	p.a = old->a + move[2];
	p.a = old->a > 0 ? clamp(p.a, 0.1 * old->a, 10 * old->a)
			 : clamp(p.a, 10 * old->a, 0.1 * old->a);
	return p;
}

static void swap_columns(struct joint *j, int i)
{
	struct column keep[2];

	memcpy(keep, j->col[i], sizeof keep);
	memcpy(j->col[i], j->trial[i], sizeof keep);
	memcpy(j->trial[i], keep, sizeof keep);
}

/* What a step changes, as it was. */
struct before {
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	double energy, qe[2][BASIS_MAX];
	long from[2], to[2]; /* samples that the pulses touch before or after */
};

static void find_span(const struct joint *j, const int *set, int m, struct before *old)
{
	for (int c = 0; c < 2; c++) {
		old->from[c] = (long)j->n;
		old->to[c] = 0;
		for (int x = 0; x < 2 * m; x++) {
			const struct column *col =
				x % 2 ? &j->col[set[x / 2]][c] : &j->trial[set[x / 2]][c];
			long end = col->first + (long)col->n;

			if (col->n == 0)
				continue;
			old->from[c] =
				col->first < old->from[c] ? col->first : old->from[c];
			old->to[c] = end > old->to[c] ? end : old->to[c];
		}
		if (old->to[c] < old->from[c])
			old->to[c] = old->from[c];
	}
}

/* Adds sign times what these samples of a channel contribute to energy and qe. */
static void count_span(struct joint *j, int c, long from, long to, double sign)
{
	const double *e = j->e[c] + from;
	size_t n = (size_t)(to - from);
	double part[BASIS_MAX];

	j->energy += sign * dot(e, e, n);
	joint_along(j, c, j->basis->vectors, from, e, n, part);
	for (int b = 0; b < j->basis->vectors; b++)
		j->qe[c][b] += sign * part[b];
}

/* Moves the pulses in set along j->move, and stores their columns before the step in
 * trial. */
static void step_forth(struct joint *j, const int *set, int m, struct before *old)
{
	for (int x = 0; x < m; x++) {
		old->pulse[x] = j->pulse[set[x]];
		j->pulse[set[x]] = joint_moved(j, &old->pulse[x], j->move + PAR * x);
		swap_columns(j, set[x]);
		joint_make_columns(j, set[x]);
	}
	find_span(j, set, m, old);
	old->energy = j->energy;
	memcpy(old->qe, j->qe, sizeof j->qe);
	for (int c = 0; c < 2; c++) {
		memcpy(j->r[c] + old->from[c], j->e[c] + old->from[c],
			(size_t)(old->to[c] - old->from[c]) * sizeof(double));
		count_span(j, c, old->from[c], old->to[c], -1);
		for (int x = 0; x < m; x++) {
			const struct column *was = &j->trial[set[x]][c];
			const struct column *is = &j->col[set[x]][c];

			add_scaled(
				j->e[c] + was->first, old->pulse[x].a, was->d[2], was->n);
			add_scaled(j->e[c] + is->first, -j->pulse[set[x]].a, is->d[2],
				is->n);
		}
		count_span(j, c, old->from[c], old->to[c], 1);
	}
}

static void step_back(struct joint *j, const int *set, int m, const struct before *old)
{
	for (int c = 0; c < 2; c++)
		memcpy(j->e[c] + old->from[c], j->r[c] + old->from[c],
			(size_t)(old->to[c] - old->from[c]) * sizeof(double));
	j->energy = old->energy;
	memcpy(j->qe, old->qe, sizeof j->qe);
	for (int x = 0; x < m; x++) {
		swap_columns(j, set[x]);
		j->pulse[set[x]] = old->pulse[x];
	}
}

double joint_fit_set(
	struct joint *j, const int *set, int m, int max_steps, double tolerance)
{
	double lambda = 1e-4, chi2;
	struct before old;
	int fresh = 0;

	joint_measure(j);
	chi2 = joint_chi_square(j);
	for (int x = 0; x < m; x++)
		joint_make_columns(j, set[x]);
	for (int step = 0; step < max_steps && m > 0; step++) {
		double after;

		if (!fresh)
			make_normal(j, set, m);
		fresh = 1;
		j->result.steps++;
		if (factorise(j, PAR * (size_t)m, lambda) != NUM_OK) {
			lambda = lambda * 10 + 1e-3;
			continue;
		}
		memcpy(j->move, j->gradient, sizeof(double) * (size_t)(PAR * m));
		joint_solve(j, PAR * m, j->move);
		step_forth(j, set, m, &old);
		after = joint_chi_square(j);
		if (after < chi2) {
			double gain = chi2 - after;

			chi2 = after;
			lambda = lambda > 1e-9 ? lambda / 10 : lambda;
			fresh = 0;
			if (gain < tolerance)
				break;
			continue;
		}
		step_back(j, set, m, &old);
		if (after - chi2 < tolerance || lambda > 1e6)
			break;
		lambda = lambda * 10;
	}
	return chi2;
}

void joint_fit_all(struct joint *j)
{
	j->result.chi2 = joint_fit_set(j, j->all, j->m, 50, 1e-4);
}

enum num_status joint_factorise(struct joint *j, const int *set, int m)
{
	for (int x = 0; x < m; x++)
		joint_make_columns(j, set[x]);
	make_normal(j, set, m);
	return factorise(j, PAR * (size_t)m, 0);
}

void joint_fill_covariance(struct joint *j)
{
	int m = j->m, np = PAR * m;
	int good = joint_factorise(j, j->all, m) == NUM_OK;
	double x[PAR][NPAR];

	j->inverted = good ? m : 0;
	/* The inverse of L L^T has the inner products of the columns of that of L. */
	for (int i = 0; i < m; i++) {
		size_t below = (size_t)(np - PAR * i);

		memset(x, 0, sizeof x);
		for (int u = 0; u < PAR && good; u++)
			x[u][PAR * i + u] = 1;
		if (good)
			joint_reduce(j, np, PAR * i, (double *[]){ x[0], x[1], x[2] });
		for (int u = 0, k = 0; u < PAR; u++)
			for (int v = 0; v <= u; v++)
				j->pulse[i].cov[k++] =
					good ? dot(x[u] + PAR * i, x[v] + PAR * i, below)
					     : INFINITY;
	}
}

void joint_gain_error(const struct joint *j, double *share, double *se)
{
	double var = 0;

	*share = 0;
	for (int c = 0; c < 2; c++) {
		double energy = 0, along = 0, own = 0, scatter = 0;

		for (int i = 0; i < j->m; i++) {
			const struct column *a = &j->col[i][c];
			double part = 0;

			along += j->pulse[i].a * dot(a->d[2], j->r[c] + a->first, a->n);
			for (int k = 0; k < j->m; k++) {
				const struct column *b = &j->col[k][c];

				part += j->pulse[i].a * j->pulse[k].a *
					dot_within(a->d[2], a->n, b->d[2], b->n,
						a->first - b->first);
			}
			energy += part;
			own += part * j->pulse[i].own[JOINT_RATIO];
			scatter += pow(part * j->scene.scatter[JOINT_RATIO], 2);
		}
		*share += (c ? along + own : -along) / energy;
		var += 1 / energy + (c ? scatter / (energy * energy) : 0);
	}
	*se = sqrt(var);
}
