/* filter.c - see filter.h */
#include "life/particle/filter.h"
#include "num/lanes.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest distance of a log-likelihood from the largest at which exp() is not 0; a
 * particle farther below has weight 0. */
static const double FAR = 700;

struct filter {
	struct filter_par par;
	struct draw *draw;
	double *x;          /* [depth][N], a ring; the arrays below are behind it */
	double *weight;     /* [N] */
	size_t *count;      /* [depth]: states that still have descendants */
	uint32_t *ancestor; /* [depth][N]: of each state of the next step */
	uint32_t *kept;     /* [N] */
	struct filter_state {
		int newest, filled;
		double sum; /* of weight */
		struct filter_now now;
	} at;
};

/* Of the arrays that belong to the state, all but kept. */
static size_t size_of_arrays(const struct filter_par *par)
{
	size_t n = par->particles, depth = (size_t)par->depth;

	return (depth + 1) * n * sizeof(double) + depth * sizeof(size_t) +
	       depth * n * sizeof(uint32_t);
}

struct filter *filter_new(const struct filter_par *par, struct draw *draw)
{
	struct filter *f = calloc(1, sizeof *f);
	size_t n = par->particles, depth = (size_t)par->depth;
	void *rest;

	if (!f)
		return NULL;
	f->par = *par;
	f->draw = draw;
	f->x = calloc(1, size_of_arrays(par) + n * sizeof *f->kept);
	if (!f->x) {
		filter_free(f);
		return NULL;
	}
	f->weight = f->x + depth * n;
	rest = f->weight + n; /* of falling alignment */
	f->count = rest;
	rest = f->count + depth;
	f->ancestor = rest;
	f->kept = f->ancestor + depth * n;
	return f;
}

struct filter *filter_copy(const struct filter *f, struct draw *draw)
{
	struct filter *copy = filter_new(&f->par, draw);

	if (!copy)
		return NULL;
	memcpy(copy->x, f->x, size_of_arrays(&f->par));
	copy->at = f->at;
	return copy;
}

void filter_free(struct filter *f)
{
	if (f)
		free(f->x);
	free(f);
}

void filter_pass(struct filter *f, struct state *s)
{
	state_move(s, f->x, size_of_arrays(&f->par));
	state_move(s, &f->at, sizeof f->at);
}

static size_t place_of(const struct filter *f, int lag)
{
	return (size_t)((f->at.newest - lag + f->par.depth) % f->par.depth);
}

static double *states_of(const struct filter *f, int lag)
{
	return f->x + place_of(f, lag) * f->par.particles;
}

static uint32_t *ancestors_of(const struct filter *f, int lag)
{
	return f->ancestor + place_of(f, lag) * f->par.particles;
}

struct filter_step filter_step(const struct filter *f, int lag)
{
	return (struct filter_step){ states_of(f, lag), ancestors_of(f, lag),
		f->count[place_of(f, lag)] };
}

/* The states of the next step, to be filled. */
static double *push_step(struct filter *f)
{
	uint32_t *own;

	f->at.newest = (f->at.newest + 1) % f->par.depth;
	if (f->at.filled < f->par.depth)
		f->at.filled++;
	f->count[f->at.newest] = f->par.particles;
	own = ancestors_of(f, 0);
	for (size_t i = 0; i < f->par.particles; i++)
		own[i] = (uint32_t)i;
	return states_of(f, 0);
}

static void weigh_equally(struct filter *f)
{
	for (size_t i = 0; i < f->par.particles; i++)
		f->weight[i] = 1;
	f->at.sum = (double)f->par.particles;
}

/* Mean of the states, about one of them, and the effective sample size. */
static void find_moments(struct filter *f)
{
	const double *x = states_of(f, 0);
	size_t n = f->par.particles;
	lanes off = { 0 }, squares = { 0 };

	for (size_t i = 0; i < n; i += 2) {
		int width = n - i < 2 ? 1 : 2;
		lanes w = lanes_load(f->weight + i, width);

		lanes_add(&off, w * (lanes_load(x + i, width) - x[0]), width);
		lanes_add(&squares, w * w, width);
	}
	f->at.now.mean = x[0] + (off[0] + off[1]) / f->at.sum;
	f->at.now.ess = f->at.sum * f->at.sum / (squares[0] + squares[1]);
}

