/* adaptive.c - see adaptive.h */
#include "life/particle/adaptive.h"
#include "life/grey/grey.h"
#include "life/grey/noise.h"
#include "num/lanes.h"
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { RECENT = 4, SETTLED = 8 };
enum { BLOCK = 256 };                  /* particles at a time */
enum { MONITOR = 20 };                 /* rows of the innovation monitor and of means */
static const double MONITOR_LIMIT = 4; /* of the mean squared innovation */
static const double MONITOR_CLIP = 16; /* limit of one squared innovation, so that a
					  single outlier does not look like a drift */

/* A past row of all particles: their states and the gap after them. */
struct lag {
	const double *x;
	const uint32_t *ancestor; /* index of the ancestor of each state of the next row;
				     NULL: the same index */
	double gap;
	size_t first, n; /* of x: the ancestors of the present block */
};

/* The sums of the grey fits of two particles, x about a centre, u the integral of the
 * states from the oldest on. */
struct sums {
	lanes tail, u, x, uu, ux;
};

/* The same of a block, particle by particle. */
struct block_sums {
	double tail[BLOCK], u[BLOCK], x[BLOCK], uu[BLOCK], ux[BLOCK];
};

struct adaptive {
	struct adaptive_par par;
	struct draw *draw, *draw_paths;
	struct filter *filter;
	struct order *order;
	struct lag *lag;    /* [depth] */
	uint32_t *index;    /* [N] */
	double *mean;       /* [N] prior means */
	double *past, *gap; /* rings of the last rows: values and gaps before */
	double *line_up;    /* past in order */
	double scale;       /* from here on the state, see adaptive_pass(): power of two
			     * that values are divided by, of the first but 0 */
	int scaled;
	struct noise noise;
	long rows;
	double time;
	double observed, observed_time, observed_gap; /* the last observation */
	double mean_gap;
	int newest, filled;
	double missed[RECENT]; /* last squared errors of the grey model, a ring */
	long misses;
	double process;             /* sigma_u */
	double innovation, carried; /* running mean squares */
	double z2[MONITOR];
	int nz;
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
	a->lag = calloc(depth, sizeof *a->lag);
	a->index = calloc(par->filter.particles, sizeof *a->index);
	a->mean = calloc(par->filter.particles, sizeof *a->mean);
	a->past = calloc(depth, sizeof *a->past);
	a->gap = calloc(depth, sizeof *a->gap);
	a->line_up = calloc(depth, sizeof *a->line_up);
	if (!a->draw_paths || !a->filter || !a->order || !a->lag || !a->index ||
		!a->mean || !a->past || !a->gap || !a->line_up) {
		adaptive_free(a);
		return NULL;
	}
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
	free(a->lag);
	free(a->index);
	free(a->mean);
	free(a->past);
	free(a->gap);
	free(a->line_up);
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
	state_move(s, a->past, depth * sizeof *a->past);
	state_move(s, a->gap, depth * sizeof *a->gap);
	state_move(s, (unsigned char *)a + from, sizeof *a - from);
}

struct adaptive_counts adaptive_counts(const struct adaptive *a)
{
	return (struct adaptive_counts){ filter_resamplings(a->filter), a->outliers,
		a->restarts, order_counts(a->order) };
}

/* Adds a state to the sums, at a gap after the state before it. */
static inline void add_state(struct sums *s, lanes x, double gap, double centre)
{
	lanes part = x * gap, u = s->tail + 0.5 * part, off = x - centre;

	s->u += u;
	s->x += off;
	s->uu += u * u;
	s->ux += u * off;
	s->tail += part;
}

/* Adds to the sums of two particles their states of several rows, oldest row first. */
static inline struct sums add_stretch(struct sums s, const struct lag *newest, int count,
	double centre, size_t a, size_t b)
{
	for (int k = count; k-- > 0;)
		add_state(&s, (lanes){ newest[k].x[a], newest[k].x[b] }, newest[k].gap,
			centre);
	return s;
}

static inline struct sums sums_of(const struct block_sums *s, size_t a, size_t b)
{
	return (struct sums){ { s->tail[a], s->tail[b] }, { s->u[a], s->u[b] },
		{ s->x[a], s->x[b] }, { s->uu[a], s->uu[b] }, { s->ux[a], s->ux[b] } };
}

