/* bubbles.c - see bubbles.h */
#include "signal/learn/bubbles.h"
#include "num/dot.h"
#include "num/robust.h"
#include <stdlib.h>
#include <string.h>

/* Points of the mean particle's pulse on the grid of the fits; pulses from which its
 * shape is taken, and half of its length, in durations. */
enum { POINTS = 12, CLIPS = 64, TAIL = 2 };

/* Longest bubble, in durations of the mean particle's pulse. */
static const double LONGEST = 4.2;

enum {
	FINEST = 2 * POINTS, /* most points of that pulse */
	SHAPE = 2 * TAIL * FINEST + 1,
	/* of a bubble with a pulse on either side */
	WINDOW = 7 * FINEST
};

/* Particles that overlap without a bubble, or with one instead of the last. */
enum { PULSES = 4, ROUNDS = 3 };

/* Share of its energy that others must leave of a wave beside which it is fitted. */
static const double LITTLE = 0.02;

/* Error of the pulses of the fits, as a share of the energy of what they describe.  At
 * the levels of evidence that no lobe of 276 records beside bubbles reached, 382, 408,
 * 396, 369 and 323 of 617 bubbles were told with 0, 0.003, 0.01, 0.03 and 0.1 (in time
 * steps half as long). */
static const double SHAPE_ERROR = 0.003;

/* Logarithm of the least ratio of what particles leave and what a bubble does, mean of
 * both channels.  With 1, 1.5 and 2, 466, 448 and 423 of 612 bubbles of 67 records are
 * taken out, with 78, 23 and 7 other pulses, and 96, 27 and 3 pulses of 176 records
 * without bubbles: 52 of them of groups, the others in laminar and turbulent flow, behind
 * high-passes and with crosstalk. */
static const double CLEARLY = 2;

struct channel {
	double *z; /* n points, the mean of so many samples each */
	size_t n, samples;
	double T, shortest, longest; /* of pulses, points */
	double pulse[SHAPE];         /* of T points, from TAIL T before its middle */
	int half;
};

/* A bubble, or the pulse of a particle, with its middle and duration. */
struct wave {
	int is_bubble;
	double t, T, level;
};

struct fit {
	double basis[PULSES][WINDOW], rest[WINDOW];
	int n;
};

/* x[0 .. n) between its points, 0 beyond them. */
static double between(const double *x, size_t n, double t)
{
	size_t i = (size_t)fmax(t, 0);

	return t < 0 || i + 1 >= n ? 0 : x[i] + (t - (double)i) * (x[i + 1] - x[i]);
}

static void draw(const struct channel *c, const struct wave *w, double *p, int n)
{
	for (int i = 0; i < n; i++) {
		double s = (i - w->t) / w->T;

		p[i] = w->is_bubble ? marks_lobe(s)
				    : between(c->pulse, 2 * (size_t)c->half + 1,
					      s * c->T + c->half);
	}
}

/* Removes from p[0 .. n) what it has of q, of energy 1. */
static void without(double *p, const double *q, int n)
{
	add_scaled(p, -dot(p, q, (size_t)n), q, (size_t)n);
}

/* Makes p orthogonal to the first waves of the basis and of energy 1; 0 if little would
 * be left. */
static int is_new(const struct fit *f, int waves, double *p)
{
	double all = dot(p, p, (size_t)f->n), left;

	for (int k = 0; k < waves; k++)
		without(p, f->basis[k], f->n);
	left = dot(p, p, (size_t)f->n);
	for (int i = 0; i < f->n && left > 0; i++)
		p[i] /= sqrt(left);
	return left > LITTLE * all;
}

/* Moves *best to w, whose values are p, if that, beside the first waves of the basis,
 * describes more of the rest. */
static void compare(const struct fit *f, int waves, const double *p, const struct wave *w,
	double *most, struct wave *best)
{
	const size_t n = (size_t)f->n;
	double all = dot(p, p, n), left = all, product = dot(p, f->rest, n);

	for (int k = 0; k < waves; k++)
		left -= pow(dot(p, f->basis[k], n), 2);
	if (left > LITTLE * all && product * product > *most * left) {
		*most = product * product / left;
		*best = *w;
		best->level = product / left;
	}
}

