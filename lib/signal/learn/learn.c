/* learn.c - see learn.h */
#include "signal/learn/learn.h"
#include "num/sigmas.h"
#include "signal/detect/spikes.h"
#include "signal/learn/correct.h"
#include "signal/learn/crowd.h"
#include "signal/learn/examples.h"
#include "signal/learn/origin.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RANGE_EVENTS = 12 };

/* Chi-square above which noise of a suspected colour is not white; half and twice of it
 * give the same rows in the records of BAD_FIT in measure.c. */
static const double HOPELESS = 100;

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

/* *lag: the same of one pulse, as a share of its duration. */
static enum num_status shape_lowest_lag(const struct shape *shape, double *lag)
{
	enum { T = 100, LAGS = 100 };
	size_t n = (size_t)(2 * shape_reach(shape) * T) + 2;
	double *p = calloc(n + LAGS, sizeof *p), r[LAGS + 1] = { 0 };

	if (!p)
		return NUM_MEMORY;
	shape_sample(shape, shape_reach(shape) * T, T, 0, n, p, NULL, NULL);
	for (int k = 0; k <= LAGS; k++)
		for (size_t i = 0; i < n; i++)
			r[k] += p[i] * p[i + (size_t)k];
	*lag = learn_lowest_lag(r, LAGS) / T;
	free(p);
	return NUM_OK;
}

/* Steps from the middle to the least of the parabola through three points a step apart,
 * at most two. */
static double to_least(double below, double middle, double above)
{
	double bend = below - 2 * middle + above;
	double move = bend > 0 ? 0.5 * (below - above) / bend : below < above ? -1 : 1;

	return fmax(fmin(move, 2), -2);
}

/* Moves *parameter by a factor to the least chi-square: parabolas through three points
 * on the logarithm, the step shrinking. */
static void minimise(struct examples *ex, double *parameter, double step, int rounds)
{
	double middle = examples_chi2(ex);

	if (isfinite(middle))
		examples_keep(ex);
	for (int round = 0; round < rounds; round++) {
		double x = *parameter, below, above, move;

		*parameter = x * exp(-step);
		below = examples_chi2(ex);
		*parameter = x * exp(step);
		above = examples_chi2(ex);
		move = to_least(below, middle, above);
		*parameter = x * exp(step * move);
		above = examples_chi2(ex);
		if (above < middle) {
			middle = above;
			examples_keep(ex);
		} else {
			*parameter = x;
		}
		step /= 3;
	}
}

static void scene_of(const struct calibration *c, struct joint_scene *scene)
{
	calibration_scene(c, scene);
	scene->max_pulses = EXAMPLE_PULSES;
}

/* Adjusts duration and gain to the least chi-square, unless they are known.  Pieces,
 * which contain parts of pulses, are fitted well by longer pulses, too: in crowds their
 * duration is not believed against the spectrum. */
static void tune(struct examples *ex, double step, int rounds)
{
	if (isnan(ex->par->duration))
		minimise(ex, &ex->scene.duration, step, rounds);
	if (fabs(ex->scene.duration - ex->spectral) > ex->within && ex->within > 0)
		ex->scene.duration = ex->spectral;
	if (isnan(ex->par->gain))
		minimise(ex, &ex->scene.gain, step, rounds);
}

/* Chi-square with this width.  Mean duration and energy at sensor 2 are kept: duration
 * and gain that go with the width then hardly change with it. */
static double chi2_of_width(struct examples *ex, double log_width)
{
	double change = sqrt(exp(log_width) / ex->scene.width);

	ex->scene.width = exp(log_width);
	ex->scene.duration /= isnan(ex->par->duration) ? change : 1;
	ex->scene.gain /= isnan(ex->par->gain) ? change : 1;
	return examples_chi2(ex);
}

/* Chi-square if the logarithm of the gain changes by this much in what is learned from.
 */
static double chi2_of_drift(struct examples *ex, double change)
{
	ex->drift = change / (2 * ex->middle);
	return examples_chi2(ex);
}

typedef double chi2_of(struct examples *, double);

