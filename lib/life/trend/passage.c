/* passage.c - see passage.h */
#include "life/trend/passage.h"
#include "life/trend/bank_state.h"
#include "life/trend/unrest.h"
#include "num/deviates.h"
#include "num/philox.h"
#include "num/running.h"
#include <math.h>
#include <stdlib.h>

enum { CHANCES = 8 }; /* uniform numbers of one draw */

/* A rate at which the damage would take more than so many ages counts as 0, and the
 * growth of a rate of 0 too. */
static const double NOTHING = 3e3;

/* The chance of a rate above 0 below which the damage does not grow: see "Single
 * constants" in doc/trends.md. */
static const double UNLIKELY = 1e-3;

/* Future changes of regime, where the rate falls, is constant or rises in a coordinate,
 * and on the paths of other units, for all of them together: hazard c, share of falls,
 * and median growth in units of the reciprocal of how long a regime lasts.  One that
 * grows may still fall.  These and the three constants below were chosen with the weights
 * of the coordinates, and swept again: see doc/trends.md. */
static const struct future {
	double hazard, falls, growth;
} future[] = { { 2.5, 0.24, 3.5 }, { 0.65, 0.27, 16 }, { 0.5, 0.033, 1.3 },
	{ 0.5, 0.18, 3 } };

/* Share of falls where the damage is a Wiener process, relative to other wear: its rate
 * seems to fall for a while without any change of regime. */
static const double WANDERING = 0.4;
static const double GROWTH_SD = 1.4; /* of its logarithm */
/* Mean and sd of the logarithm of the factor by which a fall of the rate lengthens the
 * rest of the life. */
static const double FALL = 1.4, FALL_SD = 0.45;

/* The wear may follow another curve near the coordinate: beyond the damage that has been
 * reached, and since the rows from which the rate is known.  Where the rate of the damage
 * changes by e as an average over this way, the logarithm of the time has the sd STRAY,
 * and its median is LEAN less: see "Stray and lean" in doc/trends.md. */
static const double STRAY = 0.18, LEAN = 0.05;

struct bank_chances {
	int n;
	struct chance {
		double u[CHANCES]; /* uniform */
		double z[CHANCES]; /* the same as normal deviates */
		/* Of the next change: time, exponential in log age, growth and fall. */
		double late, growth, fall;
		/* Of Laplace's distribution, variance 1, from u[3]: a Wiener process
		 * takes the square of z[3]. */
		double stray;
	} draw[];
};

/* Points that fill the unit cube evenly: an additive recurrence with the powers of the
 * root of x^(d + 1) = x + 1, shifted by the seed.  Every section of the sequence is even,
 * too, and so are the draws of each trend. */
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

		d->late = -log(d->u[5]);
		d->growth = exp(GROWTH_SD * d->z[7]);
		d->fall = exp(FALL + FALL_SD * d->z[7]);
		d->stray =
			copysign(log1p(-fabs(2 * d->u[3] - 1)) / sqrt(2), 0.5 - d->u[3]);
	}
	return c;
}

void bank_chances_free(struct bank_chances *c)
{
	free(c);
}

double bank_chance_normal(const struct bank_chances *c, int draw, int k)
{
	return c->draw[draw].z[k];
}

/* Values common to all draws of one trend. */
struct crossing {
	double line[LINE]; /* now */
	double limit;      /* h of the level to be reached */
	double common;     /* sd of h by rounding or noise that many rows share */
	double straight;   /* the distance if the rate of the damage stayed constant */
	double variance, freedom; /* of the noise, with its correlation; of chi^2 */
	double wiener;            /* variance of h per unit of time */
	double growth;            /* of the rate at present */
	double lasts;             /* a regime of the unit, on average so far */
	double regime;            /* age of the present one, but no more than that */
	double stray, lean;       /* see STRAY and face_future() */
	double repairs;           /* to come, per unit of time */
	double gain;              /* of time by each, as a share */
	const struct future *future;
	double hazard;
};

/* Includes the prior of the rate, as an observation of v. */
static void heed_prior(double mean, double sd, struct crossing *p)
{
	double noise = sd * sd / p->variance;

	if (sd > 0)
		observe_state(2, p->line, 1, p->line[LINE_VV] + noise,
			mean - p->line[LINE_V], noise);
}

