/* noise_level.c - the noise of a record, compared with that of a kept instrument */
#include "num/sigmas.h"
#include "signal/noise/robust.h"
#include "signal/separate/separate_state.h"
#include <math.h>

void separate_measure_level(struct separate *s)
{
	double work[FOLLOWING_BLOCK];
	long long clean = s->buffer[0].clean;

	for (int c = 1; c < s->channels; c++)
		clean = s->buffer[c].clean < clean ? s->buffer[c].clean : clean;

	while (s->levels < (double)s->par.learn) {
		long long n = clean - s->level_at;

		if (n < (s->ended ? SEPARATE_SHORTEST : FOLLOWING_BLOCK))
			return;
		n = n < FOLLOWING_BLOCK ? n : FOLLOWING_BLOCK;
		for (int c = 0; c < s->channels; c++) {
			const struct buffer *t = &s->buffer[c];
			size_t at = (size_t)(s->level_at - t->begin);
			double level =
				robust_noise(t->x + at, t->hidden + at, (size_t)n, work);

			level *= following_at(
				&t->noise, (double)s->level_at + 0.5 * (double)n);

			s->level[c] += (level - s->level[c]) * (double)n /
				       (s->levels + (double)n);
		}
		s->levels += (double)n;
		s->level_at += n;
	}
	s->level_at = clean;
}

/* Relative standard error of robust_noise() from n samples: that of a median
 * of independent deviates is 1.17 / sqrt(n); the correlations rho_k of fourth differences
 * (-0.8, 0.4, -0.11, 0.01) reduce n to n / (1 + 2 sum rho_k^2). */
static double level_error(double n)
{
	return 1.17 * sqrt(2.63 / n);
}

void separate_noise(const struct separate *s, double share[2])
{
	share[0] = share[1] = 1;
	for (int c = 0; c < s->channels; c++) {
		double now = s->level[c] / s->kept.level[c];

		if (s->kept.level[c] > 0 && fabs(log(now)) > fabs(log(share[c % 2])))
			share[c % 2] = now;
	}
}

int separate_is_other_noise(const struct separate *s)
{
	/* A change of chi-square by a quarter: with 1e-9 false alarms per sample, 25
	 * times more or fewer of them (the threshold of 33 becomes 26.4), and standard
	 * errors wrong by an eighth. */
	static const double tolerance = 0.118;
	double share[2], margin;

	if (!(s->levels > 0))
		return 0;
	margin = SIGMAS_NEVER *
		 hypot(level_error(s->levels), level_error(s->kept.level_samples));
	separate_noise(s, share);
	return !(fmax(fabs(log(share[0])), fabs(log(share[1]))) < tolerance + margin);
}
