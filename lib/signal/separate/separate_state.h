/* separate_state.h - data shared by the parts of separate.h, for lib/signal/separate only
 */
#ifndef SIGNAL_SEPARATE_STATE_H
#define SIGNAL_SEPARATE_STATE_H

#include "num/lesser.h"
#include "signal/detect/bursts.h"
#include "signal/detect/foreign.h"
#include "signal/detect/sections.h"
#include "signal/fit/goodness.h"
#include "signal/fit/quadrature.h"
#include "signal/separate/buffer.h"
#include "signal/separate/converter.h"
#include "signal/separate/separate.h"
#include "signal/separate/together.h"
#include "signal/separate/validate.h"

/* Of sensors 1 and 2; the second components of either follow (quadrature.h). */
enum { CHANNELS_MAX = 4 };

/* A row that may not have been tested yet. */
struct entry {
	struct transit row;
	struct evidence evidence;
	double more_square; /* as that of joint_pulse */
};

/* A section to be reported once its rows are tested. */
struct report {
	struct separate_section section;
	struct campbell dense;
	double *source;
	size_t first, rows; /* of the queue */
};

/* The range of delays follows the last TRACKED pulses that stood alone, once there are
 * ENOUGH: widened by half on either side, the range of 12 normal deviates misses 1 % of
 * later ones and that of 64 6e-5.  The gain is checked after every GAINS windows, whose
 * mean has an eighth of the variance of one.
 *
 * In 28 records with 4400 particles (scenes flow-drift, gain-drift, turbulent and plain
 * of tests/matrix/scenes.tsv, seeds 11 to 14), TRACKED 16 makes nine of the records
 * doubtful and 32 to 256 none, but 128 and 256 increase the error of delays from 1.04
 * to 1.06 of its bound; ENOUGH 6, 12 and 24 give 8, 2 and 2 wrong rows; GAINS 4, 8, 16
 * and 32 give 2, 2, 4 and 14 wrong rows and an error of 1.03, 1.04, 1.05 and 1.14 of the
 * bound. */
enum { TRACKED = 64, ENOUGH = 12, GAINS = 8 };

/* The next window of samples to separate. */
enum window {
	SEEK,    /* begins a section */
	FIT,     /* goes on with the last one */
	SHORTER, /* the same, but shorter: the last one had too many pulses */
	DENSE    /* the rest of the section is one unresolved row */
};

/* What both channels have in common (common.h). */
struct common {
	double correlation;  /* 0: it is not removed */
	double left[2];      /* noise of either channel without it, of 1 */
	struct shape *sharp; /* the pulse in units of left[0] */
	double *work;
	size_t room;
};

struct separate {
	struct separate_par par;
	struct calibration cal;
	int default_learn; /* 1: par.learn is SEPARATE_LEARN */
	int calibrated, ended;
	struct instrument kept; /* par.kept, whose cal is moved to cal */
	double level[CHANNELS_MAX], levels;
	/* Level of the same samples and of the last ones, as they are fitted, and whether
	 * and how much it has changed. */
	double fitted[CHANNELS_MAX], last_level[CHANNELS_MAX], last_levels, change[2];
	int changed;
	long long level_at;
	int looked;         /* 1: the first samples have been examined */
	int crowded;        /* 1: long sections hold too many pulses */
	int ratio;          /* samples of the record in one of buffer */
	size_t awaited;     /* samples of buffer to learn from means */
	long long averaged; /* no means are tried before this sample of the record */
	int channels;       /* of the record */
	struct converter converter[CHANNELS_MAX]; /* of each channel, in their order */
	struct buffer buffer[CHANNELS_MAX];
	struct sections *sections;
	struct joint *joint;
	struct masks *masks;
	struct joint_scene scene;
	struct common common;
	double gain;       /* of sensor 2, over the noise learned, as followed ... */
	double gain_at;    /* ... at this sample, ... */
	double drift;      /* ... the change of its logarithm per sample, ... */
	double drifts_to;  /* ... and the sample up to which it is believed: ... */
	double learned_at; /* ... for as long as it has been followed from here on */
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	struct quadrature quadrature;
	struct quadrature_pulse both[JOINT_PULSES_MAX]; /* pulse, both components */
	int with_both; /* 1: both is of the present window */
	int carried;   /* pulses of the last window that are first guesses of the next */
	enum window window;
	size_t span;           /* longest window if SHORTER */
	int failures;          /* consecutive windows that were not resolved */
	int strange;           /* 1: DENSE although the section is short */
	long long shock_end;   /* of the last shock that was found by one of its halves */
	int same_shock;        /* 1: the event found is its other half */
	unsigned char *spikes; /* flags of impulses */
	size_t spike_room;
	double pair_odds[JOINT_PULSES_MAX][JOINT_SHARES]; /* of each pulse */
	double delay[TRACKED]; /* of the last pulses that stood alone */
	size_t delays;
	struct joint_deviation own[JOINT_OWN]
				  [TRACKED]; /* what they had of their own, ... */
	size_t owns[JOINT_OWN];              /* ... and how many of it so far */
	/* Of the last GAINS windows or fewer: sums of the relative deviations of the
	 * gain in standard errors, of these by their weights, of the weights, and of
	 * their times. */
	double gain_off, gain_sum, gain_weight, gain_time;
	int gains;
	long number;
	long long done; /* samples before this one are done */
	struct entry *queue;
	size_t count, tested, given, capacity;
	struct report *report;
	size_t reports, report_capacity;
	struct validation *validation;
	struct together *together;
	long long hold; /* rows before this sample are tested together */
	int holding, group;
	double *source;
	struct separate_counters counters, before; /* before: at the first sample */
	int was_foreign;                /* 1: what came before fitted no particle */
	enum separate_status reason;    /* why nothing could be learned */
	struct bursts_power nothing[2]; /* of the last noise that had nothing in common */
	int unexplained; /* 1: although a channel stands out of its noise */
	double effort;   /* samples of pulses computed to learn */
	long long bad_frame;
	int bad_channel;
};

