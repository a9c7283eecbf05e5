/* joint_width.c - widths of pulses beside those of their velocities; see joint_state.h */
#include "num/cholesky.h"
#include "num/sigmas.h"
#include "signal/fit/joint_state.h"
#include <string.h>

/* Inner products within channel c of the derivatives of pulses i and k: u of the former,
 * and v of the latter, less what tones and baseline take of them. */
static double inner(const struct joint *j, int c, int i, int u, int k, int v)
{
	const struct column *x = &j->col[i][c], *y = &j->col[k][c];
	const double *of = j->bq + c * j->basis;
	const int nb = 2 * j->basis;

	return dot_within(x->d[u], x->n, y->d[v], y->n, x->first - y->first) -
	       dot(of + (PAR * i + u) * nb, of + (PAR * k + v) * nb, (size_t)j->basis);
}

/* The derivative of pulse i on channel c by its width, over that by its arrival at the
 * other sensor, which changes the velocity, and on this channel nothing but the width. */
static double by_width(const struct joint *j, int i, int c)
{
	return (c ? -1 : 1) * (j->scene.transit + j->pulse[i].delta);
}

/* The same of the residual. */
static double along_width(const struct joint *j, int i)
{
	double sum = 0;

	for (int c = 0; c < 2; c++) {
		const struct column *x = &j->col[i][c];

		sum += by_width(j, i, c) * dot(x->d[1 - c], j->r[c] + x->first, x->n);
	}
	return sum;
}

/* Inner products of the derivative of pulse i by its width with those of pulse k by its
 * width (PAR) and by its parameters. */
static void width_products(const struct joint *j, int i, int k, double out[PAR + 1])
{
	memset(out, 0, (PAR + 1) * sizeof *out);
	for (int c = 0; c < 2; c++) {
		const double own = by_width(j, i, c);

		for (int v = 0; v < PAR; v++)
			out[v] += own * inner(j, c, i, 1 - c, k, v);
		out[PAR] += own * by_width(j, k, c) * inner(j, c, i, 1 - c, k, 1 - c);
	}
}

/* Where measure() leaves what it computes: rows of NPAR, one for each pulse. */
struct part {
	double *by;      /* inner products with the parameters, ... */
	double *move;    /* ... how these move with the width, ... */
	double *inverse; /* ... and inverse of the covariance of the widths */
};

static struct part parts(const struct joint *j)
{
	const size_t rows = (size_t)j->m * NPAR;

	return (struct part){ j->h, j->h + rows, j->h + 2 * rows };
}

/* Fills the parts, and along with what the residual tells of each width. */
static void measure(const struct joint *j, double *along)
{
	const struct part p = parts(j);
	const int m = j->m, np = PAR * m;
	double product[PAR + 1];

	for (int i = 0; i < m; i++) {
		double *by = p.by + i * NPAR, *move = p.move + i * NPAR;

		along[i] = along_width(j, i);
		for (int k = 0; k < m; k++) {
			width_products(j, i, k, product);
			memcpy(by + PAR * k, product, PAR * sizeof *product);
			p.inverse[i * NPAR + k] = product[PAR];
		}
		memcpy(move, by, (size_t)np * sizeof *by);
		joint_solve(j, np, 0, move);
	}
	for (int i = 0; i < m; i++)
		for (int k = 0; k < m; k++)
			p.inverse[i * NPAR + k] -=
				dot(p.by + i * NPAR, p.move + k * NPAR, (size_t)np);
}

size_t joint_widths(struct joint *j, struct joint_width *width, double *explained)
{
	const struct part p = parts(j);
	const size_t m = (size_t)j->m;
	double along[JOINT_PULSES_MAX], share[JOINT_PULSES_MAX];

	*explained = 0;
	if (isinf(j->scene.transit) || j->inverted == 0)
		return 0;
	measure(j, along);
	for (size_t i = 0; i < m; i++)
		width[i].left = p.inverse[i * NPAR + i] /
				(pow(j->pulse[i].a, 2) * joint_energy(&j->scene));
	for (size_t i = 0; i < m; i++) /* before the prior was used */
		along[i] += dot(p.inverse + i * NPAR, j->wide, m);
	if (cholesky_factor(p.inverse, m, NPAR, 1e-13) != NUM_OK)
		return 0;
	memcpy(share, along, sizeof share);
	cholesky_solve(p.inverse, m, NPAR, share);
	for (size_t i = 0; i < m; i++) {
		double own[JOINT_PULSES_MAX] = { 0 };

		own[i] = 1;
		cholesky_solve(p.inverse, m, NPAR, own);
		width[i].at = j->pulse[i].t;
		width[i].share = share[i];
		width[i].se = sqrt(own[i]);
		*explained += share[i] * along[i];
	}
	return m;
}

