/* filter.c - see filter.h */
#include "life/particle/filter.h"
#include "num/lanes.h"
#include "num/student.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Log weights below it, relative to the largest, weigh nothing. */
static const double LEAST = -700;

/* One remembered step; its arrays are as long as they need be. */
struct step {
	double *x;
	size_t count;       /* of those that have descendants today */
	uint32_t *ancestor; /* of the states after it, where it was resampled */
	int resampled;
	size_t room, ancestors; /* lengths of the two */
};

struct filter {
	struct filter_par par;
	struct draw *draw;
	struct step *ring;
	int newest, filled;
	double *log_weight, *weight;
	uint32_t *kept;
	double sum; /* of weight */
	double mean, ess;
	unsigned long resamplings;
};

struct filter *filter_new(const struct filter_par *par, struct draw *draw)
{
	struct filter *f = calloc(1, sizeof *f);
	size_t n = par->particles;

	if (!f)
		return NULL;
	f->par = *par;
	f->draw = draw;
	f->ring = calloc((size_t)par->depth, sizeof *f->ring);
	f->log_weight = calloc(n, sizeof *f->log_weight);
	f->weight = calloc(n, sizeof *f->weight);
	f->kept = calloc(n, sizeof *f->kept);
	if (!f->ring || !f->log_weight || !f->weight || !f->kept) {
		filter_free(f);
		return NULL;
	}
	return f;
}

void filter_free(struct filter *f)
{
	if (!f)
		return;
	for (int k = 0; f->ring && k < f->par.depth; k++) {
		free(f->ring[k].x);
		free(f->ring[k].ancestor);
	}
	free(f->ring);
	free(f->log_weight);
	free(f->weight);
	free(f->kept);
	free(f);
}

static struct step *step_at(const struct filter *f, int lag)
{
	return &f->ring[(f->newest - lag + f->par.depth) % f->par.depth];
}

/* An array that has moved, so that the room of one that shrinks stays whole for the next
 * of full length; NULL: no memory. */
static void *moved(void *array, size_t bytes, size_t before)
{
	void *new = malloc(bytes > 0 ? bytes : 1);

	if (!new)
		return NULL;
	if (array)
		memcpy(new, array, bytes < before ? bytes : before);
	free(array);
	return new;
}

/* Resizes the arrays of a step: so many states, and ancestors of so many after it. */
static enum num_status fit_step(struct step *s, size_t count, size_t after)
{
	double *x = moved(s->x, count * sizeof *x, s->room * sizeof *x);
	uint32_t *ancestor = moved(
		s->ancestor, after * sizeof *ancestor, s->ancestors * sizeof *ancestor);

	if (x) {
		s->x = x;
		s->room = count;
	}
	if (ancestor) {
		s->ancestor = ancestor;
		s->ancestors = after;
	}
	return x && ancestor ? NUM_OK : NUM_MEMORY;
}

/* Whatever its length, an array takes the room of n: all states have one size. */
static void pass_array(struct state *s, void *array, size_t width, size_t count, size_t n)
{
	state_move(s, array, count * width);
	state_skip(s, (n - count) * width);
}

void filter_pass(struct filter *f, struct state *s)
{
	size_t n = f->par.particles;

	state_move(s, &f->newest, sizeof f->newest);
	state_move(s, &f->filled, sizeof f->filled);
	for (int lag = 0; lag < f->par.depth; lag++) {
		struct step *step = step_at(f, lag);
		size_t after = lag > 0 ? step_at(f, lag - 1)->count : n, ancestors;

		state_move(s, &step->resampled, sizeof step->resampled);
		state_move(s, &step->count, sizeof step->count);
		ancestors = lag < f->filled && step->resampled ? after : 0;
		if (s->load && fit_step(step, step->count, ancestors) != NUM_OK)
			s->failed = 1;
		if (s->failed)
			return;
		pass_array(s, step->x, sizeof *step->x, step->count, n);
		pass_array(s, step->ancestor, sizeof *step->ancestor, ancestors, n);
	}
	state_move(s, f->log_weight, n * sizeof *f->log_weight);
	state_move(s, f->weight, n * sizeof *f->weight);
	state_move(s, &f->sum, sizeof f->sum);
	state_move(s, &f->mean, sizeof f->mean);
	state_move(s, &f->ess, sizeof f->ess);
	state_move(s, &f->resamplings, sizeof f->resamplings);
}

