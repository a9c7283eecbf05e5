/* ensemble.c - see ensemble.h */
#include "stats/ensemble.h"
#include "num/realisations.h"
#include "num/status.h"
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Diameters kept of all steps or groups together, 8 MB, and of one of them at least: its
 * 32 to 64 values over a decade change a sum of k-th powers by less than (0.075 k)^2 / 8
 * (sketch.h). */
enum { VALUES = 1 << 19, VALUES_LEAST = 64 };

/* A realisation that has a group to itself. */
struct place {
	long realisation;
	int used;
};

struct ensemble {
	struct ensemble_par par;
	struct realisations *reader;
	int clash;
	long culprit;
	double particles, reported;
	double simulated; /* realisations, at least */
	size_t steps;     /* up to the last one with rows */
	struct ensemble_step *step;
	size_t step_room;
	struct ensemble_step after; /* of a step after the last one with rows */
	struct running volume, diameter;
	struct sketch diameters, *step_diameters;
	struct ensemble_group *group;
	struct place *place; /* of the groups, hashed */
	size_t groups, places;
};

/* Extends the steps to this one; it has no particles so far. */
static enum num_status reach_step(struct ensemble *e, size_t step)
{
	if (step > e->step_room) {
		size_t room = e->step_room ? e->step_room : 64;
		struct ensemble_step *more;
		struct sketch *sketch;

		while (room < step)
			room *= 2;
		more = realloc(e->step, room * sizeof *more);
		if (!more)
			return NUM_MEMORY;
		e->step = more;
		if (e->par.by_step) {
			sketch = realloc(e->step_diameters, room * sizeof *sketch);
			if (!sketch)
				return NUM_MEMORY;
			e->step_diameters = sketch;
		}
		e->step_room = room;
	}
	for (; e->steps < step; e->steps++) {
		e->step[e->steps] = e->after;
		if (e->par.by_step)
			e->step_diameters[e->steps] = (struct sketch){ 0 };
	}
	return NUM_OK;
}

static uint64_t mix(uint64_t x)
{
	x ^= x >> 33;
	x *= 0xff51afd7ed558ccdu; /* finaliser of MurmurHash3: spreads neighbours */
	x ^= x >> 33;
	x *= 0xc4ceb9fe1a85ec53u;
	return x ^ x >> 33;
}

/* The group of a realisation: its own as long as groups are free. */
static struct ensemble_group *group_of(struct ensemble *e, long realisation)
{
	uint64_t hash = mix((uint64_t)realisation);
	size_t at = hash & (e->places - 1);

	while (e->place[at].used && e->place[at].realisation != realisation)
		at = (at + 1) & (e->places - 1);
	if (e->place[at].used)
		return &e->group[e->place[at].used - 1];
	if (e->groups == (size_t)e->par.groups)
		return &e->group[(hash >> 32) % e->groups];
	e->place[at] = (struct place){ realisation, (int)++e->groups };
	return &e->group[e->groups - 1];
}

/* Volume and particles of one realisation in one step. */
static enum num_status take_step(struct ensemble *e, struct ensemble_group *g,
	const struct realisation_cell *cell, double volume_before)
{
	struct ensemble_step *s = &e->step[cell->step - 1];
	size_t step = (size_t)cell->step;

	running_add(&s->count, cell->count);
	running_add(&s->volume, cell->volume);
	running_add(&s->total_volume, volume_before + cell->volume);
	if (!g || cell->count == 0)
		return NUM_OK;
	if (step > g->steps) {
		double *more = realloc(g->count, step * sizeof *more);

		if (!more)
			return NUM_MEMORY;
		memset(more + g->steps, 0, (step - g->steps) * sizeof *more);
		g->count = more;
		g->steps = step;
	}
	g->count[step - 1] += cell->count;
	return NUM_OK;
}

/* Steps up to last in which a realisation shed nothing; sums: of the steps before. */
static void take_nothing(
	struct ensemble *e, long *next, long last, const struct realisation_cell *sums)
{
	for (; *next <= last; ++*next) {
		struct ensemble_step *s = &e->step[*next - 1];

		s->total_count += sums->count;
		if (e->par.partial)
			continue;
		running_add(&s->count, 0);
		running_add(&s->volume, 0);
		running_add(&s->total_volume, sums->volume);
	}
}

/* Sums the cells of one step up, from i on; returns the first of the next step, or 0
 * where they come from two parts. */
