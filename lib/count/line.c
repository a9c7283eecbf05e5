#include "count/line.h"
#include "num/status.h"
#include <gsl/gsl_cdf.h>
#include <math.h>

double line_t(double confidence, double degrees)
{
	return gsl_cdf_tdist_Pinv(0.5 + 0.5 * confidence, degrees);
}

enum num_status line_fit(
	const double *x, const double *y, size_t n, double confidence, struct line *l)
{
	double mx = 0, my = 0, xx = 0, xy = 0, rest = 0;

	if (n < 3)
		return NUM_DOMAIN;
	/* About the first x: equal ones have no spread by rounding. */
	for (size_t i = 0; i < n; i++) {
		mx += (x[i] - x[0]) / (double)n;
		my += y[i] / (double)n;
	}
	mx += x[0];
	for (size_t i = 0; i < n; i++) {
		xx += (x[i] - mx) * (x[i] - mx);
		xy += (x[i] - mx) * (y[i] - my);
	}
	if (!(xx > 0))
		return NUM_DOMAIN;
	l->slope = xy / xx;
	l->spread = xx;
	l->middle = mx;
	l->value = my;
	for (size_t i = 0; i < n; i++) {
		double d = y[i] - my - l->slope * (x[i] - mx);

		rest += d * d;
	}
	l->rms = sqrt(rest / (double)(n - 2));
	l->slope_se = l->rms / sqrt(xx);
	l->value_se = l->rms / sqrt((double)n);
	l->degrees = (double)(n - 2);
	l->t = line_t(confidence, l->degrees);
	return NUM_OK;
}

double line_slope_half(const struct line *l, double deviation, double confidence)
{
	double normal = gsl_cdf_ugaussian_Pinv(0.5 + 0.5 * confidence);

	return fmax(l->t * l->slope_se, normal * deviation / sqrt(l->spread));
}

void line_allow_unequal(
	const double *x, const double *y, size_t n, double confidence, struct line *l)
{
	double xx = 0, sum = 0, squares = 0;
	size_t end;

	for (size_t i = 0; i < n; i = end) {
		double u = x[i] - l->middle, group = 0;

		for (end = i; end < n && x[end] == x[i]; end++) {
			double d = y[end] - l->value - l->slope * u;

			xx += u * u;
			group += u * u * d * d;
		}
		sum += group;
		squares += group * group / fmax((double)(end - i) - 1, 1);
	}
	l->slope_se = fmax(l->slope_se, sqrt((double)n / (double)(n - 2) * sum) / xx);
	if (squares > 0)
		l->degrees = fmin(l->degrees, sum * sum / squares);
	l->t = line_t(confidence, l->degrees);
}

/* The points of equal x from one on. */
struct group {
	double x, mean;
	double degrees; /* of freedom of the weight; 0: a single point, or no scatter */
	double weight;  /* the reciprocal of the variance of the mean */
	size_t end;
};

static struct group group_at(const double *x, const double *y, size_t n, size_t begin)
{
	struct group g = { .x = x[begin], .end = begin };
	double squares = 0, count;

	for (; g.end < n && x[g.end] == g.x; g.end++)
		g.mean += y[g.end];
	count = (double)(g.end - begin);
	g.mean /= count;
	for (size_t i = begin; i < g.end; i++)
		squares += (y[i] - g.mean) * (y[i] - g.mean);
	if (squares > 0) {
		g.degrees = count - 1;
		g.weight = count * g.degrees / squares;
	}
	return g;
}

double line_lack_of_fit(const double *x, const double *y, size_t n)
{
	double sum = 0, mx = 0, my = 0, xx = 0, xy = 0, about = 0, loose = 0, groups = 0,
	       q, scale;
	struct group g;

	for (size_t i = 0; i < n; i = g.end) {
		g = group_at(x, y, n, i);
		sum += g.weight;
		mx += g.weight * (g.x - x[0]);
		my += g.weight * g.mean;
		groups += g.degrees > 0;
	}
	if (groups < 3)
		return NAN;
	mx = x[0] + mx / sum;
	my /= sum;
	for (size_t i = 0; i < n; i = g.end) {
		g = group_at(x, y, n, i);
		xx += g.weight * (g.x - mx) * (g.x - mx);
		xy += g.weight * (g.x - mx) * (g.mean - my);
	}
	for (size_t i = 0; i < n; i = g.end) {
		double u, off, lever;

		g = group_at(x, y, n, i);
		u = g.x - mx;
		off = g.mean - my - xy / xx * u;
		lever = g.weight * (1 / sum + u * u / xx);
		about += g.weight * off * off;
		if (g.degrees > 0)
			loose += (1 - lever) * (1 - lever) / g.degrees;
	}
	q = groups - 2;
	scale = q + 2 * loose - 6 * loose / (q + 2);
	return gsl_cdf_fdist_Q(about / scale, q, q * (q + 2) / (3 * loose));
}

struct line_outliers line_outliers(const double *y, size_t n)
{
	struct line_outliers found = { 0, 0, NAN };
	double mean = 0, squares = 0, sum[2] = { 0, 0 }, count = (double)n;

	for (size_t i = 0; i < n; i++)
		mean += y[i] / count;
	for (size_t i = 0; i < n; i++)
		squares += (y[i] - mean) * (y[i] - mean);
	if (n < 3 || !(squares > 0))
		return found;
	found.p = 1;
	for (size_t m = 1; m <= n / 2; m++) {
		double k = (double)m, between, t, ways, p;
		int high;

		sum[0] += mean - y[m - 1];
		sum[1] += y[n - m] - mean;
		high = sum[1] >= sum[0];
		between = pow(sum[high], 2) * count / (k * (count - k));
		t = sqrt((count - 2) * between / fmax(squares - between, 0));
		ways = lgamma(count + 1) - lgamma(k + 1) - lgamma(count - k + 1) +
		       k * log(2);
		p = exp(ways + log(2 * gsl_cdf_tdist_Q(t, count - 2)));
		if (p < found.p)
			found = (struct line_outliers){ high ? n - m : 0, m, p };
	}
	return found;
}

/* Of logarithms of up to 30, over sizes that differ by 1 % or more. */
static const double ROUNDING = 1e-12;

double line_slope_p(const struct line *l, double want)
{
	if (fabs(l->slope - want) <= ROUNDING)
		return 1;
	if (!(l->slope_se > 0))
		return 0;
	return 2 * gsl_cdf_tdist_Q(fabs(l->slope - want) / l->slope_se, l->degrees);
}
