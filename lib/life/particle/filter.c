/* filter.c - see filter.h */
#include "life/particle/filter.h"
#include "num/lanes.h"
#include "num/student.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest distance of a log-likelihood from 0 at which exp() is finite and not 0; a
 * particle farther below has weight 0. */
static const double FAR = 700;
/* Sum of the weights below which they are computed as logarithms.  A particle that has
 * underflowed by then has less than 1e-200 of the sum. */
static const double FADED = 1e-100;

/* One stored step; its arrays are only as long as required. */
struct step {
	double *x;
	size_t count;       /* states that still have descendants */
	uint32_t *ancestor; /* of each state of the next step, if that was resampled */
	int resampled;
	size_t room; /* length of x */
};

struct filter {
	struct filter_par par;
	struct draw *draw;
	struct step *ring;
	int newest, filled;
	double *weight, *next; /* next: those after */
	uint32_t *kept;
	double sum; /* of weight */
	double mean, variance, ess;
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
	f->weight = calloc(n, sizeof *f->weight);
	f->next = calloc(n, sizeof *f->next);
	f->kept = calloc(n, sizeof *f->kept);
	if (!f->ring || !f->weight || !f->next || !f->kept) {
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
	free(f->weight);
	free(f->next);
	free(f->kept);
	free(f);
}

static struct step *step_at(const struct filter *f, int lag)
{
	return &f->ring[(f->newest - lag + f->par.depth) % f->par.depth];
}

/* Resizes the arrays of a step to count states and after ancestors; one more, since 0
 * bytes may be NULL. */
static enum num_status fit_step(struct step *s, size_t count, size_t after)
{
	double *x = realloc(s->x, (count + 1) * sizeof *x);
	uint32_t *ancestor = realloc(s->ancestor, (after + 1) * sizeof *ancestor);

	if (x)
		s->x = x;
	if (ancestor)
		s->ancestor = ancestor;
	s->room = count;
	return x && ancestor ? NUM_OK : NUM_MEMORY;
}

/* Saves an array in the space of n elements whatever its length, so that all saved states
 * have one size. */
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
	state_move(s, f->weight, n * sizeof *f->weight);
	state_move(s, &f->sum, sizeof f->sum);
	state_move(s, &f->mean, sizeof f->mean);
	state_move(s, &f->variance, sizeof f->variance);
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
	for (size_t i = 0; i < f->par.particles; i++)
		f->weight[i] = 1;
	f->sum = f->ess = (double)f->par.particles;
}

/* Mean and variance of the states; squares are taken about one of the states. */
static void find_moments(struct filter *f)
{
	const double *x = f->ring[f->newest].x;
	size_t n = f->par.particles;
	lanes sums[2] = { { 0 } };
	double off;

	for (size_t i = 0; i < n; i += 2) {
		int width = n - i < 2 ? 1 : 2;
		lanes d = lanes_load(x + i, width) - x[0],
		      part = lanes_load(f->weight + i, width) * d;

		lanes_add(&sums[0], part, width);
		lanes_add(&sums[1], part * d, width);
	}
	off = (sums[0][0] + sums[0][1]) / f->sum;
	f->mean = x[0] + off;
	f->variance = fmax(0, (sums[1][0] + sums[1][1]) / f->sum - off * off);
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
	find_moments(f);
	return NUM_OK;
}

const double *filter_lag(const struct filter *f, int lag, uint32_t *index)
{
	const struct step *s = step_at(f, lag);
	size_t n = f->par.particles;

	if (s->resampled && lag == 0)
		memcpy(index, s->ancestor, n * sizeof *index);
	else if (s->resampled)
		for (size_t i = 0; i < n; i++)
			index[i] = s->ancestor[index[i]];
	else if (lag == 0)
		for (size_t i = 0; i < n; i++)
			index[i] = (uint32_t)i;
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

	if (!s)
		return NUM_MEMORY;
	if (resampled)
		weigh_equally(f);
	draw_normals(f->draw, s->x, f->par.particles);
	for (size_t i = 0; i < f->par.particles; i += 2) {
		int width = f->par.particles - i < 2 ? 1 : 2;

		lanes_store(s->x + i,
			lanes_load(mean + i, width) + sigma * lanes_load(s->x + i, width),
			width);
	}
	find_moments(f);
	return NUM_OK;
}

