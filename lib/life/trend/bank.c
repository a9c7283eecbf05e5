/* bank.c - see bank.h */
#include "life/trend/bank_state.h"
#include "num/philox.h"
#include "num/select.h"
#include "num/student.h"
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Constants without a reason here were swept: see "Single constants" in doc/trends.md. */
enum {
	PARTICLES = 52,
	BIRTHS = 4,   /* at a time */
	FIRST = 3,    /* observations whose median is D = 0 */
	BREEDING = 8, /* rows before particles are drawn */
	HELD_GOOD = 3 /* rows running on the good side that tell a repair */
};

static const double SCORED = 18;  /* rows that count in full, see bank.h */
static const double CUT = 3;      /* of an innovation, see student_square() */
static const double SURPRISE = 5; /* the same of a row that is held back */
/* Length of a gap, in usual gaps, beyond which the machine may have been idle. */
static const double HALT = 3.5;
/* Noise, as a share of the range to the threshold, below which no coordinate describes
 * the wear: see "Least noise" in doc/trends.md. */
static const double FINEST = 7.5e-4;
/* Turn of a tangent up to which it follows to second order: the CRPS is that of exact
 * tangents, and the time of a row less by a fifth. */
static const double NEAR = 0.125;
static const double DIFFUSE = 1e8; /* prior variance of v over that of the noise */

/* The correlation of an innovation with those before is summed over the last rows, their
 * weight falling to 1 / e over this share of all: a rate that changes in cycles or steps
 * shows in no two successive rows. */
static const double RECENT = 0.1;

/* Log weight of a Wiener process in a curved coordinate of the table, over that of one in
 * a straight line: its wander looks like a bend for a while. */
static const double BENT = -0.4;

/* Changes of regime in the past, represented by particles: hazard c, share of falls, and
 * growth in units of 1 / age; curved coordinates stand for slow growth.  See "Changes of
 * the regime so far" in doc/trends.md. */
static const struct {
	double hazard, falls, growth;
} past = { 0.36, 0.25, 16 };

/* Particles are drawn whenever the logarithm of the age has grown by this.  No two ages
 * of rows at equal gaps differ by e^0.02, so that no rounding of times decides. */
static const double AGEING = 0.02;

/* --- trends ------------------------------------------------------------------------- */

static size_t size_of_bank(const struct bank_par *par, int capacity)
{
	return sizeof(struct bank) +
	       (size_t)capacity * (sizeof(struct trend) + size_of_state(par));
}

struct bank *bank_new(const struct bank_par *par)
{
	int shapes = shapes_in_table() + par->n_more,
	    capacity = shapes * KINDS + PARTICLES;
	struct bank *b = calloc(1, size_of_bank(par, capacity));

	if (!b)
		return NULL;
	b->par = *par;
	if (!b->par.families)
		b->par.families = BANK_ALL;
	b->shapes = shapes;
	b->capacity = capacity;
	b->quantum = INFINITY;
	b->before = NAN;
	return b;
}

void bank_free(struct bank *b)
{
	free(b);
}

int bank_ready(const struct bank *b)
{
	return b && b->rows >= BANK_START;
}

struct bank_counts bank_counts(const struct bank *b)
{
	return b->counts;
}

double advance_of(const struct bank *b, const struct trend *tr, double step)
{
	if (tr->growth > 0)
		return grown(tr, b->age) * expm1(fmin(tr->growth * step, 100)) /
		       tr->growth;
	return step;
}

/* The variance that wander adds to h. */
static double wander_of(
	const struct bank *b, const struct trend *tr, const struct place *p, double step)
{
	return kinds[tr->kind].wander * step / b->gap * squared_slope(*p);
}

/* An observation in a coordinate in which a trend will be at h with this variance, in
 * units of the noise: on the tangent at the damage that the filter makes of both, in one
 * step of the iterated Kalman filter (Bell, Cathey, IEEE Trans. Autom. Control 38 (1993)
 * 294).  If the trend is well known, that is the predicted damage, so that the noise has
 * no influence on its own variance.  p is at the observation, and near it the tangent
 * follows to second order. */
