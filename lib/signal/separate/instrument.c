/* instrument.c - see instrument.h */
#include "signal/separate/instrument.h"
#include "num/room.h"
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Visits the numbers of an instrument in their order, and lists or restores them. */
struct walk {
	int restores;                        /* 0: lists */
	struct instrument_value *list;       /* count of them, of room */
	const struct instrument_value *from; /* n of them; count are restored */
	size_t n, count, room;
	enum instrument_status status;
	const char *missing;
};

static void visit(
	struct walk *w, const char *name, int index, double least, double most, double *x)
{
	const struct instrument_value *v;

	if (w->status != INSTRUMENT_OK)
		return;
	if (!w->restores) {
		if (room_for(&w->list, &w->room, w->count + 1, sizeof *w->list))
			w->status = INSTRUMENT_MEMORY;
		else
			w->list[w->count++] =
				(struct instrument_value){ name, index, *x };
		return;
	}
	v = w->from + w->count;
	if (w->count < w->n && v->index == index && !strcmp(v->name, name) &&
		v->value >= least && v->value <= most) {
		*x = v->value;
		w->count++;
	} else {
		w->status = INSTRUMENT_MISSING;
		w->missing = name;
	}
}

static void reals(struct walk *w, const char *name, double least, double *x, int count)
{
	for (int i = 0; i < count; i++)
		visit(w, name, i, least, INFINITY, &x[i]);
}

static double whole(struct walk *w, const char *name, double least, double most, double x)
{
	visit(w, name, 0, least, most, &x);
	return floor(x);
}

static int flag(struct walk *w, const char *name, int x)
{
	return (int)whole(w, name, 0, 1, x);
}

/* An array that is allocated when it is restored. */
static double *array(struct walk *w, const char *name, double *x, int count)
{
	if (w->restores && w->status == INSTRUMENT_OK) {
		x = malloc((size_t)count * sizeof *x);
		if (!x)
			w->status = INSTRUMENT_MEMORY;
	}
	for (int i = 0; w->status == INSTRUMENT_OK && i < count; i++)
		visit(w, name, i, -DBL_MAX, DBL_MAX, &x[i]);
	return x;
}

static void walk_whitening(struct walk *w, struct whitening *white)
{
	enum { MOST = INT_MAX / 4 };

	white->half = (int)whole(w, "white_half", 0, MOST, white->half);
	white->seen_half = (int)whole(w, "white_seen_half", 0, MOST, white->seen_half);
	white->edge = (int)whole(w, "white_edge", 0, MOST, white->edge);
	reals(w, "white_low", 0, &white->low, 1);
	reals(w, "white_high", 0, &white->high, 1);
	reals(w, "white_band", 0, &white->band, 1);
	if (white->half == 0) /* nothing is whitened */
		return;
	white->tap = array(w, "white_tap", white->tap, 2 * white->half + 1);
	white->seen = array(w, "white_seen", white->seen, 2 * white->seen_half + 1);
}

static void walk_shape(struct walk *w, struct shape **shape)
{
	enum { CELLS = 1 << 20 };
	double reach = *shape ? shape_reach(*shape) : 0;
	int cells = *shape ? shape_cells(*shape) : 0;
	double *cubic = NULL;

	visit(w, "shape_reach", 0, 1e-6, 1e6, &reach);
	cells = (int)whole(w, "shape_cells", 4, CELLS, cells);
	if (w->restores) {
		cubic = array(w, "shape", NULL, 4 * cells);
		if (w->status == INSTRUMENT_OK &&
			!(*shape = shape_from_cubic(reach, cells, cubic)))
			w->status = INSTRUMENT_MEMORY;
		free(cubic);
		return;
	}
	for (int i = 0; i < 4 * cells; i++) {
		double x = shape_cubic(*shape)[i];

		visit(w, "shape", i, 0, 0, &x);
	}
}

/* Of either sign, but not 0. */
static void visit_gain(struct walk *w, double *gain)
{
	visit(w, "gain", 0, -INFINITY, INFINITY, gain);
	if (w->status == INSTRUMENT_OK && !(fabs(*gain) >= DBL_MIN)) {
		w->status = INSTRUMENT_MISSING;
		w->missing = "gain";
	}
}