static inline void keep_sums(struct block_sums *s, size_t i, struct sums two)
{
	lanes_store(s->tail + i, two.tail, 2);
	lanes_store(s->u + i, two.u, 2);
	lanes_store(s->x + i, two.x, 2);
	lanes_store(s->uu + i, two.uu, 2);
	lanes_store(s->ux + i, two.ux, 2);
}

/* A window of states to which the grey curve is fitted. */
struct window {
	struct lag *lag;
	int count;
	double share, centre;
	struct grey_interval ahead; /* to be forecast, in time from the oldest state on */
	double least;               /* smallest mean that differs significantly from 0 */
};

/* Level and rate of the grey curves of two particles, from their sums.  An exponential
 * through states that cannot be distinguished from 0 is meaningless: such states keep
 * their mean. */
static inline void fit_pair(
	const struct window *w, struct sums s, lanes *level, lanes *rate)
{
	lanes u = s.u * w->share, x = s.x * w->share, uu = s.uu - s.u * u,
	      ux = s.ux - s.u * x, middle = w->centre + x;

	*rate = lanes_if(lanes_and(uu > 0, lanes_abs(middle) > w->least), -ux / uu);
	*level = middle + *rate * u;
}

/* The means of n <= BLOCK particles from first on.  Particles with the same ancestor have
 * the same history and the same mean. */
static void forecast_block(const struct window *window, const uint32_t *index,
	size_t first, size_t n, double *mean)
{
	/* a copy that the compiler knows to be constant */
	const struct window here = *window, *w = &here;

	struct block_sums sums;
	lanes level[BLOCK / 2], rate[BLOCK / 2];
	lane_mask far = { 0 };
	struct lag *lag = w->lag;
	const uint32_t *parent = lag[0].ancestor;
	size_t from = first, those = n;

	for (int k = 0; k < w->count; k++) {
		const uint32_t *ancestor = lag[k].ancestor;

		if (ancestor) {
			those = ancestor[from + those - 1] - ancestor[from] + 1;
			from = ancestor[from];
		}
		lag[k].first = from;
		lag[k].n = those;
	}
	for (int to, end = w->count; end > 0; end = to) {
		const uint32_t *ancestor = NULL;

		if (end < w->count)
			ancestor = lag[end].ancestor + lag[end - 1].first;
		for (to = end - 1; to > 0 && !lag[to].ancestor;)
			to--;
		/* In place, from the end: the ancestors ascend from 0 in steps of 0 or 1,
		 * so that none lies after its descendant. */
		for (size_t i = (lag[to].n + 1) / 2 * 2; i > 0;) {
			size_t j = i - 1 < lag[to].n ? i - 1 : i - 2;
			size_t a = lag[to].first + (i -= 2), b = lag[to].first + j;
			struct sums s = { 0 };

			if (ancestor)
				s = sums_of(&sums, ancestor[i] - lag[end].first,
					ancestor[j] - lag[end].first);
			s = add_stretch(s, lag + to, end - to, w->centre,
				index ? index[a] : a, index ? index[b] : b);
			if (to > 0) {
				keep_sums(&sums, i, s);
				continue;
			}
			fit_pair(w, s, &level[i / 2], &rate[i / 2]);
			far = lanes_or(
				far, lanes_abs(rate[i / 2]) > w->ahead.largest_rate);
		}
	}
	/* in a loop of its own, so that several exponentials overlap in the processor */
	for (size_t i = 0; i < lag[0].n; i += 2)
		lanes_store(mean + i,
			grey_curve_near(level[i / 2], rate[i / 2], &w->ahead),
			lag[0].n - i < 2 ? 1 : 2);
	for (size_t i = 0; (far[0] | far[1]) && i < lag[0].n; i++)
		if (fabs(rate[i / 2][i % 2]) > w->ahead.largest_rate)
			mean[i] = grey_curve(level[i / 2][i % 2], rate[i / 2][i % 2],
				w->ahead.middle + w->ahead.half, 2 * w->ahead.half);
	for (size_t i = n; parent && i-- > 0;)
		mean[i] = mean[parent[first + i] - lag[0].first];
}

/* The same for n particles, or for those in index if it is given.  Histories with a
 * common ancestor share its sums.  Works in blocks whose sums fit in the cache: the
 * ancestors of successive particles are successive states. */