static struct place seen_from(const struct bank *b, int shape, double h, double variance,
	double damage, const struct place *p)
{
	double off = (p->h - h) / p->slope, rest, expected;
	struct place q = *p;

	if (fabs(p->bend * off) < NEAR && damage > 0 && damage < 1) {
		double turn;

		rest = off * squared_slope(q) / (variance + squared_slope(q));
		turn = p->bend * rest;
		q.log_slope -= turn;
		q.slope *= turn != 0 ? exp(-turn) : 1;
		q.h -= 0.5 * q.slope * turn * rest;
		return q;
	}
	expected = damage_at(b, shape, h);
	off = damage - expected;
	q = place_of(b, shape, expected);
	rest = off * squared_slope(q) / (variance + squared_slope(q));
	q = place_of(b, shape, damage - rest);
	q.h += q.slope * rest;
	return q;
}

static double log_density(const struct bank *b, const struct trend *tr,
	const struct place *p, double f, double z)
{
	double freedom = freedom_of(b, tr), variance = tr->sum / freedom;

	return b->log_constant[tr->kind] + p->log_slope - 0.5 * log(variance * f) -
	       0.5 * (freedom + 1) * log1p(z * z / (freedom * variance));
}

/* Scores a reading that is equal to one before, rounded from anywhere in a cell with
 * these ends in h, and returns the probability that it is new and not frozen.  The share
 * of frozen readings has Jeffreys' prior; of the last value and the farthest, each is as
 * likely. */
static double news_of(const struct bank *b, struct trend *tr, const double cell[2],
	double f, double h, int equal)
{
	double sd = sqrt(2 * f * tr->sum / freedom_of(b, tr)),
	       frozen = 0.5 * equal * (b->frozen + 0.5) / ((double)b->rows + 1),
	       new = 0.5 * (1 - frozen) *
		     (erf((cell[1] - h) / sd) - erf((cell[0] - h) / sd));

	tr->score += log(new + frozen);
	return fmax(new / (new + frozen), 1e-9);
}

/* Updates one trend by a row; returns the probability that it is frozen. */
static double follow(const struct bank *b, struct trend *tr, double damage,
	const struct place *seen, const double cell[2], double step, int equal)
{
	int n = 2 + b->par.n_loads;
	double keep = b->keep[tr->kind], *x = state_of(b, tr), f, e, z, limit, news = 1;
	struct place p;

	advance_state(n, x, b->at, advance_of(b, tr, step), keep);
	for (int k = 0; k < b->par.n_loads; k++)
		priors_of(b, tr)[k] *= keep;
	p = seen_from(b, tr->shape, x[0], x[n], damage, seen);
	x[n] += wander_of(b, tr, &p, step);
	f = x[n] + squared_slope(p);
	e = p.h - x[0];
	z = e / sqrt(f);
	limit = sqrt(b->cut * tr->sum / freedom_of(b, tr));
	if (b->rows >= FIRST && fabs(z) > limit) {
		z = copysign(limit, z);
		e = z * sqrt(f);
	}
	if (b->rows >= BANK_START - 1 && equal)
		news = news_of(b, tr, cell, f, x[0], equal);
	else if (b->rows >= BANK_START - 1)
		tr->score += log_density(b, tr, &p, f, z);
	f /= news; /* as if it were so much less accurate */
	observe_state(n, x, 0, f, e, f - x[n]);
	if (b->rows < 2) /* two rows determine the trend and leave no innovation */
		return 0;
	tr->lagged = (float)(tr->lagged * (keep + (1 - news) / freedom_of(b, tr)) +
			     news * z * tr->recent);
	tr->sum = tr->sum * (keep + (1 - news) / freedom_of(b, tr)) + news * z * z +
		  FINEST * FINEST;
	tr->recent += (float)(news *
			      (z - fmin(1, 1 / (RECENT * (double)b->rows)) * tr->recent));
	return 1 - news;
}

/* The share of the way to the threshold that another unit has been through; elsewhere its
 * path is a guess. */
static double seen_of(const struct bank *b, const struct bank_shape *s)
{
	double from = damage_of(b, b->par.direction * s->path[0].level),
	       to = damage_of(b, b->par.direction * s->seen);

	return fmax(0, fmin(1, to) - fmax(0, from));
}

