/* damage.c - see damage.h */
#include "life/damage.h"
#include "life/draw.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	SHAPES = 15,
	KINDS = 6, /* memories times noises */
	MEMORIES = 3,
	ROWS_MIN = 4, /* before anything is drawn */
	ROBUST = 12   /* rows before large innovations are cut */
};

/* g(D) = e^{par D} where scale is 0, else (1 + D / scale)^par.  The prior is Gaussian in
 * par, mild acceleration being commonest, with a good part of it kept for the straight
 * line, which most wear follows. */
struct shape {
	unsigned family;
	double scale, par, log_prior;
};

#define SCALE 0.3
#define STRAIGHT 3 /* log of what the straight line is given over the others */
#define RATE(m)                                                 \
	{                                                       \
		DAMAGE_RATE, 0, m, -0.5 * ((m)-1) * ((m)-1) / 4 \
	}
#define POWER(f, k)                                              \
	{                                                        \
		f, SCALE, k, -0.5 * ((k)-0.5) * ((k)-0.5) / 2.25 \
	}

static const struct shape shapes[SHAPES] = { { DAMAGE_LINEAR, 0, 0, STRAIGHT },
	RATE(-3.0), RATE(-2.0), RATE(-1.0), RATE(1.0), RATE(2.0), RATE(3.0), RATE(4.0),
	RATE(5.0), POWER(DAMAGE_POWER, -1.0), POWER(DAMAGE_POWER, -0.5),
	POWER(DAMAGE_POWER, 0.5), POWER(DAMAGE_EXPONENTIAL, 1.0),
	POWER(DAMAGE_POWER, 1.5), POWER(DAMAGE_POWER, 2.0) };

static const double memories[MEMORIES] = { 0, 1, 3 }; /* exponent of (j / k) */
static const double FADING = 1;                       /* the same for scores */
static const double SCORED = 20;   /* rows that scores count for at most */
static const double CUT = 3;       /* standard deviations of an innovation */
static const double LEAST = 1e-3;  /* prior noise, share of the way to the threshold */
static const double DIFFUSE = 1e8; /* prior variance of v over that of the noise */

/* One line h + v t.  Covariances are in units of the noise variance. */
struct line {
	double h, v, phh, phv, pvv;
	double sum;    /* of squared standardised innovations, discounted */
	double lagged; /* of their products with the ones before */
	double before; /* the last one */
	double score;
};

struct damage {
	unsigned families;
	double threshold;
	int direction;
	long rows;
	double base, range;       /* y_0 and the signed way to the threshold */
	double unit;              /* of time: the first gap */
	double last;              /* t */
	double gap;               /* mean of them, in units */
	double level;             /* D of the last row */
	double freedom[MEMORIES]; /* discounted counts of innovations */
	double keep[MEMORIES];    /* discounts of the present row */
	double log_constant[MEMORIES];
	double scored;
	struct line line[SHAPES][KINDS];
	double weight[SHAPES * KINDS];
};

struct damage *damage_new(unsigned families, double threshold, int direction)
{
	struct damage *d = calloc(1, sizeof *d);

	if (!d)
		return NULL;
	d->families = families;
	d->threshold = threshold;
	d->direction = direction;
	return d;
}

void damage_free(struct damage *d)
{
	free(d);
}

void damage_clear(struct damage *d)
{
	d->rows = 0;
	d->gap = d->scored = 0;
}

long damage_rows(const struct damage *d)
{
	return d->rows;
}

/* h(D), and the log of its slope, -log g(D).  Below 0 and above 1 it goes on straight: no
 * shape is known there, and an outlier must not look exact where a shape has levelled. */
static double coordinate(const struct shape *s, double level, double *log_slope)
{
	double inside = fmax(0, fmin(1, level)), h;

	if (s->scale > 0) {
		double u = log1p(inside / s->scale);

		*log_slope = -s->par * u;
		h = s->par == 1 ? s->scale * u
				: s->scale * expm1((1 - s->par) * u) / (1 - s->par);
	} else {
		*log_slope = -s->par * inside;
		h = s->par == 0 ? inside : -expm1(-s->par * inside) / s->par;
	}
	return h + (level - inside) * exp(*log_slope);
}

static void start_lines(struct damage *d)
{
	for (int i = 0; i < SHAPES; i++)
		for (int k = 0; k < KINDS; k++)
			d->line[i][k] = (struct line){
				.phh = 1, .pvv = DIFFUSE, .sum = LEAST * LEAST
			};
	for (int k = 0; k < MEMORIES; k++)
		d->freedom[k] = 1;
}