static void forecast(struct adaptive *a, int count, double h, double noise,
	const uint32_t *index, size_t n, double *mean)
{
	struct window w = { .lag = a->lag,
		.count = count,
		.share = 1.0 / count,
		.centre = a->lag[0].x[0],
		.least = 3 * noise };
	double end = h;

	for (int k = 0; k < count; k++)
		end += a->lag[k].gap;
	w.ahead = grey_interval(end, h);
	for (size_t i = 0; i < n; i += BLOCK)
		forecast_block(&w, index, i, n - i < BLOCK ? n - i : BLOCK, mean + i);
}

/* Prior mean of every particle: the grey forecast from its own last p states.  The oldest
 * state of the window only starts the first interval (see grey.h). */
static void forecast_particles(struct adaptive *a, int p, double h, double noise)
{
	int depth = a->par.filter.depth;

	for (int k = 0; k < p - 1; k++) {
		struct lag *lag = &a->lag[k];

		lag->x = filter_states(a->filter, k, &lag->ancestor);
		lag->gap = a->gap[(a->newest - k + depth) % depth];
	}
	forecast(a, p - 1, h, noise, NULL, a->par.filter.particles, a->mean);
}

static void hold_particles(struct adaptive *a)
{
	const double *x = filter_lag(a->filter, 0, a->index);

	for (size_t i = 0; i < a->par.filter.particles; i++)
		a->mean[i] = x[a->index[i]];
}

/* Stores a value, and the gap before it, for a restart. */
static void push_past(struct adaptive *a, double y, double gap)
{
	int depth = a->par.filter.depth;

	a->newest = (a->newest + 1) % depth;
	a->filled += a->filled < depth;
	a->past[a->newest] = y;
	a->gap[a->newest] = gap;
}

static enum num_status start_particles(struct adaptive *a, double noise)
{
	int depth = a->par.filter.depth;

	for (int k = 0; k < a->filled; k++)
		a->line_up[k] = a->past[(a->newest - a->filled + 1 + k + depth) % depth];
	a->nz = 0;
	return filter_start(a->filter, a->line_up, a->filled, sqrt(3) * noise);
}

/* sigma_v in scaled units; never 0, since a weight divides by it. */
static double observation_noise(const struct adaptive *a)
{
	double least = 1e-9 * (1 + fabs(a->past[a->newest]));
	double s = isnan(a->par.noise) ? a->noise.scale : a->par.noise / a->scale;

	return s > least ? s : least;
}

/* Process noise below which a filter of that order follows its own states and not the
 * data: half of sigma_v up to order 40, rising to sigma_v at 60. */
static double process_floor(int order, double noise)
{
	return noise * (order <= 40 ? 0.5 : order >= 60 ? 1 : 0.5 + (order - 40) / 40.0);
}

/* The second largest of the last squared errors of the grey model of the observations, so
 * that a single outlier has no influence. */
static double missed_lately(const struct adaptive *a)
{
	double largest = 0, second = 0;

	for (int k = 0; k < RECENT; k++) {
		second = fmax(second, fmin(a->missed[k], largest));
		largest = fmax(largest, a->missed[k]);
	}
	return second;
}

/* Recent error of that model beyond three standard deviations of the noise. */
static double model_error(const struct adaptive *a, double noise)
{
	return sqrt(fmax(0, missed_lately(a) - 9 * noise * noise));
}

/* An observation is classified as an outlier if its distance from the forecast, and from
 * the observation before it, is twenty times the recent error of noise and model.  Not
 * after a longer gap and not twice in a row: then the series itself has moved. */
static int is_outlier(
	struct adaptive *a, double y, double gap, double forecast, double noise)
{
	double usual = fmax(noise * noise, missed_lately(a));
	double miss = fmin(fabs(y - forecast), fabs(y - a->observed));

	a->outlier = !a->outlier && a->misses >= SETTLED && gap <= 2 * a->observed_gap &&
		     miss * miss > 400 * usual;
	a->outliers += (unsigned long)a->outlier;
	return a->outlier;
}

static double process_noise(const struct adaptive *a, int order, double noise, double gap)
{
	double steps = a->mean_gap > 0 ? gap / a->mean_gap : 1,
	       s = a->par.process / a->scale;

	if (isnan(a->par.process))
		s = fmax(a->process,
			fmax(process_floor(order, noise), model_error(a, noise)));
	return s * sqrt(fmin(16, fmax(1, steps)));
}

