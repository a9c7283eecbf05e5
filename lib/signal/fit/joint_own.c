/* joint_own.c - what each pulse has of its own: a width beside that of its velocity, and
 * a ratio of its amplitudes at the sensors; see joint_state.h */
#include "num/cholesky.h"
#include "num/sigmas.h"
#include "signal/fit/joint_state.h"
#include <string.h>

/* What pulse i has of its own: its derivative by that is scale times column u of it, on
 * channel c. */
struct direction {
	int u;
	double scale;
};

/* That by the arrival at the other sensor changes the velocity, and on this channel
 * nothing but the width. */
static struct direction along_own(const struct joint *j, int own, int i, int c)
{
	const struct joint_pulse *p = &j->pulse[i];

	return own == JOINT_WIDTH ? (struct direction){ 1 - c,
		(c ? -1 : 1) * (j->scene.transit + p->delta) }
				  : (struct direction){ 2, c ? p->a : 0 };
}

/* The unknowns: what pulse i has of its own. */
struct unknown {
	int i, own;
};

/* Those of all pulses in a set of bits 1 << own. */
static size_t list_unknowns(const struct joint *j, unsigned set, struct unknown *list)
{
	size_t n = 0;

	for (int own = 0; own < JOINT_OWN && j->inverted > 0; own++)
		for (int i = 0; i < j->m; i++)
			if (set >> own & 1)
				list[n++] = (struct unknown){ i, own };
	return n;
}

/* Inner product within channel c of column u of pulse i and column v of pulse k, less
 * what tones and baseline take of them. */
static double inner(const struct joint *j, int c, int i, int u, int k, int v)
{
	const struct column *x = &j->col[i][c], *y = &j->col[k][c];
	const double *of = j->bq + c * j->basis;
	const int nb = 2 * j->basis;

	return dot_within(x->d[u], x->n, y->d[v], y->n, x->first - y->first) -
	       dot(of + (PAR * i + u) * nb, of + (PAR * k + v) * nb, (size_t)j->basis);
}

/* Inner product of the derivatives by two unknowns. */
static double product(const struct joint *j, struct unknown x, struct unknown y)
{
	double sum = 0;

	for (int c = 0; c < 2; c++) {
		struct direction a = along_own(j, x.own, x.i, c),
				 b = along_own(j, y.own, y.i, c);

		sum += a.scale * b.scale * inner(j, c, x.i, a.u, y.i, b.u);
	}
	return sum;
}

/* The same of an unknown and parameter v of pulse k. */
static double product_with(const struct joint *j, struct unknown x, int k, int v)
{
	double sum = 0;

	for (int c = 0; c < 2; c++) {
		struct direction a = along_own(j, x.own, x.i, c);

		sum += a.scale * inner(j, c, x.i, a.u, k, v);
	}
	return sum;
}

/* The same of the residual. */
static double along_residual(const struct joint *j, struct unknown x)
{
	double sum = 0;

	for (int c = 0; c < 2; c++) {
		const struct column *col = &j->col[x.i][c];
		struct direction a = along_own(j, x.own, x.i, c);

		sum += a.scale * dot(col->d[a.u], j->r[c] + col->first, col->n);
	}
	return sum;
}

/* Where measure() leaves what it computes: rows of NPAR, one for each unknown. */
struct part {
	double *by;      /* inner products with the parameters, ... */
	double *move;    /* ... how these move with the unknown, ... */
	double *inverse; /* ... and inverse of the covariance of the unknowns */
};

static struct part parts(const struct joint *j, size_t n)
{
	return (struct part){ j->h, j->h + n * NPAR, j->h + 2 * n * NPAR };
}

/* Fills the parts, and along with what the residual tells of each of n unknowns. */
static void measure(
	const struct joint *j, const struct unknown *x, size_t n, double *along)
{
	const struct part p = parts(j, n);
	const int np = PAR * j->m;

	for (size_t i = 0; i < n; i++) {
		double *by = p.by + i * NPAR, *move = p.move + i * NPAR;

		along[i] = along_residual(j, x[i]);
		for (int k = 0; k < np; k++)
			by[k] = product_with(j, x[i], k / PAR, k % PAR);
		for (size_t k = 0; k < n; k++)
			p.inverse[i * NPAR + k] = product(j, x[i], x[k]);
		memcpy(move, by, (size_t)np * sizeof *by);
		joint_solve(j, np, 0, move);
	}
	for (size_t i = 0; i < n; i++)
		for (size_t k = 0; k < n; k++)
			p.inverse[i * NPAR + k] -=
				dot(p.by + i * NPAR, p.move + k * NPAR, (size_t)np);
}

/* The width of a pulse is unknown where all are of one duration. */
static int is_known(const struct joint *j, int own)
{
	return own != JOINT_WIDTH || !isinf(j->scene.transit);
}

/* The set of what has a prior. */
static unsigned with_prior(const struct joint *j)
{
	unsigned set = 0;

	for (int own = 0; own < JOINT_OWN; own++)
		set |= (unsigned)(j->scene.scatter[own] > 0 && is_known(j, own)) << own;
	return set;
}

