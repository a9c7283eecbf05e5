/* learn.c - see learn.h */
#include "signal/learn.h"
#include "signal/joint.h"
#include "signal/robust.h"
#include "signal/sections.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EXAMPLES_MAX = 16, EXAMPLE_PULSES = 16, RANGE_EVENTS = 12 };

/* Chi-square that says that noise of a suspected colour is not white. */
static const double HOPELESS = 100;

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
	double misfit;  /* of joint.h, at the end */
	double rest[2]; /* power of either channel's residual, that of its noise 1 */
};

static double square_sum(const double *x, size_t n)
{
	double sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += x[i] * x[i];
	return sum;
}

/* First minimum of the autocorrelation after its smallest value has been passed by a
 * clear rise; lag in samples, 0 where there is none. */
double learn_lowest_lag(const double *r, size_t max_lag)
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
		low = learn_lowest_lag(r, LAGS) / T;
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
	double each[EXAMPLES_MAX], rest[2][EXAMPLES_MAX];

	double dof = 0;

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
		for (int c = 0; c < 2; c++)
			rest[c][i] = 2 * square_sum(joint_residual(l->joint, c), e->n) /
				     (double)result.dof;
		*price += result.chi2 + 2 * l->scene.drop_near * e->m;
		dof += (double)result.dof;
	}
	*price /= dof > 0 ? dof : 1;
	for (int c = 0; c < 2; c++)
		l->rest[c] = robust_median(rest[c], (size_t)l->count);
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
	double T = c->duration, loud[EXAMPLES_MAX] = { 0 };
	double slack = fmax(c->delta_max, -c->delta_min);
	long margin = (long)(1.2 * shape_reach_above(c->shape, 0.01) * T + slack);
	struct sections *s = sections_new(c->shape, T, 5, slack);
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

/* Takes this pulse, as the whitened record has it at the present duration. */
int learn_set_shape(struct calibration *c, int pulse)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);

	shape_free(c->shape);
	c->pulse = pulse;
	c->shape = plain;
	if (plain && c->whitening.tap) {
		c->shape = shape_filter(plain, fmax(c->duration, 8), c->whitening.seen,
			c->whitening.seen_half);
		shape_free(plain);
	}
	return c->shape != NULL;
}