/* Adjusts a parameter that is 0 in most instruments to the least chi-square, by a
 * parabola; 1 if it has changed.  It is 0 unless it reduces chi-square by more than
 * noise, and what the shape leaves, would. */
static int tune_rare(struct examples *ex, chi2_of *of, double before, double step)
{
	const double small = 5e-4;
	const struct joint_scene scene = ex->scene;
	const double drift = ex->drift;
	double middle = of(ex, before), best, now, below, above, none;

	below = of(ex, before - step);
	above = of(ex, before + step);
	now = before + step * to_least(below, middle, above);
	best = of(ex, now);
	none = before == 0 ? middle : of(ex, 0);
	if (none - best > SIGMAS_NEVER * SIGMAS_NEVER * fmax(best / ex->dof, 1))
		of(ex, now);
	else
		now = 0;
	if (fabs(now - before) > small)
		return 1;
	ex->scene = scene;
	ex->drift = drift;
	return 0;
}

/* Takes this pulse, reversed or not, as the whitened record has it at the present
 * duration. */
enum num_status learn_set_shape(struct calibration *c, int pulse)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);

	shape_free(c->shape);
	c->pulse = pulse;
	c->measured = 0;
	c->shape = plain;
	if (plain && c->reversed)
		shape_scale(plain, -1);
	if (plain && c->whitening.tap) {
		c->shape = shape_filter(plain, fmax(c->duration, SHAPE_SHORTEST),
			c->whitening.seen, c->whitening.seen_half);
		shape_free(plain);
	}
	return c->shape ? NUM_OK : NUM_MEMORY;
}

/* Duration of a pulse whose autocorrelation is lowest at this lag. */
enum num_status learn_duration(int pulse, double low, double *duration)
{
	struct shape *plain = shape_new((enum pulse_shape)pulse);
	double lag = NAN;
	enum num_status status = plain ? shape_lowest_lag(plain, &lag) : NUM_MEMORY;

	*duration = low / lag;
	shape_free(plain);
	return status;
}

/* Uses the pulse found in the record. */
static void take_template(struct calibration *c, struct template *found)
{
	shape_free(c->shape);
	c->shape = found->shape;
	found->shape = NULL;
	c->pulse = found->pulse;
	c->reversed = found->reversed;
	c->duration = found->duration;
	c->measured = 1;
}

/* A description of some clear examples: by a pulse of sensor.h or that of the single
 * event of this number; signs: 1 if it may be of either sign; upright: how many more of
 * the pulses that stand alone are positive than negative. */
struct guess {
	int pulse, reversed, single, signs, upright;
	double width, duration, gain, penalised, chi2;
};

/* Where the pulse is from: events that are alike, sensor.h, or a single event. */
enum { TAKEN, KNOWN, SINGLE };

/* Price, over the best so far, above which a guess is not worth tuning.  Of pairs within
 * 6 to 10 ms (pulses of 10 ms, eighteen records) 3 misses the right shape in one, whose
 * first guess of the duration is wrong by a fifth, and 5 in none. */
static const double FAR_OFF = 5;

/* Takes the pulse of a single event for the shape.  SEPARATE_HARD if there is none. */
static enum separate_status set_single(
	const struct examples *ex, const struct guess *guess, struct calibration *c)
{
	struct template one = { 0 };
	double reach = fmax(c->delta_max,
		calibration_reach(CALIBRATE_WIDE, (double)c->shift, c->duration));

	if (template_find(&one, ex->y1, ex->y2, ex->hidden, ex->n, c->duration,
		    c->transit, c->width, reach, guess->single) != NUM_OK)
		return SEPARATE_MEMORY;
	if (!one.shape)
		return SEPARATE_HARD;
	take_template(c, &one);
	return SEPARATE_OK;
}

/* Fits the shape of c to some examples; it has to be better than the best one by the
 * factor need. */