size_t joint_deviations(struct joint *j, unsigned set, struct joint_deviation *const *out,
	double *explained)
{
	struct unknown x[OWN_MAX];
	const size_t n = list_unknowns(j, set | with_prior(j), x);
	const struct part p = parts(j, n);
	double along[OWN_MAX], share[OWN_MAX], relaxed[OWN_MAX], left[OWN_MAX];

	*explained = 0;
	for (int own = 0; own < JOINT_OWN; own++)
		if (set >> own & 1 && !is_known(j, own))
			return 0;
	measure(j, x, n, along);
	for (size_t i = 0; i < n; i++) {
		left[i] = p.inverse[i * NPAR + i] /
			  (pow(j->pulse[x[i].i].a, 2) * joint_energy(&j->scene));
		relaxed[i] = j->pulse[x[i].i].own[x[i].own];
	}
	for (size_t i = 0; i < n; i++) /* before the prior was used */
		along[i] += dot(p.inverse + i * NPAR, relaxed, n);
	if (cholesky_factor(p.inverse, n, NPAR, 1e-13) != NUM_OK)
		return 0;
	memcpy(share, along, n * sizeof *share);
	cholesky_solve(p.inverse, n, NPAR, share);
	for (size_t i = 0; i < n; i++) {
		double column[OWN_MAX] = { 0 };

		column[i] = 1;
		cholesky_solve(p.inverse, n, NPAR, column);
		*explained += share[i] * along[i];
		if (set >> x[i].own & 1)
			out[x[i].own][x[i].i] =
				(struct joint_deviation){ j->pulse[x[i].i].t, share[i],
					sqrt(column[i]), left[i] };
	}
	return n > 0 ? (size_t)j->m : 0;
}

/* Chi-square of what pulses have of their own by its prior. */
static double price(const struct joint *j, const struct unknown *x, size_t n)
{
	double sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += pow(
			j->pulse[x[i].i].own[x[i].own] / j->scene.scatter[x[i].own], 2);
	return sum;
}

/* Normal matrix of n unknowns with their prior, and along the step to the least of
 * chi-square by it. */
static enum num_status find_step(
	const struct joint *j, const struct unknown *x, size_t n, double *along)
{
	const struct part p = parts(j, n);
	enum num_status status;

	measure(j, x, n, along);
	for (size_t i = 0; i < n; i++) {
		double var = j->scene.scatter[x[i].own] * j->scene.scatter[x[i].own];

		along[i] -= j->pulse[x[i].i].own[x[i].own] / var;
		p.inverse[i * NPAR + i] += 1 / var;
	}
	status = cholesky_factor(p.inverse, n, NPAR, 1e-13);
	if (status == NUM_OK)
		cholesky_solve(p.inverse, n, NPAR, along);
	return status;
}

/* Moves pulse i by the steps of all unknowns. */
static void move_pulse(
	struct joint *j, int i, const struct unknown *x, size_t n, const double *step)
{
	const struct part p = parts(j, n);
	struct joint_pulse *pulse = &j->pulse[i];
	double shift[PAR] = { 0 };

	for (size_t k = 0; k < n; k++) {
		double *own = &pulse->own[x[k].own];
		double most = SIGMAS_NEVER * j->scene.scatter[x[k].own];

		if (x[k].i == i)
			*own = clamp(*own + step[k], -most, most);
		for (int u = 0; u < PAR; u++)
			shift[u] -= step[k] * p.move[k * NPAR + (size_t)(PAR * i + u)];
	}
	*pulse = joint_moved(j, pulse, shift);
}

/* Adds what the unknowns leave open to the covariances. */
static void widen_covariances(struct joint *j, size_t n)
{
	const struct part p = parts(j, n);

	for (int i = 0; i < j->m; i++) {
		double column[PAR][OWN_MAX], spread[OWN_MAX];

		for (int u = 0, cell = 0; u < PAR; u++) {
			for (size_t k = 0; k < n; k++)
				column[u][k] = p.move[k * NPAR + (size_t)(PAR * i + u)];
			memcpy(spread, column[u], n * sizeof *spread);
			cholesky_solve(p.inverse, n, NPAR, spread);
			for (int v = 0; v <= u; v++)
				j->pulse[i].cov[cell++] += dot(spread, column[v], n);
		}
	}
}

/* Steps of all together, each followed by a fit of the parameters alone. */
static void relax(struct joint *j, const struct unknown *x, size_t n)
{
	enum { STEPS = 8 };
	static const double ENOUGH = 0.1;
	double step[OWN_MAX], least = j->result.chi2 + price(j, x, n);
	struct joint_pulse before[JOINT_PULSES_MAX];

	j->result.chi2 = least;
	for (int k = 0; k < STEPS && n > 0 && find_step(j, x, n, step) == NUM_OK; k++) {
		double fell;

		memcpy(before, j->pulse, (size_t)j->m * sizeof *before);
		joint_subtract_all(j, -1);
		for (int i = 0; i < j->m; i++)
			move_pulse(j, i, x, n, step);
		joint_subtract_all(j, 1);
		joint_fit_all(j);
		j->result.chi2 += price(j, x, n);
		fell = least - j->result.chi2;
		if (fell < 0) {
			joint_subtract_all(j, -1);
			memcpy(j->pulse, before, (size_t)j->m * sizeof *before);
			joint_subtract_all(j, 1);
			j->result.chi2 = least;
		}
		least = j->result.chi2;
		joint_fill_covariance(j);
		joint_project(j);
		if (fell < ENOUGH)
			break;
	}
}

