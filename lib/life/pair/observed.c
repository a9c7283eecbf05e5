/* observed.c - see observed.h */
#include "life/pair/observed.h"
#include "num/student.h"
#include <math.h>

/* Rates that differ by less, relative, are equal. */
static const double ROUNDED = 1e-6;

/* A fall at one moment is significant where two parallel lines leave so much less of the
 * squares than one line that the ratio F is above FALL, and the rest is as irregular as
 * noise: WHITE of the von Neumann ratio, which is 2 of white noise.  In one of 1000
 * series of noise or of a gamma process of nine to 17 rows, three of 1000 of a Wiener
 * process, F is larger by chance. */
static const double FALL = 60, WHITE = 1.2;
/* With fewer than eight intervals no trend is significant to 1 in 1000. */
enum { FEWEST = 9, MEANS = 2 * FEWEST };

static const double CHANCE = 0.01; /* of an error of the rate */

void observed_begin(struct observed *o, struct moment m)
{
	o->first = o->before = o->last = m;
	o->gaps = (struct blocks){ 0 };
	o->rated = 0;
	o->begun = 1;
}

/* The means of all gaps since the start of the rates, with the last one, which another
 * at its time may still replace. */
static struct blocks gaps_of(const struct observed *o)
{
	struct blocks b = o->gaps;

	if (o->rated)
		blocks_add(&b, MEANS, o->last.t, o->last.gap);
	return b;
}

void observed_add(struct observed *o, struct moment m, double value)
{
	double dt;

	if (!o->begun)
		observed_begin(o, m);
	dt = m.t - o->last.t;
	if (dt > 0 && o->rated)
		blocks_add(&o->gaps, MEANS, o->last.t, o->last.gap);
	if (dt > 0)
		o->before = o->last;
	o->rated = 1;
	o->last = m;
	if (o->grey.n == 0 || dt > 0)
		grey_append(&o->grey, value, dt);
	o->n++;
}

double observed_gap(const struct observed *o)
{
	return o->begun ? o->last.gap : NAN;
}

double observed_rate(const struct observed *o, enum rate_rule rule, const double z[2])
{
	const struct moment *from = rule == RATE_LAST ? &o->before : &o->first;
	double error = z ? z[0] * o->last.error - z[1] * from->error : 0;

	if (!(o->last.t > from->t))
		return NAN;
	return (o->last.gap - from->gap + error) / (o->last.t - from->t);
}

static double rate_between(const struct block *m)
{
	return (m[1].y - m[0].y) / (m[1].t - m[0].t);
}

double observed_rate_trend(const struct observed *o)
{
	struct blocks gaps = gaps_of(o);
	double n = gaps.n - 1, grows = 0;

	for (int i = 0; i + 1 < gaps.n; i++)
		for (int j = i + 1; j + 1 < gaps.n; j++) {
			double a = rate_between(&gaps.mean[i]),
			       b = rate_between(&gaps.mean[j]);

			if (fabs(b - a) > ROUNDED * (fabs(a) + fabs(b)))
				grows += b > a ? 1 : -1;
		}
	return grows == 0 ? 0 : grows / sqrt(n * (n - 1) * (2 * n + 5) / 18);
}

/* Of a Wiener process of variance t, the means over blocks of length d change by a
 * variance of 2 d / 3 from one to the next, and over all by nearly that of the process.
 */
int observed_rate_outside(const struct observed *o, double low, double high)
{
	struct blocks gaps = gaps_of(o);
	int n = gaps.n - 1;
	double rate, time, squares = 0, error;

	if (n < 2)
		return 0;
	time = gaps.mean[n].t - gaps.mean[0].t;
	rate = (gaps.mean[n].y - gaps.mean[0].y) / time;
	for (int i = 0; i < n; i++) {
		const struct block *m = &gaps.mean[i];

		squares += pow(m[1].y - m[0].y - rate * (m[1].t - m[0].t), 2);
	}
	error = sqrt(1.5 * squares * n / (n - 1)) / time *
		student_two_sided(1 - CHANCE, n - 1);
	return rate - error > high || rate + error < low;
}

/* What is left of the squares of the gaps kept about two parallel lines, one before
 * moment k and one from it on, and of the squares of the changes between neighbours;
 * INFINITY unless the gap is lower there than at the moment before, which a halt does not
 * explain.
 */
static double squares_about(const struct blocks *gaps, int k, double *changes)
{
	struct regression part[2] = { { 0 } };
	double slope, left, fall, passed = 0, before = 0;

	for (int i = 0; i < gaps->n; i++)
		regression_add(&part[i >= k], gaps->mean[i].t, gaps->mean[i].y);
	slope = (part[0].xy + part[1].xy) / (part[0].xx + part[1].xx);
	left = part[0].yy + part[1].yy - slope * (part[0].xy + part[1].xy);
	fall = part[0].mean_y - part[1].mean_y -
	       slope * (part[0].mean_x - part[1].mean_x);
	*changes = 0;
	for (int i = 0; i < gaps->n; i++) {
		const struct regression *p = &part[i >= k];
		double off = gaps->mean[i].y - p->mean_y -
			     slope * (gaps->mean[i].t - p->mean_x);

		*changes += i > 0 ? (off - before) * (off - before) : 0;
		before = off;
		if (i > 0 && i == k)
			passed = gaps->mean[i].t - gaps->mean[i - 1].t;
	}
	return k == 0 || fall > slope * passed ? left : INFINITY;
}

int observed_falls(const struct observed *o)
{
	struct blocks gaps = gaps_of(o);
	int n = gaps.n;
	double changes, most = gaps.mean[n > 0 ? n - 1 : 0].y - gaps.mean[0].y,
			exact = ROUNDED * ROUNDED * n * most * most;

	for (int k = 2; n >= FEWEST && k + 1 < n; k++) {
		double left = squares_about(&gaps, k, &changes) + exact;

		if (changes + 2 * exact > WHITE * left &&
			(n - 3) * (squares_about(&gaps, 0, &most) - left) > FALL * left)
			return 1;
	}
	return 0;
}