double filter_mean(const struct filter *f)
{
	return f->mean;
}

double filter_variance(const struct filter *f)
{
	return f->variance;
}

double filter_ess(const struct filter *f)
{
	return f->ess;
}

unsigned long filter_resamplings(const struct filter *f)
{
	return f->resamplings;
}

/* Of two states, without its constant. */
static inline lanes log_likelihood(lanes z, double nu)
{
	return nu > 0 ? -0.5 * (nu + 1) *
				(lanes){ log1p(z[0] * z[0] / nu),
					log1p(z[1] * z[1] / nu) }
		      : -0.5 * z * z;
}

/* Logarithm of the largest weight after the observation y, rounded as in weigh(): far
 * from y it could otherwise differ from all of them by more than FAR. */
static double best(const struct filter *f, double y, double noise)
{
	const double *x = f->ring[f->newest].x;
	double top = -INFINITY, nu = f->par.freedom, scale = 1 / noise;

	for (size_t i = 0; i < f->par.particles; i++) {
		double l = log_likelihood(lanes_all((y - x[i]) * scale), nu)[0],
		       before = log(f->weight[i]);

		if (before > -FAR)
			top = fmax(top, before + l);
	}
	return top;
}

/* Weights after y divided by e^top, into next; returns the sum of their squares. */
static double weigh(struct filter *f, double y, double noise, double top)
{
	const double *x = f->ring[f->newest].x;
	double nu = f->par.freedom, scale = 1 / noise;
	size_t n = f->par.particles;
	lanes sums[3] = { { 0 } };

	for (size_t i = 0; i < n; i += 2) {
		int width = n - i < 2 ? 1 : 2;
		lanes l =
			log_likelihood((y - lanes_load(x + i, width)) * scale, nu) - top;
		lanes w = lanes_load(f->weight + i, width) *
			  lanes_if(lanes_abs(l) < FAR, lanes_exp(l));

		lanes_store(f->next + i, w, width);
	}
	/* in a loop of its own, so that several exponentials overlap in the processor */
	for (size_t i = 0; i < n; i += 2) {
		int width = n - i < 2 ? 1 : 2;
		lanes w = lanes_load(f->next + i, width), at = lanes_load(x + i, width);

		lanes_add(&sums[0], w, width);
		lanes_add(&sums[1], w * w, width);
		lanes_add(&sums[2], w * at, width);
	}
	f->sum = sums[0][0] + sums[0][1];
	f->mean = (sums[2][0] + sums[2][1]) / f->sum;
	return sums[1][0] + sums[1][1];
}

/* log of the constant of the likelihood */
static double log_constant(const struct filter *f, double noise)
{
	double nu = f->par.freedom;

	if (nu > 0)
		return student_log_constant(nu) - log(noise);
	return -0.5 * log(2 * M_PI) - log(noise);
}

/* Renumbers the distinct values of n ascending ancestors from 0 on, and lists the old
 * values in kept.  Returns how many there are. */
static size_t renumber(uint32_t *ancestor, size_t n, uint32_t *kept)
{
	uint32_t last = ancestor[0], m = 0;

	for (size_t i = 0; i < n; i++) {
		uint32_t old = ancestor[i];

		m += old != last; /* without a branch, which would be mispredicted */
		kept[m] = last = old;
		ancestor[i] = m;
	}
	return (size_t)m + 1;
}

/* Drops the states that have had no descendants since the newest step was resampled. */
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
		if (n < s->room / 2)
			fit_step(s, n, s->resampled ? after : 0);
	}
}

double filter_update(struct filter *f, double y, double noise)
{
	struct step *s = &f->ring[f->newest];
	double before = f->sum, top = 0, squares = weigh(f, y, noise, 0), *spent;
	size_t n = f->par.particles;

	if (!(f->sum > FADED)) {
		top = best(f, y, noise);
		squares = weigh(f, y, noise, top);
	}
	spent = f->weight;
	f->weight = f->next;
	f->next = spent;
	f->ess = f->sum * f->sum / squares;
	if (f->par.share >= 1 || f->ess < f->par.share * (double)n) {
		resample(f->par.scheme, f->draw, f->weight, f->sum, n, s->ancestor);
		s->resampled = 1;
		f->resamplings++;
		prune(f);
	}
	return log_constant(f, noise) + top + log(f->sum / before);
}
