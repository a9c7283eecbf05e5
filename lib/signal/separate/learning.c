/* learning.c - the instrument of a record: learned from its first samples, or kept */
#include "num/dot.h"
#include "signal/detect/bursts.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Shortest pulse whose fourth difference is below the noise, at an amplitude of 300
 * standard deviations: 300 (2 pi / 20)^4 = 3, that of noise is 8. */
static const double FOLLOWED = 20;

/* Samples of pulses that may be computed to learn from the beginning of a record: groups
 * of six Lorentz pulses at 30 dB take 7.4e8, of three pulses behind an estimated low-pass
 * 7.7e8, and known shapes, which have half of it, 4.6e8 of pulses behind a slow low-pass
 * of one pole; a record that pulses do not describe would take more.  And per second of a
 * long record, some second of processor time, for what is tried later.  Separating takes
 * as much at most: of the scenes of tests/matrix/scenes.tsv at 10 kHz none that pulses
 * describe takes more than 4.8e7 per second (dense-350-gauss), bubbles alone take 1.7e8,
 * with many particles among them 5.9e8. */
static const double EFFORT = 1e9, EFFORT_PER_SECOND = 9e7;

double separate_effort(const struct separate *s, double samples)
{
	double rate = s->par.rate > 0 ? s->par.rate : 1e4;
	double most = fmax(EFFORT, EFFORT_PER_SECOND * samples * s->ratio / rate);

	return s->par.effort > 0 ? fmin(s->par.effort, most) : most;
}

/* The noise is followed in blocks of a sixteenth of what is learned from. */
enum { BLOCKS = 16 };

static void follow_noise(struct separate *s, size_t n)
{
	enum { SHORTEST = 256 };
	const struct calibration *c = &s->cal;
	size_t block = (n ? n : s->par.learn) / BLOCKS;
	/* Of these, no more is clean before samples beyond them are known. */
	double known = fmax(
		0.5 * (double)n, (double)n - 2 * (double)c->tone_hop - c->whitening.edge);

	block = block < FOLLOWING_BLOCK ? block : FOLLOWING_BLOCK;
	if (block < SHORTEST || c->duration < FOLLOWED)
		return;
	for (int k = 0; k < s->channels; k++)
		buffer_follow(&s->buffer[k], s->done, block, n ? 0 : s->kept.level[k],
			s->buffer[k].begin + (long long)known);
}

/* The longest stretch of the n oldest samples in which a channel does not stand still, or
 * clip, for longer than limit: its length, and its first sample. */
static size_t longest_measured(
	const struct buffer *b, size_t n, size_t limit, size_t *from)
{
	size_t run = 0, begin = 0, best = 0;

	*from = 0;
	for (size_t i = 0; i <= n; i++) {
		size_t end = n;

		if (i < n) {
			run = b->hidden[i] ? run + 1 : 0;
			if (run <= limit)
				continue;
			end = i + 1 - run;
		}
		if (end > begin + best) {
			best = end - begin;
			*from = begin;
		}
		begin = i + 1;
	}
	return best;
}

/* The same of the channel that does so for a block.  All samples if neither channel does,
 * or both, as in a record without noise, or if it is too short to be learned from, as
 * that of a dead sensor is. */
static size_t measured(const struct separate *s, size_t n, size_t *from)
{
	size_t at[2], best[2];
	int second;

	for (int c = 0; c < 2; c++)
		best[c] = longest_measured(&s->buffer[c], n, n / BLOCKS, &at[c]);
	second = best[1] < n;
	*from = 0;
	if ((best[0] < n) == second || best[second] < SEPARATE_SHORTEST)
		return n;
	*from = at[second];
	return best[second];
}

/* The noise of the second components, from the n oldest samples. */
static enum num_status measure_quadrature(struct separate *s, size_t n)
{
	const double *x[CHANNELS_MAX];

	for (int c = 0; c < CHANNELS_MAX; c++)
		x[c] = s->buffer[c].x;
	return quadrature_measure(&s->quadrature, x, x + 2, n);
}

/* Starts the separation with an instrument learned from the n oldest samples (0: kept).
 */
static enum separate_status start(struct separate *s, size_t n)
{
	const struct calibration *c = &s->cal;
	double reach;