/* A path shares its prior with the others, has it for what has been seen of it, and has
 * less weight the farther the speed of the unit along it is from 1. */
static double log_prior(const struct bank *b, const struct trend *tr)
{
	const struct bank_shape *s = shape_of(b, tr->shape);
	double mean[RATES], usual[LINE], away;

	if (s->n == 0)
		return s->log_prior;
	mean_loads(b, mean);
	line_at(b, tr, mean, usual);
	away = usual[LINE_V] - 1;
	return s->log_prior * seen_of(b, s) - log(kin_of(b)) -
	       0.5 * away * away /
		       (PACE * PACE + usual[LINE_VV] * tr->sum / freedom_of(b, tr));
}

/* Updates the weights.  A trend that has overflowed has weight 0. */
static void weigh(struct bank *b)
{
	double share = fmin(1, sqrt(SCORED / fmax(b->scored, 1))), top = -INFINITY,
	       sum = 0;

	for (int i = 0; i < b->trends; i++) {
		struct trend *tr = &b->trend[i];
		const struct kind *kind = &kinds[tr->kind];
		const struct bank_shape *s = shape_of(b, tr->shape);

		tr->weight = log_prior(b, tr) + kind->log_prior + tr->offset +
			     share * tr->score;
		if (kind->wander > 0 && s->n == 0 && s->family != BANK_LINEAR)
			tr->weight += BENT;
		if (isfinite(tr->weight))
			top = fmax(top, tr->weight);
	}
	for (int i = 0; i < b->trends; i++) {
		struct trend *tr = &b->trend[i];

		tr->weight = isfinite(tr->weight) ? exp(tr->weight - top) : 0;
		sum += tr->weight;
	}
	for (int i = 0; i < b->trends && sum > 0; i++)
		b->trend[i].weight /= sum;
}

/* --- regime changes ----------------------------------------------------------------- */

static double chance_of_birth(const struct bank *b, int k)
{
	return philox_uniform(0, (uint32_t)b->rows, RNG_PREDICT, (uint64_t)k);
}

/* Multiplies the rates of a trend. */
static void scale_trend(const struct bank *b, struct trend *tr, double times)
{
	scale_rates(2 + b->par.n_loads, state_of(b, tr), times);
	for (int k = 0; k < b->par.n_loads; k++)
		priors_of(b, tr)[k] /= times * times;
}

static void begin_regime(const struct bank *b, struct trend *tr, float growth)
{
	tr->onset = (float)b->age;
	tr->growth = growth;
	if (tr->changes < 255)
		tr->changes++;
}

/* Makes a particle for a change of regime of its parent at the present age: its rate
 * begins to grow, or falls to any value between 0 and the one before, which has half the
 * rate for its mean and 1 / 12 of its square for its variance. */
static void beget(
	const struct bank *b, const struct trend *parent, int birth, struct trend *child)
{
	int n = 2 + b->par.n_loads;
	double s = grown(parent, b->age), *x = state_of(b, child), line[LINE], rate;
	int falls;

	line_at(b, parent, b->at, line);
	rate = s * line[LINE_V];
	/* wear that recedes does not turn towards the threshold */
	falls = rate > 0 && chance_of_birth(b, 2 * birth + 1) < past.falls;
	*child = *parent;
	memcpy(x, state_of(b, parent), size_of_state(&b->par));
	scale_trend(b, child, falls ? 0.5 * s : s);
	begin_regime(b, child, falls ? 0 : (float)(past.growth / b->age));
	if (falls)
		x[n + n + 1] += rate * rate / 12 * freedom_of(b, parent) / parent->sum;
}

/* An unused place or, if there is none, that of the particle of least weight. */
static struct trend *room(struct bank *b)
{
	struct trend *lightest;

	if (b->trends < b->fixed + PARTICLES)
		return &b->trend[b->trends++];
	lightest = &b->trend[b->fixed];
	for (int i = b->fixed + 1; i < b->trends; i++)
		if (b->trend[i].weight < lightest->weight)
			lightest = &b->trend[i];
	return lightest;
}

