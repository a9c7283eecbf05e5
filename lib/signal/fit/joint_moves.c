/* joint_moves.c - adding and removing single pulses, if chi-square justifies it; see
 * joint_state.h */
#include "signal/fit/joint_state.h"
#include <string.h>

/* Pulses whose support on either channel comes near that of pulse i. */
static int neighbours(const struct joint_scene *s, const struct joint_pulse *pulses,
	int m, int i, double reach, int *set)
{
	double near = reach * s->duration * 2 * shape_reach(s->shape);
	int count = 0;

	for (int k = 0; k < m; k++)
		if (fabs(pulses[k].t - pulses[i].t) < near ||
			fabs(pulses[k].t + pulses[k].delta - pulses[i].t -
				pulses[i].delta) < near)
			set[count++] = k;
	return count;
}

/* Energy, in units of chi-square, of the pulses that overlap pulse i. */
static double energy_near(
	const struct joint_scene *s, const struct joint_pulse *pulses, int m, int i)
{
	double sum = 0, unit = joint_energy(s);
	int set[JOINT_PULSES_MAX];
	int count = neighbours(s, pulses, m, i, 1, set);

	for (int k = 0; k < count; k++)
		if (set[k] != i)
			sum += pulses[set[k]].a * pulses[set[k]].a * unit;
	return sum;
}

/* Restores the pulses from before. */
static void restore(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, const struct joint_pulse *before, int old)
{
	for (int k = 0; k < *m; k++)
		joint_subtract(j, s, &pulses[k], -1);
	memcpy(pulses, before, sizeof(*pulses) * (size_t)old);
	*m = old;
	for (int k = 0; k < *m; k++)
		joint_subtract(j, s, &pulses[k], 1);
}

/* Decrease of chi-square that a pulse next to others of some energy must bring. */
static double threshold_beside(const struct joint_scene *s, double energy)
{
	return fmax(s->threshold_near, s->misfit * energy);
}

/* 1 if pulse i, the last one added, is worth a decrease of chi-square from before to
 * after. */
static int worth(const struct joint_scene *s, const struct joint_pulse *pulses, int m,
	int i, double before, double after)
{
	double energy = energy_near(s, pulses, m, i);
	double need = energy > 0 ? threshold_beside(s, energy) : s->threshold;

	return before - after > need;
}

/* Fits the pulses near pulse i of m, without the last one if it is only listed. */
static double fit_near(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int m, int i, int listed)
{
	int set[JOINT_PULSES_MAX], count = neighbours(s, pulses, m, i, 0.8, set);

	return joint_fit_set(j, s, pulses, set, count - listed, 30, 0.1);
}

/* Fits the pulse just added with those near it; 1 if it was worth it, otherwise
 * everything is restored from before. */
static int accept_more(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int i, const struct joint_pulse *before,
	double *chi2)
{
	double after = fit_near(j, s, pulses, *m, i, 0);

	if (worth(s, pulses, *m, *m - 1, *chi2, after)) {
		*chi2 = after;
		return 1;
	}
	restore(j, s, pulses, m, before, *m - 1);
	return 0;
}

int joint_try_pulse(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, const struct candidate *c, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX];
	int i = *m;

	memcpy(before, pulses, sizeof(*pulses) * (size_t)i);
	pulses[i] = (struct joint_pulse){ .t = c->t, .delta = c->delta, .a = c->a };
	joint_subtract(j, s, &pulses[i], 1);
	++*m;
	joint_fit_set(j, s, pulses, &i, 1, 8, 1);
	return accept_more(j, s, pulses, m, i, before, chi2);
}

/* Replaces pulse i by two; 1 if it was worth it, otherwise everything is as before. */
static int try_split(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int i, double shift, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX];
	int pair[2] = { i, *m }, old = *m;

	memcpy(before, pulses, sizeof(*pulses) * (size_t)old);
	joint_subtract(j, s, &pulses[i], -1);
	pulses[old] = pulses[i];
	pulses[i].a = pulses[old].a = pulses[i].a / 2;
	pulses[i].t -= shift;
	pulses[old].t += shift;
	joint_subtract(j, s, &pulses[i], 1);
	joint_subtract(j, s, &pulses[old], 1);
	++*m;
	joint_fit_set(j, s, pulses, pair, 2, 10, 1);
	return accept_more(j, s, pulses, m, i, before, chi2);
}

