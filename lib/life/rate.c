/* rate.c - see rate.h */
#include "life/rate.h"
#include "life/noise.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Memories in observations and wanders as shares of the noise per observation. */
enum { MEMORIES = 5, WANDERS = 3, FILTERS = MEMORIES * WANDERS };
static const double memory_of[MEMORIES] = { INFINITY, 300, 100, 30, 10 };
static const double wander_of[WANDERS] = { 0, 0.01, 0.1 };

/* Beyond so many standard deviations an observation loses weight. */
static const double gate = 3;

/* So many of them running are not outliers: the level has jumped. */
enum { JUMP = 5 };

struct kalman {
	double level, rate;
	double pll, plr, prr;           /* covariance */
	double level_drift, rate_drift; /* variances gained per time */
	double log_weight;
	int outliers; /* running */
};

struct rate {
	double prior_mean, prior_sd;
	struct kalman filter[FILTERS];
	int n;             /* observations */
	double start, now; /* times of the first observation and the latest row */
	double t[RATE_START],
		y[RATE_START]; /* newest last; all of them up to RATE_START */
	struct noise *scale;
	double noise; /* variance of an observation */
};

struct rate *rate_new(double prior_mean, double prior_sd)
{
	struct rate *r = calloc(1, sizeof *r);

	if (!r)
		return NULL;
	r->prior_mean = prior_mean;
	r->prior_sd = prior_sd;
	r->scale = noise_new();
	if (!r->scale) {
		free(r);
		return NULL;
	}
	return r;
}

void rate_free(struct rate *r)
{
	if (!r)
		return;
	noise_free(r->scale);
	free(r);
}

static double square(double x)
{
	return x * x;
}

int rate_ready(const struct rate *r)
{
	return r->n >= RATE_START;
}

/* Mean time between observations. */
static double spacing(const struct rate *r)
{
	return r->n > 1 ? (r->t[RATE_START - 1] - r->start) / (r->n - 1) : 1;
}

/* Sets what level and rate of filter k gain in variance.  A rate that walks with
 * noise / (spacing^3 memory^4) lets the filter forget after some memory observations
 * (steady state of the local linear trend). */
static void set_drift(struct rate *r, int k)
{
	double dt = spacing(r), memory = memory_of[k % MEMORIES];

	r->filter[k].level_drift = wander_of[k / MEMORIES] * r->noise / dt;
	r->filter[k].rate_drift =
		isinf(memory) ? 0 : r->noise / (dt * dt * dt) / pow(memory, 4);
}

static void advance(struct kalman *f, double dt)
{
	f->level += f->rate * dt;
	f->pll += dt * (2 * f->plr + dt * f->prr) + f->level_drift * dt +
		  f->rate_drift * dt * dt * dt / 3;
	f->plr += dt * f->prr + f->rate_drift * dt * dt / 2;
	f->prr += f->rate_drift * dt;
}

static void update(const struct rate *r, struct kalman *f, double y)
{
	double error = y - f->level, s = f->pll + r->noise, score, kl, kr;

	f->outliers = error * error > gate * gate * s ? f->outliers + 1 : 0;
	if (f->outliers == JUMP) {
		f->outliers = 0;
		f->pll += error * error;
		s += error * error;
	}
	score = error * error / s;
	if (score > gate * gate) {
		/* as though the observation were so much noisier that it is at the gate
		 */
		s *= score / (gate * gate);
		f->log_weight -=
			gate * (sqrt(score) - gate / 2) + log(f->pll + r->noise) / 2;
	} else {
		f->log_weight -= (score + log(s)) / 2;
	}
	kl = f->pll / s;
	kr = f->plr / s;
	f->level += kl * error;
	f->rate += kr * error;
	f->prr -= kr * f->plr;
	f->plr -= kl * f->plr;
	f->pll -= kl * f->pll;
}