/* A power below 0, wear that goes as the root of time, counts as constant: it slows down
 * by a law of its own and not because a regime ends, as of S-shaped curves. */
static const struct future *future_of(const struct bank_shape *s)
{
	if (s->family == BANK_SATURATING)
		return &future[0];
	return &future[s->n > 0 ? 3 : s->par <= 0 ? 1 : 2];
}

/* Common to all trends of a bank on their way to a level. */
struct prospect {
	double ahead, target; /* time since the last row; damage at the level */
	double spread;        /* see spread_of() */
	double noise;         /* variance of a reading, mean of the trends */
	struct unrest unrest;
};

/* Variance of the logarithm of the time to the passage between the trends, without those
 * whose regime has changed: such a change is no curve near the coordinate. */
static double spread_of(const struct bank *b, double target)
{
	struct running logs = { 0 };
	double limit = 0, line[LINE];
	int shape = -1;

	for (int i = 0; i < b->fixed; i++) {
		const struct trend *tr = &b->trend[i];
		double time;

		if (tr->shape != shape)
			limit = place_of(b, shape = tr->shape, target).h;
		line_at(b, tr, b->at, line);
		time = (limit - line[LINE_H]) / line[LINE_V];
		if (time > 0 && isfinite(time))
			running_repeat(&logs, log(time), tr->weight);
	}
	return logs.n > 0 ? logs.square / logs.n : 0;
}

/* The time it takes if the rate grows, which would be this with the present one. */
static double hasten(double time, double growth)
{
	return growth > 0 ? log1p(growth * time) / growth : time;
}

/* Change of the logarithm of the rate from the middle of the rows from which a trend
 * knows its rate v to now, by the bend of the coordinate here. */
static double past_bend(
	const struct bank *b, const struct trend *tr, const struct place *here, double v)
{
	double ago = (b->age - tr->onset) / (2 + kinds[tr->kind].memory),
	       change = -here->bend / here->slope * v * ago;

	return copysign(log1p(fabs(change)), change);
}

/* The variance of the noise, with its correlation. */
static double noise_of(const struct bank *b, const struct trend *tr)
{
	return (tr->sum + 2 * fmax(0, tr->lagged)) / freedom_of(b, tr);
}

/* A level at a damage, when this time has passed since the last row. */
static struct prospect foresee(const struct bank *b, double ahead, double level)
{
	struct prospect o = { .ahead = ahead,
		.target = damage_of(b, level),
		.unrest = unrest_of(&b->course, b->range) };

	o.spread = spread_of(b, o.target);
	for (int i = 0; i < b->trends; i++)
		if (b->trend[i].weight > 0)
			o.noise += b->trend[i].weight * noise_of(b, &b->trend[i]);
	return o;
}

/* How the time to a level strays because the curve of the damage is not known, of which a
 * growth is a part; h: of the present damage; past: see past_bend().  A straight line
 * does not stray, and what the trends leave uncertain is a part of it. */
static void let_stray(struct crossing *p, double h, double past, double spread)
{
	double v = p->line[LINE_V], time = (p->limit - h) / v,
	       bend = log(p->straight / v / hasten(time, p->growth)) + past;

	if (!isfinite(bend))
		return;
	p->stray = hypot(p->stray, sqrt(fmax(0, STRAY * STRAY * fabs(bend) - spread)));
	p->lean = LEAN * bend;
}

/* Student's t of 2.5 degrees of freedom over Laplace's distribution of variance 1: their
 * quartiles, deciles and 95 % points have the ratios 1.6, 1.5 and 1.6. */
static const double STUDENT = 1.57;

/* The line of a trend at the loads to come.  What is not known of them strays the time;
 * as the square of a bridge has the variance 1/45 where its mean is 1/6, their variance
 * has 2 / 36 * 45 = 2.5 degrees of freedom. */
static void face_future(const struct bank *b, const struct trend *tr, struct crossing *p)
{
	double load[RATES], variance[RATES], sum = 0, ahead;

	mean_loads(b, load);
	line_at(b, tr, load, p->line);
	ahead = (p->limit - p->line[LINE_H]) / p->line[LINE_V] * b->unit;
	future_loads(b, ahead > 0 ? ahead : INFINITY, load, variance);
	line_at(b, tr, load, p->line);
	for (int k = 0; k < b->par.n_loads; k++) {
		double w = state_of(b, tr)[2 + k] / p->line[LINE_V];

		sum += w * w * variance[1 + k];
	}
	p->stray = STUDENT * sqrt(sum);
}