/* Draws new particles, for regimes that begin now. */
static void breed(struct bank *b)
{
	double older = b->bred > 0 ? log(b->age / b->bred) : AGEING, mass, reached = 0;
	int parent[BIRTHS], born = 0;

	if (b->par.steady || b->rows < BREEDING || older < AGEING)
		return;
	mass = -expm1(-past.hazard * older);
	b->bred = b->age;
	for (int i = 0; i < b->trends && born < BIRTHS; i++) {
		reached += b->trend[i].weight;
		while (born < BIRTHS &&
			(born + chance_of_birth(b, 2 * born)) / BIRTHS < reached)
			parent[born++] = i;
	}
	for (int i = 0; i < born; i++) {
		struct trend *tr = &b->trend[parent[i]], *child = room(b);

		beget(b, tr, i, child);
		child->weight = mass / BIRTHS;
		/* the sum of the trends' weights, times the mass */
		child->offset = (float)(tr->offset + log(mass / BIRTHS / tr->weight));
	}
	b->counts.births += (unsigned long)born;
	weigh(b);
}

/* --- rows --------------------------------------------------------------------------- */

/* To how many of the last value and the farthest a value is equal. */
static int equals(const struct bank *b, double y)
{
	return (y == b->before) + (y == b->farthest);
}

static void take(struct bank *b, const struct row *r)
{
	double k = (double)b->rows, fade = k / (k + 1), step = (r->t - b->last) / b->unit,
	       damage = damage_of(b, r->y);
	double frozen = 0, one;
	int equal = equals(b, r->y);
	/* Without any step so far, rounding is no coarser than the finest noise. */
	double half = isinf(b->quantum) ? sqrt(3) * FINEST
					: 0.5 * b->quantum / fabs(b->range),
	       cell[2] = { 0 };
	struct place place;
	int shape = -1;

	face_loads(b, r);
	b->cut = student_square(CUT, b->freedom[0]);
	for (int j = 0; j < KINDS; j++) {
		b->keep[j] = b->rows >= BANK_START - 1 ? k / (k + kinds[j].memory) : 1;
		b->log_constant[j] = student_log_constant(b->freedom[j]);
	}
	for (int i = 0; i < b->trends; i++) {
		struct trend *tr = &b->trend[i];

		if (tr->shape != shape) {
			place = place_of(b, shape = tr->shape, damage);
			cell[0] = place_of(b, shape, damage - half).h;
			cell[1] = place_of(b, shape, damage + half).h;
		}
		tr->score *= fade;
		one = follow(b, tr, damage, &place, cell, step, equal);
		if (tr->weight > 0 && one > 0) /* not NAN */
			frozen += tr->weight * one;
	}
	b->frozen += frozen;
	b->freed = equal ? b->freed : fmax(b->freed, b->stuck);
	b->stuck = equal ? b->stuck + frozen : 0;
	if (b->par.direction * (r->y - b->farthest) > 0)
		b->farthest = r->y;
	b->before = r->y;
	for (int j = 0; j < KINDS && b->rows > 1; j++)
		b->freedom[j] = b->keep[j] * b->freedom[j] + 1;
	if (b->rows >= BANK_START - 1)
		b->scored = b->scored * fade + 1;
	b->age += step;
	b->squares += step * step;
	b->longest = fmax(b->longest, step);
	b->gap = b->age / k;
	b->previous = (r->t + b->idle - b->seen) / b->unit;
	b->seen = r->t + b->idle;
	b->last = r->t;
	for (int i = 0; i < b->par.n_loads; i++)
		b->load[i].taken = r->sum[i];
	if (b->jumped)
		b->healed += b->level - damage;
	b->jumped = 0;
	b->level = damage;
	plateau_add(&b->course, b->seen, r->y);
	b->rows++;
	weigh(b);
	breed(b);
}

static int is_used(const struct bank *b, int shape)
{
	return b->par.families & shape_of(b, shape)->family &&
	       (b->par.own == 0 || shape_of(b, shape) != &b->par.more[b->par.own - 1]);
}

