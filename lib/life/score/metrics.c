/* metrics.c - see metrics.h */
#include "life/score/metrics.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>

struct weighted {
	double x, w;
};

struct metrics {
	struct metrics_par par;
	size_t n, infinite;
	double error, abs_error, square_error, accuracy, crps;
	size_t inside, covered;
	double since; /* start of the present uninterrupted run of good predictions; NAN
			 if there is none */
	struct weighted *scratch;
	size_t capacity;
};

double metric_quantile(const double *sorted, size_t n, double level)
{
	double place = level * (double)(n - 1);
	size_t i = (size_t)place;
	double part = place - (double)i;

	if (i + 1 >= n || part == 0)
		return sorted[i < n ? i : n - 1];
	if (isinf(sorted[i + 1]))
		return sorted[i + 1];
	return sorted[i] + part * (sorted[i + 1] - sorted[i]);
}

/* Sums rectangles between neighbours: every term is positive, so that there is no
 * cancellation. */
double metric_crps(
	const double *sorted, const double *weight, size_t n, double truth, double limit)
{
	double total = 0, below = 0, score = 0,
	       left = fmin(fmin(sorted[0], truth), limit);

	truth = fmin(truth, limit);
	for (size_t i = 0; i < n; i++)
		total += weight ? weight[i] : 1;
	for (size_t i = 0; i <= n; i++) {
		double right = i < n ? fmin(sorted[i], limit) : fmax(truth, left);
		double f = below / total;

		if (left < truth) {
			double end = fmin(right, truth);

			if (f > 0)
				score += (end - left) * f * f;
			left = end;
		}
		if (right > left && f < 1)
			score += (right - left) * (1 - f) * (1 - f);
		left = right;
		if (i < n)
			below += weight ? weight[i] : 1;
	}
	return score;
}

/* Share of the weight on samples within [lower, upper], in any order. */
static double mass_within(
	const double *sample, const double *weight, size_t n, double lower, double upper)
{
	double total = 0, inside = 0;

	for (size_t i = 0; i < n; i++) {
		double w = weight ? weight[i] : 1;

		total += w;
		if (sample[i] >= lower && sample[i] <= upper)
			inside += w;
	}
	return inside / total;
}

struct metrics *metrics_new(const struct metrics_par *par)
{
	struct metrics *m;

	if (!isfinite(par->eol) || !(par->alpha > 0) ||
		!(par->beta >= 0 && par->beta <= 1) || !(par->limit >= 0)) {
		errno = EDOM;
		return NULL;
	}
	m = calloc(1, sizeof *m);
	if (!m)
		return NULL;
	m->par = *par;
	if (m->par.limit == 0)
		m->par.limit = INFINITY;
	m->since = NAN;
	return m;
}

void metrics_free(struct metrics *m)
{
	if (m)
		free(m->scratch);
	free(m);
}

static int compare_weighted(const void *a, const void *b)
{
	double x = ((const struct weighted *)a)->x, y = ((const struct weighted *)b)->x;

	return (x > y) - (x < y);
}

/* CRPS of unsorted samples. */
static enum num_status crps_unsorted(struct metrics *m, const double *sample,
	const double *weight, size_t n, double truth, double *crps)
{
	double *x;

	/* Memory first for the pairs, then for the two separate arrays. */
	if (n > m->capacity) {
		struct weighted *more = realloc(m->scratch, 2 * n * sizeof *more);

		if (!more)
			return NUM_MEMORY;
		m->scratch = more;
		m->capacity = n;
	}
	for (size_t i = 0; i < n; i++)
		m->scratch[i] = (struct weighted){ sample[i], weight ? weight[i] : 1 };
	qsort(m->scratch, n, sizeof *m->scratch, compare_weighted);
	x = (double *)(m->scratch + n);
	for (size_t i = 0; i < n; i++) {
		x[i] = m->scratch[i].x;
		x[n + i] = m->scratch[i].w;
	}
	*crps = metric_crps(x, x + n, n, truth, m->par.limit);
	return NUM_OK;
}

enum num_status metrics_add(struct metrics *m, double t, double point, double lower,
	double upper, const double *sample, const double *weight, size_t n,
	struct metrics_row *row)
{
	double truth = m->par.eol - t, wide = m->par.alpha * fabs(m->par.eol);
	struct metrics_row r = { .truth = truth };
	double mass_horizon;

	if (!(truth > 0) || isnan(point))
		return NUM_DOMAIN;
	if (!sample || n == 0) {
		sample = &point;
		weight = NULL;
		n = 1;
	}
	r.error = point - truth;
	r.accuracy = 1 - fabs(r.error) / truth;
	r.mass = mass_within(sample, weight, n, truth * (1 - m->par.alpha),
		truth * (1 + m->par.alpha));
	r.inside = r.mass >= m->par.beta;
	r.covered = lower <= truth && truth <= upper;
	if (crps_unsorted(m, sample, weight, n, truth, &r.crps))
		return NUM_MEMORY;
	mass_horizon = mass_within(sample, weight, n, truth - wide, truth + wide);
	if (mass_horizon < m->par.beta)
		m->since = NAN;
	else if (isnan(m->since))
		m->since = t;
	m->n++;
	if (isinf(point)) {
		m->infinite++;
	} else {
		m->error += r.error;
		m->abs_error += fabs(r.error);
		m->square_error += r.error * r.error;
		m->accuracy += r.accuracy;
	}
	m->crps += r.crps;
	m->inside += (size_t)r.inside;
	m->covered += (size_t)r.covered;
	if (row)
		*row = r;
	return NUM_OK;
}

struct metrics_sum metrics_get(const struct metrics *m)
{
	double n = m->n ? (double)m->n : NAN;
	double finite = m->n > m->infinite ? (double)(m->n - m->infinite) : NAN;

	return (struct metrics_sum){
		.n = m->n,
		.infinite = m->infinite,
		.bias = m->error / finite,
		.mae = m->abs_error / finite,
		.rmse = sqrt(m->square_error / finite),
		.accuracy = m->accuracy / finite,
		.alpha_lambda = (double)m->inside / n,
		.horizon = m->n ? (isnan(m->since) ? 0 : m->par.eol - m->since) : NAN,
		.coverage = (double)m->covered / n,
		.crps = m->crps / n,
	};
}
