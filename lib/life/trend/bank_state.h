/* bank_state.h - data of a bank, for its rows (bank.c), its coordinates (shapes.c) and
 * the draws from it (passage.c)
 */
#ifndef LIFE_BANK_STATE_H
#define LIFE_BANK_STATE_H

#include "life/trend/bank.h"
#include <math.h>

enum {
	MEMORIES = 3,
	KINDS = 2 * MEMORIES, /* memories times noises */
	HELD = 8              /* rows held back at most */
};

/* One line h + v t.  Covariances are in units of the noise variance. */
struct line {
	double h, v, phh, phv, pvv;
	double sum; /* of squared standardised innovations, discounted */
	double score;
	double weight; /* all of them add up to 1 */
	double onset;  /* of the growth, age */
	float growth;  /* of the rate since then; 0: none */
	float offset;  /* of the log weight: of a particle at birth */
	float lagged;  /* sum of products of innovations with the ones before */
	float before;  /* the last one */
	unsigned char shape, kind;
};

struct row {
	double t, y;
};

struct bank {
	struct bank_par par;
	int shapes, capacity; /* coordinates; lines */
	long rows;            /* taken */
	double base, range;   /* y at D = 0, signed way to the threshold */
	double unit;          /* of time: the first gap */
	double first, last;   /* times, less idle */
	double idle;          /* time it has stood */
	double age, gap;      /* of the last row, mean gap, in units */
	double level;         /* D of the last row */
	double bred;          /* age of the last births */
	double freedom[MEMORIES], keep[MEMORIES], log_constant[MEMORIES];
	double scored;
	struct row held[HELD];
	int n_held, event;
	int lines, fixed; /* so many in use; those that are no particles */
	struct bank_counts counts;
	struct line line[];
};

/* An observation in a coordinate: h, dh/dD, and the logarithm of that with its
 * derivative. */
struct place {
	double h, slope, log_slope, bend;
};

/* The variance of h, in units of that of the damage. */
static inline double squared_slope(struct place p)
{
	return p.slope * p.slope;
}

static const double PACE = 0.3; /* sd of the speed of a unit over that of another */

int shapes_in_table(void);
/* A coordinate of the table, or after them one of the caller's. */
const struct bank_shape *shape_of(const struct bank *b, int i);
/* Below 0 and above 1 a shape goes on straight: none is known there, and an outlier must
 * not look exact where a shape has levelled. */
struct place place_of(const struct bank *b, int shape, double damage);

/* Moves a line on by a step, and its covariance with the discount. */
void project(const struct bank *b, struct line *l, const struct place *p, double step,
	double keep);

static inline double damage_of(const struct bank *b, double y)
{
	return (y - b->base) / b->range;
}

static inline double freedom_of(const struct bank *b, const struct line *l)
{
	return b->freedom[l->kind % MEMORIES];
}

/* What the rate has grown by from the onset to an age. */
static inline double grown(const struct line *l, double age)
{
	return l->growth > 0 ? exp(fmin(100, l->growth * (age - l->onset))) : 1;
}

#endif
