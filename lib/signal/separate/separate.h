/* separate.h - a two-sensor record in, particles out, as the record comes
 *
 * The instrument is learned from the first learn samples (calibration.h); if these
 * contain no particle, half of them are skipped, and so on until there is one.  From then
 * on the record is cleaned, aligned and cut into sections (sections.h); each section is
 * separated by one of the methods: joint fit (joint.h) or masks (masks.h).  Sections
 * longer than window are separated window by window; pulses near the end of one are the
 * first guesses of the next.  The cuts depend on the record alone, so that the particles
 * do not depend on the sizes of the pieces passed; memory is bounded by learn and window.
 */
#ifndef SIGNAL_SEPARATE_H
#define SIGNAL_SEPARATE_H

#include "signal/detect/campbell.h"
#include "signal/fit/joint.h"
#include "signal/fit/verdict.h"
#include "signal/learn/calibration.h"
#include "signal/mixture/masks.h"
#include "signal/separate/instrument.h"
#include <stddef.h>

/* Fewest samples from which an instrument can be learned. */
enum { SEPARATE_SHORTEST = 64 };

/* Samples from which it is learned unless told otherwise. */
enum { SEPARATE_LEARN = 65536 };

enum separate_method { SEPARATE_FIT, SEPARATE_MASKS };

/* One particle that passes both sensors, as estimated from the record. */
struct transit {
	long section;     /* from 1 */
	int sources;      /* particles in this section (or window of it); of an event 0 */
	double t1, t2;    /* arrival at either sensor, samples from the start */
	double amplitude; /* at sensor 1, units of the record */
	double t1_se, t2_se, delay_se, amplitude_se;
	double correlation; /* between the errors of delay and amplitude */
	/* Of a record of four channels, rad: then amplitude is that of both components.
	 * NAN: unknown. */
	double phase, phase_se;
	double chi2; /* of the section per degree of freedom */
	/* Of an unresolved section: that of one particle of the mean velocity with the
	 * greatest sum of squares that the section may have.  NAN: unknown. */
	double most;
	enum separate_verdict verdict;
	int together; /* 1: a misfit because it may be two particles */
};

/* What is known about a section when it is done. */
struct separate_section {
	long number;
	long long begin, end; /* samples of channel 1 */
	int sources;
	double chi2;
	enum separate_verdict verdict;
	const double *source; /* sources * (end - begin): each on sensor 1; NULL unless
				 wanted */
	const struct masks *masks;    /* for its histogram; NULL for a fit */
	const struct campbell *dense; /* of an unresolved section, else NULL; per sample
				       * and in units of the record */
};

struct separate_par {
	enum separate_method method;
	struct calibrate_par known;
	double rate;   /* of the record, Hz, which limits the work; 0: 10 kHz */
	double effort; /* samples of pulses that may be computed to learn, and to separate
			  until separate_continue(); 0: what the record allows */
	size_t learn;  /* samples held back to calibrate, at least SEPARATE_SHORTEST;
			  0: SEPARATE_LEARN */
	int clearly;   /* 1: learn only from what shows the instrument clearly, of pulses
			  that stand alone, doubling learn where there are too few of
			  them; else NO_LAG from separate_push(), before any row */
	size_t window; /* longest section worked off at once; 0: 24 durations */
	int sources;   /* exactly so many in each section; 0: find out */
	int most_pulses; /* limit for a window; 0: JOINT_PULSES_MAX */
	/* Of the masks, samples; 0: 64, or as many as the pulses need, and half of it. */
	size_t mask_window, mask_hop;
	/* 2 (0: 2), or with SEPARATE_FIT 4: two components of each sensor, I1 Q1 I2 Q2;
	 * that at this phase, rad, is positive in all pulses (quadrature.h). */
	int channels;
	double angle;
	struct instrument *kept; /* learned before, with known: its cal is taken over;
				    NULL: learn */
	int want_sources;        /* fill separate_section.source */
	void (*on_section)(void *context, const struct separate_section *section);
	void *context;
};