/* One explanation of a window: its pulses, and the goodness of their fit. */
struct account {
	long long from;
	size_t n;  /* samples from this one on */
	int cut;   /* 1: the section goes on behind it */
	int whole; /* 1: it is a section whose number of sources is not given */
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	int m, done; /* pulses, and those before the boundary */
	double boundary;
	int impulses; /* 1: it leaves out impulses */
	struct joint_result r;
	struct goodness goodness;
};

/* Channels from a sample of sensor 1 on, those of sensor 2 aligned. */
struct channels {
	const double *at[CHANNELS_MAX];
};

static inline struct channels channels_at(const struct separate *s, long long at)
{
	struct channels y = { { NULL } };

	for (int c = 0; c < s->channels; c++)
		y.at[c] = s->buffer[c].x +
			  (at + (c % 2 ? s->cal.shift : 0) - s->buffer[c].begin);
	return y;
}

static inline int has_quadrature(const struct separate *s)
{
	return s->channels > 2;
}

/* Samples before this one are prepared on all channels, aligned. */
static inline long long ready(const struct separate *s)
{
	long long least = s->buffer[0].clean;

	for (int c = 1; c < s->channels; c++) {
		long long clean = s->buffer[c].clean - (c % 2 ? s->cal.shift : 0);

		least = clean < least ? clean : least;
	}
	return least;
}

/* Noise of a channel at a sample of it, in units of the record. */
static inline double separate_noise_at(const struct separate *s, int c, double at)
{
	return s->buffer[c].scale * following_at(&s->buffer[c].noise, at);
}

/* frames.c */

/* Appends n frames to the buffers. */
enum num_status separate_append(struct separate *s, const double *x, size_t n);
/* 1 if a component of sample i of the buffers is at its limit. */
int separate_saturates(struct separate *s, int sensor, size_t i);
/* SILENT if a sensor has been constant for as long as one would learn. */
enum separate_status separate_check_alive(const struct separate *s);
/* Hides the samples at a limit of the converter that only later samples have revealed. */
void separate_review(struct separate *s);
/* Looks for limits with noise behind them in the n oldest samples; 1 if there are.
 * work: 2 n. */
int separate_find_blurred(struct separate *s, size_t n, double *work);
/* Removes the crosstalk from the samples of the buffers from the first on, and negates
 * those of sensor 2 if its polarity is known to be that of sensor 1 reversed; those
 * appended to a calibrated s are aligned as they come. */
void separate_align(struct separate *s, size_t from);

/* queue.c */

/* A new row of the queue, of the present section; NULL: no memory. */
struct entry *separate_queue_entry(struct separate *s);
/* Queues the report of a section with its rows, which are the last of the queue, and the
 * sources in s->source. */
enum separate_status separate_queue_report(
	struct separate *s, const struct separate_section *section, size_t rows);
/* Judges the rows held back; separate_next() may then return them. */
enum separate_status separate_test_rows(struct separate *s);

/* rows.c */

/* Queues the row of an event in [from, to) that is no particle, and reports the section.
 */
enum separate_status separate_give_event(
	struct separate *s, long long from, long long to, const struct foreign *event);
/* Allocates count samples of s->source, all 0. */
enum separate_status separate_reserve_sources(struct separate *s, size_t count);
/* Queues one row for [from, to), whose pulses are not resolved: rate and amplitude by
 * Campbell's theorem. */
enum separate_status separate_dense_section(
	struct separate *s, long long from, long long to);
/* Queues rows for the first done of the m pulses fitted to [from, to). */
enum separate_status separate_give_pulses(struct separate *s, long long from,
	long long to, int m, int done, const struct goodness *j);

/* learning.c */