/* Moves pulse i, whose arrivals and amplitude change by shift, and its width. */
static void move_pulse(struct joint *j, int i, double wider, const double shift[PAR])
{
	struct joint_pulse *p = &j->pulse[i];

	for (int c = 0; c < 2; c++) {
		const struct column *x = &j->col[i][c];
		double *r = j->r[c] + x->first;

		add_scaled(r, -wider * by_width(j, i, c), x->d[1 - c], x->n);
		for (int u = 0; u < PAR; u++)
			add_scaled(r, -shift[u], x->d[u], x->n);
	}
	p->t += shift[0];
	p->delta += shift[1] - shift[0];
	p->a += shift[2];
}

/* Widths that differ from those of the velocities move the parameters: a prior of zero
 * mean is combined with what the residual tells of them.  Linear, since they are small.
 */
void joint_relax(struct joint *j)
{
	const struct part p = parts(j);
	const size_t m = (size_t)j->m;
	const double prior = 1 / (j->scene.widths * j->scene.widths);
	double *wide = j->wide, along[JOINT_PULSES_MAX];

	memset(wide, 0, m * sizeof *wide);
	if (!(j->scene.widths > 0) || isinf(j->scene.transit) || j->inverted == 0)
		return;
	measure(j, along);
	for (size_t i = 0; i < m; i++)
		p.inverse[i * NPAR + i] += prior;
	if (cholesky_factor(p.inverse, m, NPAR, 1e-13) != NUM_OK)
		return;
	memcpy(wide, along, m * sizeof *wide);
	cholesky_solve(p.inverse, m, NPAR, wide);
	for (int i = 0; i < j->m; i++) {
		double shift[PAR], column[PAR][JOINT_PULSES_MAX];
		double spread[JOINT_PULSES_MAX];

		for (int u = 0, cell = 0; u < PAR; u++) {
			for (size_t k = 0; k < m; k++)
				column[u][k] = p.move[k * NPAR + (size_t)(PAR * i + u)];
			shift[u] = -dot(wide, column[u], m);
			memcpy(spread, column[u], m * sizeof *spread);
			cholesky_solve(p.inverse, m, NPAR, spread);
			for (int v = 0; v <= u; v++)
				j->pulse[i].cov[cell++] += dot(spread, column[v], m);
		}
		j->result.chi2 -= wide[i] * along[i];
		move_pulse(j, i, wide[i], shift);
	}
}

/* A straight line of widths in time, which passes through two of them. */
struct line {
	const struct joint_width *from, *to;
};

static double below(const struct line *l, const struct joint_width *w)
{
	const struct joint_width *a = l->from, *b = l->to;
	double slope = b->at == a->at ? 0 : (b->share - a->share) / (b->at - a->at);

	return w == b ? 0 : a->share + slope * (w->at - a->at) - w->share;
}

/* The line of least deviations over their errors: a median that follows an instrument
 * which changes slowly.  It is the best through either of its points: the sum is convex.
 */
static struct line centre(const struct joint_width *w, const double *error, size_t n)
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
 * constant; slope: its derivative by the variance.  Only what lies below the line counts,
 * and for both sides: two particles that arrived together look wider, never narrower. */
static double unlikely(const struct joint_width *w, size_t n, double var, double *slope)
{
	double error[JOINT_WIDTHS_MAX], sum = 0;
	struct line middle;

	for (size_t i = 0; i < n; i++)
		error[i] = sqrt(var + w[i].se * w[i].se);
	middle = centre(w, error, n);
	*slope = 0;
	for (size_t i = 0; i < n; i++) {
		double deviation = fmax(0, below(&middle, &w[i]) / error[i]);
		double square = deviation * deviation;

		sum += square + log(error[i]);
		*slope += (0.5 - square) / (error[i] * error[i]);
	}
	return sum;
}

double joint_width_scatter(const struct joint_width *w, size_t n, double certain)
{
	enum { ROUNDS = 24 };
	double none, lo = 0, hi = 0, slope;

	none = unlikely(w, n, 0, &slope);
	if (!(slope < 0))
		return 0;
	for (size_t i = 0; i < n; i++)
		hi = fmax(hi, w[i].share * w[i].share);
	for (int k = 0; k < ROUNDS; k++) {
		double middle = 0.5 * (lo + hi);

		unlikely(w, n, middle, &slope);
		if (slope < 0)
			lo = middle;
		else
			hi = middle;
	}
	return none - unlikely(w, n, hi, &slope) > certain ? sqrt(hi) : 0;
}

void joint_set_widths(struct joint_scene *s, double scatter, const struct joint_width *w,
	size_t n, double misfit)
{
	double left = 0;

	for (size_t i = 0; i < n; i++)
		left += w[i].left / (double)n;
	s->widths = scatter;
	s->misfit = fmax(misfit, pow(SIGMAS_SELDOM * s->widths, 2) * left);
}
