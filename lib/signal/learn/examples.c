/* examples.c - see examples.h */
#include "signal/learn/examples.h"
#include "num/dot.h"
#include "num/robust.h"
#include "num/sigmas.h"
#include "signal/detect/sections.h"
#include "signal/learn/crosstalk.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The flags of n samples from one on, if some of them are not known; else NULL. */
static const unsigned char *hidden_of(
	const struct examples *ex, int c, long long from, size_t n)
{
	return ex->hidden[c] && memchr(ex->hidden[c] + from, 1, n) ? ex->hidden[c] + from
								   : NULL;
}

/* Stores [from, to) of the record if it is among the most clearest. */
static void offer_example(
	struct examples *ex, long long from, long long to, int most, double shortest)
{
	double energy = 0, merit, length = (double)(to - from);
	int at;

	if (length < 1.5 * shortest / 2)
		return;
	for (long long i = from; i < to; i++)
		energy += ex->y1[i] * ex->y1[i] + ex->y2[i] * ex->y2[i] - 2;
	/* Large amplitudes and few pulses are preferred. */
	merit = energy * pow(shortest / length, 4);
	/* Samples that are not known are at the peaks of large pulses: others come first.
	 */
	if (hidden_of(ex, 0, from, (size_t)(to - from)) ||
		hidden_of(ex, 1, from, (size_t)(to - from)))
		merit = -1 / fmax(merit, 0);
	for (at = ex->count; at > 0 && ex->example[at - 1].merit < merit; at--)
		if (at < most)
			ex->example[at] = ex->example[at - 1];
	if (at == most)
		return;
	ex->example[at] = (struct example){ .y1 = ex->y1 + from,
		.y2 = ex->y2 + from,
		.begin = from,
		.n = (size_t)(to - from),
		.isolated = length < 1.4 * shortest,
		.merit = merit };
	ex->count += ex->count < most;
}

/* The clearest short sections of the record; of long ones, pieces if allowed. */
static void pick_sections(
	struct examples *ex, int most, int allow_pieces, const struct calibration *c)
{
	const long long n = (long long)ex->n;
	double T = c->duration;
	double slack = fmax(c->delta_max, -c->delta_min);
	long margin;
	struct sections *s;
	struct section section;
	const double *const y[] = { ex->y1, ex->y2 };

	ex->count = 0;
	if (!(T >= SECTIONS_SHORTEST))
		return;
	s = sections_new(c->shape, T, SIGMAS_NEVER, slack);
	if (!s || sections_scan(s, y, 2, 0, ex->n, n) != NUM_OK) {
		ex->status = SEPARATE_MEMORY;
		sections_free(s);
		return;
	}
	sections_end(s);
	margin = sections_margin(s);
	while (sections_first(s, &section)) {
		long long begin = section.begin > 0 ? section.begin : 0;
		long long end = section.end < n ? section.end : n;
		long long pieces = 1 + (end - begin) / (6 * margin);

		for (long long k = 0; k < pieces && (pieces == 1 || allow_pieces); k++)
			offer_example(ex, begin + (end - begin) * k / pieces,
				begin + (end - begin) * (k + 1) / pieces, most,
				2 * (double)margin);
		sections_take(s, section.end);
	}
	sections_free(s);
}

/* Pieces of sections contain parts of pulses: they are used only if few sections are
 * short. */
void examples_pick(struct examples *ex, int most, const struct calibration *c)
{
	enum { ENOUGH = 4 };

	ex->middle = 0.5 * (double)ex->n;
	pick_sections(ex, most, 0, c);
	ex->pieces = ex->count < ENOUGH;
	if (ex->pieces)
		pick_sections(ex, most, 1, c);
}

/* Returns the status of a fit, and stores it if memory was short. */
static enum joint_status note_memory(struct examples *ex, enum joint_status status)
{
	if (status == JOINT_MEMORY)
		ex->status = SEPARATE_MEMORY;
	return status;
}

/* 1 if more work may be done; stores SEPARATE_HARD if not. */
static int may_go_on(struct examples *ex)
{
	if (ex->before + joint_work(ex->joint) > ex->par->most)
		ex->status = SEPARATE_HARD;
	return ex->status == SEPARATE_OK;
}