/* Samples of pulses that may be computed for the first samples of the buffers, to learn
 * from them, and as many to separate them. */
double separate_effort(const struct separate *s, double samples);

/* Learns the instrument from the oldest samples; if they contain no particle, half of
 * them are skipped and the next are tried. */
enum separate_status separate_learn(struct separate *s);
/* Learns it from the first samples if they show it clearly; else NO_LAG. */
enum separate_status separate_learn_clearly(struct separate *s);
/* Samples that are wanted before the next attempt to learn. */
size_t separate_wants(const struct separate *s);
/* Uses a kept instrument for the record. */
enum separate_status separate_start_kept(struct separate *s);
/* averaging.c */

/* Samples of a pulse above which means are separated. */
enum { SEPARATE_LONG = 256 };
/* The least power of 2, or most, that leaves at most limit of a duration. */
int separate_ratio_of(double duration, int limit, int most);
/* *ratio: samples to average if the pulses are as long as the autocorrelation of the
 * first samples suggests. */
enum num_status separate_guess_ratio(const struct separate *s, int *ratio);
/* par.learn, of means, but no longer than par.window, which --latency sets. */
size_t separate_learned_means(const struct separate *s, int ratio);
/* The means of the n oldest samples of so many channels; separate_clear_buffers() frees
 * them, also on failure. */
enum num_status separate_average_buffers(const struct buffer buffer[CHANNELS_MAX],
	int channels, size_t n, int ratio, struct buffer mean[CHANNELS_MAX]);
void separate_clear_buffers(struct buffer buffer[CHANNELS_MAX]);
/* Converts what is known in samples to means. */
void separate_convert(struct separate *s, int ratio);
/* Has the samples of a record that has not begun averaged. */
void separate_average(struct separate *s, int ratio);

/* noise_level.c; separate_noise() as well */

/* Measures the noise of both channels in the prepared samples, as many at a time as are
 * used for learning. */
void separate_measure_level(struct separate *s);
int separate_is_other_noise(const struct separate *s);

/* window.c */

/* Excludes the samples that the converter has not measured from the fit.  Not if the
 * record was whitened, which spreads them over others. */
void separate_hide(struct separate *s, long long from, size_t n);
/* Fits channels y of a window, with the first a->m pulses of a as guesses, and tests the
 * fit. */
enum separate_status separate_fit_window(
	struct separate *s, const double *const y[], struct account *a);
/* Keeps of the last fit what the next one overwrites. */
void separate_keep_fit(struct separate *s, const struct account *a);
int separate_is_described(const struct account *a);

/* without_common.c */

void separate_clear_common(struct separate *s);
/* Takes what common_measure() has found. */
enum num_status separate_set_common(struct separate *s, const double found[3]);

/* Measures what the noise of both channels has in common in these samples. */
enum num_status separate_measure_common(
	struct separate *s, long long from, long long upto);
/* Samples on either side of a window that tell its noise; 0: none are needed. */
long long separate_common_reach(const struct separate *s);
/* Fits a window that a describes again, without what the noise has in common. */
enum separate_status separate_fit_without_common(struct separate *s, struct account *a);

/* following.c */

/* 1 if the range of delays is not given by the caller. */
int separate_is_range_free(const struct separate *s);
/* Widens the range of delays to the widest one, about its present middle. */
void separate_widen(struct separate *s);
/* Updates the range of delays by a pulse that stands alone, and the gain by all. */
void separate_follow(struct separate *s, const struct account *a);
/* The gain at a sample, as followed. */
double separate_gain_at(const struct separate *s, double at);
/* Sets the gain, and the noise of the second components, for a section that begins at
 * sample from: pulses are in units of the noise, which changes in every channel. */
void separate_set_gain(struct separate *s, long long from);

/* rivals.c */

/* Tries other explanations of a window that positive pulses do not describe: impulses
 * beside the pulses, a wider range of velocities, and pulses of both signs.  One is
 * accepted if it describes the window with no more pulses than before, or with one.  Of a
 * window that they describe only the last is tried, which has to be likelier. */
enum separate_status separate_try_rivals(struct separate *s, struct account *a);

/* foreign_event.c */

/* Names the event in [from, from + n) of a component, 0 or 1, if it is no particle. */
enum num_status separate_find_foreign(struct separate *s, long long from, size_t n,
	int component, struct foreign *event);

/* by_fit.c */

/* Separates [from, to) by a joint fit.  With cut the section continues: pulses behind the
 * cut are carried into the next window, whose first sample is *next.  *next is from if
 * the same samples are to be tried again, as a shorter window or as unresolved. */
enum separate_status separate_fit_section(
	struct separate *s, long long from, long long to, int cut, long long *next);

/* by_masks.c */

/* Separates [from, to) by masks. */
enum separate_status separate_mask_section(
	struct separate *s, long long from, long long to);

#endif