int filter_depth(const struct filter *f)
{
	return f->filled;
}

/* NULL: no memory. */
static struct step *push_step(struct filter *f)
{
	struct step *before = step_at(f, 0), *s = step_at(f, -1);
	size_t n = f->par.particles;

	if (fit_step(s, n, n) != NUM_OK)
		return NULL;
	if (f->filled > 0 && !before->resampled && before != s)
		fit_step(before, before->count, 0);
	f->newest = (f->newest + 1) % f->par.depth;
	if (f->filled < f->par.depth)
		f->filled++;
	s->resampled = 0;
	s->count = n;
	return s;
}

static void weigh_equally(struct filter *f)
{
	for (size_t i = 0; i < f->par.particles; i++) {
		f->log_weight[i] = 0;
		f->weight[i] = 1;
	}
	f->sum = f->ess = (double)f->par.particles;
}

static double weighted_mean(const struct filter *f)
{
	const double *x = f->ring[f->newest].x;
	double sum = 0;

	for (size_t i = 0; i < f->par.particles; i++)
		sum += f->weight[i] * x[i];
	return sum / f->sum;
}

enum num_status filter_start(
	struct filter *f, const double *past, int count, double spread)
{
	f->filled = 0;
	for (int k = 0; k < count; k++) {
		struct step *s = push_step(f);

		if (!s)
			return NUM_MEMORY;
		for (size_t i = 0; i < f->par.particles; i++)
			s->x[i] = past[k] + spread * (2 * draw_uniform(f->draw) - 1);
	}
	weigh_equally(f);
	f->mean = weighted_mean(f);
	return NUM_OK;
}

const double *filter_lag(const struct filter *f, int lag, uint32_t *index, int *changed)
{
	const struct step *s = step_at(f, lag);
	size_t n = f->par.particles;
	int first = lag == 0;

	if (s->resampled && first)
		memcpy(index, s->ancestor, n * sizeof *index);
	else if (s->resampled)
		for (size_t i = 0; i < n; i++)
			index[i] = s->ancestor[index[i]];
	else if (first)
		for (size_t i = 0; i < n; i++)
			index[i] = (uint32_t)i;
	*changed = first || s->resampled;
	return s->x;
}

const double *filter_states(const struct filter *f, int lag, const uint32_t **ancestor)
{
	const struct step *s = step_at(f, lag);

	*ancestor = s->resampled ? s->ancestor : NULL;
	return s->x;
}

enum num_status filter_predict(struct filter *f, const double *mean, double sigma)
{
	int resampled = f->ring[f->newest].resampled;
	struct step *s = push_step(f);
	double *x, moment = 0;

	if (!s)
		return NUM_MEMORY;
	if (resampled)
		weigh_equally(f);
	x = s->x;
	draw_normals(f->draw, x, f->par.particles);
	for (size_t i = 0; i < f->par.particles; i++) {
		x[i] = mean[i] + sigma * x[i];
		moment += f->weight[i] * x[i];
	}
	f->mean = moment / f->sum;
	return NUM_OK;
}

double filter_mean(const struct filter *f)
{
	return f->mean;
}

double filter_variance(const struct filter *f)
{
	const double *x = f->ring[f->newest].x;
	double sum = 0;

	for (size_t i = 0; i < f->par.particles; i++)
		sum += f->weight[i] * (x[i] - f->mean) * (x[i] - f->mean);
	return sum / f->sum;
}

double filter_ess(const struct filter *f)
{
	return f->ess;
}

unsigned long filter_resamplings(const struct filter *f)
{
	return f->resamplings;
}

