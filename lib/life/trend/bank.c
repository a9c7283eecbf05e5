/* bank.c - see bank.h */
#include "life/trend/bank.h"
#include "num/deviates.h"
#include "num/philox.h"
#include "num/select.h"
#include "num/student.h"
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum {
	MEMORIES = 3,
	KINDS = 2 * MEMORIES, /* memories times noises */
	CHANCES = 8,          /* uniform numbers of one draw */
	PARTICLES = 72,
	BIRTHS = 4,    /* at a time */
	FIRST = 3,     /* observations whose median is D = 0 */
	SETTLED = 12,  /* rows before any of them can be held back or cut */
	BREEDING = 16, /* rows before the first births */
	HELD = 8,      /* rows held back at most */
	HELD_GOOD = 3  /* the same on the good side */
};

/* The constants of the coordinates and of the changes of regime were chosen together, by
 * random search over 31 measured series, the first 13 kinds of tests/long/lives.c, 16
 * paths of each with other seeds, and the pump of scripts/synthetic-pump (CRPS of each
 * kind, coverage, calibration); the other kinds there judge. */
#define COORDINATE(family, scale, par, log_prior)            \
	{                                                    \
		family, scale, par, log_prior, NULL, NULL, 0 \
	}

static const struct bank_shape table[] = {
	COORDINATE(BANK_LINEAR, 0, 0, 1.8),
	COORDINATE(BANK_RATE, 0, -3, -4.1),
	COORDINATE(BANK_RATE, 0, -2, -1.8),
	COORDINATE(BANK_RATE, 0, -1, -0.45),
	COORDINATE(BANK_RATE, 0, 1, 0.2),
	COORDINATE(BANK_RATE, 0, 2, -1.6),
	COORDINATE(BANK_RATE, 0, 3, -4.1),
	COORDINATE(BANK_EXPONENTIAL, 0.12, 1, -2.2),
	COORDINATE(BANK_POWER, 0.3, 1.5, -0.5),
	COORDINATE(BANK_POWER, 0.3, 2, 0),
	COORDINATE(BANK_SATURATING, 0, 0.95, -2),
	COORDINATE(BANK_SATURATING, 0, 0.8, -2.2),
	COORDINATE(BANK_SATURATING, 0, 0.6, -2),
	COORDINATE(BANK_SATURATING, 10, 0.95, -2.5),
};

enum { SHAPES = sizeof table / sizeof *table };

static const double memories[MEMORIES] = { 0, 1, 3 }; /* exponent of (j / k) */
static const double SCORED = 16;   /* rows that count in full, see weigh() */
static const double CUT = 3;       /* standard deviations of an innovation */
static const double SURPRISE = 5;  /* the same of a row that is held back */
static const double LEAST = 1e-3;  /* prior noise, share of the way to the threshold */
static const double DIFFUSE = 1e8; /* prior variance of v over that of the noise */
static const double HALT = 5;      /* mean gaps beyond which the machine may have stood */
static const double PACE = 0.3;    /* sd of the speed of a unit over that of another */
/* A rate that would take so many ages is none, and growth of nothing is nothing. */
static const double NOTHING = 3e3;
/* Hazard of a change of regime on the path of another unit, and of all n of them. */
static const double KIN_HAZARD = 0.3;

/* Regime changes: of the past by particles, of the future in draws.  Growth is lognormal,
 * in units of one over the age. */
struct regimes {
	double hazard;       /* c */
	double growth, sd;   /* median, and sd of its logarithm */
	double other, scale; /* share of jumps of the rate; sd of them (past), mean of the
			      * log (future: falls) */
	double slower;       /* the same share where the rate has been falling */
};

static const struct regimes past = { 0.12, 16, 0.25, 0.04, 1.5, 0 },
			    future = { 1.25, 3.3, 3.3, 0.05, 1.2, 0.5 };

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

struct bank_chances {
	int n;
	struct chance {
		double u[CHANCES];   /* uniform */
		double z[CHANCES];   /* the normal deviates of them */
		double turn, growth; /* of the next regime by them, in ages */
	} draw[];
};

/* --- random numbers ---------------------------------------------------------------- */