/* Work done and avoided so far. */
struct separate_counters {
	double passed_over;       /* skipped before the instrument was learned */
	double unlearned;         /* of these, where both channels are not just noise */
	double samples, active;   /* frames in all, and in sections */
	double sections, singles; /* sections, and those with one pulse */
	double fits, steps, searches;
	double rows, misfits; /* of pulses fitted, and those doubted, dense ones too */
	double negative;      /* of rows, with a negative amplitude */
	double together;      /* doubted because they may be two particles */
	double foreign;       /* doubted by their velocities, though they fit */
	double events[SEPARATE_VERDICTS]; /* rows of events that are no particles */
	double masks, masks_skipped; /* sections demixed, and those with one source, which
					need not be */
	double unresolved, dense;    /* rows, and the samples these stand for */
	double countless;            /* samples of them with particles of any number */
	double compared, unlike; /* samples of them whose spectrum was compared with that
				    of the pulse, and the sum of its squared difference */
	double covered;    /* samples of events in which no particle would be found */
	double missing[2]; /* samples of either sensor that were not measured, converter.h
			    */
};

/* Rows that may fit no particle: pulses, what is unresolved, and events of no name. */
static inline double separate_tested(const struct separate_counters *c)
{
	return c->rows + c->unresolved + c->events[SEPARATE_TRANSIENT];
}

/* Those that fit none.  A row that may be two particles is not one of them, but where
 * most rows are doubted, the pulse is not that of the record. */
static inline double separate_misfits(const struct separate_counters *c)
{
	double doubted = c->misfits + c->together;

	return 2 * doubted > separate_tested(c) ? doubted : c->misfits;
}

/* If more than a tenth of the rows, and more than two, fit no particle, the pulses are
 * not those that were learned, and other rows may be wrong, too. */
static inline int separate_too_many(double misfits, double tested)
{
	return misfits > 2 && 10 * misfits > tested;
}

struct separate;
struct separate *separate_new(const struct separate_par *par); /* NULL: no memory */
void separate_free(struct separate *s);

/* Samples of the record in one of those that are separated: 1, or more if the pulses are
 * so long that means of samples are separated.  Counters and calibration are in units of
 * these. */
int separate_ratio(const struct separate *s);

/* n frames of all channels, interleaved. */
enum separate_status separate_push(struct separate *s, const double *x, size_t n);
/* NO_LAG, HARD, AT_ONCE and FAST from separate_end() only: there was nothing to learn
 * from. */
enum separate_status separate_end(struct separate *s);
/* The next particle in order of section and arrival; 0 where none is ready. */
int separate_next(struct separate *s, struct transit *p);

const struct calibration *separate_calibration(
	const struct separate *s); /* NULL: not yet */
/* What was learned, to keep, and what the rows so far tell of it; its arrays remain those
 * of s.  0: not yet, some rows of what is learned from are still to be tested. */
int separate_instrument(const struct separate *s, struct instrument *view);
/* Noise of both channels relative to that of the kept instrument, or to that it was
 * learned from, from up to par.learn samples. */
void separate_noise(const struct separate *s, double share[2]);
const struct separate_counters *separate_counters(const struct separate *s);
/* Samples of pulses computed, and those that may be up to now. */
double separate_spent(const struct separate *s);
double separate_allowed(const struct separate *s);
/* Goes on counting after another one that had counted this.  foreign: 1 if the rows of
 * that were doubtful. */
void separate_continue(struct separate *s, const struct separate *last,
	const struct separate_counters *counted, int foreign);
/* Why all rows are doubtful. */
enum separate_doubt {
	SEPARATE_BELIEVED,   /* they are not */
	SEPARATE_FOREIGN,    /* so many pulses fit no particle that none is believed */
	SEPARATE_CHANGED,    /* so did too many before the instrument was learned again */
	SEPARATE_NOISE,      /* the noise is not that of the instrument */
	SEPARATE_REVERSED,   /* nine tenths of the pulses are those of the kept instrument
				with their sign changed */
	SEPARATE_CROWD,      /* more than half is unresolved, unlike its record */
	SEPARATE_LINES,      /* what lines leave was taken for noise */
	SEPARATE_WIDTHS,     /* widths differ more than those of particles */
	SEPARATE_COUNTLESS,  /* what is unresolved may be any number of particles */
	SEPARATE_UNLIKE,     /* what is unresolved has not the spectrum of the pulse */
	SEPARATE_COVERED,    /* particles are lost under events that are none */
	SEPARATE_UNLEARNED,  /* ... and before the instrument was learned */
	SEPARATE_UNEXPLAINED /* nothing could be learned, but the record is not noise */
};
enum separate_doubt separate_doubtful(const struct separate *s);
/* Frame and channel (from 0) that made it fail with NOT_FINITE. */
long long separate_bad_sample(const struct separate *s, int *channel);

#endif
