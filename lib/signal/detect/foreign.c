/* foreign.c - see foreign.h */
#include "signal/detect/foreign.h"
#include "num/dot.h"
#include "num/sigmas.h"
#include "signal/detect/spikes.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Particles would leave more than this share of the energy of a stretch: one has its
 * pulses at the sensors at different times, so that a waveform that both have at once
 * describes none of it, and half of it lies in either lobe and at either sensor. */
static const double WRONG = 0.1;

/* Level at one sensor over that at the other below which the weaker is none: coils and
 * amplifiers are built alike. */
static const double WEAKER = 0.1;

/* What chi-square may exceed its mean by. */
static double slack_of(double dof)
{
	return CHI_SQUARE_MORE * dof + SIGMAS_NEVER * sqrt(2 * dof);
}

/* 1 if rest is no more than noise of so many degrees of freedom, and by that only a small
 * share of the energy. */
static int is_noise(double rest, double dof, double energy)
{
	double slack = slack_of(dof);

	return dof > 0 && rest < dof + slack && rest - dof + slack < WRONG * energy;
}

static int is_hidden(const struct foreign_stretch *s, int c, size_t i)
{
	return s->hidden[c] && s->hidden[c][i];
}

static double square_sum(
	const struct foreign_stretch *s, int c, size_t from, size_t to, double *count)
{
	double sum = 0;

	for (size_t i = from; i < to; i++)
		if (!is_hidden(s, c, i)) {
			sum += s->y[c][i] * s->y[c][i];
			++*count;
		}
	return sum;
}

/* Both channels as one waveform at two levels: the principal axis of the pairs of their
 * values. */
struct axis {
	double s11, s12, s22, count;
	double along[2]; /* levels, of norm 1, that of the first channel positive */
	double rest;     /* sum of squares across it */
};

static void add_pair(struct axis *a, double y1, double y2)
{
	a->s11 += y1 * y1;
	a->s12 += y1 * y2;
	a->s22 += y2 * y2;
	a->count++;
}

static void find_axis(struct axis *a)
{
	double half = 0.5 * (a->s11 - a->s22), angle = 0.5 * atan2(a->s12, half);

	a->along[0] = cos(angle);
	a->along[1] = sin(angle);
	a->rest = fmax(0.5 * (a->s11 + a->s22) - hypot(half, a->s12), 0);
}

static int is_common(const struct axis *a)
{
	return fabs(a->along[1]) > WEAKER * a->along[0] &&
	       a->along[0] > WEAKER * fabs(a->along[1]);
}

/* Place of the largest value of x[0 .. n). */
static size_t highest(const double *x, size_t n)
{
	size_t at = 0;

	for (size_t i = 1; i < n; i++)
		if (fabs(x[i]) > fabs(x[at]))
			at = i;
	return at;
}

/* At the same time y[0] is y[1] shift samples before.  The first shift samples of y[0]
 * and the last of y[1] have none to compare with, and must be noise. */
static void find_shock(
	const struct foreign_stretch *s, size_t shift, double energy, struct foreign *out)
{
	size_t n = s->n;
	struct axis a = { .count = 0 };
	double alone = 0, rest = 0, top = 0, dof;

	if (shift >= n)
		return;
	rest = square_sum(s, 0, 0, shift, &alone) +
	       square_sum(s, 1, n - shift, n, &alone);
	for (size_t i = shift; i < n; i++)
		if (!is_hidden(s, 0, i) && !is_hidden(s, 1, i - shift))
			add_pair(&a, s->y[0][i], s->y[1][i - shift]);
	find_axis(&a);
	rest += a.rest;
	dof = (1 - s->lost) * (a.count + alone);
	if (!is_noise(rest, dof, energy) || !is_common(&a))
		return;
	out->verdict = SEPARATE_SHOCK;
	out->chi2 = rest / dof;
	for (size_t i = 0; i < n - shift; i++) {
		double y = a.along[0] * s->y[0][i + shift] + a.along[1] * s->y[1][i];

		if (i > 0 && fabs(y) <= fabs(top))
			continue;
		top = y;
		out->t[1] = (double)i;
	}
	out->t[0] = out->t[1] + (double)shift;
	out->amplitude = a.along[0] * top;
}

