#include "stats/statistics.h"
#include "num/status.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>

/* Weibull */

/* The parameters of the search are ln k and K ln s, with K about k: all curvatures are
 * then of the order of 1, however narrow the distribution. */
struct sample {
	const double *log; /* of the values over the unit */
	const double *weight;
	size_t n;
	double count; /* sum of the weights */
	double low, high, mean_log, stretch /* K */;
};

static double weight_of(const double *weight, size_t i)
{
	return weight ? weight[i] : 1;
}

/* F(high) - F(low), computed so that a small tail is not lost. */
static double window(double low, double high, double k, double s)
{
	double a = pow(low / s, k), b = pow(high / s, k);

	return a > 0 ? exp(-a) * -expm1(a - b) : -expm1(-b);
}

/* Negative log likelihood over n. */
static double minus_log(const struct sample *m, double log_k, double stretched)
{
	double k = exp(log_k), log_s = stretched / m->stretch, sum = 0;

	for (size_t i = 0; i < m->n; i++)
		sum += weight_of(m->weight, i) * exp(k * (m->log[i] - log_s));
	return -(log_k - log_s + (k - 1) * (m->mean_log - log_s) - sum / m->count -
		 log(window(m->low, m->high, k, exp(log_s))));
}

/* Derivative of the likelihood of a whole distribution by the shape, with the scale at
 * its best, and its own derivative: it falls through zero at the maximum. */
static double shape_equation(const struct sample *m, double k, double *derivative)
{
	double sum = 0, logs = 0, squares = 0;

	for (size_t i = 0; i < m->n; i++) {
		double l = m->log[i], p = weight_of(m->weight, i) * exp(k * l);

		sum += p;
		logs += p * l;
		squares += p * l * l;
	}
	logs /= sum;
	*derivative = -1 / (k * k) - (squares / sum - logs * logs);
	return 1 / k + m->mean_log - logs;
}

/* Newton's method within a bracket, which is doubled until it holds the maximum. */
static double whole_shape(const struct sample *m)
{
	/* A shape of 1e-3 has diameters over 1000 decades.  Diameters that differ by the
	 * least that weibull_fit() accepts, 1e-12, have a shape of some 1e12: 40
	 * doublings, and at most 53 halvings in place of Newton's steps. */
	double low = 1e-3, high = INFINITY, k = 1, slope;

	for (int i = 0; i < 200; i++) {
		double f = shape_equation(m, k, &slope), next = k - f / slope;

		if (f > 0)
			low = k;
		else
			high = k;
		if (!(next > low && next < high))
			next = isfinite(high) ? 0.5 * (low + high) : 2 * k;
		if (fabs(next - k) < 1e-15 * k)
			break;
		k = next;
	}
	return k;
}

/* t exp(-t) with t = (x / s)^k, and the same times ln t; 0 at x = 0 and infinity. */
static double edge(double x, double k, double s, double *with_log)
{
	double t = pow(x / s, k), e = t > 0 && t < 700 ? t * exp(-t) : 0;

	*with_log = e > 0 ? e * k * log(x / s) : 0;
	return e;
}

/* Gradient of minus_log() in closed form. */
static void slope(const struct sample *m, const double p[2], double g[2])
{
	double k = exp(p[0]), log_s = p[1] / m->stretch, s = exp(log_s);
	double sum = 0, logs = 0, la, lb, n = m->count;
	double w = window(m->low, m->high, k, s);
	double a = edge(m->low, k, s, &la), b = edge(m->high, k, s, &lb);

	for (size_t i = 0; i < m->n; i++) {
		double l = m->log[i] - log_s, u = weight_of(m->weight, i) * exp(k * l);

		sum += u;
		logs += u * l;
	}
	g[0] = -(1 + k * (m->mean_log - log_s) - k * logs / n - (lb - la) / w);
	g[1] = -(-k + k * sum / n - k * (a - b) / w) / m->stretch;
}

