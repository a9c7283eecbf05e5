/* observed.c - see observed.h */
#include "life/pair/observed.h"
#include "num/student.h"
#include <math.h>

/* Rates that differ by less, relative, are equal. */
static const double ROUNDED = 1e-6;

/* A fall at one moment is significant where two parallel lines leave so much less of the
 * squares than one line that the ratio F is above FALL.  In one of 1000 series of noise
 * or of a gamma process of nine to 17 rows, three of 1000 of a Wiener process, F is
 * larger by chance. */
static const double FALL = 60;
enum { FEWEST = 9 };

static const double CHANCE = 0.01; /* of an error of the rate */

void observed_begin(struct observed *o, struct moment m)
{
	o->first = o->before = o->last = m;
	o->n_kept = 0;
	o->passed = 0;
	o->every = 1;
}

/* Every second one of those kept goes when there is no more room, and so does the new
 * one, which is as far from the last. */
static void keep(struct observed *o, struct moment m)
{
	if (o->passed++ % o->every)
		return;
	if (o->n_kept == OBSERVED_KEPT) {
		for (int i = 0; 2 * i < OBSERVED_KEPT; i++)
			o->kept[i] = o->kept[2 * i];
		o->n_kept = (OBSERVED_KEPT + 1) / 2;
		o->every *= 2;
		return;
	}
	o->kept[o->n_kept++] = m;
}

void observed_add(struct observed *o, struct moment m, double value)
{
	double dt;

	if (o->every == 0)
		observed_begin(o, m);
	dt = m.t - o->last.t;
	if (dt > 0 || o->n_kept == 0)
		keep(o, m);
	else if (o->kept[o->n_kept - 1].t == m.t)
		o->kept[o->n_kept - 1] = m;
	if (dt > 0)
		o->before = o->last;
	o->last = m;
	if (o->grey.forward.n == 0 || dt > 0)
		grey_append(&o->grey, value, dt);
}

double observed_gap(const struct observed *o)
{
	return o->every > 0 ? o->last.gap : NAN;
}

double observed_rate(const struct observed *o, enum rate_rule rule, const double z[2])
{
	const struct moment *from = rule == RATE_LAST ? &o->before : &o->first;
	double error = z ? z[0] * o->last.error - z[1] * from->error : 0;

	if (!(o->last.t > from->t))
		return NAN;
	return (o->last.gap - from->gap + error) / (o->last.t - from->t);
}

static double rate_between(const struct moment *m)
{
	return (m[1].gap - m[0].gap) / (m[1].t - m[0].t);
}

double observed_rate_trend(const struct observed *o)
{
	double n = o->n_kept - 1, grows = 0;

	for (int i = 0; i + 1 < o->n_kept; i++)
		for (int j = i + 1; j + 1 < o->n_kept; j++) {
			double a = rate_between(&o->kept[i]),
			       b = rate_between(&o->kept[j]);

			if (fabs(b - a) > ROUNDED * (fabs(a) + fabs(b)))
				grows += b > a ? 1 : -1;
		}
	return grows == 0 ? 0 : grows / sqrt(n * (n - 1) * (2 * n + 5) / 18);
}

int observed_rate_outside(const struct observed *o, double low, double high)
{
	int n = o->n_kept - 1;
	double time, rate, squares = 0, error;

	if (n < 2)
		return 0;
	time = o->kept[n].t - o->kept[0].t;
	rate = (o->kept[n].gap - o->kept[0].gap) / time;
	for (int i = 0; i < n; i++) {
		const struct moment *m = &o->kept[i];

		squares += pow(m[1].gap - m[0].gap - rate * (m[1].t - m[0].t), 2);
	}
	error = sqrt(squares * n / (n - 1)) / time * student_two_sided(1 - CHANCE, n - 1);
	return rate - error > high || rate + error < low;
}

/* What is left of the squares of the gaps kept about two parallel lines, one before
 * moment k and one from it on; INFINITY unless the gap is lower there than at the moment
 * before, which a halt does not explain. */
static double squares_about(const struct observed *o, int k)
{
	struct regression part[2] = { { 0 } };
	double slope, fall;

	for (int i = 0; i < o->n_kept; i++)
		regression_add(&part[i >= k], o->kept[i].t, o->kept[i].gap);
	slope = (part[0].xy + part[1].xy) / (part[0].xx + part[1].xx);
	fall = part[0].mean_y - part[1].mean_y -
	       slope * (part[0].mean_x - part[1].mean_x);
	if (!(fall > slope * (o->kept[k].t - o->kept[k - 1].t)))
		return INFINITY;
	return part[0].yy + part[1].yy - slope * (part[0].xy + part[1].xy);
}

int observed_falls(const struct observed *o)
{
	int n = o->n_kept;
	double most, exact, about_one;
	struct regression one = { 0 };

	if (n < FEWEST)
		return 0;
	most = o->kept[n - 1].gap - o->kept[0].gap;
	exact = ROUNDED * ROUNDED * n * most * most;
	for (int i = 0; i < n; i++)
		regression_add(&one, o->kept[i].t, o->kept[i].gap);
	about_one = one.yy - regression_slope(&one) * one.xy;
	for (int k = 2; k + 1 < n; k++) {
		double left = squares_about(o, k) + exact;

		if ((n - 3) * (about_one - left) > FALL * left)
			return 1;
	}
	return 0;
}