static enum separate_status try_shape(struct examples *ex, struct guess guess,
	double need, struct calibration *c, struct guess *best)
{
	ex->signs = guess.signs;
	c->width = guess.width;
	examples_pick(ex, EXAMPLES_MAX / 2, c);
	if (ex->count == 0)
		return SEPARATE_OK;
	scene_of(c, &ex->scene);
	examples_fit(ex, EXAMPLES_ROUGH);
	if (ex->status != SEPARATE_OK)
		return ex->status;
	if (ex->penalised > FAR_OFF * best->penalised)
		return SEPARATE_OK;
	ex->drift = 0;
	tune(ex, 0.1, 3);
	guess.chi2 = examples_fit(ex, 0.003);
	if (ex->status != SEPARATE_OK)
		return ex->status;
	guess.penalised = ex->penalised;
	for (int i = 0; i < ex->count; i++)
		if (ex->example[i].m == 1)
			guess.upright += ex->example[i].pulse[0].a > 0 ? 1 : -1;
	guess.duration = ex->scene.duration;
	guess.gain = ex->scene.gain * c->noise[1] / c->noise[0];
	if (guess.penalised < need * best->penalised)
		*best = guess;
	return SEPARATE_OK;
}

/* Tries a pulse of sensor.h from a duration on, with the width guessed and with equal
 * ones: groups mislead the guess. */
static enum separate_status try_known(struct examples *ex, int pulse, double duration,
	double need, struct calibration *c, struct guess *best)
{
	struct guess guess = { .pulse = pulse,
		.reversed = c->reversed,
		.signs = ex->signs,
		.width = c->width };
	enum separate_status status;

	c->duration = duration;
	if (learn_set_shape(c, pulse) != NUM_OK)
		return SEPARATE_MEMORY;
	status = try_shape(ex, guess, need, c, best);
	if (guess.width != 1 && status == SEPARATE_OK) {
		const double guessed = guess.width;

		guess.width = 1;
		status = try_shape(ex, guess, need, c, best);
		c->width = guessed;
	}
	return status;
}

/* Takes shape and duration from the spectrum of a long record in which few pulses stand
 * apart. */
static enum separate_status learn_crowd(struct examples *ex, struct calibration *c)
{
	int pulse = ex->par->pulse;
	double guess = c->duration, error = 0;

	c->duration = ex->par->duration;
	if (crowd_pulse(ex->y1, ex->y2, ex->n, c->tone_hop, guess, &pulse, &c->duration,
		    &error) != NUM_OK ||
		learn_set_shape(c, pulse) != NUM_OK)
		return SEPARATE_MEMORY;
	ex->spectral = c->duration;
	ex->within = SIGMAS_NEVER * error * c->duration;
	return SEPARATE_OK;
}

/* Finds the shape that describes some clear examples best, reversed or not, and its
 * approximate duration.
 * low: lag of the lowest autocorrelation, which that of a train of pulses may hide.  A
 * wrong shape needs more pulses for the same record, so each pulse costs its threshold.
 * Where more of the pulses that stand alone are positive, the shape is not reversed: both
 * describe single pulses equally well.  Other durations are tried as the first one
 * described them better, and one of each shape in whitened records: they take more work.
 */