/* Curvature (11, 12, 22) by central differences of the gradient. */
static void curvature(const struct sample *m, const double p[2], double h[3])
{
	/* About the cube root of the rounding unit, where the error of the difference,
	 * d^2, and its rounding, unit / d, are alike: 1e-10 of the curvature. */
	static const double d = 1e-5;
	double up[2], down[2], q[2];

	for (int i = 0; i < 2; i++) {
		q[0] = p[0] + (i == 0 ? d : 0), q[1] = p[1] + (i == 1 ? d : 0);
		slope(m, q, up);
		q[0] = p[0] - (i == 0 ? d : 0), q[1] = p[1] - (i == 1 ? d : 0);
		slope(m, q, down);
		if (i == 0)
			h[0] = (up[0] - down[0]) / (2 * d);
		else
			h[2] = (up[1] - down[1]) / (2 * d);
		h[1] = (up[1 - i] - down[1 - i]) / (2 * d);
	}
}

/* Newton's step; where the curvature is not that of a minimum, or hardly so, the missing
 * is added in all directions.  How much is added changes the number of steps alone, for
 * descend() takes none that leads up and ends where the slope vanishes: a thousandth of
 * the curvature bounds the step where that is singular. */
static void newton_step(const double g[2], const double h[3], double step[2])
{
	double middle = 0.5 * (h[0] + h[2]), radius = hypot(0.5 * (h[0] - h[2]), h[1]);
	double least = middle - radius, wanted = 1e-3 * (fabs(middle) + radius);
	double add = least < wanted ? wanted - least : 0;
	double a = h[0] + add, c = h[2] + add, det = a * c - h[1] * h[1];

	step[0] = (h[1] * g[1] - c * g[0]) / det;
	step[1] = (h[1] * g[0] - a * g[1]) / det;
}

/* The logarithm of the shape, or that of the scale over its width: e^20 from the start is
 * a power law, whose likelihood has no maximum on the way, or has reached its limit. */
static const double FAR = 20;

static int is_far(const struct sample *m, const double p[2])
{
	return !(fabs(p[0] - log(m->stretch)) < FAR &&
		 fabs(p[1]) < FAR * fmax(m->stretch, 1));
}

/* Minimum from p on, with steps of at most a half that never increase the value;
 * NUM_DOMAIN if there is none.  held: the parameter that keeps its value, -1: none. */
static enum num_status descend(const struct sample *m, int held, double p[2], double h[3])
{
	/* Steps of half a unit cross FAR in 40; 500 leave room for steps that were
	 * halved. Where the slope is 1e-7 the value exceeds its minimum by some 1e-14,
	 * its rounding; Newton's step from there leaves the square of the slope.  An end
	 * of an interval is determined to the root of that rounding. */
	enum { STEPS = 500 };
	static const double longest = 0.5;
	double flat = held < 0 ? 1e-7 : 1e-5;
	double here = minus_log(m, p[0], p[1]), g[2], step[2];

	for (int i = 0; i < STEPS && !is_far(m, p); i++) {
		double size, there, steep;

		slope(m, p, g);
		curvature(m, p, h);
		if (held >= 0) {
			g[held] = h[1] = 0;
			h[2 * held] = h[2 - 2 * held];
		}
		steep = hypot(g[0], g[1]);
		newton_step(g, h, step);
		/* Nearer the value of the function shows no difference: the last step. */
		if (steep < flat) {
			p[0] += step[0];
			p[1] += step[1];
			return h[0] > 0 && h[0] * h[2] > h[1] * h[1] ? NUM_OK
								     : NUM_DOMAIN;
		}
		size = fmin(1, longest / hypot(step[0], step[1]));
		there = minus_log(m, p[0] + size * step[0], p[1] + size * step[1]);
		while (!(there <= here) && size > 1e-12) {
			size /= 2;
			there = minus_log(
				m, p[0] + size * step[0], p[1] + size * step[1]);
		}
		if (!(there <= here))
			return NUM_DOMAIN;
		p[0] += size * step[0];
		p[1] += size * step[1];
		here = there;
	}
	return NUM_DOMAIN;
}

/* What the negative log likelihood over n is at least with parameter i held, and there
 * the other one.  With another shape the scale is sought over the width of that. */
static double least_minus_log(const struct sample *m, int i, double p[2])
{
	struct sample scaled = *m;
	double q[2] = { p[0], p[1] }, h[3], ratio;

	if (i == 0)
		scaled.stretch = exp(p[0]);
	ratio = scaled.stretch / m->stretch;
	q[1] *= ratio;
	descend(&scaled, i, q, h);
	p[1 - i] = i == 0 ? q[1] / ratio : q[0];
	return minus_log(&scaled, q[0], q[1]);
}