/* The first three observations start all trends. */
static void start(struct bank *b)
{
	const struct row *r = b->held;
	int n = 2 + b->par.n_loads;

	b->base = median_of_three(r[0].y, r[1].y, r[2].y);
	b->range = b->par.threshold - b->base;
	b->unit = 0.5 * (r[2].t - r[0].t); /* one of the two gaps may be tiny */
	b->last = b->seen = r[0].t;
	b->level = damage_of(b, r[0].y);
	b->before = b->farthest = r[0].y;
	b->gap = 1;
	for (int i = 0; i < b->shapes; i++)
		for (int k = 0; k < KINDS && is_used(b, i); k++) {
			struct trend *tr = &b->trend[b->trends++];
			struct place here = place_of(b, i, b->level);
			double *x = state_of(b, tr);

			*tr = (struct trend){ .sum = FINEST * FINEST,
				.shape = (unsigned short)i,
				.kind = (unsigned char)k };
			x[0] = here.h;
			x[n] = squared_slope(here);
			x[n + n + 1] = DIFFUSE;
		}
	b->fixed = b->trends;
	for (int k = 0; k < KINDS; k++)
		b->freedom[k] = 1;
	b->rows = 1;
	b->at[0] = 1;
	for (int k = 0; k < b->par.n_loads; k++) {
		b->load[k].taken = r[0].sum[k];
		b->at[1 + k] = 0;
	}
	for (int k = 1; k < FIRST; k++)
		take(b, &r[k]);
	b->n_held = 0;
}

/* Drops an outlier among the first three observations, before there is a trend that could
 * tell it: one that is as far below their median as the threshold is above it. */
static void drop_outlier(struct bank *b)
{
	struct row *r = b->held;
	double middle = median_of_three(r[0].y, r[1].y, r[2].y);
	int kept = 0;

	for (int k = 0; k < FIRST; k++)
		if ((middle - r[k].y) / (b->par.threshold - middle) < 1)
			r[kept++] = r[k];
	b->counts.outliers += (unsigned long)(FIRST - kept);
	b->n_held = kept;
}

/* What the trends, by weight, say of an observation: its density, how many of them it
 * surprises, and how many foresee it no better than within the way to the threshold. */
struct opinion {
	double density, surprised, vague;
};

/* Of an observation of a damage, step after the last row. */
static struct opinion opinion_of(const struct bank *b, double damage, double step)
{
	struct opinion sum = { 0 };
	double limit = student_square(SURPRISE, b->freedom[0]);
	struct place place;
	int shape = -1;

	for (int i = 0; i < b->trends; i++) {
		const struct trend *tr = &b->trend[i];
		struct place seen;
		double f, z, line[LINE], noise = tr->sum / freedom_of(b, tr);

		if (tr->weight < 1e-6)
			continue;
		if (tr->shape != shape)
			place = place_of(b, shape = tr->shape, damage);
		line_at(b, tr, b->at, line);
		advance_state(2, line, b->at, advance_of(b, tr, step), 1);
		seen = seen_from(
			b, tr->shape, line[LINE_H], line[LINE_HH], damage, &place);
		f = line[LINE_HH] + wander_of(b, tr, &seen, step) + squared_slope(seen);
		z = (seen.h - line[LINE_H]) / sqrt(f);
		sum.density += tr->weight * exp(log_density(b, tr, &seen, f, z));
		if (!(z * z <= limit * noise)) /* or NAN */
			sum.surprised += tr->weight;
		if (f * noise > squared_slope(seen))
			sum.vague += tr->weight;
	}
	return sum;
}

/* Widens the variance of the level by a jump of the damage to this value. */
static void unsettle(struct bank *b, double damage, double jump)
{
	int n = 2 + b->par.n_loads;

	for (int i = 0; i < b->trends; i++) {
		struct trend *tr = &b->trend[i];

		state_of(b, tr)[n] += jump * jump *
				      squared_slope(place_of(b, tr->shape, damage)) *
				      freedom_of(b, tr) / tr->sum;
	}
}

/* A regime begins: the rate may differ from the one before by as much as that, and by
 * this rate of the damage. */
