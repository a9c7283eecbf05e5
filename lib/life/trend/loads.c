/* loads.c - covariates that scale the rates of a bank, see bank.h and bank_state.h
 *
 * The rate v of a trend is always that at the present loads.  Other loads turn the state
 * (h, v, w): v changes by w times the change of f, and its covariances with it.  Thus all
 * else in the bank needs only h and v.
 */
#include "life/trend/bank_state.h"
#include <string.h>

/* Standard deviation of the effect of a covariate at its largest distance from the first
 * value, as a share of the rate.  Mean CRPS of simulated paths, straight, cracks, roots
 * and Wiener, whose covariate alternates, oscillates or is random and scales the rate by
 * 1, 3 and 9, 640 paths each: without a covariate 6.9, 11.0, 15.5; 0.5: 7.2, 9.4, 13.8;
 * 1: 7.4, 9.4, 13.3; 2: 7.6, 9.6, 13.6; 4: 7.8, 9.9, 14.0. */
static const double EFFECT = 1;
/* The largest bend: a factor of e^3 = 20 at that distance.  Without bends these CRPS,
 * with EFFECT 2, are 7.6, 9.3 and 12.4 if the future covariate is its mean, but 8.4, 13.0
 * and 23.1 instead of 8.2, 12.2 and 19.4 if it is its last value. */
static const double BEND = 3;

struct tilt *tilts_of(const struct bank *b, const struct trend *tr)
{
	return (struct tilt *)(b->trend + b->capacity) + (tr - b->trend) * b->par.n_loads;
}

static double effect(const struct load *l, double x)
{
	double far = (x - l->origin) / l->unit;

	return l->bend != 0 ? expm1(fmin(100, l->bend * far)) / l->bend : far;
}

static void bend(struct load *l, double to)
{
	double most = l->most > 0 ? BEND / l->most : 0;

	l->bend = fmax(-most, fmin(most, to));
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
		bend(l, l->bend);
		l->last = effect(l, x[k]);
		if (b->loaded)
			l->sum += l->last * (t - b->loaded_to);
	}
	if (!b->loaded)
		b->loaded_from = t;
	b->loaded = 1;
	b->loaded_to = t;
}

void mean_loads(const struct bank *b, double f[BANK_LOADS])
{
	double span = b->loaded_to - b->loaded_from - b->idle;

	for (int k = 0; k < b->par.n_loads; k++)
		f[k] = span > 0 ? b->load[k].sum / span : 0;
}

void future_loads(const struct bank *b, double f[BANK_LOADS])
{
	mean_loads(b, f);
	for (int k = 0; k < b->par.n_loads; k++) {
		const struct bank_covariate *c = &b->par.load[k];

		if (c->future != BANK_MEAN)
			f[k] = c->future == BANK_LAST ? b->load[k].last
						      : effect(&b->load[k], c->value);
	}
}

/* Turns a trend by a change of one load. */
static void turn(
	const struct bank *b, struct trend *tr, struct tilt *tilt, int k, double change)
{
	double before = tr->pvv, own = tilt[k].pww[k];

	tr->v += change * tilt[k].w;
	tr->phv += change * tilt[k].phw;
	tr->pvv += change * (2 * tilt[k].pvw + change * own);
	tr->pvv = fmax(tr->pvv, 1e-9 * (before + change * change * own));
	for (int j = 0; j < b->par.n_loads; j++)
		tilt[j].pvw += change * tilt[j].pww[k];
}

struct trend at_loads(const struct bank *b, const struct trend *tr, const double *f)
{
	struct trend turned = *tr;
	struct tilt tilt[BANK_LOADS];

	for (int k = 0; k < b->par.n_loads; k++)
		tilt[k] = tilts_of(b, tr)[k];
	for (int k = 0; k < b->par.n_loads; k++)
		turn(b, &turned, tilt, k, f[k] - b->load[k].at);
	return turned;
}

/* An observation of w_k = 0, with this variance. */
static void hold_back(
	const struct bank *b, struct trend *tr, struct tilt *tilt, int k, double variance)
{
	double f = tilt[k].pww[k] + variance, e = -tilt[k].w, column[BANK_LOADS] = { 0 };
	double h = tilt[k].phw, v = tilt[k].pvw;

	for (int j = 0; j < b->par.n_loads; j++)
		column[j] = tilt[j].pww[k];
	tr->h += h / f * e;
	tr->v += v / f * e;
	tr->phh -= h / f * h;
	tr->phv -= h / f * v;
	tr->pvv -= v / f * v;
	for (int j = 0; j < b->par.n_loads; j++) {
		tilt[j].w += column[j] / f * e;
		tilt[j].phw -= h / f * column[j];
		tilt[j].pvw -= v / f * column[j];
		for (int i = 0; i < b->par.n_loads; i++)
			tilt[j].pww[i] -= column[i] / f * column[j];
	}
}

/* The largest effect of one unit of w so far.  If a covariate has not changed yet, that
 * of its future value. */
