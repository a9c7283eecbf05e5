/* following.c - see following.h */
#include "signal/noise/following.h"
#include "num/select.h"
#include "num/sigmas.h"
#include "signal/noise/robust.h"
#include <math.h>
#include <string.h>

/* Share of the smallest differences whose mean is taken.  Pulses and impulses are among
 * the others; a mean, unlike a median, does not jump with the steps of a converter. */
static const double SHARE = 0.75;

/* That mean for white noise of variance 1: the mean modulus of the smallest three
 * quarters of normal deviates. */
static const double NORMAL = 0.51490;

double following_measure(const double *x, const unsigned char *hidden, size_t n)
{
	enum { FEWEST = 64 };
	double d[FOLLOWING_BLOCK], sum = 0;
	size_t count = 0, rank;

	for (size_t i = 0; i + 4 < n; i++)
		if (!(hidden && memchr(hidden + i, 1, 5)))
			d[count++] = fabs(fourth_difference(x + i));
	if (count < FEWEST || count < n / 2)
		return 0;
	rank = (size_t)(SHARE * (double)count);
	select_ranks(d, count, &rank, 1);
	for (size_t i = 0; i < rank; i++)
		sum += d[i];
	return sum / (double)rank / NORMAL;
}

/* What the noise is believed to be after two measures. */
static double believe(struct following *f, double now, double first, double second)
{
	double mean = 0.5 * (first + second), change = log(second / first), variance;

	if (!(first > 0) || !(second > 0))
		return now;
	/* Differences of successive blocks, so that slow changes do not count, nor,
	 * beyond three deviations, sudden ones. */
	change = fmin(fabs(change), SIGMAS_SELDOM * M_SQRT2 * f->error);
	f->error = sqrt((f->known * f->error * f->error + 0.5 * change * change) /
			(f->known + 1));
	f->known++;
	variance = 0.5 * f->error * f->error;
	if (fabs(log(mean / now)) < SIGMAS_RARELY * sqrt(variance + f->variance))
		return now;
	f->variance = variance;
	return mean;
}

double following_error(size_t n)
{
	return 1.46 / sqrt((double)n); /* tests/unit/following.c */
}

/* Blocks that the error counts for, which are as many as the noise was learned from. */
enum { PRIOR = 16 };

void following_start(struct following *f, long long begin, size_t block, double reference,
	double first, double second)
{
	*f = (struct following){ .block = block, .begin = begin, .reference = reference };
	f->error = following_error(block);
	f->known = PRIOR;
	f->variance = f->error * f->error / PRIOR;
	f->last = first / reference;
	f->node[0] = believe(f, 1, first / reference, second / reference);
}

void following_take(struct following *f, double *x, const unsigned char *hidden)
{
	double before = f->node[f->blocks % FOLLOWING_KEPT];
	double measure = following_measure(x, hidden, f->block) / f->reference;
	double after = believe(f, before, f->last, measure);

	f->last = measure;
	f->node[++f->blocks % FOLLOWING_KEPT] = after;
	for (size_t i = 0; i < f->block; i++)
		x[i] /= before + (after - before) * (double)i / (double)f->block;
}

double following_at(const struct following *f, double sample)
{
	double place, share, before, after;
	long long k,
		oldest = f->blocks >= FOLLOWING_KEPT ? f->blocks - FOLLOWING_KEPT + 1 : 0;

	if (f->block == 0)
		return 1;
	place = (sample - (double)f->begin) / (double)f->block;
	place = fmin(fmax(place, (double)oldest), (double)f->blocks);
	k = (long long)place;
	share = place - (double)k;
	before = f->node[k % FOLLOWING_KEPT];
	after = share > 0 ? f->node[(k + 1) % FOLLOWING_KEPT] : before;
	return before + (after - before) * share;
}