/* An end of the interval of parameter i, on the side of this deviation from the best
 * values: where the likelihood, at its maximum over the other parameter, has fallen by
 * fall from its own.  INFINITY with the sign of the side where it never does. */
static double interval_end(const struct sample *m, const double best[2], int i,
	double deviation, double fall)
{
	double limit = minus_log(m, best[0], best[1]) + fall;
	double far = i == 0 ? FAR : FAR * fmax(m->stretch, 1);
	double inside = best[i], below = -fall, outside, above;
	double p[2] = { best[0], best[1] };

	for (p[i] += deviation;; p[i] = best[i] + 2 * (p[i] - best[i])) {
		if (!(fabs(p[i] - best[i]) < far))
			return copysign(INFINITY, deviation);
		outside = p[i];
		above = least_minus_log(m, i, p) - limit;
		if (!(above < 0))
			break;
		inside = outside;
		below = above;
	}
	/* The Illinois method, to about the digits that the likelihood determines. */
	for (int k = 0; k < 60 && fabs(outside - inside) > 1e-8 * fabs(deviation); k++) {
		double value, at = (inside * above - outside * below) / (above - below);

		if (!(fabs(at - inside) < fabs(outside - inside)))
			at = 0.5 * (inside + outside);
		p[i] = at;
		value = least_minus_log(m, i, p) - limit;
		if (value < 0) {
			above *= 0.5;
			inside = at;
			below = value;
		} else {
			below *= 0.5;
			outside = at;
			above = value;
		}
	}
	return inside;
}

static double distribution(const struct weibull *w, double x)
{
	double k = w->shape.value, s = w->scale.value;

	return window(w->low, x, k, s) / window(w->low, w->high, k, s);
}

double weibull_density(const struct weibull *w, double x)
{
	double k = w->shape.value, s = w->scale.value, t = pow(x / s, k);

	if (x < w->low || x > w->high || x < 0)
		return 0;
	return k / s * pow(x / s, k - 1) * exp(-t) / window(w->low, w->high, k, s);
}

double weibull_distance(
	const struct weibull *w, const double *x, const double *weight, size_t n)
{
	double most = 0, all = 0, below = 0;

	for (size_t i = 0; i < n; i++)
		all += weight_of(weight, i);
	for (size_t i = 0; i < n; i++) {
		double f = distribution(w, x[i]), next = below + weight_of(weight, i);

		most = fmax(most, fmax(f - below / all, next / all - f));
		below = next;
	}
	return most;
}

/* The interval of parameter i, whose logarithm is over scale, by its standard deviation
 * from the curvature, which is where the search for its ends begins. */
static struct estimate log_interval(const struct sample *m, const double p[2], int i,
	double deviation, double t, double scale, double unit)
{
	double end[2] = { NAN, NAN };
	/* That of a normal law whose width is found from as many values less two. */
	double fall = 0.5 * log1p(t * t / (m->count - 2));

	for (int k = 0; k < 2 && !isnan(t); k++)
		end[k] = interval_end(m, p, i, k ? deviation : -deviation, fall);
	return (struct estimate){ unit * exp(p[i] / scale), unit * exp(end[0] / scale),
		unit * exp(end[1] / scale) };
}

/* For values divided by their mean. */
static enum weibull_status fit_scaled(
	struct sample *m, double unit, double confidence, struct weibull *w)
{
	double p[2], h[3], det, sum = 0;
	double k = whole_shape(m), n = m->count;
	double t = n > 2 ? gsl_cdf_tdist_Pinv(0.5 + 0.5 * confidence, n - 2) : NAN;