static enum separate_status learn_shape(struct examples *ex, double low,
	const struct template *hint, struct calibration *c)
{
	const struct calibrate_par *par = ex->par;
	static const double factor[] = { 1, 0.7, 1.4 };
	const int reversed = hint && hint->reversed;
	const int signs = ex->signs || c->whitening.tap ? 1 : 2;
	struct guess best = { .pulse = c->pulse,
		.width = c->width,
		.duration = c->duration,
		.gain = c->gain,
		.penalised = INFINITY,
		.chi2 = INFINITY };
	enum separate_status status = SEPARATE_OK;

	/* A drifting baseline looks like a crowd of a few long pulses: a spectrum is
	 * taken of as many durations as there may be examples, or more. */
	if (!c->whitening.tap && (double)ex->n >= EXAMPLES_MAX * c->duration) {
		if (!c->shape && learn_set_shape(c, c->pulse) != NUM_OK)
			return SEPARATE_MEMORY;
		examples_pick(ex, EXAMPLES_MAX, c);
		if (ex->pieces)
			return learn_crowd(ex, c);
	}
	c->reversed = reversed;
	if (hint && hint->events && hint->elsewhere)
		status = try_known(ex, hint->pulse, hint->duration, 1, c, &best);
	for (int k = 0; k < (c->whitening.tap ? 1 : 3) && status == SEPARATE_OK; k++)
		for (int i = 0; i < signs * PULSE_SHAPES; i++) {
			const int p = i % PULSE_SHAPES;
			double duration = par->duration;

			c->reversed = reversed != (i != p);
			if (k > 0 && c->reversed != best.reversed)
				continue;
			if (isnan(duration)) {
				if (learn_duration(p, low, &duration) != NUM_OK)
					return SEPARATE_MEMORY;
				duration *= factor[k];
			}
			if (best.chi2 <= (k ? 2 : 1.1) || status != SEPARATE_OK ||
				(i != p && best.upright > 0))
				break;
			if ((k == 0 || isnan(par->duration)) &&
				(par->pulse == CALIBRATE_ANY_PULSE || p == par->pulse))
				status =
					try_known(ex, p, duration, k ? 0.5 : 1, c, &best);
		}
	c->reversed = best.reversed;
	c->width = best.width;
	c->duration = best.duration;
	c->gain = best.gain;
	if (status == SEPARATE_OK && learn_set_shape(c, best.pulse) != NUM_OK)
		status = SEPARATE_MEMORY;
	return status;
}

/* Single events tried.  In the 40 of 108 records of other rates and durations that were
 * refused or doubted before (doc/benchmarks.md), 1, 2, 3 and 5 claim 666, 675, 708 and
 * 708 of 1278 particles rightly; without them it is 425. */
enum { SINGLES = 3 };

/* Takes the pulse of that single event, of the clearest few, which describes some clear
 * examples best, all of one sign or of both, and at a lower price than that of c.
 * SEPARATE_HARD if there is none. */
static enum separate_status learn_single(struct examples *ex, struct calibration *c)
{
	struct guess best = { .single = -1, .penalised = c->penalised };
	const double duration = c->duration;
	enum separate_status status = SEPARATE_OK;

	for (int k = 0; k < SINGLES && status == SEPARATE_OK; k++) {
		struct guess guess = { .single = k, .width = c->width };

		c->duration = duration;
		status = set_single(ex, &guess, c);
		for (; guess.signs < 2 && status == SEPARATE_OK; guess.signs++)
			status = try_shape(ex, guess, 1, c, &best);
	}
	if (status == SEPARATE_MEMORY || best.single < 0)
		return status == SEPARATE_OK ? SEPARATE_HARD : status;
	c->duration = duration;
	status = set_single(ex, &best, c);
	ex->signs = best.signs;
	c->duration = best.duration;
	c->gain = best.gain;
	return status;
}

/* 1 if pulses that overlap little, with something of their own, which leave so much more
 * than dof, describe an event as well as more of them do without, at their price. */
static int explain_events(const struct examples *ex, const struct example *few,
	const struct example *all, double left, double dof)
{
	return (few->m == 1 || few->m == all->m) &&
	       left <= CHI_SQUARE_MORE * dof + SIGMAS_NEVER * sqrt(2 * dof) &&
	       left <= all->excess + 2 * ex->scene.threshold_near * (all->m - few->m);
}

/* Takes the scatter of what pulses of the events in rough have of their own, in this set,
 * for that of the scene; returns by how much more it explains than it leaves, 0 unless
 * everything in the set scatters. */
static double try_scatter(struct examples *ex, struct examples *rough, unsigned set,
	struct joint_scene *scene)
{
	struct joint_deviation own[JOINT_OWN][EXAMPLES_MAX * EXAMPLE_PULSES];
	_Static_assert(sizeof own[0] <= JOINT_SCATTER_MAX * sizeof own[0][0],
		"joint_scatter() takes all pulses of the examples");
	struct joint_result result;
	double explained, left, balance = 0;
	size_t n = 0, m;