/* Duration of a pulse whose autocorrelation is lowest at this lag. */
double learn_duration(int pulse, double low)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);
	double duration = plain ? low / shape_lowest_lag(plain) : 0;

	shape_free(plain);
	return duration;
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

	for (int p = PULSE_SINE; p <= PULSE_LORENTZ && fit > 1.1; p++) {
		double price;

		if (par->pulse != CALIBRATE_ANY_PULSE && p != par->pulse)
			continue;
		c->duration =
			isnan(par->duration) ? learn_duration(p, low) : par->duration;
		if (!learn_set_shape(c, p))
			return CALIBRATE_MEMORY;
		pick_examples(l, y1, y2, n, EXAMPLES_MAX / 2, c);
		if (l->count == 0)
			continue;
		scene_of(c, &l->scene);
		fit = examples_fit(l, 0.05, &price);
		if (price > 3 * best)
			continue; /* far off: not worth tuning */
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
	return learn_set_shape(c, pulse) ? CALIBRATE_OK : CALIBRATE_MEMORY;
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

/* Means of x[0..n) under a Hann window of 2 reach + 1 points, work holding n. */
static void smooth(double *x, double *work, int n, int reach)
{
	memcpy(work, x, (size_t)n * sizeof *x);
	for (int i = 0; i < n; i++) {
		x[i] = 0;
		for (int k = -reach; k <= reach; k++)
			if (i + k >= 0 && i + k < n)
				x[i] += work[i + k] * (1 + cos(M_PI * k / (reach + 1))) /
					(2 * reach + 2);
	}
}

/* Mean residual around the pulses of the examples, sample by sample of the pulse: what
 * all of them have in common that the shape has not. */
static void mean_residual(struct learning *l, double *more, double *weight, int half)
{
	memset(more, 0, (2 * (size_t)half + 1) * sizeof *more);
	memset(weight, 0, (2 * (size_t)half + 1) * sizeof *weight);
	for (int i = 0; i < l->count; i++) {
		struct example *e = &l->example[i];
		struct joint_result result;

		if (joint_refine(l->joint, &l->scene, e->y1, e->y2, e->n, e->pulse, e->m,
			    &result) != JOINT_OK)
			continue;
		for (int p = 0; p < 2 * e->m; p++) {
			const struct joint_pulse *pulse = &e->pulse[p / 2];
			const double *r = joint_residual(l->joint, p % 2);
			double stretch = 1 + pulse->delta / l->scene.transit;
			double t0 = pulse->t + (p % 2 ? pulse->delta : 0);
			double a = pulse->a * (p % 2 ? l->scene.gain : 1);

			for (int k = -half; k <= half; k++) {
				double t = t0 + k * stretch, u = t - floor(t);
				size_t at = (size_t)t;

				if (t < 0 || at + 1 >= e->n)
					continue;
				more[k + half] += a * ((1 - u) * r[at] + u * r[at + 1]);
				weight[k + half] += a * a;
			}
		}
	}
	for (int k = 0; k <= 2 * half; k++)
		more[k] /= weight[k] > 0 ? weight[k] : 1;
	smooth(more, weight, 2 * half + 1, (int)(l->scene.duration / 10));
}

/* Gives the shape what the pulses have in common.  At first a pulse that overlaps another
 * must be a large one, lest two of a wrong shape stand for one. */
static int correct_shape(struct learning *l, struct calibration *c)
{
	enum { ROUNDS = 10 };
	int half = (int)((shape_reach(c->shape) + 0.5) * c->duration), ok = 1;
	size_t points = 2 * (size_t)half + 1;
	double *more = malloc(2 * points * sizeof *more), price;
	struct shape *first = c->shape;

	for (int k = 0; more && ok && k < ROUNDS; k++) {
		struct shape *better;
		double misfit = fmax(0.3 * pow(0.4, k), 3e-4);

		c->chi2 = examples_fit(l, misfit, &price);
		if (k > 5 && c->chi2 > 4)
			break; /* no use */
		mean_residual(l, more, more + points, half);
		better = shape_correct(c->shape, more, half, 1 / c->duration);
		ok = better != NULL;
		if (!ok)
			break;
		if (c->shape != first)
			shape_free(c->shape);
		l->scene.shape = c->shape = better;
	}
	c->chi2 = examples_fit(l, 3e-4, &price);
	if (price < c->price) {
		c->price = price;
		if (c->shape != first)
			shape_free(first);
	} else if (c->shape != first) {
		shape_free(c->shape);
		l->scene.shape = c->shape = first;
		c->chi2 = examples_fit(l, 3e-4, &price);
	}
	ok = ok && more;
	free(more);
	return ok;
}

/* Shape, duration, gain and range of delays by joint fits. */
enum calibrate_status learn_pulse(const struct calibrate_par *par, const double *y1,
	const double *y2, size_t n, double low, struct calibration *c)
{
	enum { ROUNDS = 16 };
	double step = 0.01, moved;
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

		c->chi2 = examples_fit(&l, fmax(0.01 * pow(0.3, k), 3e-4), &c->price);
		if (c->suspect && c->chi2 > HOPELESS)
			break;
		tune(par, &l, step, 2);
		moved = fabs(log(l.scene.duration / c->duration));
		step = fmin(fmax(3 * moved, 0.002), 0.02);
		c->duration = l.scene.duration;
		c->gain = l.scene.gain * c->noise[1] / c->noise[0];
		if (c->whitening.tap && moved > 1e-3) {
			if (!learn_set_shape(c, c->pulse))
				return CALIBRATE_MEMORY;
			l.scene.shape = c->shape;
		}
		if (k > 1 && c->chi2 > 10)
			break; /* too dense, or not such pulses: no use */
		if (k > 2 && moved < 5e-4 && (c->chi2 < 1.2 || c->chi2 > 0.95 * before))
			break;
	}
	if (status == CALIBRATE_OK && l.count && c->guessed && c->chi2 > 1.1 &&
		!correct_shape(&l, c))
		status = CALIBRATE_MEMORY;
	c->events = 0;
	for (int i = 0; i < l.count; i++)
		c->events += l.example[i].m;
	memcpy(c->rest, l.rest, sizeof c->rest);
	learn_range(par, &l, c);
	joint_free(l.joint);
	return status;
}