/* The rate will swing as it did; what the trends leave uncertain is a part of it. */
static void let_swing(const struct bank *b, struct crossing *p, const struct prospect *o)
{
	double time = hasten((p->limit - p->line[LINE_H]) / p->line[LINE_V], p->growth);

	if (time > 0 && isfinite(time))
		p->stray = hypot(p->stray,
			sqrt(fmax(0, unrest_swing(&o->unrest, time * b->unit, o->noise) -
					     o->spread)));
}

static struct crossing prepare(
	const struct bank *b, const struct trend *tr, const struct prospect *o)
{
	struct place here = place_of(b, tr->shape, b->level),
		     there = place_of(b, tr->shape, o->target);
	double scale;
	struct crossing p = { .limit = there.h,
		.straight = (o->target - b->level) * here.slope,
		.growth = tr->growth,
		.future = future_of(shape_of(b, tr->shape)) };

	p.lasts = (b->age + o->ahead) / (1 + tr->changes);
	p.regime = fmax(0, fmin(p.lasts, b->age + o->ahead - tr->onset));
	p.repairs = (b->repairs - 1) / (b->age + o->ahead);
	p.gain = b->healed / b->repairs / (o->target - b->level);
	p.hazard = p.future->hazard / (shape_of(b, tr->shape)->n > 0 ? kin_of(b) : 1);
	face_future(b, tr, &p);
	advance_state(2, p.line, b->at, advance_of(b, tr, o->ahead), 1);
	scale_rates(2, p.line, grown(tr, b->age + o->ahead));
	p.freedom = freedom_of(b, tr);
	p.variance = noise_of(b, tr);
	p.common = rounding_of(b) / sqrt(12);
	if (!b->par.steady)
		p.common = hypot(p.common, sqrt(unrest_common(&o->unrest, p.variance)));
	p.common *= there.slope;
	/* The noise is constant in D: its slope is taken half way to the level. */
	p.wiener =
		kinds[tr->kind].wander * p.variance * here.slope * there.slope / b->gap;
	scale = b->unit / b->range * here.slope;
	heed_prior(b->par.rate_mean * scale, b->par.rate_sd * fabs(scale), &p);
	if (shape_of(b, tr->shape)->n > 0)
		heed_prior(1, PACE, &p);
	else if (!b->par.steady) { /* the path of another unit is known to its end */
		let_stray(&p, here.h, past_bend(b, tr, &here, p.line[LINE_V]), o->spread);
		let_swing(b, &p, o);
	}
	return p;
}

/* Normal deviate under the condition that it is above -m; NAN if that is very unlikely.
 */
static double normal_above(double m, const struct chance *c)
{
	double above = 0.5 * erfc(-m / sqrt(2));

	if (m > 8) /* it always is */
		return -c->z[1];
	return above < UNLIKELY ? NAN : -normal_quantile(c->u[1] * above);
}

static int recedes(const struct bank *b)
{
	double sum = 0, line[LINE];

	for (int i = 0; i < b->trends; i++) {
		const struct trend *tr = &b->trend[i];
		double sd;

		line_at(b, tr, b->at, line);
		sd = sqrt(line[LINE_VV] * tr->sum / freedom_of(b, tr));
		if (0.5 * erfc(-line[LINE_V] / (sd * sqrt(2))) < UNLIKELY)
			sum += tr->weight;
	}
	return sum > 0.95;
}

/* Whether a bank has a property, after the rows held back if they are probably a new
 * regime. */
static int holds(const struct bank *b, int (*property)(const struct bank *))
{
	struct bank *other = chance_of_jump(b) > 0.5 ? bank_accepting(b) : NULL;
	int answer = property(other ? other : b);

	bank_free(other);
	return answer;
}

int bank_recedes(const struct bank *b)
{
	return holds(b, recedes);
}

static int has_ceased(const struct bank *b)
{
	return plateau_reached(
		&b->course, b->par.threshold, b->repairs > 0 ? b->renewed : -INFINITY, 1);
}

int bank_ceased(const struct bank *b)
{
	return holds(b, has_ceased);
}