	for (int i = 0; i < ex->count && ex->status == SEPARATE_OK; i++) {
		struct example *few = &rough->example[i];
		struct joint_deviation *out[JOINT_OWN];

		if (examples_refine(rough, few, few->pulse, &result) != JOINT_OK)
			continue;
		for (int k = 0; k < JOINT_OWN; k++)
			out[k] = own[k] + n;
		m = joint_deviations(ex->joint, set, out, &explained);
		for (int k = 0; k < JOINT_OWN; k++)
			for (size_t p = 0; p < m && set >> k & 1; p++)
				out[k][p].at += (double)few->begin;
		left = result.chi2 - (double)result.dof - explained;
		if (explain_events(ex, few, &ex->example[i], left, (double)result.dof)) {
			n += m;
			balance += explained - left;
		}
	}
	for (int k = 0; k < JOINT_OWN; k++) {
		double scatter;

		if (!(set >> k & 1) || !(balance > 0))
			continue;
		scatter = joint_scatter(k, own[k], n, LIKELIHOOD_CERTAIN);
		joint_set_scatter(
			scene, k, scatter, own[k], n, fmax(scene->misfit, ex->share));
		balance = scatter > 0 ? balance : 0;
	}
	return fmax(balance, 0);
}

/* Scatter of what pulses have of their own; 1 if there is some.  Only events that single
 * pulses do not describe can show it, and only if it explains most of what these leave:
 * pulses of another shape look wider or narrower where they overlap. */
static int learn_scatter(struct examples *ex, struct calibration *c)
{
	struct examples *rough; /* large for a stack */
	double best = 0;

	if (examples_pulses(ex) <= ex->count &&
		ex->excess <= SIGMAS_SELDOM * sqrt(2 * ex->dof))
		return 0;
	rough = malloc(sizeof *rough);
	if (!rough) {
		ex->status = SEPARATE_MEMORY;
		return 0;
	}
	*rough = *ex;
	examples_fit(rough, EXAMPLES_ROUGH);
	ex->status = rough->status;
	for (unsigned set = 1; set < 1U << JOINT_OWN; set++) {
		struct joint_scene scene = rough->scene;
		double balance;

		scene.misfit = 0;
		balance = try_scatter(ex, rough, set, &scene);
		if (balance > best) {
			best = balance;
			memcpy(ex->scene.scatter, scene.scatter, sizeof scene.scatter);
			ex->scene.misfit = scene.misfit;
		}
	}
	free(rough);
	if (!(best > 0))
		return 0;
	memcpy(c->scatter, ex->scene.scatter, sizeof c->scatter);
	ex->misfit = fmax(ex->misfit, ex->scene.misfit);
	return 1;
}

/* Share of the range of delays beyond which there are no particles of plug flow, whose
 * velocities differ by a few per cent.  With 0.5, 0.7 and 0.85 none of 1200 rows in
 * turbulent flow is wrong and all are found, and groups in plug flow do not differ
 * (scenes turbulent, group-turbulent and group of tests/matrix/scenes.tsv, seeds 11 to
 * 18). */
static const double FAR = 0.7;

/* Range of the delays seen, widened by half on either side, and how many stand alone.
 * Examples are short, which slow particles are not: outside plug flow they do not limit
 * the delays from above. */
static void learn_range(const struct examples *ex, struct calibration *c)
{
	double lo = INFINITY, hi = -INFINITY;

	c->far = c->isolated = c->negative = 0;
	for (int i = 0; i < ex->count; i++) {
		const struct example *e = &ex->example[i];

		c->isolated += e->m == 1 && !e->outlier;
		for (int k = 0; k < e->m; k++) {
			const struct joint_pulse *p = &e->pulse[k];

			c->far += !e->outlier && fabs(p->delta) > FAR * c->delta_max;
			c->negative += p->a < 0;
			lo = fmin(lo, p->delta);
			hi = fmax(hi, p->delta);
		}
	}
	calibration_widen(c->duration, &lo, &hi);
	if (isnan(ex->par->spread) && c->events >= RANGE_EVENTS) {
		c->delta_min = fmax(c->delta_min, lo);
		if (c->delta_max <= calibration_plug(c))
			c->delta_max = fmin(c->delta_max, hi);
	}
}