static double gain_at(const struct examples *ex, const struct example *e)
{
	double at = (double)e->begin + 0.5 * (double)e->n;

	return ex->scene.gain * exp(ex->drift * (at - ex->middle));
}

/* The present scene for one example. */
static const struct joint_scene *scene_of(struct examples *ex, const struct example *e)
{
	ex->present = ex->scene;
	ex->present.gain = gain_at(ex, e);
	for (int c = 0; c < 2; c++) {
		ex->present.tone_knot[c] = 0.5 * ex->scene.tone_hop -
					   (double)(e->begin + (c ? ex->shift : 0));
		ex->present.hidden[c] = hidden_of(ex, c, e->begin, e->n);
	}
	return &ex->present;
}

enum joint_status examples_refine(struct examples *ex, const struct example *e,
	struct joint_pulse *pulse, struct joint_result *result)
{
	return note_memory(ex, joint_refine(ex->joint, scene_of(ex, e), e->y1, e->y2,
				       e->n, pulse, e->m, result));
}

double examples_amplitude(const struct examples *ex, const struct example *e, int p)
{
	return e->pulse[p / 2].a * (p % 2 ? gain_at(ex, e) : 1);
}

void examples_add_residual(const struct examples *ex, const struct example *e, int p,
	double width, int half, double *sum, double *weight)
{
	const struct joint_pulse *pulse = &e->pulse[p / 2];
	const double *r = joint_residual(ex->joint, p % 2);
	double stretch = (1 + pulse->delta / ex->scene.transit) * width;
	double t0 = pulse->t + (p % 2 ? pulse->delta : 0),
	       a = examples_amplitude(ex, e, p);

	for (int k = -half; k <= half; k++) {
		double t = t0 + k * stretch, u = t - floor(t);
		size_t at = (size_t)t;

		if (t < 0 || at + 1 >= e->n)
			continue;
		sum[k + half] += a * ((1 - u) * r[at] + u * r[at + 1]);
		if (weight)
			weight[k + half] += a * a;
	}
}

double examples_chi2(struct examples *ex, struct joint_slopes *slopes)
{
	double sum = 0, chi2;

	if (slopes)
		*slopes = (struct joint_slopes){ .gradient = { 0 } };
	for (int i = 0; i < ex->count; i++) {
		struct example *e = &ex->example[i];

		if (e->outlier)
			continue;
		if (!may_go_on(ex))
			return INFINITY;
		memcpy(e->trial, e->pulse, sizeof e->trial);
		if (note_memory(ex, joint_adjust(ex->joint, scene_of(ex, e), e->y1, e->y2,
					    e->n, e->trial, e->m, &chi2)) != JOINT_OK)
			return INFINITY;
		if (slopes)
			joint_add_slopes(ex->joint, slopes);
		sum += chi2;
	}
	return sum;
}

void examples_set_scene(struct examples *ex, const struct calibration *c)
{
	calibration_scene(c, &ex->scene);
	ex->scene.max_pulses = EXAMPLE_PULSES;
}

void examples_keep(struct examples *ex)
{
	for (int i = 0; i < ex->count; i++)
		if (!ex->example[i].outlier)
			memcpy(ex->example[i].pulse, ex->example[i].trial,
				sizeof ex->example[i].pulse);
}

/* Least squares for each example. */
static double crosstalk_of(struct examples *ex, int c, const double *rest, double *model)
{
	double share[EXAMPLES_MAX], energy = 0;
	size_t count = 0;

	for (int i = 0; i < ex->count; i++) {
		const struct example *e = &ex->example[i];
		long long at = e->begin + (c ? -ex->shift : ex->shift);
		double own;

		if (e->outlier || at < 0 || at + (long long)e->n > (long long)ex->n)
			continue;
		memset(model, 0, e->n * sizeof *model);
		for (int k = 0; k < e->m; k++)
			joint_add(scene_of(ex, e), &e->pulse[k], 1, c ? model : NULL,
				c ? NULL : model, e->n);
		own = dot(model, model, e->n);
		if (own > 0)
			share[count++] = dot(model, rest + at, e->n) / own;
		energy += own;
	}
	return crosstalk_median(share, count, energy);
}

