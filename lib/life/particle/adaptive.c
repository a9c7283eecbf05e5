/* adaptive.c - see adaptive.h */
#include "life/particle/adaptive.h"
#include "life/grey/grey.h"
#include "life/grey/noise.h"
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { RECENT = 20 }; /* rows whose errors tell what is usual */
/* States that determine a grey model; fewer are continued by the last one. */
enum { MODEL = 3 };
enum { STEPS = 1000 }; /* of a path: one that needs more never reaches its end */

/* Of an observation, in recent errors of noise and model: farther than this from what was
 * expected it is an outlier, and no particle that far from it follows it.  This and
 * RECENT were swept: see "Single constants" in doc/trends.md. */
static const double OUTLYING = 10;

/* The sums of a grey fit: x about a centre, u the integral of the states from the oldest
 * on. */
struct sums {
	double tail, u, x, uu, ux;
};

struct adaptive {
	struct adaptive_par par;
	struct draw *draw, *draw_paths;
	struct filter *filter;
	struct order *order;
	double *mean;       /* [N] prior means */
	struct sums *sums;  /* [N] */
	double *past, *gap; /* the last rows, oldest first: values and gaps before */
	double scale;       /* from here on the state, see adaptive_pass(): power of two
			     * that values are divided by, of the first but 0 */
	int scaled;
	struct noise noise;
	long rows;
	double time;
	double observed, observed_time; /* the last observation */
	double mean_gap;
	int filled;
	double missed[RECENT]; /* last squared errors of the grey model, a ring */
	long misses;
	int outlier; /* the last observation was classified as an outlier */
	unsigned long restarts, outliers;
};

struct adaptive *adaptive_new(const struct adaptive_par *par)
{
	struct adaptive *a = calloc(1, sizeof *a);
	size_t depth = (size_t)par->order.largest;

	if (!a)
		return NULL;
	a->par = *par;
	a->scale = 1;
	a->par.filter.depth = par->order.largest;
	a->draw = draw_new(par->seed, par->realisation, RNG_FILTER);
	a->draw_paths = draw_new(par->seed, par->realisation, RNG_PREDICT);
	a->filter = a->draw ? filter_new(&a->par.filter, a->draw) : NULL;
	a->order = order_new(&par->order);
	a->mean = calloc(par->filter.particles, sizeof *a->mean);
	a->sums = calloc(par->filter.particles, sizeof *a->sums);
	a->past = calloc(2 * depth, sizeof *a->past);
	if (!a->draw_paths || !a->filter || !a->order || !a->mean || !a->sums ||
		!a->past) {
		adaptive_free(a);
		return NULL;
	}
	a->gap = a->past + depth;
	return a;
}

void adaptive_free(struct adaptive *a)
{
	if (!a)
		return;
	draw_free(a->draw);
	draw_free(a->draw_paths);
	filter_free(a->filter);
	order_free(a->order);
	free(a->mean);
	free(a->sums);
	free(a->past);
	free(a);
}

void adaptive_pass(struct adaptive *a, struct state *s)
{
	size_t depth = (size_t)a->par.filter.depth,
	       from = offsetof(struct adaptive, scale);

	draw_pass(a->draw, s);
	draw_pass(a->draw_paths, s);
	filter_pass(a->filter, s);
	order_pass(a->order, s);
	state_move(s, a->past, 2 * depth * sizeof *a->past);
	state_move(s, (unsigned char *)a + from, sizeof *a - from);
}

struct adaptive_counts adaptive_counts(const struct adaptive *a)
{
	return (struct adaptive_counts){ filter_now(a->filter).resamplings, a->outliers,
		a->restarts, order_counts(a->order) };
}

/* The gap before the states of lag steps ago; newest_gap: of the last, behind those
 * before it, NULL: all are h. */
static double gap_at(const double *newest_gap, int lag, double h)
{
	return newest_gap ? newest_gap[-lag] : h;
}

/* Adds a row to the sums over older rows, NULL: there are none.  States with a common
 * ancestor share its sums.  In place, from the end: ancestors ascend from 0 in steps of 0
 * or 1, so that none lies after its descendant. */
static void add_row(struct sums *sums, const struct filter_step *row,
	const struct filter_step *older, double gap, double centre)
{
	for (size_t i = row->n; i-- > 0;) {
		struct sums s = older ? sums[older->ancestor[i]] : (struct sums){ 0 };
		double part = row->x[i] * gap, u = s.tail + 0.5 * part,
		       off = row->x[i] - centre;

		sums[i] = (struct sums){ s.tail + part, s.u + u, s.x + off, s.uu + u * u,
			s.ux + u * off };
	}
}

