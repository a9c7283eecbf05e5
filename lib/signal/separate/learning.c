/* learning.c - the instrument of a record: learned from its first samples, or kept */
#include "signal/detect/bursts.h"
#include "signal/detect/spikes.h"
#include "signal/learn/learn.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Shortest pulse whose fourth difference is below the noise, at an amplitude of 300
 * standard deviations: 300 (2 pi / 20)^4 = 3, that of noise is 8. */
static const double FOLLOWED = 20;

/* Samples of pulses that may be computed to learn from the beginning of a record: groups
 * of six Lorentz pulses at 30 dB take 7.4e8, of three pulses behind a guessed low-pass
 * 7.7e8; a record that pulses do not describe would take more.  And per sample of a long
 * record, some second of processor time per second of 10 kHz, for what is tried later. */
static const double EFFORT = 9e8, EFFORT_PER_SAMPLE = 9000;

/* The noise is followed in blocks of a sixteenth of what is to be learned from. */
static void follow_noise(struct separate *s, size_t n)
{
	enum { BLOCKS = 16, SHORTEST = 256 };
	const struct calibration *c = &s->cal;
	size_t block = (n > s->par.early ? n : s->par.learn) / BLOCKS;
	/* Of these, no more is clean before samples beyond them are known. */
	double known = fmax(
		0.5 * (double)n, (double)n - 2 * (double)c->tone_hop - c->whitening.edge);

	block = block < FOLLOWING_BLOCK ? block : FOLLOWING_BLOCK;
	if (block < SHORTEST || c->duration < FOLLOWED || s->par.quadrature ||
		c->whitening.tap)
		return;
	for (int k = 0; k < 2; k++)
		tape_follow(&s->tape[k], s->done, block, n ? 0 : s->kept.level[k],
			s->tape[k].begin + (long long)known);
}

/* Starts the separation with an instrument learned from the n oldest samples (0: kept).
 */
static enum separate_status start(struct separate *s, size_t n)
{
	const struct calibration *c = &s->cal;
	double reach;