	s->calibrated = 1;
	separate_align(s, 0);
	s->done = s->level_at = s->buffer[0].begin + c->whitening.edge;
	calibration_scene(c, &s->scene);
	s->gain = s->scene.gain;
	s->drift = c->drift;
	s->learned_at = (double)s->buffer[0].begin;
	s->gain_at = s->learned_at + 0.5 * (double)n;
	s->drifts_to = s->gain_at + (double)n;
	s->scene.max_pulses = JOINT_PULSES_MAX;
	reach = 2 * shape_reach(c->shape) * c->duration;
	if (s->par.window < (size_t)(6 * reach))
		s->par.window = s->par.window ? (size_t)(6 * reach)
					      : (size_t)(reach + 23 * c->duration);
	/* Limits the number of functions that describe the baseline of a window. */
	if (c->whitening.low * 2 * (double)s->par.window > JOINT_BASELINE_MAX)
		s->par.window = (size_t)fmax(
			3 * reach, JOINT_BASELINE_MAX / (2 * c->whitening.low));
	s->quadrature =
		s->par.kept ? s->kept.second : (struct quadrature){ .noise = { 1, 1 } };
	if (has_quadrature(s) && n > 0 && measure_quadrature(s, n) != NUM_OK)
		return SEPARATE_MEMORY;
	for (int k = 0; k < s->channels; k++)
		if (buffer_start(&s->buffer[k], c,
			    k < 2 ? c->mean[k] : mean_of(s->buffer[k].x, n),
			    k < 2 ? c->noise[k]
				  : c->noise[k - 2] * s->quadrature.noise[k - 2]) !=
			NUM_OK)
			return SEPARATE_MEMORY;
	follow_noise(s, n);
	/* Equal pulses on both channels reach the threshold of a pair when each reaches 1
	 * / sqrt 2 of it. */
	s->sections = sections_new(c->shape, c->duration, 0.65 * sqrt(c->threshold),
		fmax(c->delta_max, -c->delta_min));
	if (s->sections)
		sections_skip(s->sections, s->done);
	s->hold = s->buffer[0].begin + (long long)n;
	if (isnan(s->par.known.spread) && !isinf(c->transit))
		validation_range(s->validation, c->transit, c->delta_min, c->delta_max);
	s->holding = s->par.method == SEPARATE_FIT && n > 0;
	if (s->par.kept) {
		validation_tell_flow(s->validation, &s->kept.flow);
		s->crowded = s->kept.crowded;
		s->looked = 1;
		if (separate_set_common(s, s->kept.common) != NUM_OK)
			return SEPARATE_MEMORY;
	}
	s->joint = joint_new();
	if (s->par.method == SEPARATE_MASKS) {
		size_t window = s->par.mask_window ? s->par.mask_window : 64;
		struct masks_par mp = { .duration = c->duration,
			.delta_min = c->delta_min,
			.delta_max = c->delta_max,
			.gain_max = 2 * s->scene.gain,
			.peak_share = 0.3,
			.sources = s->par.sources,
			.shape = c->shape };

		/* The first bin has to lie in the band of a pulse. */
		while (!s->par.mask_window && (double)window * MASKS_BAND < c->duration)
			window *= 2;
		if ((double)window * MASKS_BAND < c->duration)
			return SEPARATE_WINDOW;
		mp.window = window;
		mp.hop = s->par.mask_hop ? s->par.mask_hop : window / 2;
		s->masks = masks_new(&mp);
		if (!s->masks)
			return SEPARATE_MEMORY;
	}
	return s->sections && s->joint ? SEPARATE_OK : SEPARATE_MEMORY;
}

/* What is known of the instrument, in samples of the buffers. */
static struct calibrate_par known_of(const struct separate *s)
{
	struct calibrate_par known = s->par.known;

	known.lag /= s->ratio;
	known.duration /= s->ratio;
	known.false_alarm *= s->ratio;
	for (int k = 0; k < known.tones; k++)
		known.omega[k] *= s->ratio;
	return known;
}

/* Fills c from the n oldest samples, without those hidden, with at most so much work. */
static enum separate_status learn_without(struct separate *s, size_t n, double most,
	unsigned char *const hidden[2], struct calibration *c)
{
	struct calibrate_par known = known_of(s);
	enum separate_status status;

	known.hidden[0] = hidden[0];
	known.hidden[1] = hidden[1];
	known.most = most;
	status = calibrate(&known, s->buffer[0].x, s->buffer[1].x, n, c);
	s->effort += c->work;
	return status;
}

/* Half of the work at most is done to learn without samples at a limit, and where these
 * pulses describe the rest, TWICE that work to describe all.  In 17 records with limits
 * at half to all of the largest pulse, describing all took 1.0 to 170 times the work; in
 * the three of them where it was the better explanation, 1.3, 1.5 and 6.6. */
static const double HALF = 0.5, TWICE = 2;

/* Learns from the n oldest samples as they are, and without those at a limit with noise
 * behind it, and keeps the better explanation: pulses of one size may crowd at the top as
 * well. */