/* Prior mean of every particle: the grey forecast, h after the newest, from its own last
 * p states.  The oldest of them only starts the first interval (see grey.h).  An
 * exponential through states that cannot be distinguished from 0 is meaningless, and so
 * is one beyond grey_reach(): such states keep their mean. */
static void forecast_particles(struct adaptive *a, const struct filter *f,
	const double *newest_gap, int p, double h, double noise)
{
	struct filter_step newest = filter_step(f, 0), older;
	size_t n = a->par.filter.particles;
	double centre = newest.x[0], share = 1.0 / (p - 1), end = h, most, reach,
	       *mean = a->mean;

	for (int k = p - 1; k-- > 0;) {
		struct filter_step row = filter_step(f, k);

		add_row(a->sums, &row, k < p - 2 ? &older : NULL,
			gap_at(newest_gap, k, h), centre);
		older = row;
	}
	for (int k = 0; k < p - 1; k++)
		end += gap_at(newest_gap, k, h);
	most = grey_rate_limit(p - 1, end - h);
	reach = grey_reach(most, h);
	for (size_t i = 0; i < newest.n; i += 2) {
		int width = newest.n - i < 2 ? 1 : 2;
		const struct sums *s = &a->sums[i], *t = s + width - 1;
		lanes u = share * (lanes){ s->u, t->u },
		      x = share * (lanes){ s->x, t->x }, tail = { s->tail, t->tail },
		      uu = { s->uu, t->uu }, ux = { s->ux, t->ux }, middle = centre + x,
		      rate, level, next;

		uu -= (lanes){ s->u, t->u } * u;
		ux -= (lanes){ s->u, t->u } * x;
		rate = lanes_if(lanes_and(lanes_abs(ux) < most * uu,
					lanes_abs(middle) > 3 * noise),
			-ux / uu);
		level = middle + rate * u;
		next = grey_curve(level, rate, end, h);
		lanes_store(mean + i,
			lanes_pick(
				lanes_abs(next) > reach * lanes_abs(level - rate * tail),
				middle, next),
			width);
	}
	for (size_t i = newest.n < n ? n : 0; i-- > 0;)
		mean[i] = mean[newest.ancestor[i]];
}

static void hold_particles(struct adaptive *a)
{
	struct filter_step now = filter_step(a->filter, 0);

	for (size_t i = 0; i < a->par.filter.particles; i++)
		a->mean[i] = now.x[now.ancestor[i]];
}

/* Stores a value, and the gap before it, for a restart. */
static void push_past(struct adaptive *a, double y, double gap)
{
	if (a->filled == a->par.filter.depth) {
		size_t older = (size_t)--a->filled * sizeof *a->past;

		memmove(a->past, a->past + 1, older);
		memmove(a->gap, a->gap + 1, older);
	}
	a->past[a->filled] = y;
	a->gap[a->filled++] = gap;
}

static void start_particles(struct adaptive *a, double noise)
{
	filter_start(a->filter, a->past, a->filled, sqrt(3) * noise);
}

/* sigma_v in scaled units; never 0, since a weight divides by it. */
static double observation_noise(const struct adaptive *a)
{
	double least = 1e-9 * (1 + fabs(a->past[a->filled > 0 ? a->filled - 1 : 0]));
	double s = isnan(a->par.noise) ? a->noise.scale : a->par.noise / a->scale;

	return s > least ? s : least;
}

/* The mean of the last squared errors of the grey model of the observations. */
static double missed_lately(const struct adaptive *a)
{
	int n = (int)fmin((double)a->misses, RECENT);
	double sum = 0;

	for (int k = 0; k < n; k++)
		sum += a->missed[k];
	return n > 0 ? sum / n : 0;
}

/* The observation before counts as a forecast, too.  Not twice in a row: then the series
 * itself has moved. */
static int is_outlier(struct adaptive *a, double y, double forecast, double noise)
{
	double usual = fmax(noise * noise, missed_lately(a)),
	       miss = fmin(fabs(y - forecast), fabs(y - a->observed));

	a->outlier =
		!a->outlier && a->misses > 0 && miss * miss > OUTLYING * OUTLYING * usual;
	a->outliers += (unsigned long)a->outlier;
	return a->outlier;
}

/* Per step no less than sigma_v, below which the filter follows its own states and not
 * the data, and than the recent error of the model beyond the noise. */
static double process_noise(const struct adaptive *a, double noise, double gap)
{
	double steps = a->mean_gap > 0 ? gap / a->mean_gap : 1,
	       s = a->par.process / a->scale;

	if (isnan(a->par.process))
		s = fmax(noise, sqrt(fmax(0, missed_lately(a) - noise * noise)));
	return s * sqrt(steps);
}