/* The first row on the good side of the threshold. */
static void begin(struct damage *d, double t, double y)
{
	d->base = y;
	d->range = d->threshold - y;
	if (!(d->direction * d->range > 0))
		return;
	start_lines(d);
	d->last = t;
	d->rows = 1;
}

/* What a row brings to all lines of a shape or of a memory. */
struct news {
	double step;         /* time since the last row, in units */
	double h, log_slope; /* the observation in the coordinate of the shape */
	double slope2;       /* squared slope: noise variance in that coordinate */
	double wiener;       /* noise on the damage over the step */
	double keep;         /* discount of the memory, <= 1 */
	double freedom;
	double log_constant; /* of the Student-t density */
	int scored, robust;
};

/* The innovation of one line and its standardised square, cut where it is large. */
static void follow(struct line *l, const struct news *n)
{
	double f, e, z, limit, variance = l->sum / n->freedom;

	l->h += n->step * l->v;
	l->phh += n->step * (2 * l->phv + n->step * l->pvv);
	l->phv += n->step * l->pvv;
	l->phh = l->phh / n->keep + n->wiener * n->slope2;
	l->phv /= n->keep;
	l->pvv /= n->keep;
	f = l->phh + n->slope2;
	e = n->h - l->h;
	z = e / sqrt(f);
	limit = CUT * sqrt(variance);
	if (n->robust && fabs(z) > limit) {
		z = copysign(limit, z);
		e = z * sqrt(f);
	}
	if (n->scored)
		l->score +=
			n->log_constant + n->log_slope - 0.5 * log(variance * f) -
			0.5 * (n->freedom + 1) * log1p(z * z / (n->freedom * variance));
	l->h += l->phh / f * e;
	l->v += l->phv / f * e;
	l->pvv -= l->phv / f * l->phv;
	l->phv -= l->phh / f * l->phv;
	l->phh -= l->phh / f * l->phh;
	l->sum = l->sum * n->keep + z * z + 1e-9 * LEAST * LEAST;
	l->lagged = l->lagged * n->keep + z * l->before;
	l->before = z;
}

/* The constant of the Student-t density. */
static double log_constant(double freedom)
{
	return lgamma(0.5 * (freedom + 1)) - lgamma(0.5 * freedom) -
	       0.5 * log(freedom * M_PI);
}

/* All lines of one shape take the damage level, step after the last row. */
static void follow_shape(
	struct damage *d, int shape, double level, double step, double fade)
{
	long k = d->rows;
	struct news n = {
		.step = step, .scored = k >= ROWS_MIN - 1, .robust = k >= ROBUST
	};

	n.h = coordinate(&shapes[shape], level, &n.log_slope);
	n.slope2 = exp(2 * n.log_slope);
	for (int j = 0; j < KINDS; j++) {
		struct line *l = &d->line[shape][j];
		int memory = j % MEMORIES;

		n.freedom = d->freedom[memory];
		n.keep = d->keep[memory];
		n.log_constant = d->log_constant[memory];
		n.wiener = j < MEMORIES ? 0 : step / (k > 1 ? d->gap : 1);
		l->score *= fade;
		follow(l, &n);
		if (k == 1) { /* two rows make the line and leave no innovation */
			l->sum = LEAST * LEAST;
			l->lagged = l->before = 0;
		}
	}
}

void damage_add(struct damage *d, double t, double y)
{
	double k = (double)d->rows, step, fade = k / (k + FADING);
	double level = (y - d->base) / d->range;

	if (d->rows == 0) {
		begin(d, t, y);
		return;
	}
	if (d->rows == 1)
		d->unit = t - d->last;
	step = (t - d->last) / d->unit;
	for (int j = 0; j < MEMORIES; j++) {
		d->keep[j] = d->rows >= ROWS_MIN - 1 ? k / (k + memories[j]) : 1;
		d->log_constant[j] = log_constant(d->freedom[j]);
	}
	for (int i = 0; i < SHAPES; i++)
		if (d->families & shapes[i].family)
			follow_shape(d, i, level, step, fade);
	for (int j = 0; j < MEMORIES && d->rows > 1; j++)
		d->freedom[j] = d->keep[j] * d->freedom[j] + 1;
	if (d->rows >= ROWS_MIN - 1)
		d->scored = d->scored * fade + 1;
	d->gap += (step - d->gap) / k;
	d->last = t;
	d->level = level;
	d->rows++;
}