/* Keeps the largest weight at 1, so that none overflows. */
static void normalise(struct rate *r)
{
	double most = -INFINITY;

	for (int k = 0; k < FILTERS; k++)
		most = fmax(most, r->filter[k].log_weight);
	for (int k = 0; k < FILTERS; k++)
		r->filter[k].log_weight -= most;
}

/* The first observations: a filter each from scratch, now that the noise is known. */
static void start(struct rate *r)
{
	for (int k = 0; k < FILTERS; k++) {
		struct kalman *f = &r->filter[k];
		double sd = r->prior_sd;

		if (isinf(sd))
			sd = 1e3 *
			     (fabs(r->y[RATE_START - 1] - r->y[0]) + sqrt(r->noise)) /
			     (r->t[RATE_START - 1] - r->t[0]);
		*f = (struct kalman){ .level = r->y[0],
			.rate = r->prior_mean,
			.pll = r->noise,
			.prr = sd * sd };
		set_drift(r, k);
		for (int i = 1; i < RATE_START; i++) {
			advance(f, r->t[i] - r->t[i - 1]);
			update(r, f, r->y[i]);
		}
	}
}

void rate_add(struct rate *r, double t, double value)
{
	if (isnan(value)) {
		for (int k = 0; k < FILTERS && rate_ready(r); k++)
			advance(&r->filter[k], t - r->now);
		r->now = t;
		return;
	}
	for (int i = 1; i < RATE_START; i++) {
		r->t[i - 1] = r->t[i];
		r->y[i - 1] = r->y[i];
	}
	r->t[RATE_START - 1] = t;
	r->y[RATE_START - 1] = value;
	if (r->n++ == 0)
		r->start = t;
	noise_add(r->scale, value, r->n > 1 ? t - r->t[RATE_START - 2] : 1);
	r->noise = square(noise_scale(r->scale)) + 1e-18 * value * value + DBL_MIN;
	if (r->n == RATE_START)
		start(r);
	for (int k = 0; k < FILTERS && r->n > RATE_START; k++) {
		set_drift(r, k);
		advance(&r->filter[k], t - r->now);
		update(r, &r->filter[k], value);
	}
	r->now = t;
	normalise(r);
}

void rate_state(const struct rate *r, double *level, double *rate)
{
	double total = 0;

	*level = *rate = 0;
	for (int k = 0; k < FILTERS; k++) {
		double w = exp(r->filter[k].log_weight);

		total += w;
		*level += w * r->filter[k].level;
		*rate += w * r->filter[k].rate;
	}
	*level /= total;
	*rate /= total;
}

static int pick(const struct rate *r, double u)
{
	double total = 0;
	int k = 0;

	for (int i = 0; i < FILTERS; i++)
		total += exp(r->filter[i].log_weight);
	u *= total;
	while (k < FILTERS - 1 && (u -= exp(r->filter[k].log_weight)) > 0)
		k++;
	return k;
}

/* Level after x on path z. */
static double path(const struct kalman *f, double x, double z)
{
	double variance = f->pll + x * (2 * f->plr + x * f->prr) + f->level_drift * x +
			  f->rate_drift * x * x * x / 3;

	return f->level + f->rate * x + z * sqrt(fmax(variance, 0));
}

double rate_passage(const struct rate *r, double threshold, double u, double z)
{
	const struct kalman *f = &r->filter[pick(r, u)];
	double unit = spacing(r), low = 0, high = 0.01 * unit;

	if (path(f, 0, z) >= threshold)
		return 0;
	/* The first root, from a hundredth of the spacing to far beyond any use. */
	while (path(f, high, z) < threshold) {
		if (high > 1e9 * unit)
			return INFINITY;
		low = high;
		high *= 1.25;
	}
	while (high - low > 1e-9 * high) {
		double middle = (low + high) / 2;

		if (path(f, middle, z) < threshold)
			low = middle;
		else
			high = middle;
	}
	return high;
}
