#include "layout/search.h"
#include "num/status.h"
#include <math.h>
#include <string.h>

enum { HALVINGS = 30 }; /* of the step: 1e-9 of the extent */

void layout_evaluate(
	const struct layout_par *par, const double *coil, int coils, struct layout *out)
{
	struct match m;

	match_begin(&m, par, coils);
	bound_closed(&par->bound, coil, coils, &out->bound);
	out->unique = match_unique(&m, coil, 0);
	out->by_width = match_unique(&m, coil, 1);
}

/* One search. */
struct search {
	const struct layout_par *par;
	struct match match;
	int coils;
	double extent, least;
	double best[LAYOUT_COILS];
	double error; /* error of the velocity of the best layout */
	long evaluated;
};

static int try(struct search *s, const double *coil)
{
	struct bound b;

	s->evaluated++;
	bound_closed(&s->par->bound, coil, s->coils, &b);
	if (!(b.velocity < s->error) || !match_reaches(&s->match, coil, s->least))
		return 0;
	s->error = b.velocity;
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
	struct search s = { .par = par,
		.coils = coils,
		.extent = extent,
		.least = least,
		.error = INFINITY };
	double trial[LAYOUT_COILS] = { 0 }, step = extent / steps;

	match_begin(&s.match, par, coils);
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