void joint_relax(struct joint *j)
{
	struct unknown x[OWN_MAX];
	const size_t n = list_unknowns(j, with_prior(j), x);
	double step[OWN_MAX];

	if (n == 0)
		return;
	relax(j, x, n);
	if (find_step(j, x, n, step) == NUM_OK)
		widen_covariances(j, n);
}

void joint_prune_relaxed(struct joint *j)
{
	struct unknown x[OWN_MAX];

	if (with_prior(j) == 0)
		return;
	joint_fill_covariance(j);
	joint_project(j);
	relax(j, x, list_unknowns(j, with_prior(j), x));
	joint_prune(j);
	joint_fit_all(j);
}

/* Deviations beyond which one counts no more: it is that of another event. */
static const double MOST = SIGMAS_RARELY * SIGMAS_RARELY;

static double error_of(const struct joint_deviation *w, double var)
{
	return sqrt(var + w->se * w->se);
}

/* A straight line of deviations in time, which passes through two of them. */
struct line {
	const struct joint_deviation *from, *to;
};

static double below(const struct line *l, const struct joint_deviation *w)
{
	const struct joint_deviation *a = l->from, *b = l->to;
	double slope = b->at == a->at ? 0 : (b->share - a->share) / (b->at - a->at);

	return w == b ? 0 : a->share + slope * (w->at - a->at) - w->share;
}

/* The line of least deviations over their errors: a median that follows an instrument
 * which changes slowly.  It is the best through either of its points: the sum is convex.
 */
static struct line centre(const struct joint_deviation *w, size_t n, double var)
{
	struct line best = { w, w };
	double least = INFINITY, before;

	do {
		const struct line last = best;

		before = least;
		for (size_t i = 0; i < n; i++) {
			const struct line l = { last.to, &w[i] };
			double sum = 0;

			for (size_t k = 0; k < n; k++)
				sum += fabs(below(&l, &w[k])) / error_of(&w[k], var);
			if (sum < least) {
				least = sum;
				best = l;
			}
		}
	} while (least < before);
	return best;
}

/* Squares of the deviations from the line over their variances, var added.  Of widths
 * those below it: two particles that arrived together look wider, never narrower. *count:
 * number of these. */
static double squares(
	int own, const struct joint_deviation *w, size_t n, double var, size_t *count)
{
	const struct line middle = centre(w, n, var);
	double sum = 0;

	*count = 0;
	for (size_t i = 0; i < n; i++) {
		double deviation = below(&middle, &w[i]) / error_of(&w[i], var);

		if (deviation > 0 || (own != JOINT_WIDTH && deviation < 0)) {
			sum += fmin(deviation * deviation, MOST);
			++*count;
		}
	}
	return sum;
}

/* 1 if noise rarely makes this chi-square; its cube root is nearly normal (Wilson and
 * Hilferty, Proc. Natl. Acad. Sci. 17, 1931). */
static int is_significant(double chi2, size_t count)
{
	double var = 2 / (9 * (double)count);

	return count > 0 &&
	       cbrt(chi2 / (double)count) > 1 - var + SIGMAS_RARELY * sqrt(var);
}

double joint_scatter(int own, const struct joint_deviation *w, size_t n)
{
	enum { ROUNDS = 40 };
	double lo = 0, hi = 0, sum;
	size_t count;

	sum = squares(own, w, n, 0, &count);
	if (!is_significant(sum, count))
		return 0;
	for (size_t i = 0; i < n; i++)
		hi = fmax(hi, w[i].share * w[i].share);
	for (int k = 0; k < ROUNDS; k++) {
		double middle = 0.5 * (lo + hi);

		sum = squares(own, w, n, middle, &count);
		if (sum > (double)count)
			lo = middle;
		else
			hi = middle;
	}
	return sqrt(hi);
}

/* What a pulse leaves by three standard deviations is no other pulse: with 3, 2, 1 and
 * 0.5 of those of the ratio, 1060, 1064, 1078 and 918 of 1149 particles in eleven records
 * were claimed rightly, and 1, 4, 8 and 11 rows wrong. */
void joint_set_scatter(struct joint_scene *s, int own, const struct joint_deviation *w,
	size_t n, double misfit)
{
	double left = 0;

	for (size_t i = 0; i < n; i++)
		left += w[i].left / (double)n;
	s->scatter[own] = joint_scatter(own, w, n);
	s->misfit = fmax(misfit, pow(SIGMAS_SELDOM * s->scatter[own], 2) * left);
}