/* Weights of the models; returns their sum. */
static double weigh(struct damage *d)
{
	double share = fmin(1, SCORED / fmax(d->scored, 1)), top = -INFINITY, sum = 0;

	for (int i = 0; i < SHAPES * KINDS; i++) {
		const struct shape *s = &shapes[i / KINDS];

		d->weight[i] =
			d->families & s->family
				? s->log_prior +
					  share * d->line[i / KINDS][i % KINDS].score
				: -INFINITY;
		top = fmax(top, d->weight[i]);
	}
	for (int i = 0; i < SHAPES * KINDS; i++) {
		d->weight[i] = exp(d->weight[i] - top);
		sum += d->weight[i];
	}
	return sum;
}

/* Successive normal deviates from a table, over and over. */
struct table {
	const double *z;
	int n, next;
};

static double take(struct table *t)
{
	if (t->next == t->n)
		t->next = 0;
	return t->z[t->next++];
}

/* What the draws of one model share. */
struct passage {
	double h, v, phh, phv, pvv; /* now; covariances in units of the noise */
	double limit;               /* h of the threshold */
	double variance, freedom;   /* of the noise, with autocorrelation; of chi^2 */
	double wiener;              /* variance of the damage per unit of time */
};

static void prepare(
	const struct damage *d, int shape, int kind, double now, struct passage *p)
{
	const struct line *l = &d->line[shape][kind];
	double ahead = (now - d->last) / d->unit, threshold_slope, level_slope,
	       correlation;

	p->freedom = d->freedom[kind % MEMORIES];
	correlation = fmin(0.95, fmax(0, l->lagged / l->sum));
	p->variance = l->sum / p->freedom;
	p->h = l->h + ahead * l->v;
	p->v = l->v;
	p->phh = l->phh + ahead * (2 * l->phv + ahead * l->pvv);
	p->phv = l->phv + ahead * l->pvv;
	p->pvv = l->pvv;
	p->limit = coordinate(&shapes[shape], 1, &threshold_slope);
	coordinate(&shapes[shape], d->level, &level_slope);
	/* The noise is constant in D; take it half way to the threshold. */
	p->wiener = kind < MEMORIES
			    ? 0
			    : p->variance * exp(threshold_slope + level_slope) / d->gap;
	p->variance *= (1 + correlation) / (1 - correlation);
}

/* Inverse Gaussian of that mean and variance (Michael, Schucany, Haas, The American
 * Statistician 30 (1976) 88), u uniform. */
static double inverse_gaussian(double mean, double variance, double z, double u)
{
	double r = 0.5 * z * z * variance / mean;
	double x = mean / (1 + (r + sqrt(r * (2 * mean + r))) / mean);

	return u * (mean + x) <= mean ? x : mean / x * mean;
}

static double draw_life(const struct passage *p, struct table *t)
{
	double sd, v, h, time, z = 0;

	sd = sqrt(p->variance * p->freedom / chi2_from_normal(p->freedom, take(t)));
	v = -1;
	for (int tries = 0; tries < 32 && !(v > 0); tries++) {
		z = take(t);
		v = p->v + sd * sqrt(p->pvv) * z;
	}
	if (!(v > 0))
		return INFINITY;
	h = p->h;
	if (p->pvv > 0) {
		h += sd * p->phv / sqrt(p->pvv) * z;
		h += sd * sqrt(fmax(0, p->phh - p->phv * p->phv / p->pvv)) * take(t);
	}
	time = (p->limit - h) / v;
	if (time <= 0)
		return 0;
	z = take(t);
	if (p->wiener > 0 && isfinite(time))
		time = inverse_gaussian(time, p->wiener * time / (v * v), z,
			0.5 * erfc(take(t) / sqrt(2)));
	return time;
}

void damage_draw(
	struct damage *d, double now, const double *z, int m, double *life, int n)
{
	double sum = weigh(d), reached = 0;
	struct table table = { z, m, 0 };
	struct passage p;
	int drawn = 0;

	for (int i = 0; i < SHAPES * KINDS; i++) {
		reached += d->weight[i];
		if (!(reached / sum * n > drawn + 0.5))
			continue;
		prepare(d, i / KINDS, i % KINDS, now, &p);
		while (drawn < n && reached / sum * n > drawn + 0.5)
			life[drawn++] = d->unit * draw_life(&p, &table);
	}
	while (drawn < n) {
		/* No shape has a weight where the data overflow. */
		life[drawn] = drawn ? life[drawn - 1] : INFINITY;
		drawn++;
	}
}
