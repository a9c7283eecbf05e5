/* noise_level.c - the noise of a record, compared with that of a kept instrument, and
 * with what is learned */
#include "num/sigmas.h"
#include "signal/noise/robust.h"
#include "signal/separate/separate_state.h"
#include <math.h>
#include <string.h>

/* Relative standard error of robust_noise() from n samples: that of a median
 * of independent deviates is 1.17 / sqrt(n); the correlations rho_k of fourth differences
 * (-0.8, 0.4, -0.11, 0.01) reduce n to n / (1 + 2 sum rho_k^2). */
static double level_error(double n)
{
	return 1.17 * sqrt(2.63 / n);
}

/* A change of chi-square by a quarter: with 1e-9 false alarms per sample, 25 times more
 * or fewer of them (the threshold of 33 becomes 26.4), and standard errors wrong by an
 * eighth. */
static const double TOLERANCE = 0.118;

/* 1 if either ratio of two levels, known from n1 and n2 samples, is not 1. */
static int differ(const double share[2], double n1, double n2)
{
	double margin = SIGMAS_NEVER * hypot(level_error(n1), level_error(n2));

	return !(fmax(fabs(log(share[0])), fabs(log(share[1]))) < TOLERANCE + margin);
}

/* The ratio of either sensor's channels that is farther from 1. */
static void shares(
	const double *level, const double *before, int channels, double share[2])
{
	share[0] = share[1] = 1;
	for (int c = 0; c < channels; c++) {
		double now = level[c] / before[c];

		if (before[c] > 0 && fabs(log(now)) > fabs(log(share[c % 2])))
			share[c % 2] = now;
	}
}

/* Notes the last level if it is above the first one, where noise would be taken for
 * pulses, and begins another.  Below it may be that of steps of the converter. */
static void compare_levels(struct separate *s)
{
	double share[2];

	shares(s->last_level, s->fitted, s->channels, share);
	share[0] = fmax(share[0], 1);
	share[1] = fmax(share[1], 1);
	if (s->last_levels > 0 && !s->changed &&
		differ(share, s->levels, s->last_levels)) {
		memcpy(s->change, share, sizeof share);
		s->changed = 1;
	}
	memset(s->last_level, 0, sizeof s->last_level);
	s->last_levels = 0;
}

/* Adds a block of n samples to the mean level of channel c, known from so many. */
static void add_level(const struct separate *s, int c, size_t n, int followed,
	double *level, double known)
{
	double work[FOLLOWING_BLOCK];
	const struct buffer *t = &s->buffer[c];
	size_t at = (size_t)(s->level_at - t->begin);
	double here = robust_noise(t->x + at, t->hidden + at, n, work);

	if (followed)
		here *= following_at(&t->noise, (double)s->level_at + 0.5 * (double)n);
	*level += (here - *level) * (double)n / (known + (double)n);
}

/* The first par.learn samples as they are, and as they are fitted, that is in units of
 * the noise that is followed; and as these the last par.learn ones. */
void separate_measure_level(struct separate *s)
{
	long long clean = s->buffer[0].clean;

	for (int c = 1; c < s->channels; c++)
		clean = s->buffer[c].clean < clean ? s->buffer[c].clean : clean;

	for (;;) {
		long long n = clean - s->level_at;
		int first = s->levels < (double)s->par.learn;

		/* The end of a whitened record is no noise. */
		if (n < (s->ended && first ? SEPARATE_SHORTEST : FOLLOWING_BLOCK)) {
			if (s->ended)
				compare_levels(s);
			return;
		}
		n = n < FOLLOWING_BLOCK ? n : FOLLOWING_BLOCK;
		if (s->last_levels >= (double)s->par.learn)
			compare_levels(s);
		for (int c = 0; c < s->channels; c++) {
			if (first)
				add_level(s, c, (size_t)n, 1, &s->level[c], s->levels);
			add_level(s, c, (size_t)n, 0,
				first ? &s->fitted[c] : &s->last_level[c],
				first ? s->levels : s->last_levels);
		}
		*(first ? &s->levels : &s->last_levels) += (double)n;
		s->level_at += n;
	}
}

void separate_noise(const struct separate *s, double share[2])
{
	if (s->changed)
		memcpy(share, s->change, sizeof s->change);
	else
		shares(s->level, s->kept.level, s->channels, share);
}

int separate_is_other_noise(const struct separate *s)
{
	double share[2];

	if (s->changed)
		return 1;
	shares(s->level, s->kept.level, s->channels, share);
	return s->par.kept && s->levels > 0 &&
	       differ(share, s->levels, s->kept.level_samples);
}
