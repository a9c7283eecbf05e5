/* separate.c - see separate.h */
#include "signal/separate/separate_state.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct separate *separate_new(const struct separate_par *par)
{
	struct separate *s = calloc(1, sizeof *s);

	if (!s)
		return NULL;
	s->par = *par;
	s->channels = par->channels > 2 ? CHANNELS_MAX : 2;
	s->default_learn = par->learn == 0;
	s->par.learn = s->default_learn ? SEPARATE_LEARN : par->learn;
	if (s->par.learn < SEPARATE_SHORTEST)
		s->par.learn = SEPARATE_SHORTEST;
	s->ratio = 1;
	if (par->kept) {
		s->kept = *par->kept;
		s->ratio = s->kept.ratio;
		separate_average(s, s->ratio);
		s->cal = s->kept.cal;
		par->kept->cal = s->kept.cal = (struct calibration){ .shift = 0 };
	}
	s->validation = validation_new();
	s->together = together_new();
	if (!s->validation || !s->together) {
		separate_free(s);
		return NULL;
	}
	if (s->par.most_pulses <= 0 || s->par.most_pulses > JOINT_PULSES_MAX)
		s->par.most_pulses = JOINT_PULSES_MAX;
	return s;
}

void separate_free(struct separate *s)
{
	if (!s)
		return;
	calibration_clear(&s->cal);
	sections_free(s->sections);
	joint_free(s->joint);
	masks_free(s->masks);
	separate_clear_common(s);
	separate_clear_buffers(s->buffer);
	for (size_t i = 0; i < s->reports; i++)
		free(s->report[i].source);
	free(s->report);
	validation_free(s->validation);
	together_free(s->together);
	free(s->queue);
	free(s->source);
	free(s->spikes);
	free(s);
}

const struct calibration *separate_calibration(const struct separate *s)
{
	return s->calibrated ? &s->cal : NULL;
}

const struct separate_counters *separate_counters(const struct separate *s)
{
	return &s->counters;
}

double separate_spent(const struct separate *s)
{
	return s->effort + (s->joint ? joint_work(s->joint) : 0);
}

double separate_allowed(const struct separate *s)
{
	return separate_effort(s, s->counters.samples);
}

/* c + sign times more. */
static void add_counters(
	struct separate_counters *c, const struct separate_counters *more, double sign)
{
	enum { COUNTERS = sizeof *c / sizeof(double) };
	double a[COUNTERS], b[COUNTERS];

	memcpy(a, c, sizeof a); /* all members are doubles */
	memcpy(b, more, sizeof b);
	for (int i = 0; i < COUNTERS; i++)
		a[i] += sign * b[i];
	memcpy(c, a, sizeof a);
}

static int is_foreign(const struct separate *s)
{
	struct separate_counters own = s->counters;

	add_counters(&own, &s->before, -1);
	return separate_too_many(separate_misfits(&own), separate_tested(&own));
}

void separate_continue(struct separate *s, const struct separate *last,
	const struct separate_counters *counted, int foreign)
{
	struct separate_counters *c = &s->before;
	double *in_samples[] = { &c->passed_over, &c->unlearned, &c->samples, &c->active,
		&c->dense, &c->countless, &c->compared, &c->unlike, &c->covered,
		&c->missing[0], &c->missing[1] };

	s->par.effort = 0;
	s->was_foreign = last->was_foreign || foreign;
	*c = *counted;
	for (size_t i = 0; i < sizeof in_samples / sizeof *in_samples; i++)
		*in_samples[i] *= (double)last->ratio / s->ratio;
	add_counters(&s->counters, c, 1);
	for (int k = 0; k < 2; k++)
		s->buffer[k].missing += c->missing[k];
}

int separate_ratio(const struct separate *s)
{
	return s->ratio;
}

long long separate_bad_sample(const struct separate *s, int *channel)
{
	*channel = s->bad_channel;
	return s->bad_frame;
}

/* Pulses per duration above which long sections are not separated.  1.5 and 4 give the
 * same rows in eight records of 50 to 400 particles a second (scenes dense and poisson-50
 * of tests/matrix/scenes.tsv, seed 11). */
static const double CROWD = 2.5;

/* 1 if there are too many pulses throughout, by Campbell's theorem for the first samples,
 * which gives a lower bound of their rate. */
static int is_crowded(struct separate *s, long long from, long long to)
{
	struct channels y = channels_at(s, from);
	struct campbell c;

	campbell_estimate(y.at[0], y.at[1], (size_t)(to - from), s->cal.shape,
		s->cal.duration, s->scene.gain, &c);
	return (c.rate - c.rate_se) * s->cal.duration > CROWD;
}