/* Evenly spread in all dimensions: an additive recurrence with the powers of the root of
 * x^(d + 1) = x + 1, moved by the seed.  Any stretch of it is spread evenly too, so that
 * the draws of one model are. */
struct bank_chances *bank_chances_new(int draws, uint64_t seed)
{
	struct bank_chances *c = malloc(sizeof *c + (size_t)draws * sizeof c->draw[0]);
	double root = 1, step = 1;

	if (!c)
		return NULL;
	c->n = draws;
	for (int k = 0; k < 60; k++)
		root = pow(1 + root, 1.0 / (CHANCES + 1));
	for (int k = 0; k < CHANCES; k++) {
		double start = philox_uniform(seed, 0, RNG_PREDICT, (uint64_t)k);

		step /= root;
		for (int i = 0; i < draws; i++) {
			double u = start + (i + 1) * step;

			u = fmin(1 - 1e-12, fmax(1e-12, u - floor(u)));
			c->draw[i].u[k] = u;
			c->draw[i].z[k] = normal_quantile(u);
		}
	}
	for (int i = 0; i < draws; i++) {
		struct chance *d = &c->draw[i];

		d->turn = pow(d->u[5], -1 / future.hazard) - 1;
		d->growth = future.growth * exp(future.sd * d->z[7]);
	}
	return c;
}

void bank_chances_free(struct bank_chances *c)
{
	free(c);
}

int bank_chances_count(const struct bank_chances *c)
{
	return c->n;
}

/* --- coordinates ------------------------------------------------------------------- */

static const struct bank_shape *shape_of(const struct bank *b, int i)
{
	return i < SHAPES ? &table[i] : &b->par.more[i - SHAPES];
}

/* An observation in a coordinate: h, the log of dh/dD, and its square. */
struct place {
	double h, log_slope, slope2;
};

/* Along a path, and straight on beyond its ends. */
static void place_on_path(
	const struct bank *b, const struct bank_shape *s, double damage, struct place *p)
{
	double y = b->par.direction * (b->base + b->range * damage), slope;
	int low = 0, high = s->n - 1;

	while (high - low > 1) {
		int middle = (low + high) / 2;

		if (s->level[middle] < y)
			low = middle;
		else
			high = middle;
	}
	slope = (s->age[high] - s->age[low]) / (s->level[high] - s->level[low]);
	p->h = (s->age[low] + slope * (y - s->level[low])) / b->unit;
	p->log_slope = log(slope * fabs(b->range) / b->unit);
}

/* Below 0 and above 1 a shape goes on straight: none is known there, and an outlier must
 * not look exact where a shape has levelled. */
static struct place place_of(const struct bank *b, int shape, double damage)
{
	const struct bank_shape *s = shape_of(b, shape);
	double inside = fmax(0, fmin(1, damage));
	struct place p;

	if (s->n > 0) {
		place_on_path(b, s, damage, &p);
	} else if (s->family == BANK_SATURATING) {
		double up = log1p(inside * s->scale), down = log1p(-inside * s->par);

		p.log_slope = -up - down;
		p.h = (up - down) / (s->scale + s->par);
	} else if (s->scale > 0) {
		double u = log1p(inside / s->scale), k = 1 - s->par;

		p.log_slope = -s->par * u;
		p.h = k == 0 ? s->scale * u : s->scale * expm1(k * u) / k;
	} else {
		p.log_slope = -s->par * inside;
		p.h = s->par == 0 ? inside : -expm1(-s->par * inside) / s->par;
	}
	if (s->n == 0)
		p.h += (damage - inside) * exp(p.log_slope);
	p.slope2 = exp(2 * p.log_slope);
	return p;
}

static double damage_of(const struct bank *b, double y)
{
	return (y - b->base) / b->range;
}

/* --- lines ------------------------------------------------------------------------- */

struct bank *bank_new(const struct bank_par *par)
{
	int shapes = SHAPES + par->n_more, capacity = shapes * KINDS + PARTICLES;
	struct bank *b = calloc(1, sizeof *b + (size_t)capacity * sizeof b->line[0]);