static size_t sum_step(const struct realisation_cell *cell, size_t i, size_t n,
	long *part, struct realisation_cell *here)
{
	*here = (struct realisation_cell){ .step = cell[i].step };
	for (; i < n && cell[i].step == here->step; i++) {
		if (*part >= 0 && cell[i].part >= 0 && cell[i].part != *part)
			return 0;
		if (cell[i].part >= 0)
			*part = cell[i].part;
		here->count += cell[i].count;
		here->volume += cell[i].volume;
	}
	return i;
}

/* Notes the mean volume per step of a realisation.  Where all steps took place their
 * number is known at the end, and the same for all. */
static void take_volume(
	struct ensemble *e, struct ensemble_group *g, double volume, double steps)
{
	e->reported++;
	if (g)
		g->realisations++;
	if (!e->par.partial)
		steps = 1;
	if (!(steps > 0))
		return;
	running_add(&e->volume, volume / steps);
	if (g) {
		g->worn++;
		g->volume += volume / steps;
	}
}

/* Takes a realisation whose cells are sorted by step. */
static enum num_status take(void *to, const struct realisation_cell *cell, size_t n)
{
	struct ensemble *e = to;
	struct ensemble_group *g = e->par.groups ? group_of(e, cell->realisation) : NULL;
	struct realisation_cell sums = { 0 }, here;
	long part = -1, next = 1, last = e->par.last ? e->par.last : LONG_MAX;
	double volume = 0, steps = 0;

	for (size_t i = 0; i < n;) {
		i = sum_step(cell, i, n, &part, &here);
		if (i == 0) {
			e->clash = 1;
			return NUM_DOMAIN;
		}
		take_nothing(e, &next, here.step - 1, &sums);
		if (take_step(e, g, &here, sums.volume))
			return NUM_MEMORY;
		next++;
		sums.volume += here.volume;
		sums.count += here.count;
		e->step[here.step - 1].total_count += sums.count;
		if (here.step >= e->par.first && here.step <= last) {
			volume += here.volume;
			steps++;
		}
	}
	take_nothing(e, &next, (long)e->steps, &sums);
	if (!e->par.partial) {
		running_add(&e->after.count, 0);
		running_add(&e->after.volume, 0);
		running_add(&e->after.total_volume, sums.volume);
	}
	e->after.total_count += sums.count;
	take_volume(e, g, volume, steps);
	return NUM_OK;
}

struct ensemble *ensemble_new(const struct ensemble_par *par)
{
	struct ensemble *e = calloc(1, sizeof *e);

	if (!e)
		return NULL;
	e->par = *par;
	e->places = 1;
	while (par->groups && e->places < 2 * (size_t)par->groups)
		e->places *= 2;
	e->reader = realisations_new(REALISATIONS_ROOM, take, e);
	if (par->groups) {
		e->group = calloc((size_t)par->groups, sizeof *e->group);
		e->place = calloc(e->places, sizeof *e->place);
	}
	if (!e->reader || (par->groups && (!e->group || !e->place)) ||
		(par->last && reach_step(e, (size_t)par->last))) {
		ensemble_free(e);
		return NULL;
	}
	return e;
}

void ensemble_free(struct ensemble *e)
{
	if (!e)
		return;
	for (size_t s = 0; e->step_diameters && s < e->steps; s++)
		sketch_free(&e->step_diameters[s]);
	for (size_t g = 0; e->group && g < e->groups; g++) {
		sketch_free(&e->group[g].diameters);
		free(e->group[g].count);
	}
	sketch_free(&e->diameters);
	realisations_free(e->reader);
	free(e->step_diameters);
	free(e->step);
	free(e->group);
	free(e->place);
	free(e);
}

static enum ensemble_status reading(struct ensemble *e, enum realisations_status status)
{
	e->culprit = realisations_culprit(e->reader);
	switch (status) {
	case REALISATIONS_OK:
		return ENSEMBLE_OK;
	case REALISATIONS_AGAIN:
		return ENSEMBLE_APART;
	case REALISATIONS_STOP:
		return e->clash ? ENSEMBLE_CLASH : ENSEMBLE_MEMORY;
	default:
		return ENSEMBLE_MEMORY;
	}
}

/* Each of n sketches has its share of the room. */
static size_t share(size_t n, size_t most)
{
	size_t each = VALUES / (n ? n : 1);

	return each > most ? most : each < VALUES_LEAST ? VALUES_LEAST : each;
}