	for (size_t i = 0; i < m->n; i++)
		sum += weight_of(m->weight, i) * exp(k * m->log[i]);
	m->stretch = k;
	p[0] = log(k);
	p[1] = log(sum / n);
	if (m->low > 0 || isfinite(m->high)) {
		if (descend(m, -1, p, h))
			return WEIBULL_NONE;
	} else {
		curvature(m, p, h);
	}
	det = h[0] * h[2] - h[1] * h[1];
	if (!(det > 0 && h[0] > 0 && h[2] > 0))
		return WEIBULL_NONE;
	w->shape = log_interval(m, p, 0, sqrt(h[2] / det / n), t, 1, 1);
	w->scale = log_interval(m, p, 1, sqrt(h[0] / det / n), t, m->stretch, unit);
	w->low = m->low * unit;
	w->high = m->high * unit;
	w->mean = w->scale.value * tgamma(1 + 1 / w->shape.value);
	return WEIBULL_OK;
}

enum weibull_status weibull_fit(const double *x, const double *weight, size_t n,
	double low, double high, double confidence, struct weibull *w)
{
	double *y, unit = 0, least = INFINITY, most = 0;
	struct sample m = { .weight = weight, .n = n };
	enum weibull_status status;

	for (size_t i = 0; i < n; i++) {
		if (!(x[i] > 0) || x[i] < low || x[i] > high)
			return WEIBULL_NONE;
		m.count += weight_of(weight, i);
		unit += (x[i] - unit) * weight_of(weight, i) / m.count;
		least = fmin(least, x[i]);
		most = fmax(most, x[i]);
	}
	if (n < 2 || least >= most * (1 - 1e-12))
		return WEIBULL_NONE;
	y = malloc(n * sizeof *y);
	if (!y)
		return WEIBULL_MEMORY;
	for (size_t i = 0; i < n; i++) {
		double away = (x[i] - unit) / unit;

		/* Nearly equal values differ by all the digits there are; of values far
		 * below the mean the difference keeps none. */
		y[i] = fabs(away) < 0.5 ? log1p(away) : log(x[i] / unit);
		m.mean_log += y[i] * weight_of(weight, i) / m.count;
	}
	m.log = y;
	m.low = low / unit;
	m.high = high / unit;
	status = fit_scaled(&m, unit, confidence, w);
	free(y);
	return status;
}

/* Power law */

/* Best factor and offset for an exponent; sum of squared residuals. */
static double linear_fit(const double *x, const double *y, size_t n, double exponent,
	double unit, double *factor, double *offset)
{
	double mx = 0, my = 0, xx = 0, xy = 0, rest = 0;

	for (size_t i = 0; i < n; i++) {
		mx += pow(x[i] / unit, exponent) / (double)n;
		my += y[i] / (double)n;
	}
	for (size_t i = 0; i < n; i++) {
		double u = pow(x[i] / unit, exponent) - mx;

		xx += u * u;
		xy += u * (y[i] - my);
	}
	*factor = xy / xx;
	*offset = my - *factor * mx;
	for (size_t i = 0; i < n; i++) {
		double r = y[i] - *factor * pow(x[i] / unit, exponent) - *offset;

		rest += r * r;
	}
	return rest;
}

/* Inverse of the symmetric 3 x 3 matrix a (xx xy xz yy yz zz): its diagonal. */
static void inverse_diagonal(const double a[6], double out[3])
{
	double c0 = a[3] * a[5] - a[4] * a[4], c1 = a[1] * a[5] - a[2] * a[4];
	double c2 = a[1] * a[4] - a[2] * a[3], det = a[0] * c0 - a[1] * c1 + a[2] * c2;

	out[0] = c0 / det;
	out[1] = (a[0] * a[5] - a[2] * a[2]) / det;
	out[2] = (a[0] * a[3] - a[1] * a[1]) / det;
}

static struct estimate t_interval(
	double value, double deviation, double dof, double confidence)
{
	struct estimate e = { value, NAN, NAN };

	if (dof >= 1) {
		double t = gsl_cdf_tdist_Pinv(0.5 + 0.5 * confidence, dof);

		e.low = value - t * deviation;
		e.high = value + t * deviation;
	}
	return e;
}

/* Exponents that can be distinguished from a logarithm and a step: over a decade, x^b
 * differs from 1 + b ln x by b^2 / 2 (ln 10)^2, 3e-4 at the least of these, and at the
 * most of them, 20, a point at half the largest x lies 1e-6 of the rise above the first.
 */
static const double LEAST_EXPONENT = 0.01, EXPONENTS = 2000; /* most over least */