double bank_beyond(const struct bank *b)
{
	struct prospect o = foresee(b, 0, b->par.threshold);
	double sum = 0;

	for (int i = 0; i < b->trends; i++) {
		struct crossing p = prepare(b, &b->trend[i], &o);
		double sd = hypot(sqrt(p.variance * p.line[LINE_HH]), p.common);

		if (b->trend[i].weight > 0)
			sum += b->trend[i].weight * 0.5 *
			       erfc((p.limit - p.line[LINE_H]) / (sd * sqrt(2)));
	}
	return sum;
}

/* Time to the passage if the regime changes once more. */
static double change(const struct crossing *p, double time, const struct chance *c)
{
	double j = p->regime * expm1(c->late / p->hazard), rest = time - j, g;

	if (!(rest > 0))
		return time;
	if (c->u[6] < p->future->falls * (p->wiener > 0 ? WANDERING : 1))
		return j + rest * c->fall;
	if (p->growth > 0)
		return time;
	g = p->future->growth * c->growth / p->lasts;
	return j + hasten(rest, g);
}

/* Time to the passage with the repairs to come.  Their number is geometric: that of a
 * Poisson process whose rate is known from one interval. */
static double with_repairs(const struct crossing *p, double time, const struct chance *c)
{
	double mean = p->repairs * time;

	if (!(mean > 0 && p->gain > 0))
		return time;
	return time * (1 + p->gain * floor(log(c->u[4]) / log(mean / (1 + mean))));
}

static double draw_life(const struct bank *b, const struct crossing *p, double age,
	const struct chance *c)
{
	const double *x = p->line;
	double sd = sqrt(p->variance * p->freedom / chi_square(p->freedom, c->z[0])),
	       root = sqrt(x[LINE_VV]), z = normal_above(x[LINE_V] / (sd * root), c),
	       v = x[LINE_V] + sd * root * z, known, h, time;

	if (!(v > 0)) /* damage does not heal */
		return INFINITY;
	known = sd * sqrt(fmax(0, x[LINE_HH] - x[LINE_HV] * x[LINE_HV] / x[LINE_VV]));
	h = x[LINE_H] + sd * x[LINE_HV] / root * z + hypot(known, p->common) * c->z[2];
	time = (p->limit - h) / v;
	if (time <= 0)
		return 0;
	if (p->wiener > 0 && isfinite(time))
		time = inverse_gaussian(
			time, p->wiener * time / (v * v), c->z[3], c->u[4]);
	if (!isfinite(time))
		return time;
	time = hasten(time, p->growth) * exp(p->stray * c->stray - p->lean);
	if (b->par.steady)
		return time;
	if (p->straight > v * NOTHING * age)
		return INFINITY;
	return with_repairs(p, change(p, time, c), c);
}

/* 1 for this share of the draws, evenly spaced. */
static int belongs(int draw, double share)
{
	return floor((draw + 1) * share) > floor(draw * share);
}

/* Fills this share of life[]. */
static void draw_share(const struct bank *b, const struct bank_chances *c, double now,
	double level, double share, double *life)
{
	double ahead = (now - b->idle - b->last) / b->unit, reached = 0;
	struct prospect o = foresee(b, ahead, level);
	double last = INFINITY; /* if the data overflow, no trend has a weight */
	int drawn = 0;

	for (int i = 0; i < b->trends; i++) {
		struct crossing p;

		reached += b->trend[i].weight;
		if (!(reached * c->n > drawn + 0.5))
			continue;
		p = prepare(b, &b->trend[i], &o);
		for (; drawn < c->n && reached * c->n > drawn + 0.5; drawn++)
			if (belongs(drawn, share))
				life[drawn] = last =
					b->unit *
					draw_life(b, &p, b->age + ahead, &c->draw[drawn]);
	}
	for (; drawn < c->n; drawn++)
		if (belongs(drawn, share))
			life[drawn] = last;
}

enum num_status bank_draw(const struct bank *b, const struct bank_chances *c, double now,
	double level, double *life)
{
	struct bank *other;

	draw_share(b, c, now, level, 1, life);
	if (b->n_held == 0)
		return NUM_OK;
	other = bank_accepting(b);
	if (!other)
		return NUM_MEMORY;
	draw_share(other, c, now, level, chance_of_jump(b), life);
	bank_free(other);
	return NUM_OK;
}
