/* instrument.c - see instrument.h */
#include "signal/separate/instrument.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Exactly one of the pointers is set. */
struct field {
	const char *name;
	int *whole;
	long *longer;
	size_t *size;
	double *real;
	int count; /* numbers of real */
};

enum { SCALARS = 48, SHORTEST_HOP = 32 };

/* The numbers whose count is fixed or follows from preceding numbers. */
static int list(struct instrument *in, struct field *f)
{
	struct calibration *c = &in->cal;
	struct whitening *w = &c->whitening;
	const struct field all[] = {
		{ .name = "shift", .longer = &c->shift },
		{ .name = "tones", .whole = &c->tones },
		{ .name = "omega", .real = c->omega, .count = TONES_MAX },
		{ .name = "tone_hop", .size = &c->tone_hop },
		{ .name = "tone_power", .real = c->tone_power, .count = TONES_MAX },
		{ .name = "tone_variance", .real = &c->tone_variance, .count = 1 },
		{ .name = "mean", .real = c->mean, .count = 2 },
		{ .name = "noise", .real = c->noise, .count = 2 },
		{ .name = "pulse", .whole = &c->pulse },
		{ .name = "measured", .whole = &c->measured },
		{ .name = "reversed", .whole = &c->reversed },
		{ .name = "corrected", .whole = &c->corrected },
		{ .name = "duration", .real = &c->duration, .count = 1 },
		{ .name = "gain", .real = &c->gain, .count = 1 },
		{ .name = "transit", .real = &c->transit, .count = 1 },
		{ .name = "delta_min", .real = &c->delta_min, .count = 1 },
		{ .name = "delta_max", .real = &c->delta_max, .count = 1 },
		{ .name = "drop", .real = &c->drop, .count = 1 },
		{ .name = "drop_near", .real = &c->drop_near, .count = 1 },
		{ .name = "misfit", .real = &c->misfit, .count = 1 },
		{ .name = "events", .whole = &c->events },
		{ .name = "suspect", .whole = &c->suspect },
		{ .name = "guessed", .whole = &c->guessed },
		{ .name = "dense", .whole = &c->dense },
		{ .name = "chi2", .real = &c->chi2, .count = 1 },
		{ .name = "white_half", .whole = &w->half },
		{ .name = "white_seen_half", .whole = &w->seen_half },
		{ .name = "white_edge", .whole = &w->edge },
		{ .name = "white_low", .real = &w->low, .count = 1 },
		{ .name = "white_high", .real = &w->high, .count = 1 },
		{ .name = "white_band", .real = &w->band, .count = 1 },
		{ .name = "ratio", .whole = &in->ratio },
		{ .name = "crowded", .whole = &in->crowded },
		{ .name = "flow_mean", .real = &in->flow.mean, .count = 1 },
		{ .name = "flow_variance", .real = &in->flow.var, .count = 1 },
		{ .name = "flow_margin", .real = &in->flow.margin, .count = 1 },
		{ .name = "flow_count", .real = &in->flow.count, .count = 1 },
		{ .name = "level", .real = in->level, .count = 2 },
		{ .name = "level_samples", .real = &in->level_samples, .count = 1 },
		{ .name = "common", .real = in->common, .count = 3 },
	};

	memcpy(f, all, sizeof all);
	return (int)(sizeof all / sizeof *all);
}

static int is_tone(const struct field *f)
{
	return f->count == TONES_MAX;
}

static void put(struct instrument_value *v, size_t *n, const char *name, int i, double x)
{
	v[(*n)++] = (struct instrument_value){ name, i, x };
}

enum num_status instrument_values(
	const struct instrument *in, struct instrument_value **value, size_t *n)
{
	struct instrument copy = *in;
	const struct whitening *w = &copy.cal.whitening;
	const struct shape *shape = copy.cal.shape;
	struct field f[SCALARS];
	int fields = list(&copy, f), cells = shape_cells(shape);
	size_t most = 2 * (size_t)(w->half + w->seen_half) + 4 * (size_t)cells +
		      3 * TONES_MAX + SCALARS;
	struct instrument_value *v = malloc(most * sizeof *v);

	*value = v;
	*n = 0;
	if (!v)
		return NUM_MEMORY;
	for (int k = 0; k < fields; k++) {
		int count = is_tone(&f[k]) ? copy.cal.tones : f[k].count;

		if (!f[k].real)
			put(v, n, f[k].name, 0,
				f[k].whole    ? *f[k].whole
				: f[k].longer ? (double)*f[k].longer
					      : (double)*f[k].size);
		for (int i = 0; f[k].real && i < count; i++)
			put(v, n, f[k].name, i, f[k].real[i]);
	}
	for (int i = 0; w->tap && i < 2 * w->half + 1; i++)
		put(v, n, "white_tap", i, w->tap[i]);
	for (int i = 0; w->tap && i < 2 * w->seen_half + 1; i++)
		put(v, n, "white_seen", i, w->seen[i]);
	put(v, n, "white_taps", 0, w->tap ? 2 * w->half + 1 : 0);
	put(v, n, "shape_reach", 0, shape_reach(shape));
	put(v, n, "shape_cells", 0, cells);
	for (int i = 0; i < 4 * cells; i++)
		put(v, n, "shape", i, shape_cubic(shape)[i]);
	return NUM_OK;
}

