/* foreign.c - see foreign.h */
#include "signal/foreign.h"
#include "signal/gaps.h"
#include <math.h>

/* Deviations of a sample that is more than noise, share of a duration that is short, and
 * correlation of what has one cause. */
static const double LOUD = 4.5, SHORT = 0.25, ALIKE = 0.7;

struct view {
	const double *y;
	long long begin;
	size_t n;
};

static double sample(const struct view *v, long long i)
{
	return i >= v->begin && i < v->begin + (long long)v->n ? v->y[i - v->begin] : 0;
}

/* Energy beyond the noise. */
static double energy(const struct view *v, long long from, long long to)
{
	double sum = 0;

	for (long long i = from; i < to; i++)
		sum += sample(v, i) * sample(v, i) - 1;
	return sum;
}

/* Correlation of x with y lag later, 0 where either has hardly more than noise. */
static double alike(const struct view *x, const struct view *y, long long from,
	long long to, long long lag)
{
	double n = (double)(to - from), xx = energy(x, from, to),
	       yy = energy(y, from + lag, to + lag), xy = 0;

	if (xx < 5 * sqrt(2 * n) || yy < 5 * sqrt(2 * n))
		return 0;
	for (long long i = from; i < to; i++)
		xy += sample(x, i) * sample(y, i + lag);
	return xy / sqrt(xx * yy);
}

static long long loudest(const struct view *v, long long from, long long to)
{
	long long best = from;

	for (long long i = from; i < to; i++)
		if (fabs(sample(v, i)) > fabs(sample(v, best)))
			best = i;
	return best;
}

/* Samples that are more than noise. */
static double count_loud(const struct view *v, long long from, long long to)
{
	double count = 0;

	for (long long i = from; i < to; i++)
		count += fabs(sample(v, i)) > LOUD;
	return count;
}

static int is_clipped(
	const unsigned char *bad, const struct view *v, long long from, long long to)
{
	for (long long i = from; i < to; i++)
		if (i >= v->begin && i < v->begin + (long long)v->n &&
			bad[i - v->begin] == GAPS_CLIPPED)
			return 1;
	return 0;
}

void foreign_look(const double *const y[2], const unsigned char *const bad[2],
	const long long begin[2], const size_t n[2], long long from, long long to,
	long shift, double duration, struct foreign *f)
{
	struct view v[2] = { { y[0], begin[0], n[0] }, { y[1], begin[1], n[1] } };
	double first = energy(&v[0], from, to),
	       second = energy(&v[1], from + shift, to + shift);
	int louder = second > first;
	long long at[2] = { loudest(&v[0], from, to),
		loudest(&v[1], from + shift, to + shift) - shift };
	long near = (long)(0.3 * duration);
	double moving = 0;

	f->at = (double)at[first * 3 < second];
	f->peak = sample(&v[louder], at[louder] + (louder ? shift : 0));
	for (long lag = shift - near; shift && lag <= shift + near; lag++)
		moving = fmax(moving, fabs(alike(&v[0], &v[1], from, to, lag)));
	if (shift && fabs(alike(&v[0], &v[1], from + shift, to + shift, 0)) > ALIKE &&
		moving < ALIKE)
		f->kind = FOREIGN_NOTHING;
	else if (shift && fabs(alike(&v[0], &v[1], from, to, 0)) > ALIKE &&
		 moving < ALIKE)
		f->kind = FOREIGN_COMMON;
	else if (is_clipped(bad[0], &v[0], from, to) ||
		 is_clipped(bad[1], &v[1], from + shift, to + shift))
		f->kind = FOREIGN_CLIPPED;
	else if (count_loud(&v[0], from, to) +
			 count_loud(&v[1], from + shift, to + shift) <
		 SHORT * duration)
		f->kind = FOREIGN_IMPULSE;
	else
		f->kind = moving > ALIKE ? FOREIGN_MOVING : FOREIGN_TRANSIENT;
}
