/* rate.c - see rate.h */
#include "life/rate.h"
#include "life/noise.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Memories, in observations, and wanders: size, as a share of the noise, and correlation
 * time, in observations. */
enum { MEMORIES = 5, WANDERS = 5, FILTERS = MEMORIES * WANDERS };
static const double memory_of[MEMORIES] = { INFINITY, 1000, 300, 100, 30 };
static const struct {
	double size, time;
} wander_of[WANDERS] = { { 0, 1 }, { 0.5, 10 }, { 0.5, 50 }, { 1, 10 }, { 1, 50 } };

/* Beyond so many standard deviations an observation loses weight. */
static const double gate = 3;

/* So many of them running are not outliers: the level has jumped. */
enum { JUMP = 5 };

/* State: level and rate, which is a random walk, and a wander that only the observations
 * show. */
struct kalman {
	double level, rate, wander;
	double pll, plr, prr, plw, prw, pww; /* covariance */
	double drift;                        /* variance that the rate gains per time */
	double reversion; /* rate of its return to the prior's mean, 1/time */
	double log_weight;
	int outliers; /* running */
};

struct rate {
	double prior_mean, prior_sd;
	struct kalman filter[FILTERS];
	double up_to[FILTERS]; /* sum of the weights of the filters to this one */
	int n;                 /* observations */
	double start, now;     /* times of the first observation and the latest row */
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

/* What is left after dt of a rate's distance from its mean, that distance's integral, and
 * the integral of the square of the latter over the age of the shocks. */
static void decay(
	double rate, double dt, double *left, double *integral, double *square_of)
{
	double x = rate * dt;

	*left = rate > 0 ? exp(-x) : 1;
	if (x < 1e-2) {
		*integral = dt * (1 - x / 2 + x * x / 6 - x * x * x / 24);
		*square_of = dt * dt * dt * (1. / 3 - x / 4 + 7 * x * x / 60);
		return;
	}
	*integral = -expm1(-x) / rate;
	*square_of = (dt - 2 * *integral - expm1(-2 * x) / (2 * rate)) / (rate * rate);
}

/* A rate that walks with noise / (spacing^3 memory^4) lets the filter forget after some
 * memory observations (steady state of the local linear trend).  What is known beforehand
 * holds it: it returns to the prior's mean, as fast as leaves it the prior's variance. */
static void advance(const struct rate *r, int k, struct kalman *f, double dt)
{
	double unit = spacing(r), memory = memory_of[k % MEMORIES];
	double size = wander_of[k / MEMORIES].size, time = wander_of[k / MEMORIES].time;
	double keep = exp(-dt / (time * unit)), left, g, square_of;

	f->drift = isinf(memory) ? 0 : r->noise / (unit * unit * unit) / pow(memory, 4);
	f->reversion = f->drift / (2 * r->prior_sd * r->prior_sd);
	if (!isfinite(f->reversion))
		f->reversion = f->drift = 0; /* the prior is certain */
	decay(f->reversion, dt, &left, &g, &square_of);
	f->level += r->prior_mean * (dt - g) + f->rate * g;
	f->rate = r->prior_mean + (f->rate - r->prior_mean) * left;
	f->wander *= keep;
	f->pll += g * (2 * f->plr + g * f->prr) + f->drift * square_of;
	f->plr = left * (f->plr + g * f->prr) + f->drift * g * g / 2;
	f->prr = left * left * f->prr + f->drift * (g - f->reversion * g * g / 2);
	f->plw = keep * (f->plw + g * f->prw);
	f->prw *= keep * left;
	f->pww = keep * keep * f->pww + size * size * r->noise * (1 - keep * keep);
}

static void update(const struct rate *r, struct kalman *f, double y)
{
	double error = y - f->level - f->wander;
	double s = f->pll + 2 * f->plw + f->pww + r->noise;
	double score, kl, kr, kw;

	f->outliers = error * error > gate * gate * s ? f->outliers + 1 : 0;
	if (f->outliers == JUMP) {
		f->outliers = 0;
		f->pll += error * error;
		s += error * error;
	}
	score = error * error / s;
	f->log_weight -= log(s) / 2;
	if (score > gate * gate) {
		/* as though the observation were so much noisier that it is at the gate
		 */
		s *= score / (gate * gate);
		f->log_weight -= gate * (sqrt(score) - gate / 2);
	} else {
		f->log_weight -= score / 2;
	}
	kl = (f->pll + f->plw) / s;
	kr = (f->plr + f->prw) / s;
	kw = (f->plw + f->pww) / s;
	f->level += kl * error;
	f->rate += kr * error;
	f->wander += kw * error;
	f->pll -= s * kl * kl;
	f->plr -= s * kl * kr;
	f->prr -= s * kr * kr;
	f->plw -= s * kl * kw;
	f->prw -= s * kr * kw;
	f->pww -= s * kw * kw;
}

/* Keeps the largest weight at 1, so that none overflows, and adds them up. */
static void normalise(struct rate *r)
{
	double most = -INFINITY, sum = 0;

	for (int k = 0; k < FILTERS; k++)
		most = fmax(most, r->filter[k].log_weight);
	for (int k = 0; k < FILTERS; k++) {
		r->filter[k].log_weight -= most;
		r->up_to[k] = sum += exp(r->filter[k].log_weight);
	}
}

/* The first observations: a filter each from scratch, now that the noise is known. */
static void start(struct rate *r)
{
	for (int k = 0; k < FILTERS; k++) {
		struct kalman *f = &r->filter[k];
		double sd = r->prior_sd, w;

		if (isinf(sd))
			sd = 1e3 *
			     (fabs(r->y[RATE_START - 1] - r->y[0]) + sqrt(r->noise)) /
			     (r->t[RATE_START - 1] - r->t[0]);
		/* level = observation - wander - noise */
		w = square(wander_of[k / MEMORIES].size) * r->noise;
		*f = (struct kalman){ .level = r->y[0],
			.rate = r->prior_mean,
			.pll = r->noise + w,
			.plw = -w,
			.pww = w,
			.prr = sd * sd };
		for (int i = 1; i < RATE_START; i++) {
			advance(r, k, f, r->t[i] - r->t[i - 1]);
			update(r, f, r->y[i]);
		}
	}
}

void rate_add(struct rate *r, double t, double value)
{
	if (isnan(value)) {
		for (int k = 0; k < FILTERS && rate_ready(r); k++)
			advance(r, k, &r->filter[k], t - r->now);
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
		advance(r, k, &r->filter[k], t - r->now);
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
	int k = 0;

	while (k < FILTERS - 1 && r->up_to[k] < u * r->up_to[FILTERS - 1])
		k++;
	return k;
}

/* Level after x on path z.  Shocks to come die away within the time observed so far: a
 * walk for ever would leave half of the paths without an end. */
static double path(const struct rate *r, const struct kalman *f, double x, double z)
{
	double fade = fmax(f->reversion, 1 / (r->now - r->start));
	double left, g, square_of, variance;

	decay(fade, x, &left, &g, &square_of);
	variance = f->drift * square_of;
	decay(f->reversion, x, &left, &g, &square_of);
	variance += f->pll + g * (2 * f->plr + g * f->prr);
	return f->level + r->prior_mean * (x - g) + f->rate * g +
	       z * sqrt(fmax(variance, 0));
}

double rate_passage(const struct rate *r, double threshold, double u, double z)
{
	const struct kalman *f = &r->filter[pick(r, u)];
	double unit = spacing(r), low = 0, high = 0.1 * unit;
	double below = path(r, f, 0, z) - threshold, above;

	if (below >= 0)
		return 0;
	/* The first root, from a tenth of the spacing to far beyond any use. */
	while ((above = path(r, f, high, z) - threshold) < 0) {
		if (high > 1e9 * unit)
			return INFINITY;
		low = high;
		below = above;
		high *= 1.3;
	}
	/* Illinois: false position, an end that stays put counting half. */
	for (int side = 0; high - low > 1e-9 * high && above > 0;) {
		double x = (low * above - high * below) / (above - below);
		double y = path(r, f, x, z) - threshold;

		if (fabs(y) <= 1e-12 * (fabs(threshold) + fabs(f->level)))
			return x;
		if (y < 0) {
			low = x;
			below = y;
			above /= side == -1 ? 2 : 1;
			side = -1;
		} else {
			high = x;
			above = y;
			below /= side == 1 ? 2 : 1;
			side = 1;
		}
	}
	return high;
}
