/* calibrate.c - see calibrate.h */
#include "signal/calibrate.h"
#include "signal/align.h"
#include "signal/joint.h"
#include "signal/robust.h"
#include "signal/sections.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EXAMPLES_MAX = 16, EXAMPLE_PULSES = 16, RANGE_EVENTS = 12 };

/* A section used to learn the pulse: samples of noise 1 and the pulses found in it. */
struct example {
	const double *y1, *y2;
	size_t n;
	struct joint_pulse pulse[EXAMPLE_PULSES];
	int m;
};

struct learning {
	struct joint *joint;
	struct joint_scene scene;
	struct example example[EXAMPLES_MAX];
	int count;
	double misfit; /* of joint.h, at the end */
};

double calibrate_drop(double rate, const struct shape *shape, double duration,
	double gain, double width)
{
	double lambda =
		shape_slope_energy(shape) / shape_energy(shape) / (duration * duration);
	double area = width * lambda * gain / (1 + gain * gain) / pow(2 * acos(-1), 1.5);
	double edge = sqrt(lambda) / (2 * acos(-1)), lo = 1, hi = 40;

	while (hi - lo > 1e-6) {
		double u = (lo + hi) / 2;

		if ((area * u + edge) * exp(-u * u / 2) > rate)
			lo = u;
		else
			hi = u;
	}
	return hi * hi;
}

int calibrate_clean(const struct calibration *c, double *x, size_t n, double *change)
{
	double before[2 * TONES_MAX + 1], after[2 * TONES_MAX + 1], at = 0;
	size_t hop = c->tone_hop < n ? c->tone_hop : n;
	double squares = 0, count = 0;

	for (size_t middle = hop / 2, done = 0; done < n; middle += hop) {
		size_t from = middle > hop ? middle - hop : 0;
		size_t to = middle + hop < n ? middle + hop : n, until;

		if (from + hop > n) /* the last stretch keeps its length */
			from = n - hop;
		if (!tones_fit(x + (from > done ? from : done),
			    to - (from > done ? from : done),
			    (double)(from > done ? from : done), c->tones, c->omega,
			    after, NULL, NULL))
			return 0;
		if (done == 0)
			memcpy(before, after, sizeof before);
		for (int k = 1; done > 0 && k <= 2 * c->tones; k++) {
			squares += (after[k] - before[k]) * (after[k] - before[k]);
			count++;
		}
		until = middle < n ? middle : n;
		if (middle + hop / 2 >= n)
			until = n;
		tones_remove(x + done, until - done, (double)done, c->tones, c->omega, at,
			before, (double)middle, after);
		memcpy(before, after, sizeof before);
		at = (double)middle;
		done = until;
	}
	*change = count > 0 ? squares / count : INFINITY;
	return 1;
}

static int is_constant(const double *x, size_t n)
{
	for (size_t i = 1; i < n; i++)
		if (x[i] != x[0])
			return 0;
	return 1;
}

static double variance(const double *x, size_t n)
{
	double mean = 0, sum = 0;

	for (size_t i = 0; i < n; i++)
		mean += x[i] / (double)n;
	for (size_t i = 0; i < n; i++)
		sum += (x[i] - mean) * (x[i] - mean);
	return sum / (double)n;
}

/* First minimum of the autocorrelation after its smallest value has been passed by a
 * clear rise; lag in samples, 0 where there is none. */
static double lowest_lag(const double *r, size_t max_lag)
{
	size_t low = 1;

	for (size_t k = 2; k <= max_lag; k++) {
		if (r[k] < r[low])
			low = k;
		else if (r[low] < 0 && r[k] > 0.5 * r[low])
			break;
	}
	return low < max_lag && r[low] < 0 ? (double)low : 0;
}

/* The same of one pulse, as a share of its duration. */
static double shape_lowest_lag(const struct shape *shape)
{
	enum { T = 100, LAGS = 100 };
	size_t n = (size_t)(2 * shape_reach(shape) * T) + 2;
	double *p = calloc(n + LAGS, sizeof *p), r[LAGS + 1] = { 0 }, low = 0.5;

	if (p) {
		shape_sample(shape, shape_reach(shape) * T, T, 0, n, p, NULL, NULL);
		for (int k = 0; k <= LAGS; k++)
			for (size_t i = 0; i < n; i++)
				r[k] += p[i] * p[i + (size_t)k];
		low = lowest_lag(r, LAGS) / T;
	}
	free(p);
	return low;
}