int learn_describes(const struct calibration *c)
{
	return c->chi2 < CALIBRATE_DESCRIBES;
}

int learn_stands(const struct calibration *c)
{
	return learn_describes(c) && (!c->corrected || c->isolated > 0);
}

/* Adjusts duration and gain alternately with the pulses of the examples: the closer they
 * are, the smaller a pulse may be without being a misfit of its neighbour. */
static enum separate_status converge(struct examples *ex, struct calibration *c)
{
	enum { ROUNDS = 16 };
	double step = 0.01, moved, before;

	for (int k = 0; k < ROUNDS; k++) {
		before = c->chi2;
		c->chi2 = examples_fit(ex, fmax(0.01 * pow(0.3, k), ex->share));
		c->penalised = ex->penalised;
		if ((k > 1 || c->whitening.tap) && c->presumed_white &&
			c->chi2 > HOPELESS)
			break;
		tune(ex, step, 2);
		moved = fabs(log(ex->scene.duration / c->duration));
		step = fmin(fmax(3 * moved, 0.002), 0.02);
		c->duration = ex->scene.duration;
		c->gain = ex->scene.gain * c->noise[1] / c->noise[0];
		c->width = ex->scene.width;
		if (c->whitening.tap && moved > 1e-3 && !c->measured) {
			if (learn_set_shape(c, c->pulse) != NUM_OK)
				return SEPARATE_MEMORY;
			ex->scene.shape = c->shape;
		}
		if (k > 1 &&
			(examples_full(ex) || (c->chi2 > 10 && c->chi2 > 0.8 * before)))
			break; /* too dense, or other pulses: no use */
		if (k > 2 && moved < 5e-4 &&
			(learn_describes(c) || c->chi2 > 0.95 * before))
			break;
	}
	return SEPARATE_OK;
}

/* Adjusts width and drift of the gain; 1 if one has changed. */
static int tune_rest(struct examples *ex, int round)
{
	double finest = 0.01, step = fmax(0.1 * pow(0.3, round), finest);
	int changed = tune_rare(ex, chi2_of_width, log(ex->scene.width), finest);

	if (isnan(ex->par->gain))
		changed |= tune_rare(ex, chi2_of_drift, ex->drift * 2 * ex->middle, step);
	return changed;
}

/* Adjusts all parameters. */
static enum separate_status settle(struct examples *ex, struct calibration *c)
{
	enum { ROUNDS = 6 };
	enum separate_status status = converge(ex, c);

	for (int k = 0; k < ROUNDS && status == SEPARATE_OK && !ex->pieces &&
			ex->status == SEPARATE_OK && tune_rest(ex, k);
		k++)
		status = converge(ex, c);
	return status;
}

/* 1 if the shape is to be corrected by all pulses.  One given by the caller is kept,
 * except for the effect of an estimated filter; explanations of a colour are compared by
 * how well uncorrected known pulses fit.  One taken from a whitened record has the noise
 * of the few events that it is the mean of: with its correction 792 particles of 892 are
 * found and 5 rows are wrong in 23 records of coloured noise, 667 and 50 without it. */
static int wants_correction(struct examples *ex, struct calibration *c)
{
	if (examples_full(ex))
		return 0;
	if (c->estimated)
		return c->chi2 > 1.1;
	if (ex->par->pulse != CALIBRATE_ANY_PULSE || ex->pieces ||
		(c->whitening.tap && c->presumed_white && !c->measured))
		return 0;
	return correct_doubtful(ex, c) || (c->measured && c->whitening.tap);
}

void learn_hidden(const struct calibrate_par *par, const struct calibration *c,
	const unsigned char *hidden[2])
{
	int use = par->hidden[0] && par->hidden[1] && !c->whitening.tap;

	hidden[0] = use ? par->hidden[0] : NULL;
	hidden[1] = use ? par->hidden[1] + c->shift : NULL;
}

