/* joint_moves.c - adding and removing single pulses, if chi-square justifies it; see
 * joint_state.h */
#include "signal/fit/joint_state.h"
#include <string.h>

/* Pulses whose support on either channel comes near that of pulse i. */
static int neighbours(const struct joint *j, int i, double reach, int *set)
{
	const struct joint_pulse *p = j->pulse;
	double near = reach * j->scene.duration * 2 * shape_reach(j->scene.shape);
	int count = 0;

	for (int k = 0; k < j->m; k++)
		if (fabs(p[k].t - p[i].t) < near ||
			fabs(p[k].t + p[k].delta - p[i].t - p[i].delta) < near)
			set[count++] = k;
	return count;
}

/* Energy, in units of chi-square, of the pulses that overlap pulse i. */
static double energy_near(const struct joint *j, int i)
{
	double sum = 0, unit = joint_energy(&j->scene);
	int set[JOINT_PULSES_MAX], count = neighbours(j, i, 1, set);

	for (int k = 0; k < count; k++)
		if (set[k] != i)
			sum += j->pulse[set[k]].a * j->pulse[set[k]].a * unit;
	return sum;
}

/* The pulses before a move, for restore(). */
static void remember(struct joint *j)
{
	j->m_before = j->m;
	memcpy(j->before, j->pulse, sizeof(*j->pulse) * (size_t)j->m);
}

static void restore(struct joint *j)
{
	joint_subtract_all(j, -1);
	j->m = j->m_before;
	memcpy(j->pulse, j->before, sizeof(*j->pulse) * (size_t)j->m);
	joint_subtract_all(j, 1);
}

/* Decrease of chi-square that a pulse next to others of some energy must bring. */
static double threshold_beside(const struct joint *j, double energy)
{
	return fmax(j->scene.threshold_near, j->scene.misfit * energy);
}

/* 1 if the last pulse is worth a decrease of chi-square from before to after. */
static int worth(const struct joint *j, double before, double after)
{
	double energy = energy_near(j, j->m - 1);
	double need = energy > 0 ? threshold_beside(j, energy) : j->scene.threshold;

	return before - after > need;
}

/* Fits the pulses near pulse i, without the last one if it is only listed. */
static double fit_near(struct joint *j, int i, int listed)
{
	int set[JOINT_PULSES_MAX], count = neighbours(j, i, 0.8, set);

	return joint_fit_set(j, set, count - listed, 30, 0.1);
}

/* Fits the pulse just added with those near pulse i; 1 if it was worth it, otherwise
 * everything is as before. */
static int accept_more(struct joint *j, int i)
{
	double after = fit_near(j, i, 0);

	if (worth(j, j->result.chi2, after)) {
		j->result.chi2 = after;
		return 1;
	}
	restore(j);
	return 0;
}

int joint_try_pulse(struct joint *j, const struct candidate *c)
{
	int i = j->m;

	remember(j);
	j->pulse[j->m++] =
		(struct joint_pulse){ .t = c->t, .delta = c->delta, .a = c->a };
	joint_subtract(j, &j->pulse[i], 1);
	joint_fit_set(j, &i, 1, 8, 1);
	return accept_more(j, i);
}

/* Replaces pulse i by two; 1 if it was worth it, otherwise everything is as before. */
static int try_split(struct joint *j, int i, double shift)
{
	int pair[2] = { i, j->m };
	struct joint_pulse *one = &j->pulse[i], *other = &j->pulse[j->m];

	remember(j);
	joint_subtract(j, one, -1);
	one->a /= 2;
	*other = *one;
	one->t -= shift;
	other->t += shift;
	joint_subtract(j, one, 1);
	joint_subtract(j, other, 1);
	j->m++;
	joint_fit_set(j, pair, 2, 10, 1);
	return accept_more(j, i);
}