static void put_state(const struct adaptive *a, struct adaptive_row *row)
{
	struct filter_now now = filter_now(a->filter);

	row->state = now.mean;
	row->ess = now.ess;
}

static void observe(struct adaptive *a, double y, double gap, struct adaptive_row *row)
{
	double noise = observation_noise(a);
	int few, lost;

	filter_update(a->filter, y, noise);
	put_state(a, row);
	push_past(a, y, gap);
	few = a->rows < GREY_ORDER_MIN; /* of too few points the noise is not known */
	lost = fabs(y - row->state) > OUTLYING * noise;
	a->restarts += (unsigned long)(lost && !few);
	if (lost || few) {
		start_particles(a, noise);
		row->state = filter_now(a->filter).mean;
	}
}

/* The first row with a value. */
static void begin(struct adaptive *a, double t, double y, struct adaptive_row *row)
{
	y /= a->scale;
	order_add(a->order, y, 0);
	noise_add(&a->noise, y, 0);
	push_past(a, y, 0);
	a->observed_time = t;
	start_particles(a, observation_noise(a));
	put_state(a, row);
}

static void advance(struct adaptive *a, double t, double y, struct adaptive_row *row)
{
	double gap = t - a->time, noise = observation_noise(a),
	       process = process_noise(a, noise, gap);
	int order = order_chosen(a->order); /* the particles remember all its rows */

	row->order = order;
	row->grey = order_forecast(a->order, t - a->observed_time);
	if (order >= MODEL)
		forecast_particles(
			a, a->filter, &a->gap[a->filled - 1], order, gap, noise);
	else
		hold_particles(a);
	filter_predict(a->filter, a->mean, process);
	put_state(a, row);
	row->prediction = row->state;
	a->mean_gap += (gap - a->mean_gap) / fmin((double)a->rows, 50);
	y /= a->scale;
	if (isnan(y) || is_outlier(a, y, row->grey, noise)) {
		push_past(a, row->prediction, gap);
		return;
	}
	a->missed[a->misses++ % RECENT] = (y - row->grey) * (y - row->grey);
	order_add(a->order, y, t - a->observed_time);
	noise_add(&a->noise, y, t - a->observed_time);
	a->observed_time = t;
	a->observed = y;
	observe(a, y, gap, row);
}

void adaptive_step(struct adaptive *a, double t, double y, struct adaptive_row *row)
{
	*row = (struct adaptive_row){ NAN, NAN, NAN, NAN, 0 };
	if (!a->scaled && !isnan(y) && y != 0) { /* zeros are the same in any scale */
		a->scale = grey_scale(y);
		a->scaled = 1;
	}
	if (a->rows > 0)
		advance(a, t, y, row);
	else if (!isnan(y))
		begin(a, t, y, row);
	else
		return;
	a->time = t;
	a->rows++;
	row->grey *= a->scale;
	row->prediction *= a->scale;
	row->state *= a->scale;
}

/* Stores the time, on the line from the state before, of each path that is beyond the
 * limit for the first time; returns how many are not yet. */
static size_t end_paths(const struct filter *f, size_t n, double limit, int direction,
	double time, double gap, double *life)
{
	struct filter_step now = filter_step(f, 0), before = filter_step(f, 1);
	size_t left = 0;

	for (size_t i = 0; i < n; i++) {
		double x = now.x[now.ancestor[i]], old;

		if (life[i] < INFINITY)
			continue;
		if (direction * (x - limit) < 0) {
			left++;
			continue;
		}
		old = before.x[before.ancestor[now.ancestor[i]]];
		life[i] = time + gap * fmin(1, fmax(0, (limit - old) / (x - old)));
	}
	return left;
}

enum num_status adaptive_lives(
	struct adaptive *a, double threshold, int direction, double *life)
{
	int order = order_chosen(a->order);
	double limit = threshold / a->scale, noise = observation_noise(a),
	       gap = a->mean_gap, process = process_noise(a, noise, gap);
	size_t n = a->par.filter.particles, left;
	struct filter *f;

	if (order < MODEL)
		return NUM_DOMAIN;
	f = filter_copy(a->filter, a->draw_paths);
	if (!f)
		return NUM_MEMORY;
	for (size_t i = 0; i < n; i++)
		life[i] = INFINITY;
	left = end_paths(f, n, limit, direction, 0, 0, life);
	for (int k = 0; k < STEPS && left > 0; k++) {
		forecast_particles(a, f, NULL, order, gap, noise);
		for (size_t i = 0; i < n; i++)
			if (life[i] < INFINITY) /* else it might overflow */
				a->mean[i] = limit;
		filter_predict(f, a->mean, process);
		left = end_paths(f, n, limit, direction, k * gap, gap, life);
	}
	filter_free(f);
	return NUM_OK;
}