static enum separate_status learn_limited(struct separate *s, size_t n, double most)
{
	struct converter was[CHANNELS_MAX], limited[CHANNELS_MAX];
	struct calibration below = { 0 };
	unsigned char *known[2] = { s->buffer[0].hidden, s->buffer[1].hidden };
	unsigned char *hidden[2] = { malloc(n), malloc(n) };
	double *work = malloc(2 * n * sizeof *work);
	enum separate_status status =
		hidden[0] && hidden[1] && work ? SEPARATE_OK : SEPARATE_MEMORY;
	int describes = 0;

	memcpy(was, s->converter, sizeof was);
	if (status == SEPARATE_OK && separate_find_blurred(s, n, work)) {
		for (int c = 0; c < 2; c++)
			for (size_t i = 0; i < n; i++)
				hidden[c][i] = known[c][i] || separate_saturates(s, c, i);
		status = learn_without(s, n, HALF * most, hidden, &below);
		describes = status == SEPARATE_OK && calibration_describes(&below);
		most = describes ? TWICE * below.work : most - below.work;
	}
	free(work);
	free(hidden[0]);
	free(hidden[1]);
	memcpy(limited, s->converter, sizeof limited);
	memcpy(s->converter, was, sizeof was);
	if (status != SEPARATE_MEMORY)
		status = learn_without(s, n, most, known, &s->cal);
	if (status != SEPARATE_MEMORY && describes &&
		(status != SEPARATE_OK || below.penalised < s->cal.penalised)) {
		calibration_clear(&s->cal);
		s->cal = below;
		memcpy(s->converter, limited, sizeof limited);
		separate_review(s);
		return SEPARATE_OK;
	}
	calibration_clear(&below);
	return status;
}

/* The work that may still be done to learn from the n oldest samples. */
static double work_left(const struct separate *s, size_t n)
{
	return separate_effort(s, (double)(s->buffer[0].begin + (long long)n)) -
	       s->effort;
}

/* Fills s->cal from the n oldest samples, with at most so much work. */
static enum separate_status learn_from(struct separate *s, size_t n, double most)
{
	enum separate_status status;

	if (n < SEPARATE_SHORTEST)
		return SEPARATE_NO_LAG;
	separate_review(s);
	status = learn_limited(s, n, most);
	if (status != SEPARATE_OK)
		return status;
	if (s->cal.duration >= SECTIONS_SHORTEST)
		return SEPARATE_OK;
	calibration_clear(&s->cal);
	return SEPARATE_FAST;
}

/* *found: 1 if a channel of the first n samples is more than noise in the means of
 * longest samples or fewer. */
static enum separate_status look_for_bursts(
	const struct separate *s, size_t n, size_t longest, int *found)
{
	double *work = malloc((n + 1) * sizeof *work);

	if (!work)
		return SEPARATE_MEMORY;
	*found = bursts_found(s->buffer[0].x, n, longest, work) ||
		 bursts_found(s->buffer[1].x, n, longest, work);
	free(work);
	return SEPARATE_OK;
}

/* Least duration of a pulse, in means, if other components of the record are longer: the
 * more of these is learned from, the better. */
enum { SHORT = 32 };

/* Separates means from now on, if an instrument can be learned from them whose pulses
 * are not too short; otherwise s is as before.  share: of the work that may be done.
 * *duration: of a pulse, in means; 0: not learned. */
static enum separate_status learn_from_means(
	struct separate *s, int ratio, double share, double *duration)
{
	struct buffer fine[CHANNELS_MAX], mean[CHANNELS_MAX];
	size_t n, from;
	enum separate_status status;

	*duration = 0;
	memcpy(fine, s->buffer, sizeof fine);
	if (separate_average_buffers(fine, s->channels, fine[0].n, ratio, mean) !=
		NUM_OK) {
		separate_clear_buffers(mean);
		return SEPARATE_MEMORY;
	}
	memcpy(s->buffer, mean, sizeof mean);
	s->ratio = ratio;
	n = measured(s, lesser(mean[0].n, separate_learned_means(s, ratio)), &from);
	status = learn_from(s, from ? 0 : n, share * work_left(s, n));
	if (status == SEPARATE_OK)
		*duration = s->cal.duration;
	if (*duration >= SHORT) {
		separate_clear_buffers(fine);
		separate_convert(s, ratio);
		return start(s, n);
	}
	if (status == SEPARATE_OK)
		calibration_clear(&s->cal);
	separate_clear_buffers(mean);
	memcpy(s->buffer, fine, sizeof fine);
	s->ratio = 1;
	return status == SEPARATE_MEMORY ? status : SEPARATE_OK;
}