/* The same for waves around best by these steps of time and of the logarithm of the
 * duration, as many to either side. */
static void compare_around(const struct channel *c, const struct fit *f, int waves,
	double step, double scale, int steps, double *most, struct wave *best)
{
	const struct wave middle = *best;
	double p[WINDOW];

	for (int i = -steps; i <= steps; i++)
		for (int k = -steps; k <= steps; k++) {
			struct wave w = { middle.is_bubble, middle.t + i * step,
				middle.T * exp(k * scale), 0 };

			draw(c, &w, p, f->n);
			compare(f, waves, p, &w, most, best);
		}
}

/* Looks for the pulse, beside the first waves of the basis, that describes most of the
 * rest; returns how much. */
static double find_pulse(
	const struct channel *c, const struct fit *f, int waves, struct wave *best)
{
	const int reach = (int)(c->T / 4);
	double p[3 * WINDOW], most = 0;

	for (double T = c->shortest; T <= c->longest; T *= exp(MARKS_STEP)) {
		draw(c, &(struct wave){ 0, f->n + reach, T, 0 }, p, 2 * (f->n + reach));
		for (int t = -reach; t < f->n + reach; t++)
			compare(f, waves, p + f->n + reach - t,
				&(struct wave){ 0, t, T, 0 }, &most, best);
	}
	compare_around(c, f, waves, 0.5, MARKS_STEP / 2, 1, &most, best);
	return most;
}

/* What PULSES waves leave of x[0 .. n), the first a bubble near *bubble, unless NULL; no
 * fewer are tried once that is at most enough. */
static double rest_of(const struct channel *c, const double *x, int n, double enough,
	struct wave *bubble)
{
	struct wave wave[PULSES] = { { .is_bubble = 0 } };
	struct fit f = { .n = n };
	double rest = 0;

	for (int i = 0; i <= PULSES * ROUNDS; i++) {
		int own = i % PULSES, waves = 0;
		double most;

		memcpy(f.rest, x, (size_t)n * sizeof *x);
		for (int k = 0; k < PULSES && k < i; k++) {
			if (k == own)
				continue;
			draw(c, &wave[k], f.basis[waves], n);
			if (is_new(&f, waves, f.basis[waves]))
				without(f.rest, f.basis[waves++], n);
		}
		rest = dot(f.rest, f.rest, (size_t)n);
		if (bubble && own == 0) {
			most = 0;
			wave[0] = *bubble;
			compare_around(c, &f, waves, c->T / 12, MARKS_STEP / 2, 3, &most,
				&wave[0]);
		} else {
			most = find_pulse(c, &f, waves, &wave[own]);
		}
		rest -= most;
		if (rest <= enough)
			break;
	}
	if (bubble)
		*bubble = wave[0];
	return rest;
}

/* Logarithm of the ratio of what particles and what a bubble in place of one leave around
 * it. */
static double evidence(const struct channel *c, struct wave *bubble)
{
	long half = (long)(0.5 * bubble->T + c->T), middle = (long)bubble->t;
	long from = middle - half < 0 ? 0 : middle - half;
	long to = middle + half + 1 > (long)c->n ? (long)c->n : middle + half + 1;
	const double *x = c->z + from;
	int n = (int)(to - from);
	double error = SHAPE_ERROR * dot(x, x, (size_t)n), enough, rest;

	/* however well the bubble describes them */
	enough = expm1(CLEARLY) * error;
	rest = rest_of(c, x, n, enough, NULL);
	if (rest <= enough)
		return 0;
	bubble->t -= (double)from;
	rest = (rest + error) / (rest_of(c, x, n, 0, bubble) + error);
	bubble->t += (double)from;
	return log(rest);
}

/* The median of the largest pulses of particles; 0 if there is none. */
static int learn_pulse(
	const struct marks *m, const struct velocities *v, struct channel *c)
{
	double clip[CLIPS], energy = 0;
	const double mean = c->T * (double)c->samples;

	c->half = (int)(TAIL * c->T);
	for (int k = -c->half; k <= c->half; k++) {
		double *p = &c->pulse[k + c->half];
		size_t count = 0;

		for (size_t i = 0; i < m->count && count < CLIPS; i++) {
			const struct mark *a = &m->mark[i];

			if (fabs(log(a->T / mean)) > log(v->slow / mean) + MARKS_STEP)
				continue;
			clip[count++] = between(c->z, c->n,
						a->t / (double)c->samples - 0.5 +
							k * a->T / mean) /
					a->value;
		}
		*p = robust_median(clip, count);
		energy += *p * *p;
	}
	return energy > 0;
}