/* Adds the log-likelihood of y; returns the largest log-weight. */
static double weigh(struct filter *f, double y, double noise)
{
	const double *x = f->ring[f->newest].x;
	double *lw = f->log_weight, nu = f->par.freedom, scale = 1 / noise;
	lanes top = lanes_all(-INFINITY);

	for (size_t i = 0; i < f->par.particles; i += 2) {
		int width = f->par.particles - i < 2 ? 1 : 2;
		lanes z = (y - lanes_load(x + i, width)) * scale, less = 0.5 * z * z, sum;

		if (nu > 0)
			less = 0.5 * (nu + 1) *
			       (lanes){ log1p(z[0] * z[0] / nu),
				       log1p(z[1] * z[1] / nu) };
		sum = lanes_load(lw + i, width) - less;
		lanes_store(lw + i, sum, width);
		top = lanes_max(top, sum);
	}
	return fmax(top[0], top[1]);
}

/* log of the constant of the likelihood */
static double log_constant(const struct filter *f, double noise)
{
	double nu = f->par.freedom;

	if (nu > 0)
		return student_log_constant(nu) - log(noise);
	return -0.5 * log(2 * M_PI) - log(noise);
}

/* Numbers the distinct ones of n ancestors, which rise, anew from 0, and lists what they
 * were.  Returns how many there are. */
static size_t renumber(uint32_t *ancestor, size_t n, uint32_t *kept)
{
	uint32_t last = ancestor[0], m = 0;

	for (size_t i = 0; i < n; i++) {
		uint32_t old = ancestor[i];

		m += old != last; /* no branch: it would be mispredicted */
		kept[m] = last = old;
		ancestor[i] = m;
	}
	return (size_t)m + 1;
}

/* Drops the states that have no descendants since the newest step was resampled. */
static void prune(struct filter *f)
{
	size_t n = 0;

	for (int lag = 0; lag < f->filled; lag++) {
		struct step *s = step_at(f, lag);
		size_t after = lag ? n : s->count;

		if (s->resampled) {
			for (size_t i = 0; i < n; i++)
				s->ancestor[i] = s->ancestor[f->kept[i]];
			n = renumber(s->ancestor, after, f->kept);
		}
		if (n == s->count)
			return;
		for (size_t i = 0; i < n; i++)
			s->x[i] = s->x[f->kept[i]];
		s->count = n;
		if (n < s->room / 2 || after < s->ancestors / 2)
			fit_step(s, n, s->resampled ? after : 0);
	}
}

double filter_update(struct filter *f, double y, double noise)
{
	struct step *s = &f->ring[f->newest];
	double before = f->sum, top = weigh(f, y, noise), sum, squares, moment;
	lanes sums[3] = { { 0 } };
	size_t n = f->par.particles;

	for (size_t i = 0; i < n; i += 2) {
		int width = n - i < 2 ? 1 : 2;
		lanes lw = lanes_load(f->log_weight + i, width) - top;
		lanes w =
			lanes_if(lw > LEAST, lanes_exp(lanes_max(lw, lanes_all(LEAST))));

		lanes_store(f->log_weight + i, lw, width);
		lanes_store(f->weight + i, w, width);
		lanes_add(&sums[0], w, width);
		lanes_add(&sums[1], w * w, width);
		lanes_add(&sums[2], w * lanes_load(s->x + i, width), width);
	}
	sum = sums[0][0] + sums[0][1];
	squares = sums[1][0] + sums[1][1];
	moment = sums[2][0] + sums[2][1];
	f->sum = sum;
	f->ess = sum * sum / squares;
	f->mean = moment / sum;
	if (f->par.share >= 1 || f->ess < f->par.share * (double)n) {
		resample(f->par.scheme, f->draw, f->weight, f->sum, n, s->ancestor);
		s->resampled = 1;
		f->resamplings++;
		prune(f);
	}
	return log_constant(f, noise) + top + log(f->sum / before);
}