	if (!b)
		return NULL;
	b->par = *par;
	if (!b->par.families)
		b->par.families = BANK_ALL;
	b->shapes = shapes;
	b->capacity = capacity;
	return b;
}

void bank_free(struct bank *b)
{
	free(b);
}

void bank_clear(struct bank *b)
{
	b->rows = 0;
	b->n_held = 0;
}

int bank_ready(const struct bank *b)
{
	return b->rows >= BANK_START;
}

struct bank_counts bank_counts(const struct bank *b)
{
	return b->counts;
}

static double freedom_of(const struct bank *b, const struct line *l)
{
	return b->freedom[l->kind % MEMORIES];
}

/* What the rate has grown by from the onset to an age. */
static double grown(const struct line *l, double age)
{
	return l->growth > 0 ? exp(fmin(100, l->growth * (age - l->onset))) : 1;
}

/* Moves a line on by a step, and its covariance with the discount. */
static void project(const struct bank *b, struct line *l, const struct place *p,
	double step, double keep)
{
	double along = step;

	if (l->growth > 0)
		along = grown(l, b->age) * expm1(fmin(l->growth * step, 100)) / l->growth;
	l->h += along * l->v;
	l->phh += along * (2 * l->phv + along * l->pvv);
	l->phv += along * l->pvv;
	l->phh /= keep;
	l->phv /= keep;
	l->pvv /= keep;
	if (l->kind >= MEMORIES)
		l->phh += step / b->gap * p->slope2;
}

static double log_density(const struct bank *b, const struct line *l,
	const struct place *p, double f, double z)
{
	double freedom = freedom_of(b, l), variance = l->sum / freedom;

	return b->log_constant[l->kind % MEMORIES] + p->log_slope -
	       0.5 * log(variance * f) -
	       0.5 * (freedom + 1) * log1p(z * z / (freedom * variance));
}

/* One line takes a row. */
static void follow(
	const struct bank *b, struct line *l, const struct place *p, double step)
{
	double keep = b->keep[l->kind % MEMORIES], f, e, z, limit;

	project(b, l, p, step, keep);
	f = l->phh + p->slope2;
	e = p->h - l->h;
	z = e / sqrt(f);
	limit = CUT * sqrt(l->sum / freedom_of(b, l));
	if (b->rows >= SETTLED && fabs(z) > limit) {
		z = copysign(limit, z);
		e = z * sqrt(f);
	}
	if (b->rows >= BANK_START - 1)
		l->score += log_density(b, l, p, f, z);
	l->h += l->phh / f * e;
	l->v += l->phv / f * e;
	l->pvv -= l->phv / f * l->phv;
	l->phv *= p->slope2 / f;
	l->phh *= p->slope2 / f;
	if (b->rows < 2) /* two rows make the line and leave no innovation */
		return;
	l->sum = l->sum * keep + z * z + 1e-9 * LEAST * LEAST;
	l->lagged = (float)(l->lagged * keep + z * l->before);
	l->before = (float)z;
}

/* A path counts for less where the unit's speed on it is not near 1. */
static double log_kinship(const struct bank *b, const struct line *l)
{
	double away = l->v - 1;

	if (shape_of(b, l->shape)->n == 0)
		return 0;
	return -0.5 * away * away / (PACE * PACE + l->pvv * l->sum / freedom_of(b, l));
}

/* Brings the weights up to date: n rows count as sqrt(SCORED n), for they are not
 * independent given a wrong model.  A line that has overflowed has none. */
static void weigh(struct bank *b)
{
	double share = fmin(1, sqrt(SCORED / fmax(b->scored, 1))), top = -INFINITY,
	       sum = 0;

	for (int i = 0; i < b->lines; i++) {
		struct line *l = &b->line[i];

		l->weight = shape_of(b, l->shape)->log_prior + l->offset +
			    share * l->score + log_kinship(b, l);
		if (isfinite(l->weight))
			top = fmax(top, l->weight);
	}
	for (int i = 0; i < b->lines; i++) {
		struct line *l = &b->line[i];

		l->weight = isfinite(l->weight) ? exp(l->weight - top) : 0;
		sum += l->weight;
	}
	for (int i = 0; i < b->lines && sum > 0; i++)
		b->line[i].weight /= sum;
}