void filter_start(struct filter *f, const double *past, int count, double spread)
{
	f->at.filled = 0;
	for (int k = 0; k < count; k++) {
		double *x = push_step(f);

		for (size_t i = 0; i < f->par.particles; i++)
			x[i] = past[k] + spread * (2 * draw_uniform(f->draw) - 1);
	}
	weigh_equally(f);
	find_moments(f);
}

void filter_predict(struct filter *f, const double *mean, double sigma)
{
	double *x = push_step(f);

	draw_normals(f->draw, x, f->par.particles);
	for (size_t i = 0; i < f->par.particles; i++)
		x[i] = mean[i] + sigma * x[i];
	find_moments(f);
}

struct filter_now filter_now(const struct filter *f)
{
	return f->at.now;
}

/* The least distance of a particle that has a weight from y, in standard deviations. */
static double nearest(const struct filter *f, double y, double noise)
{
	const double *x = states_of(f, 0);
	double least = INFINITY;

	for (size_t i = 0; i < f->par.particles; i++) {
		double z = fabs((y - x[i]) * (1 / noise));

		if (f->weight[i] > 0 && z < least)
			least = z;
	}
	return least;
}

/* Multiplies the weights by the likelihoods of y over that of the nearest particle, whose
 * weight stays, so that they do not all underflow; returns the sum of their squares. */
static double weigh(struct filter *f, double y, double noise, double near)
{
	const double *x = states_of(f, 0);
	double *weight = f->weight;
	size_t n = f->par.particles;
	lanes sums[3] = { { 0 } };

	for (size_t i = 0; i < n; i += 2) {
		int width = n - i < 2 ? 1 : 2;
		lanes at = lanes_load(x + i, width), z = (y - at) * (1 / noise),
		      l = 0.5 * (near * near - z * z),
		      w = lanes_load(weight + i, width) *
			  lanes_if(l > -FAR, lanes_exp(l));

		lanes_store(weight + i, w, width);
		lanes_add(&sums[0], w, width);
		lanes_add(&sums[1], w * w, width);
		lanes_add(&sums[2], w * at, width);
	}
	f->at.sum = sums[0][0] + sums[0][1];
	f->at.now.mean = (sums[2][0] + sums[2][1]) / f->at.sum;
	return sums[1][0] + sums[1][1];
}

/* Point k of the comb, k + offset, is compared with the running sum of the weights.  The
 * ancestor of a particle is the number of those whose last copy lies before it; these are
 * counted and summed without a branch, which would be mispredicted. */
void resample(
	struct draw *draw, const double *weight, double sum, size_t n, uint32_t *ancestor)
{
	double scale = (double)n / sum, reached = 0, offset = draw_uniform(draw);
	uint32_t ended = 0;

	memset(ancestor, 0, n * sizeof *ancestor);
	for (size_t i = 0; i + 1 < n; i++) {
		size_t end;

		reached += weight[i];
		end = (size_t)(reached * scale + (1 - offset));
		if (end < n)
			ancestor[end]++;
	}
	for (size_t k = 0; k < n; k++)
		ancestor[k] = ended += ancestor[k];
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

	for (int lag = 0; lag < f->at.filled; lag++) {
		size_t *count = &f->count[place_of(f, lag)];
		double *x = states_of(f, lag);
		uint32_t *ancestor = ancestors_of(f, lag);

		for (size_t i = 0; i < n; i++)
			ancestor[i] = ancestor[f->kept[i]];
		n = renumber(ancestor, lag ? n : *count, f->kept);
		if (n == *count)
			return;
		for (size_t i = 0; i < n; i++)
			x[i] = x[f->kept[i]];
		*count = n;
	}
}

double filter_update(struct filter *f, double y, double noise)
{
	double before = f->at.sum, near = nearest(f, y, noise),
	       squares = weigh(f, y, noise, near), sum = f->at.sum;
	size_t n = f->par.particles;

	f->at.now.ess = sum * sum / squares;
	if (f->par.share >= 1 || f->at.now.ess < f->par.share * (double)n) {
		resample(f->draw, f->weight, sum, n, ancestors_of(f, 0));
		weigh_equally(f);
		prune(f);
		f->at.now.resamplings++;
	}
	return log(sum / before) - 0.5 * near * near - log(noise) - 0.5 * log(2 * M_PI);
}
