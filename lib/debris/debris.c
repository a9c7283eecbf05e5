#include "debris/debris.h"
#include "num/grid.h"
#include "num/lanes.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sides of the grid.  There the load of a free grid is a point load: its stress, at most
 * 3 / (2 pi 100), is a two-hundredth of the mean pressure. */
static const double DEEPEST = 10;
/* Whole cells below one another: a depth of more is known to a two-thousandth, while
 * continuous depths give volumes within 0.1 to 0.9 % (debrisgen(1)).  A cell of a
 * hundredth of the spacing is tried in continuous depths first, which takes some 16
 * layers. */
static const double CELLS = 2000, THIN = 0.01;

struct debris {
	struct debris_par par;
	struct stress *stress;
	struct particles *particles;
	struct wear *wear;
};

double debris_deepest(const struct stress_par *s)
{
	return DEEPEST * fmax(s->nx * s->dx, s->ny * s->dy);
}

double debris_border(const struct stress_par *s, size_t ix, size_t iy)
{
	if (s->periodic)
		return 0;
	return ((ix == 0) + (ix + 1 == (size_t)s->nx)) * s->dy +
	       ((iy == 0) + (iy + 1 == (size_t)s->ny)) * s->dx;
}

/* Nothing is loaded beyond the border, where the stress decays over a length of about the
 * depth: a slice of the loss at the depth z goes on for z at most, so that a stretch
 * stands for the integral of that.  On grids padded with cells without load none of 470
 * rough surfaces that lost more than 1 % beyond the border lost more than this there
 * (tests/bench/border.sh). */
static double beyond(const struct stress_par *s, const struct stretch *lost)
{
	size_t nx = (size_t)s->nx;

	return 0.5 * debris_border(s, lost->column % nx, lost->column / nx) *
	       (lost->bottom * lost->bottom - lost->top * lost->top);
}

struct debris *debris_new(const struct debris_par *par)
{
	const struct stress_par *s = &par->stress;
	struct particles_par p = { .nx = s->nx,
		.ny = s->ny,
		.dx = s->dx,
		.dy = s->dy,
		.dz = par->cell,
		.periodic = s->periodic };
	struct debris *d;

	if (!(par->yield > 0) || !(par->cell >= 0) || !(par->offset >= 0)) {
		errno = EDOM;
		return NULL;
	}
	d = calloc(1, sizeof *d);
	if (!d)
		return NULL;
	d->par = *par;
	d->stress = stress_new(s);
	d->particles = d->stress ? particles_new(&p) : NULL;
	d->wear = d->particles ? wear_new(s->nx, s->ny) : NULL;
	if (!d->wear) {
		int reason = errno;

		debris_free(d);
		errno = reason;
		return NULL;
	}
	return d;
}

void debris_free(struct debris *d)
{
	if (!d)
		return;
	stress_free(d->stress);
	particles_free(d->particles);
	wear_free(d->wear);
	free(d);
}

struct stress *debris_stress(struct debris *d)
{
	return d->stress;
}

void debris_contact(
	const struct debris *d, const double *pressure, struct debris_step *step)
{
	const struct stress_par *s = &d->par.stress;
	double sum = 0, edge = 0, most = 0;
	size_t cells = 0, nx = (size_t)s->nx;

	memset(step, 0, sizeof *step);
	for (int y = 0; y < s->ny; y++) {
		const double *row = pressure + grid_at(s->nx, 0, y);
		int inner = y > 0 && y < s->ny - 1;

		for (size_t x = lanes_next(row, 0, nx); x < nx;
			x = lanes_next(row, x + 1, nx)) {
			double p = row[x];

			sum += p;
			cells += p > 0;
			most = p > most ? p : most;
			edge += inner ? 0 : p;
		}
		if (inner)
			edge += s->nx > 1 ? row[0] + row[s->nx - 1] : row[0];
	}
	step->max_pressure = most;
	step->load = sum * s->dx * s->dy;
	step->contact = (double)cells / ((double)s->nx * s->ny);
	step->edge_load = sum > 0 && !s->periodic ? edge / sum : 0;
}

enum debris_status debris_load(struct debris *d, const double *pressure)
{
	const struct stress_span *loads;
	size_t count;

	if (stress_load(d->stress, pressure))
		return DEBRIS_NUMBERS;
	loads = stress_loads(d->stress, &count);
	for (size_t i = 0; i < count; i++) {
		const double *row = pressure + grid_at(d->par.stress.nx, 0, loads[i].y);

		for (int x = loads[i].begin; x < loads[i].end; x++)
			if (row[x] < 0)
				return DEBRIS_PULL;
	}
	return DEBRIS_OK;
}

static enum debris_status status_of(enum wear_status status)
{
	return status == WEAR_OK     ? DEBRIS_OK
	       : status == WEAR_DEEP ? DEBRIS_DEEP
				     : DEBRIS_MEMORY;
}

/* Whether the loss is more than so many cells deep. */
static enum debris_status count_cells(struct debris *d, struct wear_par wear)
{
	double cell = wear.cell;
	struct wear_result r;
	enum debris_status status;

	if (cell == 0 || cell > THIN * wear.spacing)
		return DEBRIS_OK;
	wear.cell = 0;
	status = status_of(wear_remove(d->wear, d->stress, &wear, &r));
	return status == DEBRIS_OK && r.depth > CELLS * cell ? DEBRIS_FINE : status;
}

enum debris_status debris_step(struct debris *d, double *height, const double *pressure,
	struct debris_step *step)
{
	const struct stress_par *s = &d->par.stress;
	struct wear_par wear = { .yield = d->par.yield,
		.rule = d->par.rule,
		.spacing = fmin(s->dx, s->dy),
		.cell = d->par.cell,
		.offset = d->par.offset,
		.deepest = debris_deepest(s) };
	enum debris_status valid = debris_load(d, pressure);
	enum debris_status status;

	debris_contact(d, pressure, step);
	if (valid != DEBRIS_OK)
		return valid;
	status = count_cells(d, wear);
	if (status == DEBRIS_OK)
		status = status_of(wear_remove(d->wear, d->stress, &wear, &step->wear));
	if (status != DEBRIS_OK)
		return status;
	if (particles_find(d->particles, step->wear.stretch, step->wear.count,
		    &step->particle, &step->count))
		return DEBRIS_MEMORY;
	step->volume = step->wear.height * (s->dx * s->dy);
	for (size_t i = 0; i < step->wear.count; i++) {
		const struct stretch *lost = &step->wear.stretch[i];

		step->depth = fmax(step->depth, lost->bottom);
		step->beyond += beyond(s, lost);
		if (height)
			height[lost->column] -= lost->bottom - lost->top;
	}
	return DEBRIS_OK;
}