/* --- regime changes ---------------------------------------------------------------- */

static double chance_of_birth(const struct bank *b, int k)
{
	return philox_uniform(0, (uint32_t)b->rows, RNG_PREDICT, (uint64_t)k);
}

/* The particle of a parent whose regime changes now. */
static struct line child_of(const struct bank *b, const struct line *parent, int birth)
{
	struct line child = *parent;
	double s = grown(parent, b->age);

	child.v *= s;
	child.phv *= s;
	child.pvv *= s * s;
	child.onset = b->age;
	if (chance_of_birth(b, 3 * birth + 1) > past.other) {
		child.growth = (float)(past.growth / b->age *
				       exp(past.sd * normal_quantile(chance_of_birth(
							     b, 3 * birth + 2))));
		return child;
	}
	child.growth = 0;
	child.pvv = 4 * child.pvv + past.scale * past.scale * child.v * child.v *
					    freedom_of(b, &child) / child.sum;
	child.phv *= 2;
	child.v *= 2;
	return child;
}

/* The lightest particle, or a free place. */
static struct line *room(struct bank *b)
{
	struct line *lightest;

	if (b->lines < b->capacity && b->lines < b->fixed + PARTICLES)
		return &b->line[b->lines++];
	lightest = &b->line[b->fixed];
	for (int i = b->fixed + 1; i < b->lines; i++)
		if (b->line[i].weight < lightest->weight)
			lightest = &b->line[i];
	return lightest;
}

/* Births, whenever the age has grown by 2 %: regimes that began then. */
static void breed(struct bank *b)
{
	double mass, reached = 0;
	struct line child[BIRTHS];
	int born = 0;

	if (b->par.steady || b->rows < BREEDING || b->age < 1.02 * b->bred)
		return;
	mass = 1 - pow(b->bred > 0 ? b->bred / b->age : 1 / 1.02, past.hazard);
	b->bred = b->age;
	for (int i = 0; i < b->lines && born < BIRTHS; i++) {
		const struct line *l = &b->line[i];

		reached += l->weight;
		while (born < BIRTHS &&
			(born + chance_of_birth(b, 3 * born)) / BIRTHS < reached) {
			child[born] = child_of(b, l, born);
			child[born].weight = mass / BIRTHS;
			/* so that its log weight is what the lines sum to, times the mass
			 */
			child[born].offset =
				(float)(l->offset + log(mass / BIRTHS / l->weight));
			born++;
		}
	}
	for (int i = 0; i < born; i++)
		*room(b) = child[i];
	b->counts.births += (unsigned long)born;
	weigh(b);
}

/* --- rows -------------------------------------------------------------------------- */

static void take(struct bank *b, double t, double y)
{
	double k = (double)b->rows, fade = k / (k + 1), step = (t - b->last) / b->unit,
	       damage = damage_of(b, y);
	struct place place;
	int shape = -1;

	for (int j = 0; j < MEMORIES; j++) {
		b->keep[j] = b->rows >= BANK_START - 1 ? k / (k + memories[j]) : 1;
		b->log_constant[j] = student_log_constant(b->freedom[j]);
	}
	for (int i = 0; i < b->lines; i++) {
		struct line *l = &b->line[i];

		if (l->shape != shape)
			place = place_of(b, shape = l->shape, damage);
		l->score *= fade;
		follow(b, l, &place, step);
	}
	for (int j = 0; j < MEMORIES && b->rows > 1; j++)
		b->freedom[j] = b->keep[j] * b->freedom[j] + 1;
	if (b->rows >= BANK_START - 1)
		b->scored = b->scored * fade + 1;
	b->age += step;
	b->gap = b->age / k;
	b->last = t;
	b->level = damage;
	b->rows++;
	weigh(b);
	breed(b);
}