/* Chi-square of all examples with their pulses refined under the present scene; the
 * pulses themselves stay unless keep. */
static double examples_chi2(struct learning *l, int keep)
{
	double sum = 0;

	for (int i = 0; i < l->count; i++) {
		struct example *e = &l->example[i];
		struct joint_pulse pulse[EXAMPLE_PULSES];
		struct joint_result result;

		memcpy(pulse, e->pulse, sizeof pulse);
		if (joint_refine(l->joint, &l->scene, e->y1, e->y2, e->n, pulse, e->m,
			    &result) != JOINT_OK)
			return INFINITY;
		if (keep)
			memcpy(e->pulse, pulse, sizeof pulse);
		sum += result.chi2;
	}
	return sum;
}

/* Finds the pulses of all examples anew.  Returns the median of their chi-square per
 * degree of freedom, which a few examples with hidden pulses do not spoil; *price is
 * the sum of chi-square and of twice the threshold for each pulse. */
static double examples_fit(struct learning *l, double misfit, double *price)
{
	double each[EXAMPLES_MAX];

	*price = 0;
	l->scene.misfit = misfit > l->misfit ? misfit : l->misfit;
	for (int i = 0; i < l->count; i++) {
		struct example *e = &l->example[i];
		struct joint_result result;

		e->m = 0;
		if (joint_fit(l->joint, &l->scene, e->y1, e->y2, e->n, e->pulse, &e->m,
			    &result) != JOINT_OK)
			return INFINITY;
		each[i] = result.chi2 / (double)result.dof;
		*price += result.chi2 + 2 * l->scene.drop_near * e->m;
	}
	return robust_median(each, (size_t)l->count);
}

/* Moves *parameter by a factor to the least chi-square: parabolas through three points
 * on the logarithm, the step shrinking. */
static void minimise(struct learning *l, double *parameter, double step, int rounds)
{
	double middle = examples_chi2(l, 1);

	for (int round = 0; round < rounds; round++) {
		double x = *parameter, below, above, bend, move;

		*parameter = x * exp(-step);
		below = examples_chi2(l, 0);
		*parameter = x * exp(step);
		above = examples_chi2(l, 0);
		bend = below - 2 * middle + above;
		move = bend > 0 ? 0.5 * (below - above) / bend : below < above ? -1 : 1;
		if (move > 2)
			move = 2;
		if (move < -2)
			move = -2;
		*parameter = x * exp(step * move);
		above = examples_chi2(l, 0);
		if (above < middle)
			middle = examples_chi2(l, 1);
		else
			*parameter = x;
		step /= 3;
	}
}

/* Keeps y1, y2[from, to) if it is among the most clearest.  loud: merits of those kept.
 */
static void offer_example(struct learning *l, const double *y1, const double *y2,
	long long from, long long to, int most, double shortest, double *loud)
{
	double energy = 0, merit, length = (double)(to - from);
	int at;

	if (length < 1.5 * shortest / 2)
		return;
	for (long long i = from; i < to; i++)
		energy += y1[i] * y1[i] + y2[i] * y2[i] - 2;
	/* Loud is good, few pulses are better. */
	merit = energy * pow(shortest / length, 4);
	for (at = l->count; at > 0 && loud[at - 1] < merit; at--)
		if (at < most) {
			loud[at] = loud[at - 1];
			l->example[at] = l->example[at - 1];
		}
	if (at == most)
		return;
	loud[at] = merit;
	l->example[at].y1 = y1 + from;
	l->example[at].y2 = y2 + from;
	l->example[at].n = (size_t)(to - from);
	l->example[at].m = 0;
	l->count += l->count < most;
}

