/* fleet.c - see fleet.h */
#include "life/prior/fleet.h"
#include "life/trend/passage.h"
#include "num/room.h"
#include "num/select.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	LEVELS = 24, /* of a path */
	AHEAD = 7,   /* levels up to the threshold for a unit that has not reached it */
	DRAWS = 200  /* of the ages at these levels */
};

/* Log prior of all paths together, relative to the coordinates of the bank, whose priors
 * sum to e^4.3: see "Single constants" in doc/trends.md. */
static const double KINSHIP = 6.4;

struct unit {
	int rows;
	double t[3], y[3]; /* last rows, newest first; y times the direction */
	double first;
	struct bank *bank;
	struct bank_point *point; /* rising */
	size_t n, room;
	int shape; /* from 1; 0: none */
};

struct fleet {
	struct bank_par par; /* of the banks of the units */
	struct unit *path;
	size_t room;
	int units;
	struct bank_shape *shape;
	struct bank_point *grid; /* memory of the paths of the shapes */
	int shapes;
};

struct fleet *fleet_new(double threshold, int direction)
{
	struct fleet *f = calloc(1, sizeof *f);

	if (f)
		f->par = (struct bank_par){ .threshold = threshold,
			.direction = direction };
	return f;
}

void fleet_free(struct fleet *f)
{
	if (!f)
		return;
	for (int i = 0; i < f->units; i++) {
		free(f->path[i].point);
		bank_free(f->path[i].bank);
	}
	free(f->path);
	free(f->shape);
	free(f->grid);
	free(f);
}

const struct bank_shape *fleet_shapes(const struct fleet *f, int *n)
{
	*n = f->shapes;
	return f->shape;
}

int fleet_shape_of(const struct fleet *f, int unit)
{
	return unit < f->units ? f->path[unit].shape : 0;
}

/* Adds a point to the path if both age and level exceed those of the last one. */
static enum num_status rise(struct unit *p, double age, double level)
{
	if (p->n > 0 &&
		(level <= p->point[p->n - 1].level || age <= p->point[p->n - 1].age))
		return NUM_OK;
	if (room_for(&p->point, &p->room, p->n + 1, sizeof *p->point))
		return NUM_MEMORY;
	p->point[p->n++] = (struct bank_point){ age, level };
	return NUM_OK;
}

static struct unit *path_of(struct fleet *f, int unit)
{
	if (room_for(&f->path, &f->room, (size_t)unit + 1, sizeof *f->path))
		return NULL;
	while (f->units <= unit)
		f->path[f->units++] = (struct unit){ .bank = bank_new(&f->par) };
	return f->path[unit].bank ? &f->path[unit] : NULL;
}

enum num_status fleet_add(struct fleet *f, int unit, double t, double y)
{
	struct unit *p = path_of(f, unit);

	if (!p)
		return NUM_MEMORY;
	if (p->rows > 0 && t <= p->t[0])
		return t < p->t[0] ? NUM_DOMAIN : NUM_OK;
	if (p->rows++ == 0)
		p->first = t;
	bank_add(p->bank, t, y);
	memmove(p->t + 1, p->t, 2 * sizeof *p->t);
	memmove(p->y + 1, p->y, 2 * sizeof *p->y);
	p->t[0] = t;
	p->y[0] = f->par.direction * y;
	if (p->rows < 3)
		return p->rows == 1 ? rise(p, 0, p->y[0]) : NUM_OK;
	return rise(p, p->t[1] - p->first, median_of_three(p->y[0], p->y[1], p->y[2]));
}

/* Extrapolates a unit to the threshold by the median ages that its own bank predicts. */
static enum num_status carry_on(const struct fleet *f, struct unit *p)
{
	struct bank_chances *chances = bank_chances_new(DRAWS, 0);
	double end = f->par.direction * f->par.threshold, from = p->point[p->n - 1].level,
	       life[DRAWS];
	size_t middle = DRAWS / 2;
	enum num_status status = chances ? NUM_OK : NUM_MEMORY;

	for (int k = 1; status == NUM_OK && k <= AHEAD && bank_ready(p->bank); k++) {
		double level = from + (end - from) * k / AHEAD;

		status = bank_draw(
			p->bank, chances, p->t[0], f->par.direction * level, life);
		if (status == NUM_OK)
			select_ranks(life, DRAWS, &middle, 1);
		if (status == NUM_OK && isfinite(life[middle]))
			status = rise(p, p->t[0] - p->first + life[middle], level);
	}
	bank_chances_free(chances);
	return status;
}

/* The path at evenly spaced levels up to the threshold; 0 if it has no length. */
static int lay_out(const struct unit *p, double end, struct bank_point *path)
{
	double from = p->point[0].level, to = fmin(end, p->point[p->n - 1].level), slope;

	for (int k = 0; k < LEVELS; k++) {
		path[k].level = from + (to - from) * k / (LEVELS - 1);
		path[k].age = bank_path_age(p->point, p->n, path[k].level, &slope);
	}
	return to > from && path[LEVELS - 1].age > 0;
}

enum num_status fleet_build(struct fleet *f, int *failed, int *carried_on)
{
	double end = f->par.direction * f->par.threshold;
	size_t units = (size_t)f->units;

	*failed = *carried_on = 0;
	f->shape = calloc(units + 1, sizeof *f->shape);
	f->grid = calloc(units + 1, LEVELS * sizeof *f->grid);
	if (!f->shape || !f->grid)
		return NUM_MEMORY;
	for (int i = 0; i < f->units; i++) {
		struct unit *p = &f->path[i];
		struct bank_point *path = f->grid + (size_t)f->shapes * LEVELS;
		double seen;

		if (p->rows == 0)
			continue; /* no value */
		/* The last row has no later neighbour for a median. */
		if (rise(p, p->t[0] - p->first, p->y[0]))
			return NUM_MEMORY;
		if (p->n < 2)
			continue; /* no wear: no path */
		seen = p->point[p->n - 1].level;
		if (seen < end && carry_on(f, p))
			return NUM_MEMORY;
		if (!lay_out(p, end, path))
			continue;
		f->shape[f->shapes++] = (struct bank_shape){ .family = BANK_OTHER,
			.log_prior = KINSHIP,
			.path = path,
			.n = LEVELS,
			.seen = seen };
		p->shape = f->shapes;
		*failed += seen >= end;
		*carried_on += seen < end;
	}
	return NUM_OK;
}