void examples_crosstalk(struct examples *ex, double share[2])
{
	const size_t n = ex->n;
	double *work = malloc((3 * n + 1) * sizeof *work);

	if (!work) {
		ex->status = SEPARATE_MEMORY;
		return;
	}
	memcpy(work, ex->y1, n * sizeof *work);
	memcpy(work + n, ex->y2, n * sizeof *work);
	for (int i = 0; i < ex->count; i++) {
		const struct example *e = &ex->example[i];
		double most = 0;

		for (int k = 0; k < e->m; k++)
			most = fmax(most, fabs(e->pulse[k].a));
		/* A small pulse may have been fitted to crosstalk. */
		for (int k = 0; k < e->m; k++)
			if (fabs(e->pulse[k].a) > CROSSTALK_MOST * most)
				joint_add(scene_of(ex, e), &e->pulse[k], -1,
					work + e->begin, work + n + e->begin, e->n);
	}
	for (int c = 0; c < 2; c++)
		share[c] = crosstalk_of(ex, c, work + (size_t)c * n, work + 2 * n);
	free(work);
}

int examples_pulses(const struct examples *ex)
{
	int sum = 0;

	for (int i = 0; i < ex->count; i++)
		sum += ex->example[i].m;
	return sum;
}

int examples_full(const struct examples *ex)
{
	return 10 * examples_pulses(ex) > 9 * EXAMPLE_PULSES * ex->count;
}

/* Bounds of the estimated misfit of a shape: nothing is known of pulses louder than the
 * examples; the residual of isolated pulses is misfit, that of crowded ones is mostly due
 * to hidden pulses. */
static const double LEAST_SHARE = 1e-5, MOST_ISOLATED = 3e-4, MOST_CROWDED = 1e-4;

/* Chi-square that the error of one parameter of the shape leaves in a pulse with the
 * energy of all examples together. */
#define ERROR (SIGMAS_SELDOM * SIGMAS_SELDOM)

/* Energy of the pulses of an example, in units of chi-square. */
static double example_energy(const struct examples *ex, const struct example *e)
{
	double unit = joint_energy(&ex->scene), sum = 0;

	for (int k = 0; k < e->m; k++)
		sum += e->pulse[k].a * e->pulse[k].a * unit;
	return sum;
}

/* Estimates the misfit of the shape from the share of energy that each example leaves,
 * and its scatter.  For isolated pulses it is mainly the misfit, but they may have
 * different forms; most crowded examples contain hidden pulses, and only the best ones
 * count.  A further pulse cannot reduce this residual. */
static void learn_misfit(
	struct examples *ex, const double *share, const double *scatter, int isolated)
{
	double work[EXAMPLES_MAX], left, noise;
	size_t n = (size_t)ex->count;

	memcpy(work, scatter, n * sizeof *work);
	noise = robust_median(work, n);
	memcpy(work, share, n * sizeof *work);
	left = robust_quantile(work, n, isolated ? 0.5 : 0.25) -
	       1.25 * noise / sqrt((double)n);
	left = fmax(left, 0);
	ex->share = fmin(2 * left, isolated ? MOST_ISOLATED : MOST_CROWDED);
	ex->share = fmax(ex->share, LEAST_SHARE);
	ex->share =
		fmax(ex->share, ERROR * (ex->corrected ? 20 : 2) / fmax(ex->energy, 1));
	for (size_t i = 0; i < n; i++)
		ex->example[i].outlier = share[i] > 4 * left + 4 * scatter[i];
}

/* Chi-square and twice the threshold for each pulse. */
static double cost_of(const struct examples *ex, const struct joint_result *result, int m)
{
	return result->chi2 + 2 * ex->scene.threshold_near * m;
}

/* Finds the pulses of an example: a single negative one, or positive ones, or those of
 * either sign, if there are such, where positive ones do not tolerably describe it. */
static enum joint_status find_pulses(
	struct examples *ex, struct example *e, struct joint_result *result)
{
	const struct joint_scene *scene = scene_of(ex, e);
	struct joint_scene either = *scene;
	struct joint_pulse positive[EXAMPLE_PULSES];
	struct joint_result first;
	int m = 0;
	enum joint_status status;

