/* bank_state.h - data of a bank, for its rows (bank.c), its coordinates (shapes.c) and
 * the covariates (loads.c) and the draws from it (passage.c)
 */
#ifndef LIFE_BANK_STATE_H
#define LIFE_BANK_STATE_H

#include "life/trend/bank.h"
#include <math.h>

enum {
	KINDS = 6,
	HELD = 8 /* rows held back at most */
};

/* Kinds of trends: the weight of observation j of k is (j / k)^memory, and the damage is
 * a Wiener process whose variance over a mean gap is wander times that of an observation.
 * The wanders and weights, and BENT in bank.c, were swept as doc/benchmarks.md tells. */
static const struct kind {
	double memory, wander, log_prior;
} kinds[KINDS] = { { 0, 0, 0 }, { 1, 0, 0 }, { 3, 0, 0 }, { 0, 3, 0 }, { 0, 0.3, 0 },
	{ 3, 3, -1 } };

/* A local trend h + v t, where v is the rate at the present load.  Covariances are in
 * units of the noise variance. */
struct trend {
	double h, v, phh, phv, pvv;
	double sum; /* discounted sum of squared standardised innovations */
	double score;
	double weight; /* the weights of all trends sum to 1 */
	double onset;  /* of the growth, age */
	float growth;  /* of the rate since then; 0: none */
	float offset;  /* log weight of a particle when it was drawn */
	float lagged;  /* sum of products of innovations with the ones before */
	float before;  /* the last innovation */
	unsigned char shape, kind;
};

/* What a trend knows of a covariate: the change w of v with f, its covariances, and the
 * precision that its prior has at present. */
struct tilt {
	double w, phw, pvw, pww[BANK_LOADS], prior;
};

/* A covariate, as f(x). */
struct load {
	double origin, unit; /* x_0, and the first distance from it */
	double most;         /* the largest one, in units */
	double bend;         /* c, per unit */
	double last;         /* f at the last row */
	double sum;          /* of f times the time, without the idle time */
	double taken;        /* sum at the last row that was taken */
	double at;           /* f that the rates of the trends are for */
};

struct row {
	double t, y;
	double sum[BANK_LOADS]; /* of the loads */
};

struct bank {
	struct bank_par par;
	int shapes, capacity; /* coordinates; trends */
	long rows;            /* taken */
	double base, range;   /* y at D = 0; from there to the threshold, signed */
	double unit;          /* of time: the mean of the first two gaps */
	double first, last;   /* times without the idle time */
	double idle;          /* total idle time */
	double age, gap;      /* of the last row, mean gap, in units */
	double squares;       /* sum of the squares of all gaps, with halts, units^2 */
	double longest;       /* of these gaps */
	double level;         /* D of the last row */
	double before;        /* y of the last row */
	double farthest;      /* y of the row nearest to the threshold, or beyond */
	double quantum;       /* common divisor of the steps of y */
	int repeats;          /* 1: successive values have been equal */
	double frozen;        /* rows that did so by a frozen sensor, expected */
	double bred;          /* age at which particles were last drawn */
	double freedom[KINDS], keep[KINDS], log_constant[KINDS];
	double cut; /* square of the largest standardised innovation */
	double scored;
	struct row held[HELD];
	struct load load[BANK_LOADS];
	int loaded;                    /* 1: the loads have begun */
	double loaded_from, loaded_to; /* times */
	int n_held, event;
	int trends, fixed; /* trends in use; those of them that are not particles */
	struct bank_counts counts;
	struct trend trend[]; /* [capacity], then struct tilt [capacity][n_loads] */
};

/* An observation in a coordinate: h, dh/dD, ln(dh/dD) and its derivative. */
struct place {
	double h, slope, log_slope, bend;
};

/* The factor from the variance of the damage to the variance of h. */
static inline double squared_slope(struct place p)
{
	return p.slope * p.slope;
}

static const double PACE = 0.3; /* sd of the speed of a unit over that of another */

int shapes_in_table(void);
/* Coordinate i: first those of the table, then those of the caller. */
const struct bank_shape *shape_of(const struct bank *b, int i);
/* Below 0 and above 1 a shape continues as a straight line: it is unknown there, and a
 * flat shape would make outliers look exact. */
struct place place_of(const struct bank *b, int shape, double damage);

/* A copy that takes the rows held back for the beginning of a new regime, free it by
 * bank_free(); NULL: no memory. */
struct bank *bank_accepting(const struct bank *b);

/* Advances a trend by a step, and discounts its covariance. */
void project(const struct bank *b, struct trend *tr, const struct place *p, double step,
	double keep);

/* --- covariates, loads.c --- */

/* The tilts [n_loads] of a trend of the bank. */
struct tilt *tilts_of(const struct bank *b, const struct trend *tr);
/* A trend with its rate at other loads f[n_loads]. */
struct trend at_loads(const struct bank *b, const struct trend *tr, const double *f);
/* The mean loads so far, and those assumed for the future. */
void mean_loads(const struct bank *b, double f[BANK_LOADS]);
void future_loads(const struct bank *b, double f[BANK_LOADS]);
/* Turns all trends to the mean loads between the last row taken and this one. */
void face_loads(struct bank *b, const struct row *r);
/* Advances, corrects by an observation (gain is of the level, over f), scales. */
void project_tilts(const struct bank *b, struct trend *tr, double along, double keep);
void correct_tilts(
	const struct bank *b, struct trend *tr, double f, double e, double noise);
void scale_tilts(const struct bank *b, struct trend *tr, double times);
/* Sets the bends to the effects learnt so far. */
void bend_loads(struct bank *b);

/* Number of paths of other units. */
static inline int kin_of(const struct bank *b)
{
	return b->par.n_more - (b->par.own > 0);
}

static inline double damage_of(const struct bank *b, double y)
{
	return (y - b->base) / b->range;
}

static inline double freedom_of(const struct bank *b, const struct trend *tr)
{
	return b->freedom[tr->kind];
}

/* 1: the damage is a Wiener process. */
static inline int wanders(const struct trend *tr)
{
	return kinds[tr->kind].wander > 0;
}

/* Factor by which the rate has grown from the onset to an age. */
static inline double grown(const struct trend *tr, double age)
{
	return tr->growth > 0 ? exp(fmin(100, tr->growth * (age - tr->onset))) : 1;
}

#endif