int separate_instrument(const struct separate *s, struct instrument *view)
{
	if (!s->calibrated || s->holding || !s->looked)
		return 0;
	*view = (struct instrument){ .cal = s->cal,
		.ratio = s->ratio,
		.crowded = s->crowded,
		.level_samples = s->levels,
		.common = { s->common.correlation, s->common.left[0], s->common.left[1] },
		.second = s->quadrature };
	memcpy(view->cal.scatter, s->scene.scatter, sizeof view->cal.scatter);
	view->cal.misfit = s->scene.misfit;
	view->cal.gain *= separate_gain_at(s, (double)s->done) * s->cal.noise[1] /
			  (fabs(s->cal.gain) * s->cal.noise[0]);
	memcpy(view->level, s->level, sizeof view->level);
	validation_flow(s->validation, &view->flow);
	return 1;
}

static enum num_status scan(struct separate *s, long long limit)
{
	struct channels y = channels_at(s, s->done);

	return sections_scan(s->sections, y.at, s->channels, s->done,
		(size_t)(limit - s->done),
		s->ended ? limit : limit - sections_reach(s->sections));
}

/* Looks at the first samples before any is separated: always the same ones, whatever the
 * sizes of the pieces passed.  *enough: 0 if there are too few yet. */
static enum separate_status look(struct separate *s, long long limit, int *enough)
{
	long long upto = s->done + (long long)s->par.learn / 2;

	*enough = limit >= upto || s->ended;
	if (!*enough)
		return SEPARATE_OK;
	upto = limit < upto ? limit : upto;
	s->crowded = !s->par.sources && is_crowded(s, s->done, upto);
	if (separate_measure_common(s, s->done, upto) != NUM_OK)
		return SEPARATE_MEMORY;
	s->looked = 1;
	/* Too few samples to remove what is common. */
	if (s->par.clearly && (s->crowded || s->common.correlation != 0))
		return SEPARATE_NO_LAG;
	return SEPARATE_OK;
}

/* Judges what was held back until so much was done. */
static enum separate_status release(struct separate *s, long long done)
{
	if (!s->holding || done < s->hold)
		return SEPARATE_OK;
	s->holding = 0;
	return separate_test_rows(s);
}

/* Separates a window of the first section, which goes on behind it if it is cut. */
static enum separate_status take_window(
	struct separate *s, long long from, long long to, int cut, long long end)
{
	long long next = to;
	enum separate_status status = SEPARATE_OK;

	if (s->window == SEEK) {
		s->number++;
		s->counters.sections++;
	}
	if (release(s, from) != SEPARATE_OK)
		return SEPARATE_MEMORY;
	separate_set_gain(s, from);
	if (s->par.method == SEPARATE_FIT && !s->par.sources &&
		((cut && s->crowded) ||
			joint_work(s->joint) > separate_effort(s, (double)from))) {
		s->window = DENSE;
		s->carried = 0;
	}
	if (s->window == DENSE)
		status = separate_dense_section(s, from, to);
	else if (s->par.method == SEPARATE_MASKS)
		status = separate_mask_section(s, from, to);
	else
		status = separate_fit_section(s, from, to, cut, &next);
	if (status == SEPARATE_OK && !s->holding)
		status = separate_test_rows(s);
	s->counters.active += (double)(next - from);
	if (status != SEPARATE_OK || next == from)
		return status;
	if (s->window == SEEK || !cut)
		s->window = cut ? FIT : SEEK;
	if (!cut)
		s->failures = 0;
	sections_take(s->sections, cut ? next : end);
	return status;
}

/* Drops the samples that are no longer needed. */
static void forget(struct separate *s)
{
	long reach = sections_reach(s->sections);
	struct section section;
	long long keep;

	s->done = sections_scanned(s->sections) - reach;
	if (sections_first(s->sections, &section) && section.begin < s->done)
		s->done = section.begin;
	if (s->done < 0)
		s->done = 0;
	keep = s->done < s->level_at ? s->done : s->level_at;
	for (int c = 0; c < s->channels; c++)
		buffer_forget(&s->buffer[c], keep - reach - separate_common_reach(s));
}

/* Separates all sections that are complete. */
static enum separate_status work(struct separate *s)
{
	long long limit;
	struct section section;
	enum separate_status status = SEPARATE_OK;

	for (int c = 0; c < s->channels; c++)
		if (buffer_prepare(&s->buffer[c], &s->cal, s->ended) != NUM_OK)
			return SEPARATE_MEMORY;
	separate_measure_level(s);
	limit = ready(s);
	if (limit <= s->done)
		return SEPARATE_OK;
	if (!s->looked) {
		int enough;

		status = look(s, limit, &enough);
		if (status != SEPARATE_OK || !enough)
			return status;
	}
	if (scan(s, limit) != NUM_OK)
		return SEPARATE_MEMORY;
	if (s->ended)
		sections_end(s->sections);
	while (status == SEPARATE_OK && sections_first(s->sections, &section)) {
		long long from = section.begin > 0 ? section.begin : 0, to = section.end;
		long long longest = (long long)(s->window == DENSE     ? s->par.learn
						: s->window == SHORTER ? s->span
								       : s->par.window);
		int cut = to - from > longest;

		if (cut)
			to = from + longest;
		if (!s->ended && (to + separate_common_reach(s) > limit ||
					 sections_scanned(s->sections) < to))
			break;
		if (!cut && section.open)
			break;
		if (to > limit)
			to = limit;
		if (to - from < 2)
			sections_take(s->sections, section.end);
		else
			status = take_window(s, from, to, cut, section.end);
	}
	if (status != SEPARATE_OK)
		return status;
	forget(s);
	return release(s, s->ended ? s->hold : s->done);
}