/* Share of the work of learning after which pulses that seem long are looked for in
 * means, if the record holds events that these hide: there it takes less.  With an
 * eighth, bubbles are learned instead of the shorter pulses of particles among them
 * (tests/events.t); a half takes twice the time where hum hides long pulses
 * (rate-100k-hum of tests/matrix/scenes.tsv). */
static const double FIRST = 0.25;

/* Learns from the n oldest samples, even if more have arrived at once.  If the pulses
 * seem long, and are not described as short ones, awaits as many means; where nothing was
 * learned from these, they are averaged again when half of them have been passed over. */
static enum separate_status calibrate_now(struct separate *s, size_t n)
{
	size_t means;
	int ratio = 1, again = s->awaited > 0, brief = 0;
	enum separate_status status = SEPARATE_OK;

	s->awaited = 0;
	if (s->ratio == 1 && s->par.method == SEPARATE_FIT && !s->par.known.filter &&
		!s->par.want_sources && separate_guess_ratio(s, &ratio) != NUM_OK)
		return SEPARATE_MEMORY;
	if (s->buffer[0].begin < s->averaged)
		ratio = 1;
	if (ratio > 1 && !again &&
		look_for_bursts(s, n, (size_t)ratio, &brief) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	if (brief) {
		status = learn_from(s, n, FIRST * work_left(s, n));
		if (status == SEPARATE_OK && s->cal.duration <= SEPARATE_LONG)
			return start(s, n);
		if (status == SEPARATE_OK)
			calibration_clear(&s->cal);
		if (status == SEPARATE_MEMORY)
			return status;
	}
	means = (size_t)ratio * separate_learned_means(s, ratio);
	if (ratio > 1 && !s->ended && s->buffer[0].n < means) {
		s->awaited = means;
		return SEPARATE_OK;
	}
	if (ratio > 1)
		s->averaged =
			s->buffer[0].begin + (long long)lesser(means, s->buffer[0].n) / 2;
	status = SEPARATE_OK;
	/* The ratios are quartered down to 1; each has an equal part of the work left. */
	while (ratio > 1 && status == SEPARATE_OK && !s->calibrated) {
		double duration, tries = 1 + log2(ratio) / 2;

		status = learn_from_means(s, ratio, 1 / tries, &duration);
		ratio = duration > 0 ? separate_ratio_of(
					       duration * ratio, 2 * SHORT, ratio / 2)
				     : ratio / 4;
	}
	if (status != SEPARATE_OK || s->calibrated)
		return status;
	status = learn_from(s, n, work_left(s, n));
	return status == SEPARATE_OK ? start(s, n) : status;
}

/* Fewest pulses that stand alone.  Each parameter of the instrument adds to the variance
 * of a row at most the mth part of what the row itself tells of it if m pulses tell it:
 * to its standard errors 8 % for six. */
enum { ISOLATED = 6 };

/* 1 if pulses of a known shape and nearly one velocity, in white noise and without
 * crosstalk, describe what was learned from.  Chi-square compares the noise in the band
 * of the pulses with that of fourth differences: it is too small or too large where noise
 * is not white, for which there are too few samples to test its spectrum. */
static int is_clear(const struct calibration *c)
{
	return calibration_describes(c) && c->chi2 > 1 / CALIBRATE_DESCRIBES &&
	       c->duration <= SEPARATE_LONG && c->tones == 0 &&
	       c->delta_max - c->delta_min <= 2 * calibration_plug(c) && !c->dense &&
	       !c->presumed_white && !c->measured && !c->corrected && !c->whitening.tap &&
	       c->negative == 0 && c->crosstalk[0] == 0 && c->crosstalk[1] == 0;
}

/* Samples of pulses that may be computed for this per sample.  In 44 records of as many
 * scenes (tests/matrix/scenes.tsv) it takes 70 to 180 where pulses stand alone, 530 of
 * Lorentz pulses, 1340 in turbulent flow; 20 that are not clear take more than 2250. */
static const double CLEARLY = 600;

/* Where there are too few pulses, twice as many samples are awaited. */
enum separate_status separate_learn_clearly(struct separate *s)
{
	size_t n = s->buffer[0].n;
	int few;
	enum separate_status status;