/* The clearest short sections of the record; of long ones, pieces. */
static void pick_examples(struct learning *l, const double *y1, const double *y2,
	size_t n, int most, const struct calibration *c)
{
	double T = c->duration, reach = shape_reach(c->shape), loud[EXAMPLES_MAX] = { 0 };
	long margin = (long)(1.2 * reach * T + fmax(c->delta_max, -c->delta_min));
	struct sections *s = sections_new(c->shape, T, 5, margin);
	struct section section;

	l->count = 0;
	if (!s)
		return;
	sections_scan(s, y1, y2, 0, n, (long long)n);
	sections_end(s);
	while (sections_first(s, &section)) {
		long long begin = section.begin > 0 ? section.begin : 0;
		long long end = section.end < (long long)n ? section.end : (long long)n;
		long long pieces = 1 + (end - begin) / (6 * margin);

		for (long long k = 0; k < pieces; k++)
			offer_example(l, y1, y2, begin + (end - begin) * k / pieces,
				begin + (end - begin) * (k + 1) / pieces, most,
				2 * (double)margin, loud);
		sections_take(s, section.end);
	}
	sections_free(s);
}

static void scene_of(const struct calibration *c, struct joint_scene *scene)
{
	calibration_scene(c, scene);
	scene->tones = 0; /* the examples were cleaned */
	scene->max_pulses = EXAMPLE_PULSES;
}

/* Duration and gain to least chi-square, unless they are known. */
static void tune(
	const struct calibrate_par *par, struct learning *l, double step, int rounds)
{
	if (isnan(par->duration))
		minimise(l, &l->scene.duration, step, rounds);
	if (isnan(par->gain))
		minimise(l, &l->scene.gain, step, rounds);
}

static int set_shape(struct calibration *c, int pulse)
{
	shape_free(c->shape);
	c->pulse = pulse;
	c->shape = shape_new((enum pulse_shape)pulse);
	return c->shape != NULL;
}

/* Which shape describes some clear examples best, and its rough duration; low: lag of
 * the lowest autocorrelation.  A wrong shape needs more pulses for the same record, so
 * that each costs what it must take away. */
static enum calibrate_status learn_shape(const struct calibrate_par *par,
	struct learning *l, const double *y1, const double *y2, size_t n, double low,
	struct calibration *c)
{
	double best = INFINITY, duration = c->duration, gain = c->gain, fit = INFINITY;
	int pulse = c->pulse;

	pick_examples(l, y1, y2, n, EXAMPLES_MAX / 2, c);
	for (int p = PULSE_SINE; p <= PULSE_LORENTZ && l->count && fit > 1.1; p++) {
		double price;

		if (par->pulse != CALIBRATE_ANY_PULSE && p != par->pulse)
			continue;
		if (!set_shape(c, p))
			return CALIBRATE_MEMORY;
		c->duration = isnan(par->duration) ? low / shape_lowest_lag(c->shape)
						   : par->duration;
		scene_of(c, &l->scene);
		examples_fit(l, 0.05, &price);
		tune(par, l, 0.1, 3);
		fit = examples_fit(l, 0.003, &price);
		if (price < best) {
			best = price;
			pulse = p;
			duration = l->scene.duration;
			gain = l->scene.gain * c->noise[1] / c->noise[0];
		}
	}
	c->duration = duration;
	c->gain = gain;
	return set_shape(c, pulse) ? CALIBRATE_OK : CALIBRATE_MEMORY;
}

/* Range of the delays seen, widened by half on either side. */
static void learn_range(
	const struct calibrate_par *par, const struct learning *l, struct calibration *c)
{
	double lo = INFINITY, hi = -INFINITY, margin;

	for (int i = 0; i < l->count; i++)
		for (int k = 0; k < l->example[i].m; k++) {
			const struct joint_pulse *p = &l->example[i].pulse[k];

			lo = fmin(lo, p->delta);
			hi = fmax(hi, p->delta);
		}
	margin = fmax(0.5 * (hi - lo), 0.02 * c->duration);
	if (isnan(par->spread) && c->events >= RANGE_EVENTS) {
		c->delta_min = fmax(c->delta_min, lo - margin);
		c->delta_max = fmin(c->delta_max, hi + margin);
	}
}

