/* learn.c - see learn.h */
#include "signal/learn/learn.h"
#include "num/sigmas.h"
#include "signal/detect/spikes.h"
#include "signal/learn/examples.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RANGE_EVENTS = 12 };

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

/* Learns by the best shape of these kinds, or by that of events that are alike if none is
 * set. */
static enum separate_status learn_by(const struct calibrate_par *par, const double *y1,
	const double *y2, size_t n, double low, struct template *found, unsigned kinds,
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
	if (!kinds)
		find_shape_take(c, found);
	else if (status == SEPARATE_OK)
		status = find_shape(&ex, kinds, low, found, c);
	if (status == SEPARATE_OK) {
		examples_pick(&ex, EXAMPLES_MAX, c);
		examples_set_scene(&ex, c);
		if (ex.count)
			status = tune_all(&ex, c);
		if (status == SEPARATE_OK && ex.count && learn_scatter(&ex, c))
			status = tune_pulse(&ex, c);
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
	return calibration_stands(c) && !(taken && (c->whitening.tap || hidden));
}

/* Work of comparing known shapes, over that of learning by a pulse taken that stands.  In
 * 15 whitened records the known ones take .9 to 54 times as much; where they are better,
 * at most 3.5 (scenes with a baseline of tests/matrix/scenes.tsv). */
static const double COMPARED = 8;

/* Shape, duration, gain and range of delays by joint fits.  Up to three attempts end with
 * the first that describes the examples: by a pulse taken from the record, which groups
 * of nearly equal composition mislead; by the best guess of those of sensor.h and of
 * single events, with half of the work that is left; and by those of the other kind. */
enum separate_status learn_pulse(const struct calibrate_par *par, const double *y1,
	const double *y2, size_t n, double low, struct template *found,
	struct calibration *c)
{
	const struct calibration first = *c;
	const unsigned either = SHAPES_KNOWN | SHAPES_SINGLE;
	const int taken = found && found->shape;
	const int any = par->pulse == CALIBRATE_ANY_PULSE && isnan(par->duration);
	const int hidden = is_hidden(par, c, n);
	unsigned left = taken && found->alone               ? 0
			: found && any && !c->whitening.tap ? either
							    : SHAPES_KNOWN;
	unsigned kinds = taken ? 0 : left;
	enum separate_status status = SEPARATE_HARD;

	do {
		struct calibration other = first;
		struct calibrate_par part = *par;
		enum separate_status now;
		int stands;

		other.shape = NULL;
		other.work = c->work;
		stands = status == SEPARATE_OK && calibration_stands(c);
		other.penalised =
			stands || (status == SEPARATE_OK && kinds == SHAPES_SINGLE)
				? c->penalised
				: INFINITY;
		if (kinds == either)
			part.most = 0.5 * (c->work + par->most);
		if (kinds & SHAPES_KNOWN && stands)
			part.most = fmin(
				part.most, c->work + COMPARED * (c->work - first.work));
		now = learn_by(&part, y1, y2, n, low,
			kinds & SHAPES_KNOWN && taken ? NULL : found, kinds, &other);
		c->work = other.work;
		if (now != SEPARATE_OK && now != SEPARATE_HARD) {
			shape_free(other.shape);
			return now;
		}
		if (kinds)
			left = kinds != either                        ? 0
			       : now == SEPARATE_OK && other.measured ? SHAPES_KNOWN
								      : SHAPES_SINGLE;
		if (kinds & SHAPES_SINGLE && other.measured && other.events < FEWEST)
			now = SEPARATE_HARD;
		if (now == SEPARATE_OK &&
			(status != SEPARATE_OK || other.penalised < c->penalised)) {
			shape_free(c->shape);
			*c = other;
			status = now;
		} else {
			shape_free(other.shape);
		}
		if (status == SEPARATE_OK && is_enough(!kinds, hidden, c))
			break;
		kinds = left;
	} while (left);
	return status;
}