/* --- reading the numbers */

struct values {
	const struct instrument_value *v;
	size_t n, taken;
	const char *missing; /* the first missing one */
};

/* A number that must occur once; nan if it is missing or not between least and most. */
static double take(
	struct values *from, const char *name, int index, double least, double most)
{
	double found = NAN;
	int times = 0;

	/* Usually they are in the order in which they are read. */
	for (size_t i = 0; i < from->n && !times; i++) {
		size_t k = (from->taken + i) % from->n;

		if (from->v[k].index == index && !strcmp(from->v[k].name, name)) {
			found = from->v[k].value;
			times = 1;
		}
	}
	from->taken += (size_t)times;
	if (times && found >= least && found <= most)
		return found;
	if (!from->missing)
		from->missing = name;
	return NAN;
}

static int take_whole(struct values *from, const char *name, int least, int most)
{
	double x = take(from, name, 0, least, most);

	if (isnan(x))
		return least;
	if (x != floor(x) && !from->missing)
		from->missing = name;
	return (int)x;
}

static double *take_many(struct values *from, const char *name, int count)
{
	double *x = malloc((size_t)(count > 0 ? count : 1) * sizeof *x);

	for (int i = 0; x && i < count && !from->missing; i++)
		x[i] = take(from, name, i, -1e300, 1e300);
	return x;
}

static enum instrument_status take_arrays(struct values *from, struct calibration *c)
{
	enum { CELLS = 1 << 20 };
	struct whitening *w = &c->whitening;
	int taps = take_whole(from, "white_taps", 0, INT_MAX), cells;
	double reach, *cubic;

	if (taps && (taps != 2 * w->half + 1 || w->seen_half < 0 || w->edge < 0))
		from->missing = "white_half";
	if (taps && !from->missing) {
		w->tap = take_many(from, "white_tap", 2 * w->half + 1);
		w->seen = take_many(from, "white_seen", 2 * w->seen_half + 1);
		if (!w->tap || !w->seen)
			return INSTRUMENT_MEMORY;
	}
	reach = take(from, "shape_reach", 0, 1e-6, 1e6);
	cells = take_whole(from, "shape_cells", 4, CELLS);
	if (from->missing)
		return INSTRUMENT_MISSING;
	cubic = take_many(from, "shape", 4 * cells);
	c->shape = cubic && !from->missing ? shape_from_cubic(reach, cells, cubic) : NULL;
	free(cubic);
	if (from->missing)
		return INSTRUMENT_MISSING;
	return c->shape ? INSTRUMENT_OK : INSTRUMENT_MEMORY;
}

/* The first number outside the range of instruments, or NULL. */
static const char *out_of_range(const struct instrument *in)
{
	const struct calibration *c = &in->cal;
	const double *common = in->common;

	return in->ratio < 1                           ? "ratio"
	       : c->tone_hop < SHORTEST_HOP            ? "tone_hop"
	       : c->pulse >= PULSE_SHAPES              ? "pulse"
	       : !(c->noise[0] > 0 && c->noise[1] > 0) ? "noise"
	       : !(c->duration >= SHAPE_SHORTEST)      ? "duration"
	       : !(c->gain > 0)                        ? "gain"
	       : !(c->transit > 0)                     ? "transit"
	       : !(c->delta_min < c->delta_max)        ? "delta_max"
	       : !(c->drop > 0 && c->drop_near > 0)    ? "drop"
	       : common[0] != 0 &&
			       !(fabs(common[0]) < 1 && common[1] > 0 && common[2] > 0)
		       ? "common"
		       : NULL;
}

enum instrument_status instrument_restore(struct instrument *in,
	const struct instrument_value *value, size_t n, const char **which)
{
	struct values from = { .v = value, .n = n };
	struct field f[SCALARS];
	enum instrument_status status;
	int fields;

	memset(in, 0, sizeof *in);
	fields = list(in, f);
	for (int k = 0; k < fields && !from.missing; k++) {
		int count = is_tone(&f[k]) ? in->cal.tones : f[k].count;

		if (f[k].whole)
			*f[k].whole = take_whole(&from, f[k].name, 0, INT_MAX / 4);
		else if (f[k].longer)
			*f[k].longer = take_whole(&from, f[k].name, 0, INT_MAX);
		else if (f[k].size)
			*f[k].size = (size_t)take_whole(&from, f[k].name, 0, INT_MAX);
		else if (count > TONES_MAX)
			from.missing = f[k].name;
		else
			for (int i = 0; i < count; i++)
				f[k].real[i] =
					take(&from, f[k].name, i, -INFINITY, INFINITY);
	}
	if (!from.missing)
		from.missing = out_of_range(in);
	status = from.missing ? INSTRUMENT_MISSING : take_arrays(&from, &in->cal);
	if (status == INSTRUMENT_OK && from.taken != n)
		status = INSTRUMENT_UNKNOWN;
	*which = from.missing;
	if (status != INSTRUMENT_OK)
		calibration_clear(&in->cal);
	return status;
}