int joint_split_pulses(struct joint *j)
{
	int split = 0;

	joint_project(j);
	for (int i = 0; i < j->m && j->m < j->scene.max_pulses; i++) {
		double gap, half = 0.5 * j->pulse[i].a;
		double need = threshold_beside(
			j, energy_near(j, i) + half * half * joint_energy(&j->scene));

		if (joint_factorise(j, &i, 1) != NUM_OK)
			continue;
		joint_pair_start(j, i, &i, 1);
		/* A fit with shares and gaps of their own was worth up to 1.6 times as
		 * much as that of the table. */
		if (2 * joint_pair_best(j, &gap) < 0.5 * need)
			continue;
		split += try_split(j, i, gap * j->scene.duration / 2);
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

/* Forgets, of the pulses that are left without the kth, exchanges with it. */
static void forget_exchanges(struct joint *j, int k)
{
	for (int i = 0; i < j->m; i++) {
		struct joint_pulse *p = &j->pulse[i];

		if (p->partner == k)
			p->exchange = 0;
		p->partner -= p->partner > k;
	}
}

/* Removes pulse k, which is no longer subtracted, from the list and fits those near it; 1
 * if it is not needed, otherwise everything is as before. */
static int accept_fewer(struct joint *j, int k)
{
	int last = j->m - 1, needed;
	double after;

	for (int i = k; i < last; i++)
		j->pulse[i] = j->pulse[i + 1];
	j->pulse[last] = j->before[k]; /* for neighbours() and worth() only */
	after = fit_near(j, last, 1);
	needed = worth(j, after, j->result.chi2);
	j->m = last;
	if (needed) {
		restore(j);
		return 0;
	}
	forget_exchanges(j, k);
	j->result.chi2 = after;
	return 1;
}

/* Removes pulse i if it is not needed. */
static int try_without(struct joint *j, int i)
{
	remember(j);
	joint_subtract(j, &j->pulse[i], -1);
	return accept_fewer(j, i);
}

/* Replaces pulses i and k by one if that is enough. */
static int try_merge(struct joint *j, int i, int k)
{
	struct joint_pulse *one = &j->pulse[i], *other = &j->pulse[k];
	double part = other->a / (one->a + other->a);

	remember(j);
	joint_subtract(j, one, -1);
	joint_subtract(j, other, -1);
	one->a += other->a;
	one->t += part * (other->t - one->t);
	one->delta += part * (other->delta - one->delta);
	joint_subtract(j, one, 1);
	return accept_fewer(j, k);
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
static void keep_exchange(const struct joint *j, struct joint_pulse *i,
	const struct joint_pulse *k, const struct joint_pulse *p,
	const struct joint_pulse *q, double ratio)
{
	const struct joint_pulse *same = (i->t < k->t) == (p->t < q->t) ? p : q;
	double apart = fabs(k->t + k->delta - i->t - i->delta);

	if (ratio <= i->exchange || fabs(same->delta - i->delta) < 0.5 * apart)
		return;
	i->exchange = ratio;
	i->partner = (int)(k - j->pulse);
	i->kept_t = i->t;
	i->kept_delta = i->delta;
	i->other_delta = same->delta;
	i->more_square = p->delta * p->delta + q->delta * q->delta - i->delta * i->delta -
			 k->delta * k->delta;
}

/* Exchanges arrivals of two pulses if that reduces chi-square. */
static void try_swap(struct joint *j, int i, int k)
{
	struct joint_pulse *p = &j->pulse[i], *q = &j->pulse[k], other[2];
	double delta[2], after, ratio;

	if (!can_swap(&j->scene, p, q, delta))
		return;
	remember(j);
	joint_subtract(j, p, -1);
	joint_subtract(j, q, -1);
	p->delta = delta[0];
	q->delta = delta[1];
	joint_subtract(j, p, 1);
	joint_subtract(j, q, 1);
	after = fit_near(j, i, 0);
	ratio = exp(-0.5 * fabs(after - j->result.chi2));
	other[0] = after < j->result.chi2 ? j->before[i] : *p;
	other[1] = after < j->result.chi2 ? j->before[k] : *q;
	if (after < j->result.chi2)
		j->result.chi2 = after;
	else
		restore(j);
	keep_exchange(j, p, q, &other[0], &other[1], ratio);
	keep_exchange(j, q, p, &other[1], &other[0], ratio);
}

void joint_forget_moved(struct joint *j)
{
	const double same = SHAPE_FINEST * j->scene.duration;

	for (int i = 0; i < j->m; i++) {
		struct joint_pulse *p = &j->pulse[i];

		if (fabs(p->t - p->kept_t) > same ||
			fabs(p->delta - p->kept_delta) > same)
			p->exchange = 0;
	}
}

void joint_swap_pulses(struct joint *j)
{
	for (int i = 0; i < j->m; i++)
		for (int k = i + 1; k < j->m; k++)
			try_swap(j, i, k);
}

void joint_merge_pulses(struct joint *j)
{
	double near = 0.12 * j->scene.duration;
	const struct joint_pulse *p = j->pulse;

	for (int i = 0; i < j->m; i++)
		for (int k = i + 1; k < j->m; k++)
			if (fabs(p[k].t - p[i].t) < near && p[k].a * p[i].a > 0 &&
				try_merge(j, i, k))
				k = i;
}

void joint_prune(struct joint *j)
{
	enum { TRIES = 4 };
	int needed[TRIES], tries = 0;

	while (j->m > 1 && tries < TRIES) {
		double least = 6 * j->scene.threshold;
		int worst = -1;

		joint_fill_covariance(j);
		for (int i = 0; i < j->m; i++) {
			double here = significance(&j->scene, &j->pulse[i]);
			int tried = 0;

			for (int k = 0; k < tries; k++)
				tried |= needed[k] == i;
			if (!tried && here < least) {
				least = here;
				worst = i;
			}
		}
		if (worst < 0)
			break;
		if (try_without(j, worst))
			tries = 0;
		else
			needed[tries++] = worst;
	}
}