/* The first three observations start all lines. */
static void start(struct bank *b)
{
	const struct row *r = b->held;

	b->base = median_of_three(r[0].y, r[1].y, r[2].y);
	b->range = b->par.threshold - b->base;
	b->unit = r[1].t - r[0].t;
	b->first = b->last = r[0].t;
	b->level = damage_of(b, r[0].y);
	b->idle = b->age = b->bred = b->scored = 0;
	b->gap = 1;
	b->lines = 0;
	for (int i = 0; i < b->shapes; i++)
		for (int k = 0; k < KINDS && b->par.families & shape_of(b, i)->family;
			k++)
			b->line[b->lines++] =
				(struct line){ .h = place_of(b, i, b->level).h,
					.phh = place_of(b, i, b->level).slope2,
					.pvv = DIFFUSE,
					.sum = LEAST * LEAST,
					.shape = (unsigned char)i,
					.kind = (unsigned char)k };
	b->fixed = b->lines;
	for (int k = 0; k < MEMORIES; k++)
		b->freedom[k] = 1;
	b->rows = 1;
	for (int k = 1; k < FIRST; k++)
		take(b, r[k].t, r[k].y);
	b->n_held = 0;
}

/* Calls for each line that has a weight: an observation of a damage, step after the last
 * row, as the line expects it, with its standardised innovation and variance. */
static double expect(const struct bank *b, double damage, double step,
	double (*of)(const struct bank *, const struct line *, const struct place *,
		double f, double z))
{
	double sum = 0;
	struct place place;
	int shape = -1;

	for (int i = 0; i < b->lines; i++) {
		struct line l = b->line[i];
		double f;

		if (l.weight < 1e-6)
			continue;
		if (l.shape != shape)
			place = place_of(b, shape = l.shape, damage);
		project(b, &l, &place, step, 1);
		f = l.phh + place.slope2;
		sum += l.weight * of(b, &l, &place, f, (place.h - l.h) / sqrt(f));
	}
	return sum;
}

static double density(const struct bank *b, const struct line *l, const struct place *p,
	double f, double z)
{
	return exp(log_density(b, l, p, f, z));
}

static double is_surprised(const struct bank *b, const struct line *l,
	const struct place *p, double f, double z)
{
	(void)p;
	(void)f;
	return z * z > SURPRISE * SURPRISE * l->sum / freedom_of(b, l);
}

/* Standard deviation of an observation's damage. */
static double noise_of(const struct bank *b)
{
	double sum = 0;

	for (int i = 0; i < b->lines; i++)
		sum += b->line[i].weight * b->line[i].sum / freedom_of(b, &b->line[i]);
	return sqrt(sum);
}

/* The level has moved by so much: it is learned anew, the rates are kept. */
static void shift(struct bank *b, double y)
{
	double damage = damage_of(b, y), away = damage - b->level;

	for (int i = 0; i < b->lines; i++) {
		struct line *l = &b->line[i];

		l->phh += away * away * place_of(b, l->shape, damage).slope2 *
			  freedom_of(b, l) / l->sum;
	}
	b->counts.shifts++;
}

/* 1 when the rows held back run away in steps, the last two each well beyond the noise.
 */
static int runs_away(const struct bank *b)
{
	const struct row *r = b->held + b->n_held - 1;
	double step = 2 * noise_of(b);

	return b->n_held >= 3 && (r[0].y - r[-1].y) / b->range > step &&
	       (r[-1].y - r[-2].y) / b->range > step;
}

/* 1 when the last rows all are healthier than the one before them. */
static int is_repaired(const struct bank *b)
{
	for (int k = 1; k <= HELD_GOOD; k++)
		if (k > b->n_held || !(damage_of(b, b->held[b->n_held - k].y) < b->level))
			return 0;
	return 1;
}

static void release(struct bank *b)
{
	int n = b->n_held;

	b->n_held = 0;
	for (int i = 0; i < n; i++)
		take(b, b->held[i].t, b->held[i].y);
}

/* Time that counts: after a long gap the machine may have stood. */
static double running(struct bank *b, double t, double damage)
{
	double step = (t - b->last) / b->unit;

	if (b->n_held > 0 || step <= HALT * b->gap ||
		expect(b, damage, b->gap, density) <= expect(b, damage, step, density))
		return t;
	b->idle += (step - b->gap) * b->unit;
	b->counts.halts++;
	return b->last + b->gap * b->unit;
}

