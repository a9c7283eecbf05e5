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

/* Inner product within channel c of column u of pulse i and column v of pulse k. */
static double inner(const struct joint *j, int c, int i, int u, int k, int v)
{
	return joint_inner(j, joint_column(j, i, i, u, c), joint_column(j, k, k, v, c));
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
		joint_solve(j, np, move);
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
static struct line centre(const struct joint_deviation *w, const double *error, size_t n)
{
	struct line best = { w, w };
	double least = INFINITY, before;

	do {
		const struct line last = best;

		before = least;
		for (size_t i = 0; i < n; i++) {
			const struct line l = { last.to, &w[i] };
			double sum = 0;

			for (size_t k = 0; k < n && sum < least; k++)
				sum += fabs(below(&l, &w[k])) / error[k];
			if (sum < least) {
				least = sum;
				best = l;
			}
		}
	} while (least < before);
	return best;
}

/* Minus twice the logarithm of the likelihood of a scatter of this variance, but for a
 * constant; slope: its derivative by the variance.  Of widths only those below the line
 * count, as the half of all: two particles that arrived together look wider, never
 * narrower. */
static double unlikely(
	int own, const struct joint_deviation *w, size_t n, double var, double *slope)
{
	const double half = own == JOINT_WIDTH ? 0.5 : 1;
	const double free =
		(double)n / ((double)n - 2); /* of the line's two parameters */
	double error[JOINT_SCATTER_MAX], sum = 0;
	struct line middle;

	for (size_t i = 0; i < n; i++)
		error[i] = sqrt(var + w[i].se * w[i].se);
	middle = centre(w, error, n);
	*slope = 0;
	for (size_t i = 0; i < n; i++) {
		double deviation = below(&middle, &w[i]) / error[i];
		double square = own == JOINT_WIDTH && deviation < 0
					? 0
					: free * deviation * deviation;

		sum += square + 2 * half * log(error[i]);
		*slope += (half - square) / (error[i] * error[i]);
	}
	return sum;
}

/* Largest scatter: the deviations are linear in what a pulse has of its own, and three
 * standard deviations of this are then a factor of two. */
static const double MOST = M_LN2 / SIGMAS_SELDOM;

double joint_scatter(int own, const struct joint_deviation *w, size_t n, double certain)
{
	enum { ROUNDS = 24 };
	double none, lo = 0, hi = 0, slope;

	if (n < 3)
		return 0;
	none = unlikely(own, w, n, 0, &slope);
	if (!(slope < 0))
		return 0;
	for (size_t i = 0; i < n; i++)
		hi = fmax(hi, w[i].share * w[i].share);
	for (int k = 0; k < ROUNDS; k++) {
		double middle = 0.5 * (lo + hi);

		unlikely(own, w, n, middle, &slope);
		if (slope < 0)
			lo = middle;
		else
			hi = middle;
	}
	return sqrt(hi) < MOST && none - unlikely(own, w, n, hi, &slope) > certain
		       ? sqrt(hi)
		       : 0;
}

/* What a pulse leaves by three standard deviations is no other pulse: with 3, 2, 1 and
 * 0.5 of those of the ratio, 1060, 1064, 1078 and 918 of 1149 particles in eleven records
 * were claimed rightly, and 1, 4, 8 and 11 rows wrong. */
void joint_set_scatter(struct joint_scene *s, int own, double scatter,
	const struct joint_deviation *w, size_t n, double misfit)
{
	double left = 0;

	for (size_t i = 0; i < n; i++)
		left += w[i].left / (double)n;
	s->scatter[own] = scatter;
	s->misfit = fmax(misfit, pow(SIGMAS_SELDOM * scatter, 2) * left);
}