static double largest_effect(const struct bank *b, int k)
{
	const struct load *l = &b->load[k];
	double far = l->most * l->unit;

	if (far == 0 && b->par.load[k].future == BANK_VALUE)
		far = fabs(b->par.load[k].value - l->origin);
	return fmax(fabs(effect(l, l->origin + far)), fabs(effect(l, l->origin - far)));
}

/* The prior of the tilts of a trend follows its mean rate and the largest effects. */
static void heed_load_prior(const struct bank *b, struct trend *tr)
{
	double noise = tr->sum / b->freedom[tr->kind],
	       rate = (tr->h * tr->h + noise) / (b->age * b->age);
	struct tilt *tilt = tilts_of(b, tr);

	for (int k = 0; k < b->par.n_loads; k++) {
		double most = largest_effect(b, k),
		       precision = most * most * noise / (EFFECT * EFFECT * rate),
		       more = precision - tilt[k].prior;

		if (fabs(more) <= 0.01 * precision)
			continue;
		if (tilt[k].prior == 0)
			tilt[k].pww[k] = 1 / precision;
		else
			hold_back(b, tr, tilt, k, 1 / more);
		if (b->load[k].most > 0) /* else nothing is known of it yet */
			tilt[k].prior = precision;
	}
}

void face_loads(struct bank *b, const struct row *r)
{
	for (int i = 0; i < b->trends && b->par.n_loads > 0 && b->age > 0; i++)
		heed_load_prior(b, &b->trend[i]);
	for (int k = 0; k < b->par.n_loads; k++) {
		struct load *l = &b->load[k];
		double f = (r->sum[k] - l->taken) / (r->t - b->last);

		for (int i = 0; i < b->trends && f != l->at; i++)
			turn(b, &b->trend[i], tilts_of(b, &b->trend[i]), k, f - l->at);
		l->at = f;
	}
}

void project_tilts(const struct bank *b, struct trend *tr, double along, double keep)
{
	struct tilt *tilt = tilts_of(b, tr);

	for (int k = 0; k < b->par.n_loads; k++) {
		tilt[k].phw = (tilt[k].phw + along * tilt[k].pvw) / keep;
		tilt[k].pvw /= keep;
		tilt[k].prior *= keep;
		for (int j = 0; j < b->par.n_loads; j++)
			tilt[k].pww[j] /= keep;
	}
}

void correct_tilts(
	const struct bank *b, struct trend *tr, double f, double e, double noise)
{
	struct tilt *tilt = tilts_of(b, tr);

	for (int k = 0; k < b->par.n_loads; k++) {
		tilt[k].w += tilt[k].phw / f * e;
		tilt[k].pvw -= tr->phv / f * tilt[k].phw;
		for (int j = 0; j < b->par.n_loads; j++)
			tilt[k].pww[j] -= tilt[k].phw / f * tilt[j].phw;
	}
	for (int k = 0; k < b->par.n_loads; k++)
		tilt[k].phw *= noise / f;
}

void scale_tilts(const struct bank *b, struct trend *tr, double times)
{
	struct tilt *tilt = tilts_of(b, tr);

	for (int k = 0; k < b->par.n_loads; k++) {
		tilt[k].w *= times;
		tilt[k].phw *= times;
		tilt[k].pvw *= times;
		tilt[k].prior /= times * times;
		for (int j = 0; j < b->par.n_loads; j++)
			tilt[k].pww[j] *= times * times;
	}
}

/* Weighted means of dD/dt at the mean loads, and of its change with each f. */
static double mean_rate(
	const struct bank *b, double mean[BANK_LOADS], double change[BANK_LOADS])
{
	double rate = 0;

	mean_loads(b, mean);
	memset(change, 0, BANK_LOADS * sizeof *change);
	for (int i = 0; i < b->trends; i++) {
		const struct trend *tr = &b->trend[i];
		const struct tilt *tilt = tilts_of(b, tr);
		double scale = tr->weight * grown(tr, b->age) /
			       place_of(b, tr->shape, b->level).slope;

		rate += scale * tr->v;
		for (int k = 0; k < b->par.n_loads; k++)
			change[k] += scale * tilt[k].w;
	}
	for (int k = 0; k < b->par.n_loads; k++)
		rate += change[k] * (mean[k] - b->load[k].at);
	return rate;
}

/* In v + w f the derivative of the logarithm of the rate is the bend, if that is right.
 */
void bend_loads(struct bank *b)
{
	double change[BANK_LOADS], mean[BANK_LOADS], rate;

	if (b->par.n_loads == 0)
		return;
	rate = mean_rate(b, mean, change);
	for (int k = 0; k < b->par.n_loads && rate > 0; k++)
		bend(&b->load[k], change[k] * (1 + b->load[k].bend * mean[k]) / rate);
}

double bank_factor(const struct bank *b, int k)
{
	double change[BANK_LOADS], mean[BANK_LOADS],
		rate = mean_rate(b, mean, change),
		last = rate + change[k] * (b->load[k].last - mean[k]);

	return rate > 0 && last > 0 ? last / rate : NAN;
}