/* Shape, duration, gain and range of delays by joint fits. */
static enum calibrate_status learn_pulse(const struct calibrate_par *par,
	const double *y1, const double *y2, size_t n, double low, struct calibration *c)
{
	enum { ROUNDS = 16 };
	double step = 0.01, moved, price;
	struct learning l = { .joint = joint_new(), .misfit = c->misfit };
	enum calibrate_status status =
		l.joint ? learn_shape(par, &l, y1, y2, n, low, c) : CALIBRATE_MEMORY;

	if (status == CALIBRATE_OK) {
		pick_examples(&l, y1, y2, n, EXAMPLES_MAX, c);
		scene_of(c, &l.scene);
	}
	/* The closer duration and gain come, the smaller a pulse may be that is not just
	 * a misfit of its neighbour. */
	for (int k = 0; status == CALIBRATE_OK && l.count && k < ROUNDS; k++) {
		double before = c->chi2;

		c->chi2 = examples_fit(&l, fmax(0.01 * pow(0.3, k), 3e-4), &price);
		tune(par, &l, step, 2);
		moved = fabs(log(l.scene.duration / c->duration));
		step = fmin(fmax(3 * moved, 0.002), 0.02);
		c->duration = l.scene.duration;
		c->gain = l.scene.gain * c->noise[1] / c->noise[0];
		if (k > 1 && c->chi2 > 10)
			break; /* too dense, or not such pulses: no use */
		if (k > 2 && moved < 5e-4 && (c->chi2 < 1.2 || c->chi2 > 0.95 * before))
			break;
	}
	c->events = 0;
	for (int i = 0; i < l.count; i++)
		c->events += l.example[i].m;
	learn_range(par, &l, c);
	joint_free(l.joint);
	return status;
}

/* Range of the delays as far as it is known. */
static void set_range(const struct calibrate_par *par, struct calibration *c)
{
	double share = isnan(par->spread) ? 0.1 : par->spread;
	double spread = fmax(share * (double)c->shift, 0.05 * c->duration);

	c->delta_min = -spread;
	c->delta_max = spread;
}

static void set_thresholds(const struct calibrate_par *par, struct calibration *c)
{
	double gain = c->gain * c->noise[0] / c->noise[1];

	c->drop = calibrate_drop(par->false_alarm, c->shape, c->duration, gain,
		c->delta_max - c->delta_min);
	/* Next to a pulse the search is over some 40 cells: 23 means 2e-3 false ones. */
	c->drop_near = c->drop < 23 ? c->drop : 23;
}

/* Matched filter of y[0 .. n) at every eighth of a duration; returns the number of
 * points, 0 when out of memory. */
static size_t filter_points(
	const struct calibration *c, const double *y, size_t n, double *out)
{
	double T = c->duration;
	size_t len, count = 0, stride = (size_t)(T / 8);
	long first = shape_support(c->shape, 0, T, &len);
	double *p = malloc(len * sizeof *p);

	if (p && n > len) {
		shape_sample(c->shape, 0, T, first, len, p, NULL, NULL);
		for (size_t at = 0; at + len <= n; at += stride, count++) {
			out[count] = 0;
			for (size_t i = 0; i < len; i++)
				out[count] += p[i] * y[at + i];
		}
	}
	free(p);
	return count;
}

/* Correlation of the filtered channels over the quietest tenth of the record: noise has
 * none, pulses that are always there have much.  *level is the root mean square there, 1
 * for white noise.  r holds n. */
static double quiet_coherence(const struct calibration *c, const double *y1,
	const double *y2, size_t n, double *r, double *level)
{
	enum { BLOCK = 16 }; /* points: two durations */
	double *z = malloc((n + 2) * sizeof *z), xy = 0, xx = 0, yy = 0, limit, count = 0;
	size_t points, blocks;

	if (!z)
		return 0;
	points = filter_points(c, y1, n, z);
	/* A point per eighth of a duration of at least 8 samples: two channels fit in n.
	 */
	points = points < n / 2 && filter_points(c, y2, n, z + n / 2) == points ? points
										: 0;
	blocks = points / BLOCK;
	for (size_t b = 0; b < blocks; b++) {
		r[b] = 0;
		for (size_t i = b * BLOCK; i < (b + 1) * BLOCK; i++)
			r[b] += z[i] * z[i] + z[n / 2 + i] * z[n / 2 + i];
		r[blocks + b] = r[b];
	}
	limit = robust_quantile(r, blocks, 0.1);
	for (size_t b = 0; b < blocks; b++)
		for (size_t i = b * BLOCK; r[blocks + b] <= limit && i < (b + 1) * BLOCK;
			i++) {
			xy += z[i] * z[n / 2 + i];
			xx += z[i] * z[i];
			yy += z[n / 2 + i] * z[n / 2 + i];
			count += 2;
		}
	*level =
		count > 0
			? sqrt((xx + yy) / count / (c->duration * shape_energy(c->shape)))
			: 0;
	free(z);
	return xx > 0 && yy > 0 ? xy / sqrt(xx * yy) : 0;
}

