#include "layout/search.h"
#include "num/status.h"
#include <math.h>
#include <string.h>

enum { HALVINGS = 30 };             /* of the step: 1e-9 of the extent */
static const double deviations = 3; /* of a window to either side: 99.7 % of arrivals */

/* Variance of the arrival at a position beyond the coils that determine it, s2. */
static double predicted_variance(const struct layout_par *par, const double *coil,
	int coils, const struct bound *b, double at)
{
	double slowness = b->velocity / (par->bound.velocity * par->bound.velocity);
	double mean = 0;

	for (int k = 0; k < coils; k++)
		mean += coil[k] / coils;
	/* The arrival at the mean position is independent of the velocity. */
	return b->time * b->time +
	       (pow(at - mean, 2) - pow(coil[0] - mean, 2)) * slowness * slowness;
}

/* The windows at the coils of a layout, s.  Other particles are in at least one of them
 * during their union, which is between the widest of them and their sum. */
struct windows {
	double sum, widest;
};

static void search_window(struct windows *w, double width)
{
	w->sum += width;
	w->widest = fmax(w->widest, width);
}

void layout_evaluate(
	const struct layout_par *par, const double *coil, int coils, struct layout *out)
{
	double window = traffic_window(&par->traffic), single;
	struct windows first = { 0, 0 }, width = { 0, 0 };
	struct bound b;
	int next;

	bound_closed(&par->bound, coil, 1, &b);
	single = b.time * b.time;
	for (int k = 0; k < coils; k = next) {
		double all, narrow;

		for (next = k + 1; next < coils && !(coil[next] > coil[k]);)
			next++;
		if (next == coils)
			break;
		/* From the coils so far; both arrivals are measured. */
		bound_closed(&par->bound, coil, next, &b);
		narrow = 2 * deviations *
			 sqrt(predicted_variance(par, coil, next, &b, coil[next]) +
				 single);
		all = (coil[next] - coil[k]) * window + 2 * deviations * sqrt(2 * single);
		search_window(&first, k == 0 ? all : fmin(all, narrow));
		search_window(&width, fmin(all, narrow));
	}
	bound_closed(&par->bound, coil, coils, &out->bound);
	out->unique = traffic_unique(&par->traffic, first.sum);
	out->by_width = traffic_unique(&par->traffic, width.sum);
	out->unique_high = traffic_unique(&par->traffic, first.widest);
	out->by_width_high = traffic_unique(&par->traffic, width.widest);
}

/* One search. */
struct search {
	const struct layout_par *par;
	int coils;
	double extent, least;
	double best[LAYOUT_COILS];
	double error; /* error of the velocity of the best layout */
	long evaluated;
};

static int try(struct search *s, const double *coil)
{
	struct layout found;

	s->evaluated++;
	layout_evaluate(s->par, coil, s->coils, &found);
	if (found.by_width < s->least || !(found.bound.velocity < s->error))
		return 0;
	s->error = found.bound.velocity;
	memcpy(s->best, coil, (size_t)s->coils * sizeof *coil);
	return 1;
}

/* All positions of coil k and those after it, from the place of the one before on. */
static void try_all(struct search *s, double *coil, int k, int from, int steps)
{
	if (k == s->coils) {
		try(s, coil);
		return;
	}
	for (int i = from; i <= steps; i++) {
		coil[k] = s->extent * i / steps;
		try_all(s, coil, k + 1, i, steps);
	}
}

/* Moves the coils i to j by step if they stay in order. */
static int move(struct search *s, int i, int j, double step)
{
	double coil[LAYOUT_COILS];

	memcpy(coil, s->best, sizeof coil);
	for (int k = i; k <= j; k++)
		coil[k] = fmin(fmax(coil[k] + step, 0), s->extent);
	if (coil[i] < coil[i - 1] || (j + 1 < s->coils && coil[j] > coil[j + 1]))
		return 0;
	return try(s, coil);
}

static int improve(struct search *s, double step)
{
	int better = 0;

	for (int i = 1; i < s->coils; i++)
		for (int j = i; j < s->coils; j++)
			better |= move(s, i, j, step) || move(s, i, j, -step);
	return better;
}

enum num_status layout_search(const struct layout_par *par, int coils, double extent,
	double least, int steps, double *coil, struct layout *out)
{
	struct search s = { par, coils, extent, least, { 0 }, INFINITY, 0 };
	double trial[LAYOUT_COILS] = { 0 }, step = extent / steps;

	try_all(&s, trial, 1, 0, steps);
	if (!isfinite(s.error))
		return NUM_DOMAIN;
	for (int k = 0; k < HALVINGS; k++) {
		for (int turn = 0; turn < 2 * steps && improve(&s, step); turn++)
			;
		step /= 2;
	}
	memcpy(coil, s.best, (size_t)coils * sizeof *coil);
	layout_evaluate(par, coil, coils, out);
	out->evaluated = s.evaluated;
	return NUM_OK;
}
