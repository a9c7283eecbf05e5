/* find_shape.c - see examples.h */
#include "num/sigmas.h"
#include "signal/learn/crowd.h"
#include "signal/learn/examples.h"
#include <math.h>
#include <stdlib.h>

void find_shape_take(struct calibration *c, struct template *found)
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

/* Steps from a guess to the least of chi-square.  With five, groups are not learned again
 * behind a fall of the flow (slower-flow-group of tests/matrix/scenes.tsv, seed 303). */
enum { STEPS = 8 };

/* Price, over the best so far, above which a guess is not worth tuning.  Of pairs within
 * 6 to 10 ms (pulses of 10 ms, eighteen records) 3 misses the right shape in one, whose
 * first guess of the duration is wrong by a fifth, and 5 in none.  A known shape that is
 * right costs 1.1 to 2.1 times as much as that of a single event (clipped groups, crowds,
 * twins), one that is not, behind a high-pass, 7 to 22 times. */
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
	find_shape_take(c, &one);
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
	examples_set_scene(ex, c);
	examples_fit(ex, EXAMPLES_ROUGH);
	if (ex->status != SEPARATE_OK)
		return ex->status;
	if (ex->penalised > FAR_OFF * best->penalised)
		return SEPARATE_OK;
	ex->drift = 0;
	tune(ex, 0.2, STEPS);
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
		.single = -1,
		.reversed = c->reversed,
		.signs = ex->signs,
		.width = c->width };
	enum separate_status status;

	c->duration = duration;
	if (known_shape_set(c, pulse) != NUM_OK)
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
		known_shape_set(c, pulse) != NUM_OK)
		return SEPARATE_MEMORY;
	ex->spectral = c->duration;
	ex->within = SIGMAS_NEVER * error * c->duration;
	return SEPARATE_OK;
}

/* Chi-square per degree of freedom of a guess beside which no other shape is tried, and
 * of one beside which no other duration is. */
static const double GOOD = 1.1, FAIR = 2;

/* The lag of the lowest autocorrelation may be hidden by that of a train of pulses.  A
 * wrong shape needs more pulses for the same record, so each pulse costs its threshold.
 * Where more of the pulses that stand alone are positive, the shape is not reversed: both
 * describe single pulses equally well.  Other durations are tried as the first one
 * described them better, and one of each shape in whitened records: they take more work.
 */
static enum separate_status try_all_known(struct examples *ex, double low,
	const struct template *hint, struct calibration *c, struct guess *best)
{
	const struct calibrate_par *par = ex->par;
	static const double factor[] = { 1, 0.7, 1.4 };
	const int reversed = hint && hint->reversed;
	const int signs = ex->signs || c->whitening.tap ? 1 : 2;
	enum separate_status status = SEPARATE_OK;

	c->reversed = reversed;
	if (hint && hint->events && hint->elsewhere)
		status = try_known(ex, hint->pulse, hint->duration, 1, c, best);
	for (int k = 0; k < (c->whitening.tap ? 1 : 3) && status == SEPARATE_OK; k++)
		for (int i = 0; i < signs * PULSE_SHAPES; i++) {
			const int p = i % PULSE_SHAPES;
			double duration = par->duration;

			c->reversed = reversed != (i != p);
			if (k > 0 && c->reversed != best->reversed)
				continue;
			if (isnan(duration)) {
				if (known_shape_duration(p, low, &duration) != NUM_OK)
					return SEPARATE_MEMORY;
				duration *= factor[k];
			}
			if (best->chi2 <= (k ? FAIR : GOOD) || status != SEPARATE_OK ||
				(i != p && best->upright > 0))
				break;
			if ((k == 0 || isnan(par->duration)) &&
				(par->pulse == CALIBRATE_ANY_PULSE || p == par->pulse))
				status = try_known(ex, p, duration, k ? 0.5 : 1, c, best);
		}
	return status;
}

/* Single events tried.  In the 40 of 108 records of other rates and durations that were
 * refused or doubted before (doc/benchmarks.md), 1, 2, 3 and 5 claim 666, 675, 708 and
 * 708 of 1278 particles rightly; without them it is 425. */
enum { SINGLES = 3 };

/* Tries pulses all of one sign and of both; the first that is taken has to be better than
 * the best one by the factor need. */
static enum separate_status try_singles(struct examples *ex, double duration, double need,
	struct calibration *c, struct guess *best)
{
	enum separate_status status = SEPARATE_OK;

	for (int k = 0; k < SINGLES && status == SEPARATE_OK; k++) {
		struct guess guess = { .single = k, .width = c->width };

		c->duration = duration;
		status = set_single(ex, &guess, c);
		for (; guess.signs < 2 && status == SEPARATE_OK; guess.signs++)
			status = try_shape(
				ex, guess, best->single < 0 ? need : 1, c, best);
	}
	return status == SEPARATE_HARD ? ex->status : status;
}

/* Price of a guess of known shapes, over that of a pulse that stands, above which it is
 * not worth tuning.  In 110 records of random instruments, known shapes that in the end
 * described a record better than the pulse taken from it had guesses of .98 to 1.13 times
 * its price; the others, of .4 times and more, took up to half of the work that may be
 * done. */
static const double WORTH = 1.5;

enum separate_status find_shape(struct examples *ex, unsigned kinds, double low,
	const struct template *hint, struct calibration *c)
{
	const int known = (kinds & SHAPES_KNOWN) != 0;
	struct guess best = { .pulse = c->pulse,
		.single = -1,
		.signs = ex->signs,
		.width = c->width,
		.duration = c->duration,
		.gain = c->gain,
		.penalised = (known ? WORTH : 1) * c->penalised,
		.chi2 = INFINITY };
	const double duration = c->duration;
	enum separate_status status = SEPARATE_OK;

	/* A drifting baseline looks like a crowd of a few long pulses: a spectrum is
	 * taken of as many durations as there may be examples, or more. */
	if (known && !c->whitening.tap && (double)ex->n >= EXAMPLES_MAX * c->duration) {
		if (!c->shape && known_shape_set(c, c->pulse) != NUM_OK)
			return SEPARATE_MEMORY;
		examples_pick(ex, EXAMPLES_MAX, c);
		if (ex->pieces)
			return learn_crowd(ex, c);
	}
	if (known)
		status = try_all_known(ex, low, hint, c, &best);
	/* What describes a record well costs about 1. */
	if (status == SEPARATE_OK && kinds & SHAPES_SINGLE &&
		(!known || best.penalised > FAR_OFF)) {
		c->width = best.width;
		status = try_singles(ex, duration, known ? 1 / FAR_OFF : 1, c, &best);
	}
	if (status == SEPARATE_OK && isinf(best.chi2) &&
		(!known || isfinite(c->penalised)))
		status = SEPARATE_HARD;
	ex->signs = best.signs;
	c->reversed = best.reversed;
	c->width = best.width;
	c->duration = duration;
	if (status == SEPARATE_OK && best.single >= 0)
		status = set_single(ex, &best, c);
	c->duration = best.duration;
	c->gain = best.gain;
	if (status == SEPARATE_OK && best.single < 0 &&
		known_shape_set(c, best.pulse) != NUM_OK)
		status = SEPARATE_MEMORY;
	return status;
}