/* All of it at one sensor. */
static void find_transient(
	const struct foreign_stretch *s, double energy, struct foreign *out)
{
	for (int c = 0; c < 2; c++) {
		double count = 0, rest = square_sum(s, !c, 0, s->n, &count);
		double dof = (1 - s->lost) * count;

		if (!is_noise(rest, dof, energy))
			continue;
		out->verdict = SEPARATE_TRANSIENT;
		out->chi2 = rest / dof;
		out->t[c] = (double)highest(s->y[c], s->n);
		out->t[!c] = NAN;
		out->amplitude = s->y[c][(size_t)out->t[c]];
	}
}

/* y at i + part, 0 <= part < 1, by the cubic through four samples; variance: that of its
 * noise. */
static double between(const double *y, double part, double *variance)
{
	double w[4] = { -part * (part - 1) * (part - 2) / 6,
		(part + 1) * (part - 1) * (part - 2) / 2,
		-(part + 1) * part * (part - 2) / 2, (part + 1) * part * (part - 1) / 6 };
	double sum = 0;

	*variance = 0;
	for (int k = 0; k < 4; k++) {
		sum += w[k] * y[k - 1];
		*variance += w[k] * w[k];
	}
	return sum;
}

/* What y[0][i] has beside it in y[1], with a delay; 0: nothing, or, if all must be known,
 * samples that are not. */
static int second_at(
	const struct foreign_stretch *s, double delay, size_t i, int known, double *y2)
{
	long k = (long)i + (long)floor(delay);
	double part = delay - floor(delay), variance;

	if (k < 1 || k + 2 >= (long)s->n)
		return 0;
	if (known && (is_hidden(s, 0, i) ||
			     (s->hidden[1] && memchr(s->hidden[1] + k - 1, 1, 4))))
		return 0;
	*y2 = s->y[1][k];
	if (part > 0)
		*y2 = between(s->y[1] + k, part, &variance) / sqrt(variance);
	return 1;
}

static struct axis compare(const struct foreign_stretch *s, double delay)
{
	struct axis a = { .count = 0 };
	double y2;

	for (size_t i = 0; i < s->n; i++)
		if (second_at(s, delay, i, 1, &y2))
			add_pair(&a, s->y[0][i], y2);
	find_axis(&a);
	return a;
}

/* A run of values that have been replaced by their mean. */
struct block {
	double sum, count;
};

/* Least squares of the rising sequence through the first i values, for each i, in
 * error[0 .. n] (pool adjacent violators; Barlow et al., Statistical Inference under
 * Order Restrictions, 1972).  step -1: from the last value on. */
static void rising_errors(
	const double *x, size_t n, int step, struct block *block, double *error)
{
	size_t blocks = 0;
	double explained = 0, total = 0;

	error[0] = 0;
	for (size_t i = 0; i < n; i++) {
		double value = step > 0 ? x[i] : x[n - 1 - i];
		struct block last = { value, 1 };

		total += value * value;
		while (blocks > 0 && block[blocks - 1].sum * last.count >=
					     last.sum * block[blocks - 1].count) {
			struct block *before = &block[--blocks];

			explained -= before->sum * before->sum / before->count;
			last.sum += before->sum;
			last.count += before->count;
		}
		explained += last.sum * last.sum / last.count;
		block[blocks++] = last;
		error[i + 1] = total - explained;
	}
}

/* Least squares of a waveform that rises to one place and falls from there on. */
static enum num_status one_lobe(const double *x, size_t n, double *least)
{
	struct block *block = malloc((n + 1) * sizeof *block);
	double *error = malloc(2 * (n + 1) * sizeof *error);

	if (block && error) {
		double *after = error + n + 1;

		rising_errors(x, n, 1, block, error);
		rising_errors(x, n, -1, block, after);
		*least = INFINITY;
		for (size_t i = 0; i <= n; i++)
			*least = fmin(*least, error[i] + after[n - i]);
	}
	free(error);
	free(block);
	return block && error ? NUM_OK : NUM_MEMORY;
}