/* Standard deviation of white noise that would have the same effect on the matched
 * filter as the noise there is; for records that have been filtered before. */
static double filtered_noise(
	const struct calibration *c, const double *y, size_t n, double *work)
{
	size_t count = filter_points(c, y, n, work);

	for (size_t i = 0; i < count; i++)
		work[i] = fabs(work[i]);
	return count ? 1.482602218505602 * robust_median(work, count) /
			       sqrt(c->duration * shape_energy(c->shape))
		     : 1;
}

static void normalise(const struct calibration *c, double *y1, double *y2, size_t n)
{
	for (size_t i = 0; i < n; i++) {
		y1[i] /= c->noise[0];
		y2[i] /= c->noise[1];
	}
}

/* Correlation coefficient of y1 with y2 lag samples later. */
static double correlation_at(const double *y1, const double *y2, size_t n, size_t lag)
{
	double xy = 0, xx = 0, yy = 0;

	for (size_t i = 0; i + lag < n; i++) {
		xy += y1[i] * y2[i + lag];
		xx += y1[i] * y1[i];
		yy += y2[i + lag] * y2[i + lag];
	}
	return xx > 0 && yy > 0 ? xy / sqrt(xx * yy) : 0;
}

/* A correlation that channels with nothing in common do not reach: six of its standard
 * deviations, by Bartlett's formula from the autocorrelation r at n / 4 lags; half where
 * the record is too short to tell. */
static double chance_correlation(const double *r, size_t n)
{
	double sum = 1;
	size_t lags = n / 4 < 4096 ? n / 4 : 4096;

	for (size_t k = 1; k <= lags; k++)
		sum += 2 * (r[k] / r[0]) * (r[k] / r[0]);
	return fmin(6 * sqrt(sum / (double)n), 0.5);
}

