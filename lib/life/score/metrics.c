/* metrics.c - see metrics.h */
#include "life/score/metrics.h"
#include "num/select.h"
#include <math.h>

void metric_cut(double *sample, size_t n, double horizon)
{
	for (size_t i = 0; i < n; i++)
		if (!(sample[i] <= horizon))
			sample[i] = INFINITY;
	sort_numbers(sample, n);
}

/* A running mean does not overflow at 1e300. */
double metric_mean(const double *sorted, size_t n, size_t *failed)
{
	double mean = 0;

	for (*failed = 0; *failed < n && isfinite(sorted[*failed]); ++*failed)
		mean += (sorted[*failed] - mean) / (double)(*failed + 1);
	return *failed ? mean : NAN;
}

/* Sums rectangles between neighbours: every term is positive, so that there is no
 * cancellation. */
double metric_crps(const double *sorted, size_t n, double truth, double limit)
{
	double score = 0, left = fmin(fmin(sorted[0], truth), limit);

	truth = fmin(truth, limit);
	for (size_t i = 0; i <= n; i++) {
		double right = i < n ? fmin(sorted[i], limit) : fmax(truth, left);
		double f = (double)i / (double)n;

		if (left < truth) {
			double end = fmin(right, truth);

			if (f > 0)
				score += (end - left) * f * f;
			left = end;
		}
		if (right > left && f < 1)
			score += (right - left) * (1 - f) * (1 - f);
		left = right;
	}
	return score;
}

/* Share of the samples within [lower, upper]. */
static double share_within(const double *sample, size_t n, double lower, double upper)
{
	size_t inside = 0;

	for (size_t i = 0; i < n; i++)
		inside += sample[i] >= lower && sample[i] <= upper;
	return (double)inside / (double)n;
}

enum num_status metrics_add(struct metrics *m, double t, double point, double lower,
	double upper, const double *sample, size_t n, struct metrics_row *row)
{
	double truth = m->eol - t, wide = m->alpha * fabs(m->eol);
	struct metrics_row r = { .truth = truth };

	if (!(truth > 0) || isnan(point))
		return NUM_DOMAIN;
	r.error = point - truth;
	r.accuracy = 1 - fabs(r.error) / truth;
	r.mass = share_within(sample, n, truth * (1 - m->alpha), truth * (1 + m->alpha));
	r.inside = r.mass >= 0.5;
	r.covered = lower <= truth && truth <= upper;
	r.crps = metric_crps(sample, n, truth, m->limit > 0 ? m->limit : INFINITY);
	if (share_within(sample, n, truth - wide, truth + wide) < 0.5)
		m->horizon = 0;
	else if (m->horizon == 0)
		m->horizon = truth;
	m->n++;
	if (isinf(point)) {
		m->infinite++;
	} else {
		m->bias += r.error;
		m->mae += fabs(r.error);
		m->rmse += r.error * r.error;
		m->accuracy += r.accuracy;
	}
	m->crps += r.crps;
	m->alpha_lambda += r.inside;
	m->coverage += r.covered;
	if (row)
		*row = r;
	return NUM_OK;
}

struct metrics metrics_get(const struct metrics *m)
{
	struct metrics mean = *m;
	double n = m->n ? (double)m->n : NAN;
	double finite = m->n > m->infinite ? (double)(m->n - m->infinite) : NAN;

	mean.bias /= finite;
	mean.mae /= finite;
	mean.rmse = sqrt(m->rmse / finite);
	mean.accuracy /= finite;
	mean.alpha_lambda /= n;
	mean.horizon = m->n ? m->horizon : NAN;
	mean.coverage /= n;
	mean.crps /= n;
	return mean;
}
