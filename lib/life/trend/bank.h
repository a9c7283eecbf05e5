/* bank.h - remaining life by a bank of local trends in damage coordinates
 *
 * The model in words is in aopf(1), Long-term models, and its sweeps in doc/trends.md.
 *
 * The damage D grows from 0 at the start (the median of the first three observations) to
 * 1 at the threshold at the rate dD/dt = v g(D), so that in the coordinate
 * h(D) = int_0^D dD' / g(D') it is a straight line, h = h_0 + v t, whose level and rate a
 * Kalman filter follows over gaps of any length.  Each row of a table defines a
 * coordinate (struct bank_shape), and so does the path of an earlier unit (fleet.h); each
 * has a trend of every kind (bank_state.h).  The variance of the noise is unknown, so
 * that predictions are Student-t.  Covariates x add w_k (x_k - x_0k) to the rate v.
 *
 * The slope of h is taken at the predicted damage, as far as it is known, and not at that
 * observed; otherwise noise alone would favour curved coordinates.
 *
 * Trends whose regime has changed are particles drawn from the others by their weight:
 * a Rao-Blackwellised particle filter (Chen, Liu, J. R. Stat. Soc. B 62 (2000) 493).
 *
 * Trends and particles are averaged by the logarithm of their one-step predictive
 * densities, which fades with age as j / k; n rows count as sqrt(18 n), since they are
 * not independent given a wrong model (Raftery, Karny, Ettler, Technometrics 52 (2010)
 * 52; Grunwald, van Ommen, Bayesian Analysis 12 (2017) 1069).
 *
 *	struct bank *b = bank_new(&par);
 *	for each row
 *		bank_load(b, t, x);             (only with covariates)
 *		bank_add(b, t, y);              (y NAN: missing)
 *	if (bank_ready(b))
 *		bank_draw(b, chances, t, par.threshold, life);   (life/trend/passage.h)
 */
#ifndef LIFE_BANK_H
#define LIFE_BANK_H

#include "num/state.h"

enum bank_family {
	BANK_LINEAR = 1,
	BANK_EXPONENTIAL = 2,
	BANK_POWER = 4,
	BANK_RATE = 8,
	BANK_SATURATING = 16,
	BANK_OTHER = 32, /* the caller's coordinates */
	BANK_ALL = 63
};

struct bank_point {
	double age, level; /* direction times y */
};

/* The age at a level of a path, on straight lines, also beyond its ends; *slope: of the
 * age over the level there. */
double bank_path_age(
	const struct bank_point *path, size_t n, double level, double *slope);

/* g(D) = e^{par D} where scale is 0, else (1 + D / scale)^par; of BANK_SATURATING
 * (1 + scale D)^power (1 - par D), par < 1, power 1 or 1/2; or, where there is a path, dD
 * over the age at which another unit had D. */
struct bank_shape {
	unsigned family;
	double log_prior; /* of a path: of all paths together */
	double scale, par, power;
	int of_value; /* 1: scale is instead the value at D = 0 over the way
		       * to the threshold; without one above 0 g is 1 */
	const struct bank_point *path; /* [n], both of them rising */
	int n;                         /* 0: no path, else 2 or more */
	double seen;                   /* level up to which it is not extrapolated */
};

/* Paths of other units at most: the numbers of shapes have 16 bits. */
enum { BANK_PATHS_MAX = 65000 };

/* The value of a covariate in the future: as its own past tells, see loads.c, or exactly
 * its mean so far, its last value, or value. */
enum bank_future { BANK_PAST, BANK_MEAN, BANK_LAST, BANK_VALUE };

struct bank_covariate {
	enum bank_future future;
	double value;
};

enum { BANK_LOADS = 4 }; /* covariates at most */

struct bank_par {
	double threshold;
	int direction;                 /* +1 reached from below, -1 from above */
	unsigned families;             /* of coordinates; 0: all */
	const struct bank_shape *more; /* further coordinates, the caller's; NULL: none */
	int n_more;
	int own; /* from 1: the one of more that is the path of this very unit, which is
		  * left out; 0: none */
	double rate_mean, rate_sd; /* prior of dy/dt; sd 0: none */
	int steady;                /* 1: no regime changes, neither past nor future */
	const struct bank_covariate *load; /* [n_loads], the caller's */
	int n_loads;
};

enum { BANK_START = 4 }; /* observations before there is a prediction */

/* par is copied; its shapes remain the property of the caller.  NULL: no memory. */
struct bank *bank_new(const struct bank_par *par);
void bank_free(struct bank *b);

/* The covariates x[n_loads] since the row before, up to t; call before bank_add(). */
void bank_load(struct bank *b, double t, const double *x);
/* The rate at the last value of covariate k over that at its mean so far. */
double bank_factor(const struct bank *b, int k);

/* Adds an observation; t must increase; y NAN: none.  Observations before the first one
 * on the good side of the threshold are ignored. */
void bank_add(struct bank *b, double t, double y);
int bank_ready(const struct bank *b); /* 0 for NULL, too */

/* A known event before the next row. */
enum bank_event {
	BANK_REPAIR, /* the level is new, the rate as before */
	BANK_LOAD    /* the rate is new, the level as before */
};
/* 0: no effect, because fewer than three observations are known. */
int bank_event(struct bank *b, enum bank_event event);

/* 1 if the level has fallen at once, and stayed there: a repair. */
int bank_repaired(const struct bank *b);

/* Rows held back, which no trend predicts. */
int bank_held(const struct bank *b);

/* 1 if the last eight values or more are equal because the sensor is frozen, but not all
 * values: those of a unit without wear may be.  Nor if half as many have been before:
 * coarse readings of steady wear repeat as often from one step to the next. */
int bank_stuck(const struct bank *b);

/* Share of a family in the weight, without the trends whose regime has changed; BANK_ALL:
 * the share of these. */
double bank_weight(const struct bank *b, enum bank_family family);

/* Events so far. */
struct bank_counts {
	unsigned long outliers, shifts, halts, births;
};
struct bank_counts bank_counts(const struct bank *b);

/* Saves, or restores into a bank of the same par. */
void bank_pass(struct bank *b, struct state *s);

#endif
