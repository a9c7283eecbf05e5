/* loads.c - covariates that scale the rates of a bank, see bank.h and bank_state.h
 *
 * They are states of the trends beside h and v.
 */
#include "life/trend/bank_state.h"
#include <string.h>

/* Standard deviation of the effect of a covariate at its largest distance from the first
 * value, as a share of the rate: see "Single constants" in doc/trends.md. */
static const double EFFECT = 1;

static double effect(const struct load *l, double x)
{
	return (x - l->origin) / l->unit;
}

/* Extends the integrals over f, which has its last value from one time to another. */
static void extend(struct load *l, double from, double to)
{
	double gap = to - from, one = l->whole, two = one + l->last * gap;

	l->sum += l->last * gap;
	l->whole = two;
	l->squares += l->last * l->last * gap;
	l->bridge += (one * one + one * two + two * two) * gap / 3;
	l->product += (2 * one * from + 2 * two * to + one * to + two * from) * gap / 6;
}

/* z coth z - 1; below 1e-2 the leading term, here and in learn(), is right to 1e-5. */
static double z_coth_z_less_1(double z)
{
	return z < 1e-2 ? z * z / 3 : z / tanh(z) - 1;
}

/* A covariate is taken for an Ornstein-Uhlenbeck process, df = -pull (f - mean) dt + dW,
 * of which wander is the variance of W per unit of time.  Over the age T, with z = pull
 * T, let s^2 be the variance of f about its mean so far, and let B be the integral of f
 * less this mean.  In the cosines of n pi t / T, whose variances are as 1 / (z^2 + n^2
 * pi^2), the expectations are
 *	s^2 = wander T (z coth z - 1) / (2 z^2),
 *	mean of B^2 over s^2 T^2 = 1 / (3 (z coth z - 1)) - 1 / z^2,
 * which falls from 1/15 at z = 0, a random walk, to 1 / (3 z).  A load that alternates is
 * pulled at once, and one that only rises has no pull. */
static void learn(struct load *l, double age)
{
	double mean = l->whole / age, square = l->squares / age - mean * mean,
	       bridge = l->bridge / age - 2 * mean * l->product / age +
			mean * mean * age * age / 3,
	       ratio, low = 0, high = 1e6; /* of z: pulled at once */

	l->pull = l->wander = 0;
	if (!(square > 1e-12 * l->squares / age))
		return;
	ratio = bridge / (square * age * age);
	for (int i = 0; i < 60; i++) {
		double z = 0.5 * (low + high),
		       expected = z < 1e-2 ? 1. / 15
					   : 1 / (3 * z_coth_z_less_1(z)) - 1 / (z * z);

		if (expected > ratio)
			low = z;
		else
			high = z;
	}
	low = fmax(low, 1e-2);
	l->pull = low / age;
	l->wander = 2 * square * low * low / (age * z_coth_z_less_1(low));
}

void bank_load(struct bank *b, double t, const double *x)
{
	for (int k = 0; k < b->par.n_loads; k++) {
		struct load *l = &b->load[k];
		double far;

		if (!b->loaded)
			*l = (struct load){ .origin = x[k], .unit = 1 };
		far = fabs(x[k] - l->origin);
		if (l->most == 0 && far > 0)
			l->unit = far;
		l->most = fmax(l->most, far / l->unit);
		l->last = effect(l, x[k]);
		if (b->loaded) {
			extend(l, b->loaded_to - b->loaded_from, t - b->loaded_from);
			if (b->par.load[k].future == BANK_PAST)
				learn(l, t - b->loaded_from);
		}
	}
	if (!b->loaded)
		b->loaded_from = t;
	b->loaded = 1;
	b->loaded_to = t;
}

void mean_loads(const struct bank *b, double f[RATES])
{
	double span = b->loaded_to - b->loaded_from - b->idle;

	f[0] = 1;
	for (int k = 0; k < b->par.n_loads; k++)
		f[1 + k] = b->load[k].sum / span;
}