/* The coarse channel and its lobes, from x[0 .. n). */
static enum num_status prepare(const struct velocities *v, double factor,
	const struct marks *m, const double *x, size_t n, double *work, struct channel *c,
	struct marks *lobes)
{
	const double mean = sqrt(v->fast * v->slow);
	size_t q = mean > POINTS ? (size_t)(mean / POINTS) : 1;
	double *y = malloc((n + 1) * sizeof *y);
	enum num_status status = NUM_MEMORY;

	*c = (struct channel){ .samples = q,
		.n = n / q,
		.T = mean / (double)q,
		.shortest = v->fast / (double)q,
		.longest = v->slow / (double)q * exp(MARKS_STEP / 2) };
	c->z = calloc(c->n + 1, sizeof *c->z);
	if (y && c->z) {
		double middle;

		memcpy(work, x, n * sizeof *x);
		middle = robust_median(work, n);
		for (size_t i = 0; i < n; i++)
			y[i] = x[i] - middle;
		for (size_t i = 0; i < c->n; i++)
			c->z[i] = mean_of(y + i * q, q);
		status = learn_pulse(m, v, c) ? marks_find_lobes(y, n, factor * mean,
							LONGEST * mean, work, lobes)
					      : NUM_OK;
	}
	free(y);
	return status;
}

/* 1 if a lobe of sensor 1 and one of sensor 2 may be of one bubble, with the transit
 * times of the particles widened by factor. */
static int is_pair(const struct velocities *v, double factor, const struct mark *one,
	const struct mark *other)
{
	double lag = other->t - one->t;

	return fabs(log(one->T / other->T)) <= log(factor) &&
	       lag >= v->ratio * v->fast / factor && lag <= v->ratio * v->slow * factor &&
	       one->value * other->value > 0;
}

static struct wave wave_of(const struct mark *m, const struct channel *c)
{
	double q = (double)c->samples;

	return (struct wave){ 1, m->t / q - 0.5, m->T / q, 0 };
}

static void take_out(const struct wave *b, const struct channel *c, double *x, size_t n)
{
	double q = (double)c->samples, t = (b->t + 0.5) * q, T = b->T * q;
	size_t to = (size_t)fmin(t + T / 2 + 1, (double)n);

	for (size_t i = (size_t)fmax(t - T / 2, 0); i < to; i++)
		x[i] -= b->level * marks_lobe(((double)i + 0.5 - t) / T);
}

enum num_status bubbles_remove(const struct velocities *v, double factor,
	const struct marks m[2], const double *y, size_t n, double *work, double *seen)
{
	struct channel c[2] = { { .z = NULL }, { .z = NULL } };
	struct marks lobes[2] = { { .count = 0 }, { .count = 0 } };
	enum num_status status = NUM_OK;

	for (int k = 0; k < 2 && v->ratio > 0 && status == NUM_OK; k++)
		status = prepare(
			v, factor, &m[k], y + (size_t)k * n, n, work, &c[k], &lobes[k]);
	for (size_t i = 0; status == NUM_OK && i < lobes[0].count * lobes[1].count; i++) {
		struct mark *one = &lobes[0].mark[i / lobes[1].count];
		struct mark *two = &lobes[1].mark[i % lobes[1].count];
		struct wave a = wave_of(one, &c[0]), b = wave_of(two, &c[1]);

		if (!is_pair(v, factor, one, two) ||
			evidence(&c[0], &a) + evidence(&c[1], &b) < 2 * CLEARLY)
			continue;
		take_out(&a, &c[0], seen, n);
		take_out(&b, &c[1], seen + n, n);
		/* each is of one pair only */
		one->value = 0;
		two->value = 0;
	}
	for (int k = 0; k < 2; k++) {
		marks_clear(&lobes[k]);
		free(c[k].z);
	}
	return status;
}