	if (n < s->par.learn)
		return SEPARATE_OK;
	status = learn_from(s, n, CLEARLY * (double)n);
	few = status == SEPARATE_NO_LAG && s->cal.attempts == 0;
	if (status == SEPARATE_OK) {
		if (is_clear(&s->cal) && s->cal.isolated >= ISOLATED)
			return start(s, n);
		few = is_clear(&s->cal) && s->cal.events < ISOLATED;
		calibration_clear(&s->cal);
	}
	if (status == SEPARATE_MEMORY)
		return status;
	s->par.learn *= 2;
	return few && s->par.learn < SEPARATE_LEARN ? SEPARATE_OK : SEPARATE_NO_LAG;
}

/* *again: 1 if the first n samples are noise, and like the last ones that had nothing in
 * common, from which nothing would be learned again; otherwise they are compared with. */
static enum separate_status compare_with_noise(struct separate *s, size_t n, int *again)
{
	double *work = malloc((n + 1) * sizeof *work);
	struct bursts_power power[2];
	int found = 0;

	if (!work)
		return SEPARATE_MEMORY;
	for (int c = 0; c < 2; c++)
		bursts_measure(s->buffer[c].x, n, work, &power[c]);
	free(work);
	*again = bursts_alike(&power[0], &s->nothing[0]) &&
		 bursts_alike(&power[1], &s->nothing[1]);
	if (*again && look_for_bursts(s, n, n, &found) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	*again = *again && !found;
	if (!*again)
		memcpy(s->nothing, power, sizeof power);
	return SEPARATE_OK;
}

/* Drops the n oldest samples, from which nothing was learned.  found: 0 if they are known
 * to be noise. */
static enum separate_status pass_over(struct separate *s, size_t n, int found)
{
	if (found && look_for_bursts(s, n, n, &found) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	s->counters.unlearned += found ? (double)n : 0;
	s->counters.passed_over += (double)n;
	for (int c = 0; c < s->channels; c++)
		buffer_discard(&s->buffer[c], n);
	return SEPARATE_OK;
}

/* Notes why nothing could be learned.  found: 0 if it is known to be from noise, which
 * says nothing if there is more than noise elsewhere.  A kind of event that not all
 * stretches show does not explain the record. */
static void give_reason(struct separate *s, enum separate_status status, int found)
{
	if (found && s->unexplained && status != s->reason)
		status = SEPARATE_HARD;
	if (found || !s->unexplained)
		s->reason = status;
	s->unexplained |= found;
}

size_t separate_wants(const struct separate *s)
{
	size_t next = s->awaited > s->par.learn ? s->awaited : s->par.learn;

	return s->calibrated || s->par.kept ? SIZE_MAX : next - s->buffer[0].n;
}

/* Samples that an attempt wants.  At the end of the record the first one takes what there
 * is, those after it half of the usual. */
static size_t wanted(const struct separate *s, int first)
{
	return !s->ended ? s->par.learn : first ? 1 : s->par.learn / 2;
}

enum separate_status separate_learn(struct separate *s)
{
	size_t half = s->par.learn / 2;
	int first = 1, found, again;
	size_t n, from;

	while (!s->calibrated && s->buffer[0].n >= wanted(s, first)) {
		enum separate_status status;

		if (s->buffer[0].n < s->awaited && !s->ended)
			return SEPARATE_OK;
		n = measured(s, lesser(s->buffer[0].n, s->par.learn), &from);
		if (from > 0) {
			if (pass_over(s, from, 1) != SEPARATE_OK)
				return SEPARATE_MEMORY;
			continue;
		}
		if (!s->awaited && n == s->par.learn) {
			if (compare_with_noise(s, n, &again) != SEPARATE_OK)
				return SEPARATE_MEMORY;
			first = first && !again;
			if (again && pass_over(s, half, 0) != SEPARATE_OK)
				return SEPARATE_MEMORY;
			if (again)
				continue;
		}
		status = calibrate_now(s, n);
		if (s->awaited)
			return status;
		first = 0;
		if (status != SEPARATE_OK && status != SEPARATE_NO_LAG &&
			status != SEPARATE_FAST && status != SEPARATE_HARD &&
			status != SEPARATE_AT_ONCE)
			return status;
		if (s->calibrated)
			break;
		if (look_for_bursts(s, lesser(s->buffer[0].n, s->par.learn), SIZE_MAX,
			    &found) != SEPARATE_OK)
			return SEPARATE_MEMORY;
		give_reason(s, status, found);
		if (status != SEPARATE_NO_LAG || found)
			s->nothing[0].octaves = 0;
		if (s->buffer[0].n < wanted(s, first))
			break;
		if (pass_over(s, half, found) != SEPARATE_OK)
			return SEPARATE_MEMORY;
	}
	return SEPARATE_OK;
}

enum separate_status separate_start_kept(struct separate *s)
{
	return s->cal.duration >= SECTIONS_SHORTEST ? start(s, 0) : SEPARATE_FAST;
}