/* Estimates the process noise from the excess of the mean squared innovation over what
 * noise and the spread of the particles explain. */
static void learn_process(
	struct adaptive *a, double e, double variance, double process, double noise)
{
	double expected = variance + noise * noise, excess;
	double e2 = fmin(e * e, MONITOR_CLIP * expected);

	if (!(a->innovation > 0)) {
		a->innovation = expected;
		a->carried = expected - process * process;
	}
	a->innovation += (e2 - a->innovation) / MONITOR;
	a->carried += (expected - process * process - a->carried) / MONITOR;
	excess = a->innovation - a->carried;
	a->process = excess > 0 ? sqrt(excess) : 0;
}

/* 1 if the particles no longer follow the observations. */
static int monitor(struct adaptive *a, double e, double variance)
{
	double sum = 0;

	a->z2[a->nz++ % MONITOR] = fmin(e * e / variance, MONITOR_CLIP);
	if (a->nz < MONITOR)
		return 0;
	for (int i = 0; i < MONITOR; i++)
		sum += a->z2[i];
	if (a->nz == 2 * MONITOR)
		a->nz = MONITOR;
	return sum > MONITOR * MONITOR_LIMIT;
}

static enum num_status observe(struct adaptive *a, double y, double gap, double process,
	struct adaptive_row *row)
{
	double noise = observation_noise(a), variance = filter_variance(a->filter);
	double e = y - row->prediction, own;
	int lost;

	filter_update(a->filter, y, noise);
	row->state = filter_mean(a->filter);
	row->ess = filter_ess(a->filter);
	push_past(a, y, gap);
	if (row->order == 0) { /* too few points for a model: restart from all of them */
		lost = 1;
	} else {
		learn_process(a, e, variance, process, noise);
		/* The spread of the particles is limited: diverged particles would
		 * otherwise pass for uncertain ones. */
		own = noise * noise + process * process;
		lost = monitor(a, e, noise * noise + fmin(variance, 4 * own));
		a->restarts += (unsigned long)lost;
	}
	if (lost && start_particles(a, noise) != NUM_OK)
		return NUM_MEMORY;
	row->state = lost ? filter_mean(a->filter) : row->state;
	return NUM_OK;
}

/* Zeros are the same in any scale, so the scale may be set after them. */
static void learn_scale(struct adaptive *a, double y)
{
	int exponent;

	if (a->scaled || isnan(y) || y == 0)
		return;
	frexp(y, &exponent);
	a->scale = ldexp(1, exponent < -1000 ? -1000 : exponent);
	a->scaled = 1;
}

/* The first row with a value. */
static enum num_status begin(
	struct adaptive *a, double t, double y, struct adaptive_row *row)
{
	y /= a->scale;
	order_add(a->order, y, 0);
	noise_add(&a->noise, y, 0);
	push_past(a, y, 0);
	a->observed_time = t;
	if (start_particles(a, observation_noise(a)) != NUM_OK)
		return NUM_MEMORY;
	row->state = filter_mean(a->filter);
	row->ess = filter_ess(a->filter);
	return NUM_OK;
}

static enum num_status advance(
	struct adaptive *a, double t, double y, struct adaptive_row *row)
{
	double gap = t - a->time, noise = observation_noise(a), process;
	int order = order_chosen(a->order);

	if (order > filter_depth(a->filter))
		order = filter_depth(a->filter);
	if (order < GREY_ORDER_MIN)
		order = 0;
	row->order = order;
	row->grey = order_forecast(a->order, t - a->observed_time);
	process = process_noise(a, order, noise, gap);
	if (order > 0)
		forecast_particles(a, order, gap, noise);
	else
		hold_particles(a);
	if (filter_predict(a->filter, a->mean, process) != NUM_OK)
		return NUM_MEMORY;
	row->prediction = row->state = filter_mean(a->filter);
	row->ess = filter_ess(a->filter);
	a->mean_gap += (gap - a->mean_gap) / fmin((double)a->rows, 50);
	if (isnan(y)) {
		push_past(a, row->prediction, gap);
		return NUM_OK;
	}
	y /= a->scale;
	if (is_outlier(a, y, t - a->observed_time, row->grey, noise)) {
		push_past(a, row->prediction, gap);
		return NUM_OK;
	}
	a->missed[a->misses++ % RECENT] = (y - row->grey) * (y - row->grey);
	order_add(a->order, y, t - a->observed_time);
	noise_add(&a->noise, y, t - a->observed_time);
	a->observed_gap = t - a->observed_time;
	a->observed_time = t;
	a->observed = y;
	return observe(a, y, gap, process, row);
}