	s->calibrated = 1;
	s->done = s->level_at = s->tape[0].begin + c->whitening.edge;
	calibration_scene(c, &s->scene);
	s->gain = s->scene.gain;
	s->energy = c->energy;
	s->scene.max_pulses = JOINT_PULSES_MAX;
	reach = 2 * shape_reach(c->shape) * c->duration;
	if (s->par.window < (size_t)(6 * reach))
		s->par.window = s->par.window ? (size_t)(6 * reach)
					      : (size_t)(reach + 23 * c->duration);
	/* Limits the number of functions that describe the baseline of a window. */
	if (c->whitening.low * 2 * (double)s->par.window > JOINT_BASELINE_MAX)
		s->par.window = (size_t)fmax(
			3 * reach, JOINT_BASELINE_MAX / (2 * c->whitening.low));
	if (tape_start(&s->tape[0], c) != NUM_OK ||
		tape_start(&s->tape[1], c) != NUM_OK ||
		separate_start_common(s) != NUM_OK)
		return SEPARATE_MEMORY;
	follow_noise(s, n);
	if (s->par.quadrature && quadrature_start(&s->quadrature, c, n) != NUM_OK)
		return SEPARATE_MEMORY;
	/* Equal pulses on both channels reach the threshold of a pair when each reaches 1
	 * / sqrt 2 of it. */
	s->sections = sections_new(c->shape, c->duration, 0.65 * sqrt(c->drop),
		fmax(c->delta_max, -c->delta_min));
	if (s->sections)
		sections_skip(s->sections, s->done);
	s->learned = n ? n : s->par.learn;
	s->told = s->tape[0].begin + (long long)s->par.learn;
	/* Of an early instrument, the first rows come at once: an eighth of the samples
	 * is left for the transit time and the reach of a pulse. */
	s->hold = s->tape[0].begin + (long long)(n == s->par.early ? n - n / 8 : n);
	if (isnan(s->par.known.spread) && !isinf(c->transit))
		validation_range(s->validation, c->delta_min, c->delta_max);
	s->holding = s->par.method == SEPARATE_FIT && n > 0;
	if (s->par.kept) {
		validation_tell_flow(s->validation, &s->kept.flow);
		s->crowded = s->kept.crowded;
		s->looked = 1;
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

/* Fewest isolated pulses of an early instrument.  Each of its parameters adds to the
 * variance of a row at most the mth part of what the row itself knows of it if m pulses
 * tell it: 8 % of the standard error for six, until the parameter has been followed. */
enum { EARLY = 6 };

/* 1 if pulses of a known shape in white noise describe all that an early instrument is
 * learned from, and nothing had to be guessed.  Nor is it early where noise is common to
 * both channels: without it the rows would have smaller errors than the instrument.
 * Chi-square compares the noise in the band of the pulses with that in its fourth
 * differences: it is too small or too large where the noise is not white, for which there
 * are too few samples to test its spectrum. */
static int is_clear(const struct calibration *c)
{
	return c->lone >= EARLY && learn_describes(c) && c->chi2 > 1 / 1.2 &&
	       c->far == 0 && c->tones == 0 && c->common[0] == 0 && !c->dense &&
	       !c->suspect && !c->measured && !c->corrected && !c->whitening.tap;
}

/* Learns from the n oldest samples. */
static enum separate_status calibrate_now(struct separate *s, size_t n)
{
	static const enum separate_status of[] = {
		[CALIBRATE_OK] = SEPARATE_OK,
		[CALIBRATE_MEMORY] = SEPARATE_MEMORY,
		[CALIBRATE_COLOURED] = SEPARATE_NO_LAG,
		[CALIBRATE_SILENT_1] = SEPARATE_SILENT_1,
		[CALIBRATE_SILENT_2] = SEPARATE_SILENT_2,
		[CALIBRATE_HARD] = SEPARATE_HARD,
		[CALIBRATE_NO_LAG] = SEPARATE_NO_LAG,
		[CALIBRATE_AT_ONCE] = SEPARATE_AT_ONCE,
		[CALIBRATE_SWAPPED] = SEPARATE_SWAPPED,
		[CALIBRATE_FAR] = SEPARATE_FAR,
		[CALIBRATE_NARROW] = SEPARATE_NARROW,
		[CALIBRATE_FAST] = SEPARATE_FAST,
		[CALIBRATE_SLOW] = SEPARATE_SLOW,
		[CALIBRATE_TONES] = SEPARATE_TONES,
	};
	const int early = n == s->par.early;
	struct calibrate_par known = s->par.known;
	enum calibrate_status status;

	if (n < SEPARATE_SHORTEST)
		return SEPARATE_NO_LAG;
	for (int c = 0; c < 2; c++) {
		tape_review(&s->tape[c]);
		known.hidden[c] = s->tape[c].hidden;
	}
	known.most = fmax(EFFORT, EFFORT_PER_SAMPLE *
					  (double)(s->tape[0].begin + (long long)n)) -
		     s->effort;
	if (early) /* a quarter of a second of work that may be in vain */
		known.most = EFFORT_PER_SAMPLE / 4 * (double)n;
	status = calibrate(&known, s->tape[0].x, s->tape[1].x, n, &s->cal);
	s->effort += early ? 0 : s->cal.work;
	if (status != CALIBRATE_OK)
		return of[status];
	if (early && !is_clear(&s->cal))
		status = CALIBRATE_NO_LAG;
	else if (!(s->cal.duration >= SECTIONS_SHORTEST))
		status = CALIBRATE_FAST;
	if (status == CALIBRATE_OK)
		return start(s, n);
	calibration_clear(&s->cal);
	return of[status];
}

/* Notes whether the first n samples, of which nothing could be learned, are noise. */
static enum separate_status look_for_bursts(struct separate *s, size_t n)
{
	double *work = malloc(n * sizeof *work);

	if (!work)
		return SEPARATE_MEMORY;
	s->unexplained |= bursts_found(s->tape[0].x, n, work) &&
			  bursts_found(s->tape[1].x, n, work);
	free(work);
	return SEPARATE_OK;
}

/* 1 if this failure to learn is one of the samples, of which later ones may do. */
static int is_of_samples(enum separate_status status)
{
	return status == SEPARATE_NO_LAG || status == SEPARATE_FAST ||
	       status == SEPARATE_HARD || status == SEPARATE_AT_ONCE;
}

size_t separate_wants(const struct separate *s)
{
	size_t next = s->tried ? s->par.learn : s->par.early;

	return s->calibrated || s->par.kept ? SIZE_MAX : next - s->tape[0].n;
}

enum separate_status separate_learn(struct separate *s)
{
	size_t half = s->par.learn / 2;
	int first = 1;

	if (!s->tried && s->tape[0].n >= s->par.early) {
		enum separate_status status = calibrate_now(s, s->par.early);

		s->tried = 1;
		if (status == SEPARATE_MEMORY || s->calibrated)
			return status;
	}
	while (!s->calibrated && s->tape[0].n >= (s->ended && first ? 1 : s->par.learn)) {
		enum separate_status status = calibrate_now(s, s->tape[0].n);

		first = 0;
		if (s->calibrated || !is_of_samples(status))
			return status;
		s->reason = status;
		if (look_for_bursts(s, s->tape[0].n) != SEPARATE_OK)
			return SEPARATE_MEMORY;
		if (s->tape[0].n < s->par.learn)
			break;
		for (int c = 0; c < 2; c++)
			tape_drop(&s->tape[c], half);
		if (s->par.quadrature)
			quadrature_drop(&s->quadrature, half);
		s->counters.passed_over += (double)half;
	}
	return SEPARATE_OK;
}

enum separate_status separate_start_kept(struct separate *s)
{
	return s->cal.duration >= SECTIONS_SHORTEST ? start(s, 0) : SEPARATE_FAST;
}

enum separate_status separate_check_alive(struct separate *s, const double *x, size_t n)
{
	double before = s->counters.samples;

	for (size_t i = 0; i < 2 * n && before < (double)s->par.learn; i++) {
		if (before == 0 && i < 2)
			s->first[i] = x[i];
		s->varies[i % 2] |= x[i] != s->first[i % 2];
	}
	if (before + (double)n < (double)s->par.learn && !s->ended)
		return SEPARATE_OK;
	return !s->varies[0]   ? SEPARATE_SILENT_1
	       : !s->varies[1] ? SEPARATE_SILENT_2
			       : SEPARATE_OK;
}