/* The mean ahead and its variance, under the condition of the last value and of the mean
 * so far, whose variance is the wander over pull^2 T. */
static void foresee(
	const struct load *l, double age, double ahead, double *mean, double *variance)
{
	double a = l->pull * ahead, kept, stays;

	if (!(l->wander > 0))
		return;
	kept = -expm1(-a) / a;
	stays = a < 1e-2 ? 2 * a / 3 : 2 / a - (3 - 4 * exp(-a) + exp(-2 * a)) / (a * a);
	*mean += kept * (l->last - *mean);
	*variance = l->wander / l->pull *
		    (stays / 2 + (1 - kept) * (1 - kept) / (l->pull * age));
}

void future_loads(
	const struct bank *b, double ahead, double f[RATES], double variance[RATES])
{
	mean_loads(b, f);
	memset(variance, 0, RATES * sizeof *variance);
	for (int k = 0; k < b->par.n_loads; k++) {
		const struct bank_covariate *c = &b->par.load[k];
		const struct load *l = &b->load[k];

		if (c->future == BANK_PAST)
			foresee(l, b->loaded_to - b->loaded_from, ahead, &f[1 + k],
				&variance[1 + k]);
		else if (c->future == BANK_LAST)
			f[1 + k] = l->last;
		else if (c->future == BANK_VALUE)
			f[1 + k] = effect(l, c->value);
	}
}

/* The largest effect of one unit of w so far.  If a covariate has not changed yet, that
 * of its future value. */
static double largest_effect(const struct bank *b, int k)
{
	const struct load *l = &b->load[k];

	if (l->most == 0 && b->par.load[k].future == BANK_VALUE)
		return fabs(effect(l, b->par.load[k].value));
	return l->most;
}

/* The priors of a trend follow its mean rate and the largest effects: an observation of
 * w = 0 makes up for what is missing. */
static void heed_load_prior(const struct bank *b, const struct trend *tr)
{
	int n = 2 + b->par.n_loads;
	double *x = state_of(b, tr), *prior = priors_of(b, tr),
	       noise = tr->sum / b->freedom[tr->kind],
	       rate = (x[0] * x[0] + noise) / (b->age * b->age);

	for (int k = 0; k < b->par.n_loads; k++) {
		double most = largest_effect(b, k),
		       precision = most * most * noise / (EFFECT * EFFECT * rate),
		       more = precision - prior[k], *own = &x[n + (n + 1) * (2 + k)];

		if (fabs(more) <= 0.01 * precision)
			continue;
		if (prior[k] == 0)
			*own = 1 / precision;
		else
			observe_state(n, x, 2 + k, *own + 1 / more, -x[2 + k], 1 / more);
		if (b->load[k].most > 0) /* else nothing is known of it yet */
			prior[k] = precision;
	}
}

void face_loads(struct bank *b, const struct row *r)
{
	for (int i = 0; i < b->trends && b->par.n_loads > 0 && b->age > 0; i++)
		heed_load_prior(b, &b->trend[i]);
	for (int k = 0; k < b->par.n_loads; k++)
		b->at[1 + k] = (r->sum[k] - b->load[k].taken) / (r->t - b->last);
}

/* From the weighted means of dD/dt at the mean loads, and of its change with f. */
double bank_factor(const struct bank *b, int k)
{
	double mean[RATES], line[LINE], rate = 0, change = 0, last;

	mean_loads(b, mean);
	for (int i = 0; i < b->trends; i++) {
		const struct trend *tr = &b->trend[i];
		double scale = tr->weight * grown(tr, b->age) /
			       place_of(b, tr->shape, b->level).slope;

		line_at(b, tr, mean, line);
		rate += scale * line[LINE_V];
		change += scale * state_of(b, tr)[2 + k];
	}
	last = rate + change * (b->load[k].last - mean[1 + k]);
	return rate > 0 && last > 0 ? last / rate : NAN;
}