void bank_add(struct bank *b, double t, double y)
{
	if (isnan(y))
		return;
	if (b->rows == 0) {
		if (!(b->par.direction * (b->par.threshold - y) > 0))
			return;
		b->held[b->n_held++] = (struct row){ t, y };
		if (b->n_held == FIRST)
			start(b);
		return;
	}
	t -= b->idle;
	if (b->rows < SETTLED) {
		take(b, t, y);
		return;
	}
	t = running(b, t, damage_of(b, y));
	if (expect(b, damage_of(b, y), (t - b->last) / b->unit, is_surprised) < 0.9) {
		b->counts.outliers += (unsigned long)b->n_held;
		b->n_held = 0;
		take(b, t, y);
		return;
	}
	b->held[b->n_held++] = (struct row){ t, y };
	if (runs_away(b)) {
		release(b);
	} else if (b->n_held == HELD || is_repaired(b)) {
		shift(b, b->held[0].y);
		release(b);
	}
}

void bank_event(struct bank *b, enum bank_event event)
{
	if (b->rows == 0)
		return;
	for (int i = 0; i < b->lines; i++) {
		struct line *l = &b->line[i];
		double scale = freedom_of(b, l) / l->sum;

		if (event == BANK_REPAIR)
			l->phh += place_of(b, l->shape, b->level).slope2 * scale;
		else
			l->pvv += l->v * l->v * scale;
	}
}

/* --- draws ------------------------------------------------------------------------- */

/* What the draws of one line share. */
struct crossing {
	double h, v, phh, phv, pvv; /* now; covariances in units of the noise */
	double limit;               /* h of the level to be passed */
	double variance, freedom;   /* of the noise, with autocorrelation; of chi^2 */
	double wiener;              /* variance of h per unit of time */
	double growth, hazard, falls;
};

/* What is known of the rate beforehand, as an observation of v. */
static void heed_prior(double mean, double sd, struct crossing *p)
{
	double f, e = mean - p->v;

	if (!(sd > 0))
		return;
	f = p->pvv + sd * sd / p->variance;
	p->h += p->phv / f * e;
	p->v += p->pvv / f * e;
	p->phh -= p->phv / f * p->phv;
	p->phv -= p->pvv / f * p->phv;
	p->pvv -= p->pvv / f * p->pvv;
}

/* 1 where the rate falls as damage grows. */
static int slows(const struct bank_shape *s)
{
	return s->n == 0 && (s->family == BANK_SATURATING || s->par < 0);
}

static struct crossing prepare(
	const struct bank *b, const struct line *l, double ahead, double target)
{
	struct place here = place_of(b, l->shape, b->level),
		     there = place_of(b, l->shape, target);
	double correlation = fmin(0.95, fmax(0, l->lagged / l->sum)), s, scale;
	struct line now = *l;
	struct crossing p = { .limit = there.h,
		.growth = l->growth,
		.hazard = shape_of(b, l->shape)->n > 0 ? KIN_HAZARD / b->par.n_more
						       : future.hazard,
		.falls = slows(shape_of(b, l->shape)) ? future.slower : future.other };

	now.kind = 0;
	project(b, &now, &here, ahead, 1);
	s = grown(l, b->age + ahead);
	p.h = now.h;
	p.v = s * now.v;
	p.phh = now.phh;
	p.phv = s * now.phv;
	p.pvv = s * s * now.pvv;
	p.freedom = freedom_of(b, l);
	p.variance = l->sum / p.freedom;
	/* The noise is constant in D; take it half way to the level. */
	if (l->kind >= MEMORIES)
		p.wiener = p.variance * exp(here.log_slope + there.log_slope) / b->gap;
	p.variance *= (1 + correlation) / (1 - correlation);
	scale = b->unit / b->range * exp(here.log_slope);
	heed_prior(b->par.rate_mean * scale, b->par.rate_sd * fabs(scale), &p);
	if (shape_of(b, l->shape)->n > 0)
		heed_prior(1, PACE, &p);
	return p;
}

/* Normal deviate given that it is above -m, as by drawing until one is; NAN where none of
 * 32 would be. */