/* Excludes impulses from the examples as well, by flags of 2 n samples, unless the pulses
 * are so short that they are classified as impulses. */
static void hide_spikes(struct examples *ex, double duration, unsigned char *flags)
{
	const size_t n = ex->n;
	size_t spikes = spikes_find(ex->y1, n, duration, flags) +
			spikes_find(ex->y2, n, duration, flags + n);

	for (size_t c = 0; spikes > 0 && 10 * spikes < n && c < 2; c++) {
		for (size_t i = 0; ex->hidden[c] && i < n; i++)
			flags[c * n + i] |= ex->hidden[c][i];
		ex->hidden[c] = flags + c * n;
	}
}

/* 1 if both examples hold two pulses, which follow each other at the same distance and
 * with the same ratio of amplitudes, within a tenth.  Ratios of halves were 0.98 to 1.03
 * in the scene lowpass-short-pulses of tests/matrix/scenes.tsv; those of particles differ
 * by more than a tenth in most pairs. */
static int same_pair(double duration, const struct example *a, const struct example *b)
{
	const struct joint_pulse *p = a->pulse, *q = b->pulse;

	return a->m == 2 && b->m == 2 &&
	       fabs(p[1].t - p[0].t - (q[1].t - q[0].t)) < SHAPE_FINEST * duration &&
	       fabs(p[1].a * q[0].a / (p[0].a * q[1].a) - 1) < 0.1;
}

/* 1 if most examples hold the same pair: each pulse is half of another one. */
static int are_halves(const struct examples *ex)
{
	int most = 0;

	for (int i = 0; i < ex->count; i++) {
		int same = 0;

		for (int k = 0; k < ex->count; k++)
			same += same_pair(
				ex->scene.duration, &ex->example[i], &ex->example[k]);
		most = same > most ? same : most;
	}
	return ex->corrected && 2 * most > ex->count;
}

/* 1 if the pulses stand out at the sensor that shows them less, on average as much as a
 * pulse has to: what one sensor alone shows has no transit time. */
static int shows_at_both(const struct examples *ex)
{
	double share = joint_energy_least(&ex->scene) / joint_energy(&ex->scene);

	return share * ex->energy >= ex->scene.threshold_near * examples_pulses(ex);
}

/* Learns by pulses of one source. */
static enum separate_status learn_by(const struct calibrate_par *par, const double *y1,
	const double *y2, size_t n, double low, struct template *found, int source,
	struct calibration *c)
{
	struct examples ex = { .par = par,
		.y1 = y1,
		.y2 = y2,
		.n = n,
		.joint = joint_new(),
		.misfit = c->misfit,
		.shift = c->shift,
		.before = c->work,
		.signs = found && found->signs };
	unsigned char *flags = c->whitening.tap ? NULL : malloc(2 * n + 1);
	enum separate_status status =
		ex.joint && (flags || c->whitening.tap) ? SEPARATE_OK : SEPARATE_MEMORY;

	learn_hidden(par, c, ex.hidden);
	if (flags)
		hide_spikes(&ex, c->duration, flags);
	if (source == TAKEN)
		take_template(c, found);
	else if (status == SEPARATE_OK)
		status = source == KNOWN ? learn_shape(&ex, low, found, c)
					 : learn_single(&ex, c);
	if (status == SEPARATE_OK) {
		examples_pick(&ex, EXAMPLES_MAX, c);
		scene_of(c, &ex.scene);
		if (ex.count)
			status = settle(&ex, c);
		if (status == SEPARATE_OK && ex.count && learn_scatter(&ex, c))
			status = converge(&ex, c);
	}
	if (status == SEPARATE_OK && ex.count && wants_correction(&ex, c) &&
		correct_shape(&ex, c) != NUM_OK)
		status = SEPARATE_MEMORY;
	if (status == SEPARATE_OK && ex.count && c->width != 1 &&
		find_origin(&ex, c) != NUM_OK)
		status = SEPARATE_MEMORY;
	if (status == SEPARATE_OK && ex.count && !isinf(c->transit)) {
		examples_crosstalk(&ex, c->crosstalk);
		c->crosstalk[0] *= c->noise[0] / c->noise[1];
		c->crosstalk[1] *= c->noise[1] / c->noise[0];
	}
	if (status == SEPARATE_OK)
		status = are_halves(&ex) || !shows_at_both(&ex) ? SEPARATE_HARD
								: ex.status;
	if (ex.joint)
		c->work += joint_work(ex.joint);
	c->events = examples_pulses(&ex);
	c->drift = ex.drift;
	memcpy(c->rest, ex.rest, sizeof c->rest);
	c->misfit = fmax(ex.misfit, ex.share);
	c->corrected = ex.corrected;
	learn_range(&ex, c);
	joint_free(ex.joint);
	free(flags);
	return status;
}

