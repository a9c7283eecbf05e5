/* separate_state.h - data shared by the parts of separate.h, for lib/signal/separate only
 */
#ifndef SIGNAL_SEPARATE_STATE_H
#define SIGNAL_SEPARATE_STATE_H

#include "signal/detect/sections.h"
#include "signal/fit/goodness.h"
#include "signal/separate/quadrature.h"
#include "signal/separate/separate.h"
#include "signal/separate/tape.h"
#include "signal/separate/together.h"
#include "signal/separate/validate.h"

/* A row that may not have been judged yet. */
struct entry {
	struct transit row;
	struct evidence evidence;
	struct arrival arrival; /* its group 0: none */
};

/* A section to be reported once its rows are judged. */
struct report {
	struct separate_section section;
	struct campbell dense;
	double *source;
	size_t first, rows; /* of the queue */
};

/* Pulses that stood alone by which the range of delays and the gain are followed. */
enum { TRACKED = 64, ENOUGH = 12, GAINS = 8 };

struct separate {
	struct separate_par par;
	struct calibration cal;
	int calibrated, ended;
	struct instrument kept; /* par.kept, its cal moved to cal */
	int varies[2];          /* channel: not constant so far */
	double first[2];        /* samples of a kept instrument's record */
	double level[2], levels;
	long long level_at;
	int looked, crowded; /* at the first stretch: too many pulses in long sections */
	struct tape tape[2];
	struct sections *sections;
	struct joint *joint;
	struct masks *masks;
	struct joint_scene scene;
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	struct quadrature quadrature;
	struct quadrature_pulse both[JOINT_PULSES_MAX]; /* pulse, with both components */
	int with_both;  /* 1: both is of the present window */
	int carried;    /* pulses of the last window that the next one starts from */
	long long span; /* longest window in this section; 0: as given */
	int failures;   /* windows unresolved, one after the other */
	int dense;      /* the rest of this section is not taken apart */
	int strange;    /* ... though it is short */
	unsigned char *spikes; /* flags of impulses */
	size_t spike_room;
	/* Covariances of the delays of pulse, all of them; 0: not known. */
	double delay_cov[JOINT_PULSES_MAX * JOINT_PULSES_MAX];
	int all;
	double pair_odds[JOINT_PULSES_MAX][JOINT_SHARES]; /* of each of them */
	double delay[TRACKED]; /* of the last pulses that stood alone */
	size_t delays;
	double gain_off[GAINS]; /* of such, in standard errors, since it was last set */
	double gain_sum, gain_weight;
	int gains;
	int continuing; /* the next window belongs to the same section */
	long number;
	long long done; /* samples before this one are worked off */
	struct entry *queue;
	size_t count, judged, given, capacity;
	struct report *report;
	size_t reports, report_capacity;
	struct validation *validation;
	struct together *together;
	long long hold; /* rows of what lies before are judged together */
	int holding, group;
	double *source;
	struct separate_counters counters;
	enum separate_status reason; /* why nothing could be learned */
	long long bad_frame;
	int bad_channel;
};

/* One account of a window: its pulses and what is thought of them. */
struct account {
	struct joint_pulse pulse[JOINT_PULSES_MAX];
	int m, done; /* pulses, and those before the boundary */
	double boundary;
	struct joint_result r;
	struct goodness goodness;
};

static inline double *channel_1(struct separate *s, long long at)
{
	return s->tape[0].x + (at - s->tape[0].begin);
}

static inline double *channel_2(struct separate *s, long long at)
{
	return s->tape[1].x + (at + s->cal.shift - s->tape[1].begin);
}

/* The second components, as channel_1() and channel_2(). */
static inline void quadrature_at(struct separate *s, long long at, double *v[2])
{
	for (int c = 0; c < 2; c++) {
		const struct tape *t = &s->quadrature.tape[c];

		v[c] = t->x + (at + (c ? s->cal.shift : 0) - t->begin);
	}
}

/* Aligned samples before this one are ready on both channels. */
static inline long long ready(const struct separate *s)
{
	long long second = s->tape[1].clean - s->cal.shift;

	return s->tape[0].clean < second ? s->tape[0].clean : second;
}

/* judging.c */

/* A new row of the queue, zeroed; NULL: no memory. */
struct entry *separate_queue_entry(struct separate *s);
/* The section is reported with its rows, the last of the queue, and the sources drawn. */
int separate_queue_report(
	struct separate *s, const struct separate_section *section, size_t rows);
/* Judges the rows held back, which are given out from now on. */
enum separate_status separate_judge_rows(struct separate *s);

/* rows.c */

/* s->source of so many samples, zeroed. */
int separate_reserve_sources(struct separate *s, size_t count);
/* Reports a section at once. */
int separate_report_section(struct separate *s, long long from, long long to, int sources,
	double chi2, enum separate_verdict verdict, const double *source);
/* Shot noise of [from, to): one row. */
enum separate_status separate_dense_section(
	struct separate *s, long long from, long long to);
/* Gives out the first done of the m pulses fitted to [from, to). */
enum separate_status separate_give_pulses(struct separate *s, long long from,
	long long to, int m, int done, const struct goodness *j);

/* learning.c */

/* Learns from the oldest samples held; where they hold no particle, half of them are
 * passed over and the next are tried. */
enum separate_status separate_learn(struct separate *s);
/* Takes a kept instrument for that of the record. */
enum separate_status separate_start_kept(struct separate *s);
/* A channel of a kept instrument that stays constant as long as one would learn. */
enum separate_status separate_check_alive(struct separate *s, const double *x, size_t n);

/* noise_level.c; separate_noise() as well */

/* Measures the noise of both channels once they are clean, until as many samples as are
 * learned from have shown it. */
void separate_measure_level(struct separate *s);
int separate_is_other_noise(const struct separate *s);

/* window.c */

/* Samples that the converter has not measured are left out of the fit, except where the
 * record was made white, which spreads them. */
void separate_hide(struct separate *s, long long from, size_t n);
/* Fits a window from the first a->m pulses of a, and judges the fit. */
enum separate_status separate_fit_window(
	struct separate *s, long long from, size_t n, int cut, struct account *a);
/* Keeps of the last fit what the next one overwrites. */
void separate_keep_fit(struct separate *s, const struct account *a);
int separate_is_described(const struct account *a);

/* following.c */

/* Is the range of delays not given? */
int separate_is_range_free(const struct separate *s);
/* Searches a range of delays about the present one that is as wide as may be. */
void separate_widen(struct separate *s);
/* What a pulse that stands alone tells of the instrument. */
void separate_follow(struct separate *s, const struct account *a);

/* rivals.c */

/* Where pulses do not describe a window: impulses beside the pulses, other velocities,
 * pulses of either sign, or those with impulses; without more pulses. */
enum separate_status separate_try_rivals(
	struct separate *s, long long from, size_t n, int cut, struct account *a);

/* by_fit.c */

/* Works off [from, to) by a joint fit.  With cut, the section goes on: pulses behind
 * the cut are carried into the next window, whose first sample is *next; from again if
 * a shorter one, or shot noise, is to be tried. */
enum separate_status separate_fit_section(
	struct separate *s, long long from, long long to, int cut, long long *next);

/* by_masks.c */

/* Works off [from, to) by masks. */
enum separate_status separate_mask_section(
	struct separate *s, long long from, long long to);

#endif
