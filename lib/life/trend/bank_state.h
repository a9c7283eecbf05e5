/* bank_state.h - data of a bank, for its rows (bank.c), its coordinates (shapes.c), the
 * states of its trends (states.c), the covariates (loads.c) and the draws from it
 * (passage.c)
 */
#ifndef LIFE_BANK_STATE_H
#define LIFE_BANK_STATE_H

#include "life/trend/bank.h"
#include "life/trend/plateau.h"
#include <math.h>

enum {
	KINDS = 6,
	HELD = 32,  /* rows held back at most: bursts that are waited for */
	LIKELY = 8, /* of them, those that are rather a new regime */
	RATES = BANK_LOADS + 1
};

/* Kinds of trends: the weight of observation j of k is (j / k)^memory, and the damage is
 * a Wiener process whose variance over a mean gap is wander times that of an observation.
 * The wanders and weights, and BENT in bank.c, were swept: see "Wiener processes and
 * weights" in doc/trends.md. */
static const struct kind {
	double memory, wander, log_prior;
} kinds[KINDS] = { { 0, 0, 0 }, { 1, 0, 0 }, { 3, 0, 0 }, { 0, 3, 0 }, { 0, 0.3, 0 },
	{ 3, 3, -1 } };

/* A local trend.  Its state (state_of()) is h, v and, for each covariate f, w; the rate
 * is v + sum w f. */
struct trend {
	double sum; /* discounted sum of squared standardised innovations */
	double score;
	double weight; /* the weights of all trends sum to 1 */
	float onset;   /* of the growth, age */
	float growth;  /* of the rate since then; 0: none */
	float offset;  /* log weight of a particle when it was drawn */
	float lagged;  /* sum of products of innovations with recent before them */
	float recent;  /* faded sum of the last innovations */
	unsigned short shape;
	unsigned char kind;
	unsigned char changes; /* of the regime so far, 255 at most */
};

/* h and the rate at some load, as a state of its own. */
enum { LINE_H, LINE_V, LINE_HH, LINE_HV, LINE_VH, LINE_VV, LINE };

/* A covariate, as f(x). */
struct load {
	double origin, unit; /* x_0, and the first distance from it */
	double most;         /* the largest one, in units */
	double last;         /* f at the last row */
	double sum;          /* of f times the time, without the idle time */
	double taken;        /* sum at the last row that was taken */
	/* Over the time since the start, with the idle time, of f and its integral F. */
	double whole;           /* F */
	double squares;         /* integral of f^2 */
	double bridge, product; /* integrals of F^2 and of F times the time */
	double pull, wander;    /* of the process that it is taken for, see learn() */
};

struct row {
	double t, y;
	double sum[BANK_LOADS]; /* of the loads */
};

struct bank {
	struct bank_par par;
	int shapes, capacity;   /* coordinates; trends */
	long rows;              /* taken */
	double base, range;     /* y at D = 0; from there to the threshold, signed */
	double unit;            /* of time: the mean of the first two gaps */
	double last;            /* time of the last row, without the idle time */
	double idle;            /* total idle time */
	double seen;            /* time of the last row, with the idle time */
	double previous;        /* gap before it, with the idle time, in units */
	double age, gap;        /* of the last row, mean gap, in units */
	double squares;         /* sum of the squares of all gaps, with halts, units^2 */
	double longest;         /* of these gaps */
	double level;           /* D of the last row */
	double before;          /* y of the last row */
	double farthest;        /* y of the row nearest to the threshold, or beyond */
	double quantum;         /* common divisor of the steps of y */
	int repeats;            /* 1: successive values have been equal */
	double frozen;          /* rows that did so by a frozen sensor, expected */
	double stuck;           /* of them, those since a row that did not repeat */
	double freed;           /* most of them before such a row */
	double bred;            /* age at which particles were last drawn */
	double renewed;         /* time of the last repair, with the idle time */
	double repairs, healed; /* their number, and the damage that they took back */
	double freedom[KINDS], keep[KINDS], log_constant[KINDS];
	double cut; /* square of the largest standardised innovation */
	double scored;
	struct row held[HELD];
	struct load load[BANK_LOADS];
	double at[RATES];              /* 1, and each f since the row before */
	int loaded;                    /* 1: the loads have begun */
	double loaded_from, loaded_to; /* times */
	struct plateau course;         /* of the rows taken */
	int n_held, jumped;            /* 1: the next row shows the level after a jump */
	int trends, fixed; /* trends in use; those of them that are not particles */
	struct bank_counts counts;
	struct trend trend[]; /* [capacity], then their states */
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
/* The damage at h. */
double damage_at(const struct bank *b, int shape, double h);

/* The probability that the rows held back are the beginning of a new regime or follow a
 * repair. */
double chance_of_jump(const struct bank *b);
/* A copy that takes the rows held back for the beginning of a new regime, free it by
 * bank_free(); NULL: no memory. */
struct bank *bank_accepting(const struct bank *b);

/* --- states, states.c ---
 * x[n] and its covariance [n][n] in units of the noise variance; x[0] is h, and the
 * others are the rates. */

/* The state of a trend, n = 2 + n_loads; behind it priors_of(). */
double *state_of(const struct bank *b, const struct trend *tr);
size_t size_of_state(const struct bank_par *par);
/* The precisions [n_loads] that the priors of the w of a trend have at present. */
static inline double *priors_of(const struct bank *b, const struct trend *tr)
{
	int n = 2 + b->par.n_loads;

	return state_of(b, tr) + n + n * n;
}
/* h and the rate of a trend at some loads; here and below, f[n - 1] begins with 1. */
void line_at(const struct bank *b, const struct trend *tr, const double *f, double *line);
/* Advances by the length of the way along the rates at these loads, and discounts the
 * covariance. */
void advance_state(int n, double *x, const double *f, double along, double keep);
/* An observation of x[k] that is e above it and has the variance f with x[k]'s own and
 * noise without. */
void observe_state(int n, double *x, int k, double f, double e, double noise);
/* Multiplies the rates. */
void scale_rates(int n, double *x, double times);

/* --- covariates, loads.c --- */

/* 1, and the mean loads so far. */
void mean_loads(const struct bank *b, double f[RATES]);
/* 1, and the mean loads over the time ahead, with their variances. */
void future_loads(
	const struct bank *b, double ahead, double f[RATES], double variance[RATES]);
/* Sets the loads to their means between the last row taken and this one, and the priors
 * to what is known by then. */
void face_loads(struct bank *b, const struct row *r);

/* The way along the present rate in a step, which is longer where the rate grows. */
double advance_of(const struct bank *b, const struct trend *tr, double step);

/* Number of paths of other units. */
static inline int kin_of(const struct bank *b)
{
	return b->par.n_more - (b->par.own > 0);
}

static inline double damage_of(const struct bank *b, double y)
{
	return (y - b->base) / b->range;
}

/* The step of rounded damages, 0 where no two successive ones have been equal. */
static inline double rounding_of(const struct bank *b)
{
	return b->repeats && isfinite(b->quantum) ? b->quantum / fabs(b->range) : 0;
}

static inline double freedom_of(const struct bank *b, const struct trend *tr)
{
	return b->freedom[tr->kind];
}

/* Factor by which the rate has grown from the onset to an age. */
static inline double grown(const struct trend *tr, double age)
{
	return tr->growth > 0 ? exp(fmin(100, tr->growth * (age - tr->onset))) : 1;
}

#endif