enum num_status adaptive_step(
	struct adaptive *a, double t, double y, struct adaptive_row *row)
{
	enum num_status status;

	*row = (struct adaptive_row){ NAN, NAN, NAN, NAN, NAN, 0 };
	learn_scale(a, y);
	if (a->rows > 0)
		status = advance(a, t, y, row);
	else if (!isnan(y))
		status = begin(a, t, y, row);
	else
		return NUM_OK;
	a->time = t;
	a->rows++;
	row->noise = observation_noise(a) * a->scale;
	row->grey *= a->scale;
	row->prediction *= a->scale;
	row->state *= a->scale;
	return status;
}

/* The histories of the particles as arrays side by side, the newest state at place 0 of
 * the ring. */
struct tracks {
	int p, newest;
	double noise;
	double *x;       /* [p][N] */
	uint32_t *index; /* of the particles that have not crossed */
};

static double *track_lag(const struct tracks *s, size_t n, int lag)
{
	return s->x + (size_t)((s->newest - lag + s->p) % s->p) * n;
}

static enum num_status start_tracks(struct adaptive *a, struct tracks *s)
{
	size_t n = a->par.filter.particles;

	s->x = malloc((size_t)s->p * n * sizeof *s->x);
	s->index = malloc(n * sizeof *s->index);
	if (!s->x || !s->index)
		return NUM_MEMORY;
	s->newest = s->p - 1;
	for (int lag = 0; lag < s->p; lag++) {
		const double *x = filter_lag(a->filter, lag, a->index);

		for (size_t i = 0; i < n; i++)
			track_lag(s, n, lag)[i] = x[a->index[i]];
	}
	return NUM_OK;
}

/* One step of the first live paths of index; paths that cross are removed.  Returns how
 * many remain. */
static size_t step_paths(struct adaptive *a, struct tracks *s, size_t live,
	double process, double limit, int direction, double time, double *life)
{
	size_t n = a->par.filter.particles, left = 0;
	double gap = a->mean_gap, *old = track_lag(s, n, 0), *now;

	for (int k = 0; k < s->p - 1; k++)
		a->lag[k] = (struct lag){ .x = track_lag(s, n, k), .gap = gap };
	forecast(a, s->p - 1, gap, s->noise, s->index, live, a->mean);
	s->newest = (s->newest + 1) % s->p;
	now = track_lag(s, n, 0);
	for (size_t k = 0; k < live; k++) {
		uint32_t i = s->index[k];

		now[i] = a->mean[k] + process * draw_normal(a->draw_paths);
		if (direction * (now[i] - limit) >= 0)
			life[i] = time +
				  gap * fmax(0, (limit - old[i]) / (now[i] - old[i]));
		else
			s->index[left++] = i;
	}
	return left;
}

enum num_status adaptive_lives(
	struct adaptive *a, double threshold, int direction, int steps, double *life)
{
	struct tracks s = { .p = order_chosen(a->order) };
	double noise = observation_noise(a), process, limit = threshold / a->scale;
	size_t n = a->par.filter.particles, left = 0;
	enum num_status status;

	if (s.p > filter_depth(a->filter))
		s.p = filter_depth(a->filter);
	if (s.p < GREY_ORDER_MIN)
		return NUM_DOMAIN;
	s.noise = noise;
	process = process_noise(a, s.p, noise, a->mean_gap);
	status = start_tracks(a, &s);
	for (size_t i = 0; status == NUM_OK && i < n; i++) {
		int crossed = direction * (track_lag(&s, n, 0)[i] - limit) >= 0;

		life[i] = crossed ? 0 : INFINITY;
		if (!crossed)
			s.index[left++] = (uint32_t)i;
	}
	for (int k = 0; status == NUM_OK && k < steps && left > 0; k++)
		left = step_paths(
			a, &s, left, process, limit, direction, k * a->mean_gap, life);
	free(s.x);
	free(s.index);
	return status;
}