static enum separate_status push(struct separate *s, const double *x, size_t n)
{
	enum separate_status status = SEPARATE_OK;

	/* What is kept is known before the first sample. */
	if (s->par.kept && !s->calibrated)
		status = separate_start_kept(s);
	if (separate_append(s, x, n) != NUM_OK)
		return SEPARATE_MEMORY;
	s->counters.samples += (double)n / s->ratio;
	if (s->par.kept && status == SEPARATE_OK)
		status = separate_check_alive(s);
	for (int c = 0; c < 2; c++)
		s->counters.missing[c] = s->buffer[c].missing;
	if (!s->calibrated && status == SEPARATE_OK)
		status = s->par.clearly ? separate_learn_clearly(s) : separate_learn(s);
	if (status != SEPARATE_OK)
		return status;
	return s->calibrated ? work(s) : status;
}

/* What is learned from ends at the same samples whatever the sizes of the pieces. */
enum separate_status separate_push(struct separate *s, const double *x, size_t n)
{
	size_t channels = (size_t)s->channels;
	enum separate_status status = SEPARATE_OK;

	for (size_t i = 0; i < channels * n; i++)
		if (isinf(x[i])) {
			s->bad_frame = (long long)(s->counters.samples * s->ratio) +
				       (long long)(i / channels);
			s->bad_channel = (int)(i % channels);
			return SEPARATE_NOT_FINITE;
		}
	for (size_t at = 0, some; at < n && status == SEPARATE_OK; at += some) {
		some = separate_wants(s) < n - at ? separate_wants(s) : n - at;
		status = push(s, x + channels * at, some);
	}
	return status;
}

enum separate_status separate_end(struct separate *s)
{
	enum separate_status status = SEPARATE_OK;

	s->ended = 1;
	if (!s->calibrated)
		status = s->counters.samples < SEPARATE_SHORTEST ? SEPARATE_SHORT
								 : separate_learn(s);
	if (status == SEPARATE_OK && s->par.kept)
		status = separate_check_alive(s);
	if (status != SEPARATE_OK)
		return status;
	return s->calibrated ? work(s) : s->reason;
}

/* Share of negative pulses above which the sign of a record is taken to differ from that
 * of the kept instrument: particles of the other polarity may be a tenth of either.  Of
 * ten records of 20 particles (tests/matrix/simulate, 30 dB) none with half of them
 * negative is doubted, 1 with 0.8, 4 with 0.9 and all that are reversed. */
static const double REVERSED = 0.9;

/* Particles arrive at any time, so that this share of them is lost: a record is believed
 * to hold 98 % of those that can be found. */
static const double COVERED = 0.02;

/* Relative difference of the spectra, of the record and of the pulse, from which on the
 * sums by Campbell's theorem are not believed. */
static const double UNLIKE = 0.2;

/* Standard deviation of the widths of pulses from those of their velocities, logarithm,
 * from which on they are not believed to be of particles: that of the square of the field
 * of a loop, at half its height, over a bore of half its radius.  Of .4 it is .05, of .6
 * .12. */
static const double WIDTHS = 0.08;

enum separate_doubt separate_doubtful(const struct separate *s)
{
	const struct separate_counters *c = &s->counters;

	if (!s->calibrated)
		return s->unexplained ? SEPARATE_UNEXPLAINED : SEPARATE_BELIEVED;
	if (separate_is_other_noise(s))
		return SEPARATE_NOISE;
	if (s->par.kept && c->rows > 2 && c->negative > REVERSED * c->rows)
		return SEPARATE_REVERSED;
	if (s->par.kept && !s->kept.crowded && 2 * c->dense > c->samples)
		return SEPARATE_CROWD;
	if (is_foreign(s))
		return SEPARATE_FOREIGN;
	if (s->was_foreign)
		return SEPARATE_CHANGED;
	if (s->cal.lines_in_noise)
		return SEPARATE_LINES;
	if (s->scene.scatter[JOINT_WIDTH] > WIDTHS)
		return SEPARATE_WIDTHS;
	if (c->unlike > UNLIKE * UNLIKE * c->compared)
		return SEPARATE_UNLIKE;
	if (c->countless > COVERED * c->samples)
		return SEPARATE_COUNTLESS;
	if (c->unlearned > COVERED * c->samples)
		return SEPARATE_UNLEARNED;
	return c->covered > COVERED * c->samples ? SEPARATE_COVERED : SEPARATE_BELIEVED;
}
