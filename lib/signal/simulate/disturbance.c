/* disturbance.c - events that are no particles */
#include "signal/simulate/disturbance.h"
#include "num/philox.h"
#include <math.h>
#include <stdlib.h>

const char *const disturbance_names[DISTURBANCES] = { "bubble", "shock", "impulse",
	"transient", "dropout" };

/* Uniform numbers of one event, by address. */
enum { DRAW_WAIT, DRAW_LEVEL, DRAW_SIGN, DRAW_SIDE, DRAW_LENGTH, DRAW_FREQUENCY, DRAWS };

/* Exponentials are taken for dead after so many time constants: exp(-36) = 2e-16. */
enum { CONSTANTS = 36 };

struct disturbances {
	struct disturbances_par par;
	uint64_t count[DISTURBANCES]; /* events of the kind so far, the one waiting too */
	double next[DISTURBANCES];    /* its time */
};

static double draw(
	const struct disturbances *d, int kind, uint64_t k, int what, double a, double b)
{
	uint64_t place = ((uint64_t)kind << 56) + k * DRAWS + (uint64_t)what;

	return a + (b - a) * philox_uniform(d->par.seed, d->par.realisation,
				     RNG_DISTURBANCE, place);
}

static void wait(struct disturbances *d, int kind)
{
	double u = draw(d, kind, d->count[kind]++, DRAW_WAIT, 0, 1);

	d->next[kind] -= log(u) / d->par.rate[kind];
}

struct disturbances *disturbances_new(const struct disturbances_par *par)
{
	struct disturbances *d = calloc(1, sizeof *d);

	if (!d)
		return NULL;
	d->par = *par;
	for (int kind = 0; kind < DISTURBANCES; kind++)
		if (par->rate[kind] > 0)
			wait(d, kind);
		else
			d->next[kind] = INFINITY;
	return d;
}

void disturbances_free(struct disturbances *d)
{
	free(d);
}

static void make_event(const struct disturbances *d, int kind, struct disturbance *e)
{
	uint64_t k = d->count[kind] - 1;
	double T = d->par.duration, t = d->next[kind];
	double level = d->par.level * draw(d, kind, k, DRAW_LEVEL, 0.4, 1.6);
	double side = draw(d, kind, k, DRAW_SIDE, 0, 1);
	double length = draw(d, kind, k, DRAW_LENGTH, 0, 1);

	if (draw(d, kind, k, DRAW_SIGN, 0, 1) < 0.5)
		level = -level;
	*e = (struct disturbance){ (enum disturbance_kind)kind, { t, t }, t, t,
		{ level, level }, T, 0 };
	switch (e->kind) {
	case DISTURBANCE_BUBBLE:
		e->duration = T * (1.5 + 1.5 * length);
		e->time[1] += d->par.transit;
		e->begin = t - e->duration / 2;
		e->end = e->time[1] + e->duration / 2;
		return;
	case DISTURBANCE_SHOCK:
		e->level[side < 0.5] *= 1 - 0.3 * length;
		e->frequency = draw(d, kind, k, DRAW_FREQUENCY, 1, 3) / T;
		e->end = t + CONSTANTS * T;
		return;
	case DISTURBANCE_IMPULSE:
		e->duration = d->par.sample;
		/* a third of them at sensor 1 alone, a third at sensor 2 */
		e->level[0] *= side < 2 / 3. && side >= 1 / 3. ? 0 : 1 + 4 * length;
		e->level[1] *= side < 1 / 3. ? 0 : 1 + 4 * length;
		e->end = t + e->duration;
		return;
	case DISTURBANCE_TRANSIENT:
		e->duration = T * (0.5 + 2.5 * length);
		e->level[side < 0.5] = 0;
		e->end = t + CONSTANTS * e->duration;
		return;
	default:
		e->duration = T * (0.5 + 3.5 * length);
		e->level[0] = e->level[1] = 0;
		e->end = t + e->duration;
	}
}

int disturbances_next(struct disturbances *d, struct disturbance *event)
{
	int first = 0;

	for (int kind = 1; kind < DISTURBANCES; kind++)
		if (d->next[kind] < d->next[first])
			first = kind;
	if (isinf(d->next[first]))
		return 0;
	make_event(d, first, event);
	wait(d, first);
	return 1;
}

double disturbance_value(const struct disturbance *e, int sensor, double t)
{
	double s = t - e->time[sensor], level = e->level[sensor];

	switch (e->kind) {
	case DISTURBANCE_BUBBLE:
		return fabs(s) < e->duration / 2
			       ? level * (0.5 + 0.5 * cos(2 * M_PI * s / e->duration))
			       : 0;
	case DISTURBANCE_SHOCK:
		return s >= 0 ? level * exp(-s / e->duration) *
					sin(2 * M_PI * e->frequency * s)
			      : 0;
	case DISTURBANCE_IMPULSE:
		return s >= 0 && s < e->duration ? level : 0;
	case DISTURBANCE_TRANSIENT:
		return s >= 0 ? level * exp(-s / e->duration) : 0;
	default:
		return 0;
	}
}
