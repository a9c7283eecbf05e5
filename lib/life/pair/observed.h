/* observed.h - observed gaps of one unit, their rate and the grey model of their values
 *
 * Time, gap and value may have any units, which must be the same throughout.
 *
 *	struct observed o = { 0 };
 *	observed_add(&o, (struct moment){ t, gap, error }, leakage);
 *	rate = observed_rate(&o, RATE_MEAN, NULL);
 *	left = grey_life(&o.grey, limit, 1, 0, 0);
 */
#ifndef LIFE_OBSERVED_H
#define LIFE_OBSERVED_H

#include "life/grey/grey.h"

/* How the wear rate is found (Li's thesis, 4.2). */
enum rate_rule {
	RATE_MEAN,  /* total wear over total time (4-29) */
	RATE_LAST,  /* wear of the last interval over its length (4-28) */
	RATE_FILTER /* by the bank of bank.h */
};

struct moment {
	double t, gap;
	double error; /* standard error of the gap */
};

/* The least for which at least eight intervals are left when every second one is dropped:
 * with fewer no trend is significant to 1 in 1000.  More are noisier. */
enum { OBSERVED_KEPT = 17 };

/* All 0 at first. */
struct observed {
	struct moment first, before,
		last; /* of the rates; different times but at first */
	/* Observations since the start of the rates, one of every so many. */
	struct moment kept[OBSERVED_KEPT];
	long every, passed; /* every 0: none yet */
	int n_kept;
	struct grey_series grey; /* of the observations at times of their own */
};

/* Sets the start of the rates if it is not the first observation; called again, restarts
 * them. */
void observed_begin(struct observed *o, struct moment m);
/* Adds an observation: the gap, and the value as read from which it is derived.  Times
 * must not decrease; an observation at the same time as the last one replaces it. */
void observed_add(struct observed *o, struct moment m, double value);

double observed_gap(const struct observed *o); /* latest; NAN without observations */

/* Rate of the gap by the rule (RATE_FILTER: as RATE_MEAN), if the last gap is z[0] and
 * that at the start of the rate z[1] standard errors above its observation (NULL: 0); NAN
 * while all observations have the same time. */
double observed_rate(const struct observed *o, enum rate_rule rule, const double z[2]);

/* Whether the rate grows (> 0) or falls with time: Mann's test of trend (Econometrica 13,
 * 1945) on the rates in up to 16 intervals, in standard deviations.  Normal where the gap
 * is a process of independent increments at a constant rate, and narrower where readings
 * are noisy.  Sixteen rates have at most 5.4, eight 3.5. */
double observed_rate_trend(const struct observed *o);

/* 1 if the mean rate is, but for one series in 100, outside of [low, high], its standard
 * error being that of independent increments, which is too large for readings with noise.
 */
int observed_rate_outside(const struct observed *o, double low, double high);

/* 1 if the gap falls at one moment and grows steadily before and after, as by a repair;
 * from nine observations on. */
int observed_falls(const struct observed *o);

#endif