static enum num_status add_diameter(struct ensemble *e, const struct particle_row *p)
{
	if (p->step < e->par.first || (e->par.last && p->step > e->par.last))
		return NUM_OK;
	running_add(&e->diameter, p->diameter);
	if (sketch_add(&e->diameters, p->diameter, SKETCH_MOST))
		return NUM_MEMORY;
	if (e->par.by_step && sketch_add(&e->step_diameters[p->step - 1], p->diameter,
				      share(e->steps, SKETCH_MOST)))
		return NUM_MEMORY;
	if (e->par.groups && sketch_add(&group_of(e, p->realisation)->diameters,
				     p->diameter, share(e->groups, SKETCH_MOST)))
		return NUM_MEMORY;
	return NUM_OK;
}

enum ensemble_status ensemble_add(struct ensemble *e, const struct particle_row *p)
{
	int counts = p->diameter >= e->par.low && p->diameter <= e->par.high;
	struct realisation_cell cell = { p->realisation, p->step, p->part, p->volume,
		counts, 0 };

	e->particles++;
	if (reach_step(e, (size_t)p->step) || (counts && add_diameter(e, p)))
		return ENSEMBLE_MEMORY;
	return reading(e, realisations_add(e->reader, &cell));
}

enum ensemble_status ensemble_took_place(struct ensemble *e, long realisation, long step)
{
	struct realisation_cell cell = { realisation, step, -1, 0, 0, 0 };

	if (reach_step(e, (size_t)step))
		return ENSEMBLE_MEMORY;
	return reading(e, realisations_add(e->reader, &cell));
}

enum ensemble_status ensemble_simulated(
	struct ensemble *e, double realisations, long steps)
{
	e->simulated = fmax(e->simulated, realisations);
	return reach_step(e, (size_t)steps) ? ENSEMBLE_MEMORY : ENSEMBLE_OK;
}

/* Realisations without rows have no particles, and all their steps took place. */
static void add_empty(struct ensemble *e)
{
	double n = e->par.realisations - e->reported;

	for (size_t s = 0; s < e->steps; s++) {
		running_repeat(&e->step[s].count, 0, n);
		running_repeat(&e->step[s].volume, 0, n);
		running_repeat(&e->step[s].total_volume, 0, n);
	}
	running_repeat(&e->volume, 0, n);
}

/* Volumes per step from volumes. */
static void divide_volumes(struct ensemble *e, double steps)
{
	if (!(steps > 0))
		e->volume = (struct running){ 0 };
	e->volume.mean /= fmax(steps, 1);
	e->volume.square /= fmax(steps * steps, 1);
	for (size_t g = 0; g < e->groups; g++)
		e->group[g].volume /= fmax(steps, 1);
}

enum ensemble_status ensemble_close(struct ensemble *e)
{
	enum ensemble_status status = reading(e, realisations_end(e->reader));

	if (status != ENSEMBLE_OK)
		return status;
	if (!(e->par.realisations > 0))
		e->par.realisations = fmax(e->reported, e->simulated);
	if (e->par.realisations < e->reported)
		return ENSEMBLE_MORE;
	if (!e->par.last)
		e->par.last = (long)e->steps;
	if (!e->par.partial) {
		add_empty(e);
		divide_volumes(e, (double)(e->par.last - e->par.first + 1));
	}
	if (sketch_sort(&e->diameters))
		return ENSEMBLE_MEMORY;
	for (size_t s = 0; e->par.by_step && s < e->steps; s++)
		if (sketch_sort(&e->step_diameters[s]))
			return ENSEMBLE_MEMORY;
	return ENSEMBLE_OK;
}

long ensemble_culprit(const struct ensemble *e)
{
	return e->culprit;
}

size_t ensemble_reported(const struct ensemble *e)
{
	return (size_t)e->reported;
}

const struct ensemble_par *ensemble_par(const struct ensemble *e)
{
	return &e->par;
}

double ensemble_particles(const struct ensemble *e)
{
	return e->particles;
}

const struct ensemble_step *ensemble_step(const struct ensemble *e, long step)
{
	return &e->step[step - 1];
}

const struct running *ensemble_volume(const struct ensemble *e)
{
	return &e->volume;
}

const struct running *ensemble_diameter(const struct ensemble *e)
{
	return &e->diameter;
}

const struct sketch *ensemble_diameters(const struct ensemble *e)
{
	return &e->diameters;
}

const struct sketch *ensemble_step_diameters(const struct ensemble *e, long step)
{
	return &e->step_diameters[step - 1];
}

const struct ensemble_group *ensemble_groups(const struct ensemble *e, size_t *n)
{
	*n = e->groups;
	return e->group;
}

double ensemble_empty(const struct ensemble *e)
{
	return e->par.realisations - e->reported;
}