/* Golden-section search around the best of a grid of exponents, to a hundredth of
 * the 1e-8 that rounding leaves of the place of a minimum; -1 if that is at an end of the
 * grid.  Of 4000 random sets of 4 to 23 points, 38 of which have several minima, grids
 * of 15 to 120 steps all lead to the one of a grid of 1920, except those next to an end:
 * 19, 9, 5 and 3 with 15, 30, 60 and 120 steps. */
static double best_exponent(const double *x, const double *y, size_t n, double unit)
{
	static const double golden = 0.6180339887498949;
	double best = INFINITY, a, b, c, d, fc, fd, factor, offset;
	enum { STEPS = 120 };
	int at = 0;

	for (int i = 0; i <= STEPS; i++) {
		double f = linear_fit(x, y, n,
			LEAST_EXPONENT * pow(EXPONENTS, (double)i / STEPS), unit, &factor,
			&offset);

		if (f < best) {
			best = f;
			at = i;
		}
	}
	if (at == 0 || at == STEPS)
		return -1;
	a = LEAST_EXPONENT * pow(EXPONENTS, (double)(at - 1) / STEPS);
	b = LEAST_EXPONENT * pow(EXPONENTS, (double)(at + 1) / STEPS);
	c = b - golden * (b - a);
	d = a + golden * (b - a);
	fc = linear_fit(x, y, n, c, unit, &factor, &offset);
	fd = linear_fit(x, y, n, d, unit, &factor, &offset);
	while (b - a > 1e-10 * b) {
		if (fc < fd) {
			b = d, d = c, fd = fc;
			c = b - golden * (b - a);
			fc = linear_fit(x, y, n, c, unit, &factor, &offset);
		} else {
			a = c, c = d, fc = fd;
			d = a + golden * (b - a);
			fd = linear_fit(x, y, n, d, unit, &factor, &offset);
		}
	}
	return 0.5 * (a + b);
}

static int distinct(const double *x, size_t n)
{
	int count = 0;

	for (size_t i = 0; i < n && count < 3; i++) {
		size_t j = 0;

		while (j < i && x[j] != x[i])
			j++;
		count += j == i;
	}
	return count;
}

enum num_status power_fit(
	const double *x, const double *y, size_t n, double confidence, struct power *p)
{
	double unit = 0, b, factor, offset, rest, jj[6] = { 0 }, var[3], s2,
	       dof = (double)n - 3;

	for (size_t i = 0; i < n; i++) {
		if (!(x[i] > 0))
			return NUM_DOMAIN;
		unit = fmax(unit, x[i]);
	}
	if (distinct(x, n) < 3)
		return NUM_DOMAIN;
	b = best_exponent(x, y, n, unit);
	if (b < 0)
		return NUM_DOMAIN;
	rest = linear_fit(x, y, n, b, unit, &factor, &offset);
	for (size_t i = 0; i < n; i++) {
		double u = pow(x[i] / unit, b), v = factor * u * log(x[i]);

		jj[0] += u * u, jj[1] += u * v, jj[2] += u;
		jj[3] += v * v, jj[4] += v, jj[5] += 1;
	}
	inverse_diagonal(jj, var);
	s2 = dof > 0 ? rest / dof : 0;
	/* The factor of x itself; its deviation with the exponent's is that of the model
	 * in x, for which the derivative by the exponent above holds. */
	p->factor = t_interval(factor * pow(unit, -b), sqrt(s2 * var[0]) * pow(unit, -b),
		dof, confidence);
	p->exponent = t_interval(b, sqrt(s2 * var[1]), dof, confidence);
	p->offset = t_interval(offset, sqrt(s2 * var[2]), dof, confidence);
	p->rms = sqrt(rest / (double)n);
	return NUM_OK;
}

/* Samples */

struct estimate sample_mean(const struct running *r, double confidence)
{
	double mean = r->n > 0 ? r->mean : NAN, deviation;
	struct estimate e;

	deviation = sqrt(running_variance(r) / r->n);
	if (!(mean > 0))
		return t_interval(mean, deviation, r->n - 1, confidence);
	e = t_interval(0, deviation / mean, r->n - 1, confidence);
	return (struct estimate){ mean, mean * exp(e.low), mean * exp(e.high) };
}