static enum num_status find_bubble(const struct foreign_stretch *s, double delta_min,
	double delta_max, double energy, struct foreign *out)
{
	struct axis a, best = { .rest = INFINITY };
	double delay = 0, lobe = INFINITY, dof, sum = 0, square = 0, middle = 0, y2;
	double *wave;
	size_t n = 0;
	enum num_status status;

	for (double d = ceil(delta_min); d <= delta_max; d++) {
		a = compare(s, d);
		if (a.rest < best.rest) {
			best = a;
			delay = d;
		}
	}
	for (double step = 0.5; step > 0.05; step /= 2)
		for (int side = -1; side <= 1; side += 2) {
			a = compare(s, delay + side * step);
			if (a.rest / a.count < best.rest / best.count) {
				best = a;
				delay += side * step;
			}
		}
	if (!is_noise(best.rest, (1 - s->lost) * best.count, energy) ||
		!is_common(&best) || best.along[1] < 0)
		return NUM_OK;
	wave = malloc(s->n * sizeof *wave);
	if (!wave)
		return NUM_MEMORY;
	/* The lobes of a particle are lobes where the converter limits them, too. */
	for (size_t i = 0; i < s->n; i++)
		if (second_at(s, delay, i, 0, &y2)) {
			double y = best.along[0] * s->y[0][i] + best.along[1] * y2;

			middle += (double)i * y * y;
			square += y * y;
			sum += y;
			wave[n++] = y;
		}
	if (sum < 0)
		negate(wave, n);
	status = one_lobe(wave, n, &lobe);
	dof = (1 - s->lost) * 2 * best.count;
	if (status == NUM_OK && is_noise(best.rest + lobe, dof, energy))
		*out = (struct foreign){ SEPARATE_BUBBLE,
			{ middle / square, middle / square + delay },
			best.along[0] * wave[highest(wave, n)] * (sum < 0 ? -1 : 1),
			(best.rest + lobe) / dof };
	free(wave);
	return status;
}

static const struct foreign none = { SEPARATE_MISFIT, { NAN, NAN }, NAN, NAN };

/* The largest impulse; *rest: sum of squares without impulses, of *count values. */
static enum num_status find_impulse(
	const struct foreign_stretch *s, double *rest, double *count, struct foreign *out)
{
	unsigned char *flags = malloc(s->n ? s->n : 1);
	double height[2] = { 0, 0 };

	*rest = *count = 0;
	for (int c = 0; flags && c < 2; c++) {
		spikes_find(s->y[c], s->n, s->duration, flags);
		for (size_t i = 0; i < s->n; i++) {
			double y = s->y[c][i];

			if (is_hidden(s, c, i))
				continue;
			if (!flags[i]) {
				*rest += y * y;
				++*count;
			} else if (fabs(y) > fabs(height[c])) {
				height[c] = y;
				out->t[c] = (double)i;
				out->verdict = SEPARATE_IMPULSE;
			}
		}
	}
	free(flags);
	out->amplitude = height[0] != 0 ? height[0] : height[1];
	out->chi2 = *rest / ((1 - s->lost) * *count);
	return flags ? NUM_OK : NUM_MEMORY;
}

/* Sum of squares of both channels less that of noise. */
static double energy_of(const struct foreign_stretch *s)
{
	double count = 0, sum = square_sum(s, 0, 0, s->n, &count);

	sum += square_sum(s, 1, 0, s->n, &count);
	return sum - (1 - s->lost) * count;
}

void foreign_at_once(const struct foreign_stretch *s, struct foreign *out)
{
	*out = none;
	find_shock(s, 0, energy_of(s), out);
}

enum num_status foreign_find(const struct foreign_stretch *s, double delta_min,
	double delta_max, struct foreign *out)
{
	double energy = energy_of(s), rest = 0, count = 0;
	struct foreign impulse = none;

	*out = none;
	if (find_impulse(s, &rest, &count, &impulse) != NUM_OK)
		return NUM_MEMORY;
	if (s->shift > 0)
		find_shock(s, s->shift, energy, out);
	if (out->verdict == SEPARATE_MISFIT)
		find_transient(s, energy, out);
	/* A weak particle beside it would be no more than noise either. */
	count *= 1 - s->lost;
	if (impulse.verdict != SEPARATE_MISFIT &&
		(is_noise(rest, count, energy) ||
			(out->verdict != SEPARATE_MISFIT &&
				rest < count + slack_of(count))))
		*out = impulse;
	return out->verdict == SEPARATE_MISFIT
		       ? find_bubble(s, delta_min, delta_max, energy, out)
		       : NUM_OK;
}