static void walk_all(struct walk *w, struct instrument *in)
{
	enum { SHORTEST_HOP = 32 };
	struct calibration *c = &in->cal;

	c->shift = (long)whole(w, "shift", 0, INT_MAX, (double)c->shift);
	c->tones = (int)whole(w, "tones", 0, TONES_MAX, c->tones);
	reals(w, "omega", 0, c->omega, c->tones);
	c->tone_hop =
		(size_t)whole(w, "tone_hop", SHORTEST_HOP, INT_MAX, (double)c->tone_hop);
	reals(w, "tone_variance", 0, &c->tone_variance, 1);
	reals(w, "mean", -INFINITY, c->mean, 2);
	reals(w, "noise", DBL_MIN, c->noise, 2);
	c->pulse = (int)whole(w, "pulse", 0, PULSE_SHAPES - 1, c->pulse);
	c->measured = flag(w, "measured", c->measured);
	c->reversed = flag(w, "reversed", c->reversed);
	c->corrected = flag(w, "corrected", c->corrected);
	reals(w, "duration", SHAPE_SHORTEST, &c->duration, 1);
	visit_gain(w, &c->gain);
	reals(w, "width", DBL_MIN, &c->width, 1);
	reals(w, "origin", -INFINITY, &c->origin, 1);
	reals(w, "origin_se", 0, &c->origin_se, 1);
	reals(w, "crosstalk", -1, c->crosstalk, 2);
	reals(w, "transit", DBL_MIN, &c->transit, 1);
	reals(w, "delta_min", -INFINITY, &c->delta_min, 1);
	reals(w, "delta_max", -INFINITY, &c->delta_max, 1);
	reals(w, "threshold", DBL_MIN, &c->threshold, 1);
	reals(w, "threshold_near", DBL_MIN, &c->threshold_near, 1);
	reals(w, "misfit", 0, &c->misfit, 1);
	reals(w, "scatter", 0, c->scatter, JOINT_OWN);
	c->events = (int)whole(w, "events", 0, INT_MAX, c->events);
	c->dense = flag(w, "dense", c->dense);
	reals(w, "chi2", 0, &c->chi2, 1);
	in->ratio = (int)whole(w, "ratio", 1, INT_MAX, in->ratio);
	in->crowded = flag(w, "crowded", in->crowded);
	reals(w, "flow_mean", -INFINITY, &in->flow.mean, 1);
	reals(w, "flow_variance", 0, &in->flow.var, 1);
	reals(w, "flow_margin", 0, &in->flow.margin, 1);
	reals(w, "flow_count", 0, &in->flow.count, 1);
	reals(w, "level", 0, in->level, 4);
	reals(w, "level_samples", 0, &in->level_samples, 1);
	reals(w, "common", -1, in->common, 3);
	reals(w, "second_noise", DBL_MIN, in->second.noise, 2);
	reals(w, "second_correlation", -1, in->second.correlation, 2);
	walk_whitening(w, &c->whitening);
	walk_shape(w, &c->shape);
}

enum num_status instrument_values(
	const struct instrument *in, struct instrument_value **value, size_t *n)
{
	struct instrument copy = *in;
	struct walk w = { .restores = 0 };

	walk_all(&w, &copy);
	*value = w.list;
	*n = w.count;
	return w.status == INSTRUMENT_OK ? NUM_OK : NUM_MEMORY;
}

enum instrument_status instrument_restore(struct instrument *in,
	const struct instrument_value *value, size_t n, const char **which)
{
	struct walk w = { .restores = 1, .from = value, .n = n };

	memset(in, 0, sizeof *in);
	walk_all(&w, in);
	if (w.status == INSTRUMENT_OK && w.count != n)
		w.status = INSTRUMENT_UNKNOWN;
	if (w.status != INSTRUMENT_OK)
		calibration_clear(&in->cal);
	*which = w.missing;
	return w.status;
}