int joint_split_pulses(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, double *chi2)
{
	int split = 0;

	joint_project(j);
	for (int i = 0; i < *m && *m < s->max_pulses; i++) {
		double gap, half = 0.5 * pulses[i].a;
		double need = threshold_beside(
			s, energy_near(s, pulses, *m, i) + half * half * joint_energy(s));

		if (joint_factorise(j, s, pulses, &i, 1) != NUM_OK)
			continue;
		joint_pair_start(j, s, pulses, i, &i, 1);
		/* A fit with shares and gaps of their own was worth up to 1.6 times as
		 * much as that of the table. */
		if (2 * joint_pair_best(j, &gap) < 0.5 * need)
			continue;
		split += try_split(j, s, pulses, m, i, gap * s->duration / 2, chi2);
		joint_project(j);
	}
	return split;
}

/* Squared amplitude of a pulse in units of its variance; if the matrix is singular, as it
 * is with too many pulses, in units of that of an isolated pulse. */
static double significance(const struct joint_scene *s, const struct joint_pulse *p)
{
	return isfinite(p->cov[5]) ? p->a * p->a / p->cov[5]
				   : p->a * p->a * joint_energy(s);
}

/* Forgets, of the last pulses that are left without pulse k of those before, exchanges
 * with it: it is the one that arrives at sensor 2 where they would. */
static void forget_exchanges(
	struct joint_pulse *pulses, int last, int k, const struct joint_pulse *before)
{
	for (int i = 0; i < last; i++) {
		const struct joint_pulse *was = &before[i + (i >= k)];
		double at = was->t + was->other_delta, gone, other = INFINITY;

		if (!(was->exchange > 0))
			continue;
		gone = fabs(before[k].t + before[k].delta - at);
		for (int x = 0; x <= last; x++)
			if (x != k && &before[x] != was)
				other = fmin(
					other, fabs(before[x].t + before[x].delta - at));
		if (gone < other)
			pulses[i].exchange = 0;
	}
}

/* Removes pulse k, which is no longer subtracted, from the list and fits those near it; 1
 * if it is not needed, otherwise everything is restored from before. */
static int accept_fewer(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int k, const struct joint_pulse *before,
	double *chi2)
{
	int last = --*m;
	double after;

	for (int i = k; i < last; i++)
		pulses[i] = pulses[i + 1];
	pulses[last] = before[k]; /* for neighbours() and worth() only */
	after = fit_near(j, s, pulses, last + 1, last, 1);
	if (worth(s, pulses, last + 1, last, after, *chi2)) {
		restore(j, s, pulses, m, before, last + 1);
		return 0;
	}
	forget_exchanges(pulses, last, k, before);
	*chi2 = after;
	return 1;
}

/* Removes pulse i if it is not needed. */
static int try_without(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int i, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX];

	memcpy(before, pulses, sizeof(*pulses) * (size_t)*m);
	joint_subtract(j, s, &pulses[i], -1);
	return accept_fewer(j, s, pulses, m, i, before, chi2);
}

/* Replaces pulses i and k by one if that is enough. */
static int try_merge(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, int i, int k, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX];
	double part = pulses[k].a / (pulses[i].a + pulses[k].a);

	memcpy(before, pulses, sizeof(*pulses) * (size_t)*m);
	joint_subtract(j, s, &pulses[i], -1);
	joint_subtract(j, s, &pulses[k], -1);
	pulses[i].a += pulses[k].a;
	pulses[i].t += part * (pulses[k].t - pulses[i].t);
	pulses[i].delta += part * (pulses[k].delta - pulses[i].delta);
	joint_subtract(j, s, &pulses[i], 1);
	return accept_fewer(j, s, pulses, m, k, before, chi2);
}