/* Fewest pulses by which the pulse of a single event is known well enough: larger pulses
 * show the errors of the shape as second pulses.  Of a high-passed Lorentz pulse that
 * three describe, 12 of 21 rows are wrong. */
enum { FEWEST = 6 };

/* 1 if the converter has not measured all samples that are learned from. */
static int is_hidden(
	const struct calibrate_par *par, const struct calibration *c, size_t n)
{
	const unsigned char *hidden[2];

	learn_hidden(par, c, hidden);
	return hidden[0] && (memchr(hidden[0], 1, n) || memchr(hidden[1], 1, n));
}

/* 1 if what was learned needs no other attempt.  A pulse taken from the record is
 * compared with the known ones where whitening takes most of its power, and where the
 * largest pulses are clipped: it is from smaller ones, whose noise shows in the larger
 * ones. */
static int is_enough(int taken, int hidden, const struct calibration *c)
{
	return learn_stands(c) && !(taken && (c->whitening.tap || hidden));
}

/* Work of comparing known shapes, over that of learning by the pulse taken. */
static const double COMPARED = 1;

/* Shape, duration, gain and range of delays by joint fits.  Up to three attempts end with
 * the first that describes the examples: by a pulse taken from the record, which groups
 * of nearly equal composition mislead, by those of sensor.h, with half of the work that
 * is left, and by those of single events. */
enum separate_status learn_pulse(const struct calibrate_par *par, const double *y1,
	const double *y2, size_t n, double low, struct template *found,
	struct calibration *c)
{
	const struct calibration first = *c;
	const int taken = found && found->shape;
	const int any = par->pulse == CALIBRATE_ANY_PULSE && isnan(par->duration);
	const int hidden = is_hidden(par, c, n);
	const int last = taken && found->alone               ? TAKEN
			 : found && any && !c->whitening.tap ? SINGLE
							     : KNOWN;
	enum separate_status status = SEPARATE_HARD;

	for (int k = taken ? TAKEN : KNOWN; k <= last; k++) {
		struct calibration other = first;
		struct calibrate_par part = *par;
		enum separate_status now;

		other.shape = NULL;
		other.work = c->work;
		other.penalised = status == SEPARATE_OK ? c->penalised : INFINITY;
		if (k == KNOWN && last == SINGLE)
			part.most = 0.5 * (c->work + par->most);
		if (k == KNOWN && status == SEPARATE_OK && is_enough(1, 0, c))
			part.most = fmin(
				part.most, c->work + COMPARED * (c->work - first.work));
		now = learn_by(&part, y1, y2, n, low, k == KNOWN && taken ? NULL : found,
			k, &other);
		c->work = other.work;
		if (now != SEPARATE_OK && now != SEPARATE_HARD) {
			shape_free(other.shape);
			return now;
		}
		if (k == SINGLE && now == SEPARATE_OK && other.events < FEWEST)
			now = SEPARATE_HARD;
		if (now == SEPARATE_OK &&
			(status != SEPARATE_OK || other.penalised < c->penalised)) {
			shape_free(c->shape);
			*c = other;
			status = now;
		} else {
			shape_free(other.shape);
		}
		if (status == SEPARATE_OK && is_enough(k == TAKEN, hidden, c))
			break;
	}
	return status;
}
