#include "quick.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/surrogate_table.h"
#include <math.h>
#include <stdlib.h>

static const char *path;
static double level = 0.9, width = 0.25, audit = 0.02;

struct opt quick_rows[] = {
	OPT_HEADING("Surrogate"),
	{ 0, "surrogate", OPT_TEXT, UNIT_NONE, &path, 0, 0, "FILE",
		"estimate volumes by the surrogate that debrisfit has written", NULL, 0 },
	{ 0, "interval", OPT_NUM, UNIT_FRACTION, &level, 0.1, 0.999, "C",
		"level of the intervals of the estimates", NULL, 0 },
	{ 0, "width", OPT_NUM, UNIT_FRACTION, &width, 0, 1e6, "W",
		"run the full model where the interval of the total volume is wider than "
		"this on either side, relative",
		NULL, 0 },
	{ 0, "audit", OPT_NUM, UNIT_FRACTION, &audit, 0, 1, "A",
		"run the full model as well on this share of the surfaces", NULL, 0 },
	OPT_END,
};

/* An audit fails where so many misses or more have less than this probability. */
static const double UNLIKELY = 0.01;

struct quick {
	struct surrogate surrogate;
	struct footprints *footprints;
	struct stress_par par;
	struct surrogate_guess *guess;
	struct particle *particle;
	size_t room;
	struct quick_volumes volumes;
	int audited; /* the present surface */
	int doubted; /* the surrogate itself */
	long outside, wide, audits, within, estimated;
};

int quick_asked(void)
{
	return path != NULL;
}

struct quick *quick_open(void)
{
	struct quick *q = xcalloc(1, sizeof *q);
	double highest;

	q->doubted = surrogate_read(path, &q->surrogate);
	highest = surrogate_highest_level(&q->surrogate);
	if (level > highest + 1e-9)
		die(EXIT_RUN,
			"--interval %g: the surfaces behind %s give intervals of level %.3g at most",
			level, path, floor(highest * 1000) / 1000);
	return q;
}

void quick_close(struct quick *q)
{
	if (!q)
		return;
	footprints_free(q->footprints);
	free(q->guess);
	free(q->particle);
	free(q);
}

void quick_prepare(struct quick *q, const struct stress_par *par)
{
	footprints_free(q->footprints);
	q->footprints = footprints_new(par);
	q->par = *par;
	if (!q->footprints)
		die(EXIT_RUN, "out of memory");
}

/* The properties of a particle that follow from its footprint. */
static struct particle particle_of(
	const struct footprint *f, const struct surrogate_guess *guess)
{
	return (struct particle){ .columns = f->cells,
		.volume = guess->volume,
		.diameter = cbrt(6 * guess->volume / M_PI),
		.length = NAN,
		.width = NAN,
		.aspect = NAN,
		.elongation = NAN,
		.solidity = NAN,
		.area = NAN,
		.azimuth = NAN,
		.dip = NAN,
		.x = f->x,
		.y = f->y,
		.z = NAN,
		.low = { f->low[0], f->low[1], 0 },
		.high = { f->high[0], f->high[1], NAN } };
}

/* Surfaces to audit, by their number: the multiples of the golden ratio fill [0, 1)
 * evenly. */
static int chosen(long realisation)
{
	double u = (double)realisation * 0.6180339887498949;

	return u - floor(u) < audit;
}

/* As in debris.c, below the border as deep as on average. */
static double beyond(const struct footprint *f)
{
	double depth = f->volume / f->area;

	return 0.5 * f->border * depth * depth;
}

static int is_wide(const struct surrogate_guess *total)
{
	return total->high > total->volume * (1 + width) ||
	       total->low < total->volume * (1 - width);
}

int quick_step(struct quick *q, struct stress *stress, const double *pressure,
	double yield, double hardness, long realisation, struct debris_step *step)
{
	const struct footprint *list;
	struct surrogate_contact contact;
	size_t n;

	if (footprints_find(q->footprints, stress, pressure, yield, &list, &n) != NUM_OK)
		die(EXIT_RUN, "out of memory");
	if (n > q->room) {
		q->room = 2 * n;
		q->guess = xrealloc(q->guess, q->room, sizeof *q->guess);
		q->particle = xrealloc(q->particle, q->room, sizeof *q->particle);
	}
	q->volumes = (struct quick_volumes){ .exact = n == 0, .particle = q->guess };
	q->audited = 0;
	contact = surrogate_contact(&q->par, stress, pressure, hardness);
	if (!surrogate_guess(&q->surrogate, list, n, &contact, level, q->guess,
		    &q->volumes.total)) {
		q->outside++;
		return 0;
	}
	if (n > 0 && is_wide(&q->volumes.total)) {
		q->wide++;
		return 0;
	}
	if (chosen(realisation)) {
		q->audited = 1;
		return 0;
	}
	q->estimated++;
	step->wear = (struct wear_result){ .layers = 1 };
	step->volume = q->volumes.total.volume;
	step->depth = n ? NAN : 0;
	step->count = n;
	step->particle = q->particle;
	for (size_t i = 0; i < n; i++) {
		q->particle[i] = particle_of(&list[i], &q->guess[i]);
		step->wear.stress = fmax(step->wear.stress, list[i].stress);
		step->wear.columns += (long)list[i].cells;
		step->beyond += beyond(&list[i]);
	}
	return 1;
}

void quick_take(struct quick *q, const struct debris_step *step)
{
	const struct surrogate_guess *guessed = &q->volumes.total;

	if (q->audited) {
		q->audits++;
		q->within += step->volume >= guessed->low * (1 - 1e-12) &&
			     step->volume <= guessed->high * (1 + 1e-12);
	}
	q->volumes.exact = 1;
}

const struct quick_volumes *quick_volumes(const struct quick *q)
{
	return &q->volumes;
}

/* Probability of at most k of n events of probability p. */
static double at_most(long k, long n, double p)
{
	double sum = 0;

	for (long i = 0; i <= k; i++)
		sum += exp(lgamma((double)n + 1) - lgamma((double)i + 1) -
			   lgamma((double)(n - i) + 1) + (double)i * log(p) +
			   (double)(n - i) * log1p(-p));
	return sum;
}

int quick_report(const struct quick *q, const char *name)
{
	stats_set("surfaces_estimated", (double)q->estimated);
	stats_set("surfaces_outside", (double)q->outside);
	stats_set("surfaces_wide", (double)q->wide);
	stats_set("surfaces_audited", (double)q->audits);
	stats_set("audits_within", (double)q->within);
	if (q->outside + q->wide > 0)
		warn("%s: the full model was run on %ld surfaces outside the range of %s and "
		     "on %ld of too wide an interval; %ld were estimated",
			name, q->outside, path, q->wide, q->estimated);
	if (at_most(q->within, q->audits, level) >= UNLIKELY)
		return !q->doubted;
	warn("%s: %ld of %ld audited volumes lie within their intervals of level %g: %s is "
	     "not of surfaces like these",
		name, q->within, q->audits, level, path);
	return 0;
}