/* 1 if the arrivals of pulses p and q at sensor 2 can be exchanged; fills their delays
 * then. */
static int can_swap(const struct joint_scene *s, const struct joint_pulse *p,
	const struct joint_pulse *q, double delta[2])
{
	delta[0] = q->t + q->delta - p->t;
	delta[1] = p->t + p->delta - q->t;
	return fmin(delta[0], delta[1]) >= s->delta_min &&
	       fmax(delta[0], delta[1]) <= s->delta_max;
}

/* Keeps the fit with exchanged arrivals p, q as another one of i, k if it is the most
 * likely one.  Where the delay of i is nearer to its own than to the exchanged one, under
 * either name, nothing has been exchanged. */
static void keep_exchange(struct joint_pulse *i, const struct joint_pulse *k,
	const struct joint_pulse *p, const struct joint_pulse *q, double ratio)
{
	const struct joint_pulse *same = (i->t < k->t) == (p->t < q->t) ? p : q;
	double apart = fabs(k->t + k->delta - i->t - i->delta);

	if (ratio <= i->exchange || fabs(same->delta - i->delta) < 0.5 * apart)
		return;
	i->exchange = ratio;
	i->other_delta = same->delta;
	i->more_square = p->delta * p->delta + q->delta * q->delta - i->delta * i->delta -
			 k->delta * k->delta;
}

void joint_swap_pulses(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int m, double *chi2)
{
	struct joint_pulse before[JOINT_PULSES_MAX], other[2];
	double delta[2], after, ratio;

	for (int i = 0; i < m; i++)
		pulses[i].exchange = 0;
	for (int i = 0; i < m; i++)
		for (int k = i + 1; k < m; k++) {
			if (!can_swap(s, &pulses[i], &pulses[k], delta))
				continue;
			memcpy(before, pulses, sizeof(*pulses) * (size_t)m);
			joint_subtract(j, s, &pulses[i], -1);
			joint_subtract(j, s, &pulses[k], -1);
			pulses[i].delta = delta[0];
			pulses[k].delta = delta[1];
			joint_subtract(j, s, &pulses[i], 1);
			joint_subtract(j, s, &pulses[k], 1);
			after = fit_near(j, s, pulses, m, i, 0);
			ratio = exp(-0.5 * fabs(after - *chi2));
			other[0] = after < *chi2 ? before[i] : pulses[i];
			other[1] = after < *chi2 ? before[k] : pulses[k];
			if (after < *chi2)
				*chi2 = after;
			else
				restore(j, s, pulses, &m, before, m);
			keep_exchange(
				&pulses[i], &pulses[k], &other[0], &other[1], ratio);
			keep_exchange(
				&pulses[k], &pulses[i], &other[1], &other[0], ratio);
		}
}

void joint_merge_pulses(struct joint *j, const struct joint_scene *s,
	struct joint_pulse *pulses, int *m, double *chi2)
{
	double near = 0.12 * s->duration;

	for (int i = 0; i < *m; i++)
		for (int k = i + 1; k < *m; k++)
			if (fabs(pulses[k].t - pulses[i].t) < near &&
				pulses[k].a * pulses[i].a > 0 &&
				try_merge(j, s, pulses, m, i, k, chi2))
				k = i;
}

void joint_prune(struct joint *j, const struct joint_scene *s, struct joint_pulse *pulses,
	int *m, double *chi2)
{
	enum { TRIES = 4 };
	int needed[TRIES], tries = 0;

	while (*m > 1 && tries < TRIES) {
		double least = 6 * s->threshold;
		int worst = -1;

		joint_fill_covariance(j, s, pulses, *m);
		for (int i = 0; i < *m; i++) {
			int tried = 0;

			for (int k = 0; k < tries; k++)
				tried |= needed[k] == i;
			if (!tried && significance(s, &pulses[i]) < least) {
				least = significance(s, &pulses[i]);
				worst = i;
			}
		}
		if (worst < 0)
			break;
		if (try_without(j, s, pulses, m, worst, chi2))
			tries = 0;
		else
			needed[tries++] = worst;
	}
}