	either.signs = either.max_pulses = 1;
	e->m = 0;
	e->either = 1;
	status = joint_fit(
		ex->joint, &either, e->y1, e->y2, e->n, e->pulse, &e->m, result);
	if (status != JOINT_OK || (e->m == 1 && !result->full && e->pulse[0].a < 0))
		return status;
	e->m = 0;
	e->either = 0;
	status = joint_fit(ex->joint, scene, e->y1, e->y2, e->n, e->pulse, &e->m, result);
	if (status != JOINT_OK || !ex->signs || !result->negative ||
		result->chi2 < CALIBRATE_TOLERABLE * (double)result->dof)
		return status;
	first = *result;
	memcpy(positive, e->pulse, sizeof positive);
	m = e->m;
	e->m = 0;
	e->either = 1;
	either.max_pulses = scene->max_pulses;
	status = joint_fit(
		ex->joint, &either, e->y1, e->y2, e->n, e->pulse, &e->m, result);
	if (status != JOINT_OK || cost_of(ex, result, e->m) < cost_of(ex, &first, m))
		return status;
	memcpy(e->pulse, positive, sizeof positive);
	e->m = m;
	e->either = 0;
	return joint_refine(ex->joint, scene, e->y1, e->y2, e->n, e->pulse, e->m, result);
}

/* Notes how an example was fitted. */
static enum joint_status note_fit(const struct examples *ex, struct example *e,
	enum joint_status status, const struct joint_result *result)
{
	const int describes = status == JOINT_OK && !result->full &&
			      result->chi2 < CALIBRATE_TOLERABLE * (double)result->dof;

	e->found = describes ? ex->scene.misfit : 0;
	return status;
}

/* Finds the pulses of an example as ex->by states, from those that described it before
 * where these are known.  From those found with a smaller misfit it would not be seen
 * that fewer describe it as well. */
static enum joint_status fit_example(
	struct examples *ex, struct example *e, struct joint_result *result)
{
	struct joint_result first = { .chi2 = INFINITY };
	struct example before = *e;
	int described = 0;
	enum joint_status status;

	if (ex->by != EXAMPLES_ANEW && ex->scene.misfit <= e->found) {
		struct joint_scene scene = *scene_of(ex, e);

		scene.signs = scene.signs || e->either;
		status = note_fit(ex, e,
			joint_fit(ex->joint, &scene, e->y1, e->y2, e->n, e->pulse, &e->m,
				result),
			result);
		described = e->found > 0;
		if (status != JOINT_OK || (described && ex->by == EXAMPLES_AGAIN))
			return status;
		first = *result;
		before = *e;
	}
	status = note_fit(ex, e, find_pulses(ex, e, result), result);
	if (status == JOINT_OK && described &&
		cost_of(ex, &first, before.m) <= cost_of(ex, result, e->m)) {
		*result = first;
		*e = before;
	}
	return status;
}

double examples_fit(struct examples *ex, double misfit)
{
	double each[EXAMPLES_MAX], share[EXAMPLES_MAX], scatter[EXAMPLES_MAX];
	int isolated = 0;

	ex->penalised = ex->dof = ex->excess = ex->energy = 0;
	if (ex->count == 0)
		return INFINITY;
	ex->scene.misfit = misfit > ex->misfit ? misfit : ex->misfit;
	for (int i = 0; i < ex->count; i++) {
		struct example *e = &ex->example[i];
		struct joint_result result;
		double energy;

		if (!may_go_on(ex))
			return INFINITY;
		if (note_memory(ex, fit_example(ex, e, &result)))
			return INFINITY;
		energy = fmax(example_energy(ex, e), 1);
		ex->energy += energy;
		isolated += e->isolated;
		each[i] = result.chi2 / (double)result.dof;
		share[i] = (result.chi2 - (double)result.dof) / energy;
		scatter[i] = sqrt(2 * (double)result.dof) / energy;
		ex->penalised += cost_of(ex, &result, e->m);
		ex->dof += (double)result.dof;
		e->excess = result.chi2 - (double)result.dof;
		ex->excess += e->excess;
	}
	ex->penalised /= ex->dof > 0 ? ex->dof : 1;
	learn_misfit(ex, share, scatter, 2 * isolated > ex->count);
	return robust_median(each, (size_t)ex->count);
}