static double normal_above(double m, const struct chance *c)
{
	double u = c->u[1], above, none;

	if (m > 8) /* always */
		return -c->z[1];
	above = 0.5 * erfc(-m / sqrt(2));
	none = pow(1 - above, 32);

	if (u < none)
		return NAN;
	u = fmax(1e-12, (u - none) / (1 - none));
	return -normal_quantile(u * above);
}

/* Time to the passage if the regime changes once. */
static double change(
	double time, double age, double hazard, double falls, const struct chance *c)
{
	double turn = hazard == future.hazard ? c->turn : pow(c->u[5], -1 / hazard) - 1;
	double j = age * turn, rest = time - j, g;

	if (!(rest > 0))
		return time;
	if (c->u[6] < falls)
		return j + rest * exp(-future.scale * log(c->u[7]));
	g = c->growth / age;
	return j + log1p(g * rest) / g;
}

static double draw_life(const struct bank *b, const struct crossing *p, double age,
	const struct chance *c)
{
	double sd = sqrt(p->variance * p->freedom / chi_square(p->freedom, c->z[0]));
	double z = normal_above(p->v / (sd * sqrt(p->pvv)), c), v, h, time;

	v = p->v + sd * sqrt(p->pvv) * z;
	if (!(v > 0)) /* damage does not heal */
		return INFINITY;
	h = p->h + sd * p->phv / sqrt(p->pvv) * z +
	    sd * sqrt(fmax(0, p->phh - p->phv * p->phv / p->pvv)) * c->z[2];
	time = (p->limit - h) / v;
	if (time <= 0)
		return 0;
	if (p->wiener > 0 && isfinite(time))
		time = inverse_gaussian(
			time, p->wiener * time / (v * v), c->z[3], c->u[4]);
	if (!isfinite(time) || b->par.steady)
		return time;
	if (time > NOTHING * age)
		return INFINITY;
	if (p->growth > 0)
		return log1p(p->growth * time) / p->growth;
	return change(time, age, p->hazard, p->falls, c);
}

void bank_draw(struct bank *b, const struct bank_chances *c, double now, double level,
	double *life)
{
	double ahead = (now - b->idle - b->last) / b->unit, reached = 0;
	double target = damage_of(b, level);
	int drawn = 0;

	for (int i = 0; i < b->lines; i++) {
		struct crossing p;

		reached += b->line[i].weight;
		if (!(reached * c->n > drawn + 0.5))
			continue;
		p = prepare(b, &b->line[i], ahead, target);
		for (; drawn < c->n && reached * c->n > drawn + 0.5; drawn++)
			life[drawn] = b->unit *
				      draw_life(b, &p, b->age + ahead, &c->draw[drawn]);
	}
	/* No line has a weight where the data overflow. */
	for (; drawn < c->n; drawn++)
		life[drawn] = drawn ? life[drawn - 1] : INFINITY;
}

void bank_state(const struct bank *b, double *y, double *rate)
{
	*y = *rate = 0;
	for (int i = 0; i < b->lines; i++) {
		const struct line *l = &b->line[i];
		struct place p = place_of(b, l->shape, b->level);
		double slope = exp(p.log_slope);

		*y += l->weight *
		      (b->base + b->range * (b->level + (l->h - p.h) / slope));
		*rate += l->weight * b->range * grown(l, b->age) * l->v / slope / b->unit;
	}
}

double bank_chance_normal(const struct bank_chances *c, int draw, int k)
{
	return c->draw[draw].z[k];
}

double bank_weight(const struct bank *b, enum bank_family family)
{
	double sum = 0;

	for (int i = 0; i < b->lines; i++)
		if (family == BANK_ALL
				? i >= b->fixed
				: i < b->fixed &&
					  shape_of(b, b->line[i].shape)->family == family)
			sum += b->line[i].weight;
	return sum;
}

/* All but the parameters, which are at the front. */
void bank_pass(struct bank *b, struct state *s)
{
	size_t from = offsetof(struct bank, rows);

	state_move(s, (unsigned char *)b + from,
		sizeof *b + (size_t)b->capacity * sizeof b->line[0] - from);
}