static void renew(struct bank *b, double damage, double rate)
{
	int n = 2 + b->par.n_loads;

	for (int i = 0; i < b->trends; i++) {
		struct trend *tr = &b->trend[i];
		double line[LINE], square = squared_slope(place_of(b, tr->shape, damage));

		scale_trend(b, tr, grown(tr, b->age));
		begin_regime(b, tr, 0);
		line_at(b, tr, b->at, line);
		state_of(b, tr)[n + n + 1] +=
			(line[LINE_V] * line[LINE_V] + rate * rate * square) *
			freedom_of(b, tr) / tr->sum;
	}
}

/* The level has jumped before a row.  A repair keeps the rates; otherwise the jump may be
 * the beginning of a new rate, which makes all of it in the time since the row before. */
static void shift(struct bank *b, const struct row *r, int repaired)
{
	double damage = damage_of(b, r->y), jump = damage - b->level;

	unsettle(b, damage, jump);
	if (!repaired)
		renew(b, damage, jump * b->unit / (r->t - b->last));
	b->repairs += repaired;
	if (repaired)
		b->renewed = r->t + b->idle;
	b->jumped = 1;
	b->counts.shifts++;
}

/* 1 if HELD_GOOD rows running are all healthier than the row before those held. */
static int is_repaired(const struct bank *b)
{
	int running = 0;

	for (int k = 0; k < b->n_held && running < HELD_GOOD; k++)
		running = damage_of(b, b->held[k].y) < b->level ? running + 1 : 0;
	return running == HELD_GOOD;
}

int bank_repaired(const struct bank *b)
{
	return b->repairs > 0 || is_repaired(b);
}

int bank_held(const struct bank *b)
{
	return b->n_held;
}

int bank_stuck(const struct bank *b)
{
	return b->stuck > fmax(LIKELY - 1, 2 * b->freed) && isfinite(b->quantum);
}

double chance_of_jump(const struct bank *b)
{
	double jump = damage_of(b, b->held[0].y) - b->level;

	if (is_repaired(b))
		return 1;
	return b->n_held < LIKELY ? b->n_held / (LIKELY * pow(1 + jump * jump, 2))
				  : b->n_held / (b->n_held + 1.0);
}

/* 1 if the machine was idle in a long gap of step: running does not explain the
 * observation, or explains it less well; or it has been repaired, which says nothing
 * against idleness.  Where it is not known what running would do, as after a first burst
 * of readings, any other explanation seems better, and none is preferred. */
static int was_idle(const struct bank *b, double damage, double step)
{
	struct opinion idle = opinion_of(b, damage, b->gap),
		       running = opinion_of(b, damage, step);

	return (damage < b->level && idle.surprised >= 0.9) || running.surprised >= 0.9 ||
	       (running.vague < 0.5 && idle.density > running.density);
}

/* The mean gap, halts included, as seen from a random time: of readings in bursts it is
 * that between the bursts.  The longest one is left out, so as not to hide a second. */
static double usual_gap(const struct bank *b)
{
	double total = b->age + b->idle / b->unit - b->longest;

	return (b->squares - b->longest * b->longest) / total;
}

/* The next gap, halts included, if rows come at a constant ratio of their ages, as they
 * do in many tests, or at a constant distance. */
static double next_gap(const struct bank *b)
{
	double age = b->age + b->idle / b->unit;

	return b->previous * age / (age - b->previous);
}

/* Takes the idle time out of a row. */
static void leave_idle_time(struct bank *b, struct row *r)
{
	double step = (r->t - b->last) / b->unit, idle,
	       usual = fmax(usual_gap(b), next_gap(b));

	if (!bank_ready(b) || b->n_held > 0 || step <= HALT * usual ||
		!was_idle(b, damage_of(b, r->y), step))
		return;
	idle = (step - b->gap) * b->unit;
	b->idle += idle;
	b->squares += step * step - b->gap * b->gap; /* the rest: take() */
	b->longest = fmax(b->longest, step);
	r->t -= idle;
	for (int k = 0; k < b->par.n_loads; k++) {
		b->load[k].sum -= idle * b->at[1 + k];
		r->sum[k] -= idle * b->at[1 + k];
	}
	b->counts.halts++;
}

/* Greatest common divisor of two numbers that are known to a twentieth of it. */
static double common_divisor(double a, double b)
{
	double rest = fabs(remainder(a, b));

	return rest > 0.05 * b ? common_divisor(b, rest) : b;
}