static enum calibrate_status measure(const struct calibrate_par *par, double *y1,
	double *y2, size_t n, struct calibration *c, double *r)
{
	size_t max_lag = n / 2, rest;
	double lag = par->lag, low, change[2], coherence, level = 0;

	if (par->tones == CALIBRATE_FIND_TONES) {
		c->tones = tones_find(y1, y2, n, TONES_MAX, c->omega);
		if (c->tones < 0)
			return CALIBRATE_MEMORY;
		rest = n < 16384 ? n : 16384;
		c->tones = tones_confirm(y1 + (n - rest) / 2, y2 + (n - rest) / 2, rest,
			c->tones, c->omega);
	} else {
		c->tones = par->tones;
		memcpy(c->omega, par->omega, sizeof c->omega);
	}
	c->tone_hop = n < 8192 ? n : 4096;
	if (!calibrate_clean(c, y1, n, &change[0]) ||
		!calibrate_clean(c, y2, n, &change[1]))
		return CALIBRATE_MEMORY;
	for (int k = 0; k < 2; k++) {
		const double *y = k ? y2 : y1;
		double least = 1e-6 * sqrt(variance(y, n));

		c->noise[k] = robust_noise(y, n, 4, r);
		if (c->noise[k] < least)
			c->noise[k] = least;
	}
	if (isnan(lag))
		lag = align_lag(y1, y2, n, max_lag, &c->correlation);
	else if (lag < (double)n - 16)
		c->correlation = correlation_at(y1, y2, n, (size_t)(lag + 0.5));
	if (lag < 0)
		return lag == -1 ? CALIBRATE_MEMORY : CALIBRATE_NO_LAG;
	c->shift = (long)floor(lag + 0.5);
	if (c->shift >= (long)n - 16)
		return CALIBRATE_NO_LAG;
	if (isnan(par->duration) || isnan(par->lag)) {
		if (n > 4096 && c->correlation < 6 / sqrt((double)n))
			return CALIBRATE_NO_LAG; /* whatever the autocorrelation */
		if (!align_autocorrelation(y1, y2, n, n / 4, r))
			return CALIBRATE_MEMORY;
		if (c->correlation < chance_correlation(r, n))
			return CALIBRATE_NO_LAG;
	}
	c->transit = c->shift > 0 ? (double)c->shift : INFINITY;
	rest = n - (size_t)c->shift;
	y2 += c->shift;
	if (!align_autocorrelation(y1, y2, rest, rest / 4, r))
		return CALIBRATE_MEMORY;
	low = lowest_lag(r, rest / 4);
	c->pulse = par->pulse == CALIBRATE_ANY_PULSE ? PULSE_SINE : par->pulse;
	c->shape = shape_new((enum pulse_shape)c->pulse);
	if (!c->shape)
		return CALIBRATE_MEMORY;
	c->duration =
		isnan(par->duration) ? low / shape_lowest_lag(c->shape) : par->duration;
	if (!(c->duration >= 8))
		return CALIBRATE_FAST;
	if (8 * c->duration > (double)n && c->duration > 0.5 * (double)n)
		return CALIBRATE_SLOW;
	c->gain = par->gain;
	if (isnan(c->gain)) {
		double v1 = variance(y1, rest) - c->noise[0] * c->noise[0];
		double v2 = variance(y2, rest) - c->noise[1] * c->noise[1];

		c->gain = v1 > 0 && v2 > 0 ? sqrt(v2 / v1) : 1;
	}
	c->tone_variance = fmax(change[0] / (c->noise[0] * c->noise[0]),
		change[1] / (c->noise[1] * c->noise[1]));
	normalise(c, y1, y2, rest);
	set_range(par, c);
	set_thresholds(par, c);
	c->misfit = 3e-4;
	if (learn_pulse(par, y1, y2, rest, low, c) != CALIBRATE_OK)
		return CALIBRATE_MEMORY;
	if (c->events == 0 && isnan(par->duration))
		return CALIBRATE_NO_LAG;
	coherence = c->chi2 > 4 ? quiet_coherence(c, y1, y2, rest, r, &level) : 0;
	if (c->chi2 > 4 && (coherence > 0.6 || level < 1.5)) {
		/* Even where it is most quiet, both sensors see the same, or the noise is
		 * what it should be there: too many pulses. */
		c->dense = 1;
		c->misfit = 0.01;
		set_range(par, c);
	} else if (c->chi2 > 4) {
		/* Neither the shape nor white noise will do: the record was filtered.
		 * What counts then is the noise that passes the matched filter. */
		double n1 = filtered_noise(c, y1, rest, r),
		       n2 = filtered_noise(c, y2, rest, r);

		c->noise[0] *= n1;
		c->noise[1] *= n2;
		for (size_t i = 0; i < rest; i++) {
			y1[i] /= n1;
			y2[i] /= n2;
		}
		c->misfit = 0.15;
		set_range(par, c);
		set_thresholds(par, c);
		if (learn_pulse(par, y1, y2, rest, low, c) != CALIBRATE_OK)
			return CALIBRATE_MEMORY;
	}
	set_thresholds(par, c);
	return CALIBRATE_OK;
}

enum calibrate_status calibrate(const struct calibrate_par *par, const double *x1,
	const double *x2, size_t n, struct calibration *c)
{
	double *work;
	enum calibrate_status status;

	memset(c, 0, sizeof *c);
	if (is_constant(x1, n))
		return CALIBRATE_SILENT_1;
	if (is_constant(x2, n))
		return CALIBRATE_SILENT_2;
	work = malloc(3 * n * sizeof *work);
	if (!work)
		return CALIBRATE_MEMORY;
	memcpy(work, x1, n * sizeof *work);
	memcpy(work + n, x2, n * sizeof *work);
	status = measure(par, work, work + n, n, c, work + 2 * n);
	free(work);
	if (status != CALIBRATE_OK)
		calibration_clear(c);
	return status;
}

void calibration_clear(struct calibration *c)
{
	shape_free(c->shape);
	c->shape = NULL;
}

void calibration_scene(const struct calibration *c, struct joint_scene *scene)
{
	*scene = (struct joint_scene){ .shape = c->shape,
		.duration = c->duration,
		.transit = c->transit,
		.gain = c->gain * c->noise[0] / c->noise[1],
		.delta_min = c->delta_min,
		.delta_max = c->delta_max,
		.drop = c->drop,
		.drop_near = c->drop_near,
		.misfit = c->misfit,
		.offset = 1,
		.tone_variance = c->tone_variance };
	for (int k = 0; k < c->tones; k++)
		if (c->omega[k] * c->duration < 8 * acos(-1) || isinf(c->tone_variance))
			scene->omega[scene->tones++] = c->omega[k];
}