/* Where values repeat they have been rounded, and the noise is at least that of rounding:
 * a quantum over sqrt(12).  Without it a step after equal values would count as a shift,
 * and the wear as none. */
static void heed_rounding(struct bank *b, double y)
{
	double step = fabs(y - b->before);

	if (step == 0)
		b->repeats = 1;
	else if (step > 0) /* else it is the first value */
		b->quantum = isinf(b->quantum) ? step : common_divisor(step, b->quantum);
	if (b->rows == 0)
		return;
	step = rounding_of(b);
	for (int i = 0; i < b->trends; i++) {
		struct trend *tr = &b->trend[i];

		tr->sum = fmax(tr->sum, freedom_of(b, tr) * step * step / 12);
	}
}

/* 1 for a row that the trends predict, and that is not nearer to those after a repair. */
static int goes_on(const struct bank *b, const struct row *r)
{
	double damage = damage_of(b, r->y);

	if (is_repaired(b) &&
		2 * damage < b->level + damage_of(b, b->held[b->n_held - 1].y))
		return 0;
	return equals(b, r->y) ||
	       opinion_of(b, damage, (r->t - b->last) / b->unit).surprised < 0.9;
}

static void accept_held(struct bank *b);

static void consider(struct bank *b, const struct row *r, int most)
{
	if (goes_on(b, r)) {
		b->counts.outliers += (unsigned long)b->n_held;
		b->n_held = 0;
		take(b, r);
		return;
	}
	b->held[b->n_held++] = *r;
	if (b->n_held >= most)
		accept_held(b);
}

/* Takes the first of the rows held back as the level after a jump, and the others as
 * ever, because that may not have been the last one; but no burst within is waited for.
 */
static void accept_held(struct bank *b)
{
	struct row held[HELD];
	int n = b->n_held;

	memcpy(held, b->held, sizeof held);
	shift(b, &held[0], is_repaired(b));
	b->n_held = 0;
	take(b, &held[0]);
	for (int k = 1; k < n; k++)
		consider(b, &held[k], LIKELY);
}

void bank_add(struct bank *b, double t, double y)
{
	struct row r = { .t = t, .y = y };

	if (isnan(y))
		return;
	if (b->rows == 0 && !(b->par.direction * (b->par.threshold - y) > 0))
		return;
	heed_rounding(b, y);
	for (int k = 0; k < b->par.n_loads; k++)
		r.sum[k] = b->load[k].sum;
	if (b->rows == 0) {
		b->before = y;
		b->held[b->n_held++] = r;
		if (b->n_held == FIRST)
			drop_outlier(b);
		if (b->n_held == FIRST)
			start(b);
		return;
	}
	r.t -= b->idle;
	face_loads(b, &r);
	leave_idle_time(b, &r);
	consider(b, &r, HELD);
}

struct bank *bank_accepting(const struct bank *b)
{
	size_t size = size_of_bank(&b->par, b->capacity);
	struct bank *copy = malloc(size);

	if (!copy)
		return NULL;
	memcpy(copy, b, size);
	do
		accept_held(copy);
	while (is_repaired(copy));
	return copy;
}

int bank_event(struct bank *b, enum bank_event event)
{
	if (b->rows == 0)
		return 0;
	b->course = (struct plateau){ 0 }; /* the event explains it */
	if (event == BANK_REPAIR) {
		unsettle(b, b->level, 1);
		b->repairs++;
		b->jumped = 1;
	} else {
		renew(b, b->level, 0);
	}
	return 1;
}

/* --- what is known ------------------------------------------------------------------ */

double bank_weight(const struct bank *b, enum bank_family family)
{
	double sum = 0;

	for (int i = 0; i < b->trends; i++) {
		int changed = i >= b->fixed;

		if (family ==
			(changed ? BANK_ALL : shape_of(b, b->trend[i].shape)->family))
			sum += b->trend[i].weight;
	}
	return sum;
}

/* Everything except the parameters, which are at the front. */
void bank_pass(struct bank *b, struct state *s)
{
	size_t from = offsetof(struct bank, rows);

	state_move(
		s, (unsigned char *)b + from, size_of_bank(&b->par, b->capacity) - from);
}
