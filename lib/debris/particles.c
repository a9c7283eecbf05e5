/* The stretches are sorted by column and each body is filled from its first one.  On a
 * periodic grid every stretch is visited with an offset of whole periods; a body that is
 * visited with two different offsets is infinite. */
#include "debris/particles.h"
#include "debris/chords.h"
#include "debris/hull.h"
#include "num/room.h"
#include "num/status.h"
#include "num/sym3.h"

#include <errno.h>
#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { X, Y, Z };

/* Steps of depth to a body in its hull where none are given.  The number of chords grows
 * with the square of the number of corners of a hull; columns are no finer than their
 * spacing either. */
enum { STEPS = 64 };
/* Corners in memory before the first are dropped: 12 bytes each. */
enum { CORNERS = 1 << 16 };
enum { COLUMN_MASK = (1 << 24) - 1 };

/* A stretch with its position during the search. */
struct piece {
	double top, bottom;
	int period[2]; /* of the frame in which it was reached */
	/* Column, on the grid, in few bits: there may be more pieces than cells. */
	unsigned x : 24, reached : 1;
	unsigned y : 24;
	/* Whether its top and bottom corners towards -x, +x, -y, +y lie on the neighbour
	 * there as well: bits of covered_bit(). */
	unsigned covered : 8;
};

static unsigned covered_bit(int axis, int up, int bottom)
{
	return 1u << (4 * axis + 2 * up + bottom);
}

struct particles {
	struct particles_par par;
	uint32_t *start; /* of nx * ny + 1: the pieces of a column */
	struct piece *piece;
	size_t piece_room;
	uint32_t *body; /* pieces of the present body, in the order reached */
	size_t members, body_room;
	double area;  /* of its exposed sides */
	int winds[2]; /* the body is endless along x, y */
	struct hull *hull;
	struct chords *chords;
	struct hull_point *corner;
	size_t corner_room;
	struct particle *done;
	size_t ndone, done_room;
};

struct particles *particles_new(const struct particles_par *par)
{
	struct particles *ps;

	if (par->nx < 1 || par->ny < 1 || par->nx > HULL_SPAN || par->ny > HULL_SPAN ||
		!(par->dx > 0) || !(par->dy > 0) || !(par->dz >= 0)) {
		errno = EDOM;
		return NULL;
	}
	ps = calloc(1, sizeof *ps);
	if (!ps)
		return NULL;
	ps->par = *par;
	ps->start = malloc(((size_t)par->nx * (size_t)par->ny + 1) * sizeof *ps->start);
	ps->hull = hull_new();
	ps->chords = chords_new();
	if (!ps->start || !ps->hull || !ps->chords) {
		particles_free(ps);
		errno = ENOMEM;
		return NULL;
	}
	return ps;
}

void particles_free(struct particles *ps)
{
	if (!ps)
		return;
	free(ps->start);
	free(ps->piece);
	free(ps->body);
	hull_free(ps->hull);
	chords_free(ps->chords);
	free(ps->corner);
	free(ps->done);
	free(ps);
}

/* Counting sort by column; within a column from the surface down. */
static enum num_status sort_by_column(
	struct particles *ps, const struct stretch *s, size_t count)
{
	size_t columns = (size_t)ps->par.nx * (size_t)ps->par.ny;

	if (count >= UINT32_MAX ||
		room_for(&ps->piece, &ps->piece_room, count + 1, sizeof *ps->piece) ||
		room_for(&ps->body, &ps->body_room, count + 1, sizeof *ps->body))
		return NUM_MEMORY;
	memset(ps->start, 0, (columns + 1) * sizeof *ps->start);
	for (size_t i = 0; i < count; i++)
		ps->start[s[i].column + 1]++;
	for (size_t c = 0; c < columns; c++)
		ps->start[c + 1] += ps->start[c];
	/* Filled from the front, each column's start moves to its end, and back. */
	for (size_t i = 0; i < count; i++) {
		size_t at = ps->start[s[i].column]++;

		ps->piece[at] = (struct piece){ .top = s[i].top,
			.bottom = s[i].bottom,
			.x = s[i].column % (size_t)ps->par.nx & COLUMN_MASK,
			.y = s[i].column / (size_t)ps->par.nx & COLUMN_MASK };
	}
	memmove(ps->start + 1, ps->start, columns * sizeof *ps->start);
	ps->start[0] = 0;
	for (size_t c = 0; c < columns; c++)
		for (size_t i = ps->start[c] + 1; i < ps->start[c + 1]; i++)
			for (size_t k = i; k > ps->start[c] &&
					   ps->piece[k].top < ps->piece[k - 1].top;
				k--) {
				struct piece t = ps->piece[k];

				ps->piece[k] = ps->piece[k - 1];
				ps->piece[k - 1] = t;
			}
	return NUM_OK;
}

static void reach(struct particles *ps, size_t at, const int period[2])
{
	struct piece *p = &ps->piece[at];

	if (p->reached) {
		for (int k = X; k <= Y; k++)
			ps->winds[k] |= p->period[k] != period[k];
		return;
	}
	p->reached = 1;
	memcpy(p->period, period, sizeof p->period);
	ps->body[ps->members++] = (uint32_t)at;
}

/* Brings a coordinate onto the grid; whether there is such a column. */
static int onto_grid(int *at, int n, int periodic, int *period)
{
	int over = *at < 0 ? -1 : *at >= n;

	*at -= over * n;
	*period += over;
	return !over || periodic;
}

/* Adds the pieces of the column at (dx, dy) from a piece that overlap it; returns the
 * height of the overlap.  ends: 1 if the top is within one of them, and 2 if the bottom
 * is. */
static double reach_column(
	struct particles *ps, const struct piece *p, int dx, int dy, unsigned *ends)
{
	int x = (int)p->x + dx, y = (int)p->y + dy,
	    period[2] = { p->period[X], p->period[Y] };
	double top = p->top, bottom = p->bottom, shared = 0;
	size_t column;

	*ends = 0;
	if (!onto_grid(&x, ps->par.nx, ps->par.periodic, &period[X]) ||
		!onto_grid(&y, ps->par.ny, ps->par.periodic, &period[Y]))
		return 0;
	column = (size_t)y * (size_t)ps->par.nx + (size_t)x;
	for (size_t i = ps->start[column]; i < ps->start[column + 1]; i++) {
		double overlap =
			fmin(bottom, ps->piece[i].bottom) - fmax(top, ps->piece[i].top);

		if (!(overlap > 0))
			continue;
		shared += overlap;
		*ends |= (ps->piece[i].top <= top ? 1u : 0) |
			 (ps->piece[i].bottom >= bottom ? 2u : 0);
		reach(ps, i, period);
	}
	return shared;
}

/* Adds the neighbours of a piece along an axis; returns the height of its exposed sides.
 */
static double reach_along(struct particles *ps, size_t at, int axis)
{
	const struct piece p = ps->piece[at];
	double exposed = 0;

	for (int up = 0; up <= 1; up++) {
		int side = up ? 1 : -1;
		unsigned ends;

		exposed += p.bottom - p.top -
			   reach_column(ps, &p, axis == X ? side : 0,
				   axis == Y ? side : 0, &ends);
		ps->piece[at].covered |= ends * covered_bit(axis, up, 0) & 255;
	}
	return exposed;
}

/* All pieces of the body of one. */
static void fill(struct particles *ps, size_t from)
{
	static const int home[2] = { 0, 0 };

	ps->members = 0;
	ps->area = 0;
	ps->winds[X] = ps->winds[Y] = 0;
	reach(ps, from, home);
	for (size_t next = 0; next < ps->members; next++) {
		size_t at = ps->body[next];
		const struct piece p = ps->piece[at];
		unsigned ends;

		ps->area += reach_along(ps, at, X) * ps->par.dy;
		ps->area += reach_along(ps, at, Y) * ps->par.dx;
		for (int side = -1; ps->par.corners && side <= 1; side += 2) {
			reach_column(ps, &p, side, -1, &ends);
			reach_column(ps, &p, side, 1, &ends);
		}
		ps->area += 2 * ps->par.dx * ps->par.dy;
	}
}

/* Measures */

/* Column of a piece in the frame of its body. */
static void column_of(const struct particles *ps, const struct piece *p, int at[2])
{
	at[X] = (int)p->x + p->period[X] * ps->par.nx;
	at[Y] = (int)p->y + p->period[Y] * ps->par.ny;
}

/* Columns and depths, low[] to high[] exclusive, of the body. */
struct extent {
	int low[2], high[2];
	double top, bottom;
};

static struct extent extent_of(const struct particles *ps)
{
	struct extent e = { { INT_MAX, INT_MAX }, { INT_MIN, INT_MIN }, INFINITY, 0 };

	for (size_t i = 0; i < ps->members; i++) {
		const struct piece *p = &ps->piece[ps->body[i]];
		int at[2];

		column_of(ps, p, at);
		for (int k = X; k <= Y; k++) {
			e.low[k] = at[k] < e.low[k] ? at[k] : e.low[k];
			e.high[k] = at[k] + 1 > e.high[k] ? at[k] + 1 : e.high[k];
		}
		e.top = fmin(e.top, p->top);
		e.bottom = fmax(e.bottom, p->bottom);
	}
	return e;
}

/* Volume, over that of a unit of depth, and centroid from the low corner of the body, in
 * columns and metres. */
static double centroid(const struct particles *ps, const struct extent *e, double mean[3])
{
	double sum = 0;

	mean[X] = mean[Y] = mean[Z] = 0;
	for (size_t i = 0; i < ps->members; i++) {
		const struct piece *p = &ps->piece[ps->body[i]];
		double height = p->bottom - p->top;
		int at[2];

		column_of(ps, p, at);
		sum += height;
		mean[X] += height * (at[X] - e->low[X] + 0.5);
		mean[Y] += height * (at[Y] - e->low[Y] + 0.5);
		mean[Z] += height * (0.5 * (p->bottom + p->top) - e->top);
	}
	for (int k = X; k <= Z; k++)
		mean[k] /= sum;
	return sum;
}

/* Elongation and direction, by the second moments about the centroid. */
static void measure_moments(const struct particles *ps, const struct extent *e,
	const double mean[3], double volume, struct particle *out)
{
	double m[6] = { 0 }, value[3], axis[3][3], dx = ps->par.dx, dy = ps->par.dy;
	double rounding = 16 * sqrt((double)ps->members + 16) * DBL_EPSILON;

	for (size_t i = 0; i < ps->members; i++) {
		const struct piece *p = &ps->piece[ps->body[i]];
		double height = p->bottom - p->top, share = height / volume, x, y, z;
		int at[2];

		column_of(ps, p, at);
		x = dx * (at[X] - e->low[X] + 0.5 - mean[X]);
		y = dy * (at[Y] - e->low[Y] + 0.5 - mean[Y]);
		z = 0.5 * (p->bottom + p->top) - e->top - mean[Z];
		m[0] += share * (x * x + dx * dx / 12);
		m[1] += share * (y * y + dy * dy / 12);
		m[2] += share * (z * z + height * height / 12);
		m[3] += share * x * y;
		m[4] += share * x * z;
		m[5] += share * y * z;
	}
	/* Sums of n terms have a rounding error of some sqrt(n) units in the last place.
	 * Products below that are set to 0, so that bodies along the axes have exact
	 * directions. */
	for (int k = 3; k < 6; k++) {
		double most = sqrt(m[k == 5] * m[k == 3 ? 1 : 2]);

		m[k] = fabs(m[k]) < rounding * most ? 0 : m[k];
	}
	sym3_eigen(m, value, axis);
	out->elongation = 1 - sqrt(value[1] / value[0]);
	out->azimuth = out->dip = NAN;
	if (value[0] - value[1] < rounding * value[0])
		return;
	if (axis[0][X] < 0 || (axis[0][X] == 0 && axis[0][Y] < 0))
		for (int k = X; k <= Z; k++)
			axis[0][k] = -axis[0][k];
	out->azimuth = atan2(axis[0][Y], axis[0][X]);
	out->dip = atan2(fabs(axis[0][Z]), hypot(axis[0][X], axis[0][Y]));
}

/* Corners of the body, depths in steps of unit; count of them.  A corner that the
 * neighbour covers lies between two points of the body and is no corner of the hull.
 * Others that cannot be are dropped whenever they fill their memory. */
static enum num_status put_corners(
	struct particles *ps, const struct extent *e, double unit, size_t *count)
{
	size_t n = 0, full = CORNERS;

	for (size_t i = 0; i < ps->members; i++) {
		const struct piece *p = &ps->piece[ps->body[i]];
		int at[2];

		if (n + 8 > full) {
			if (hull_thin(ps->hull, ps->corner, &n))
				return NUM_MEMORY;
			full = n > full / 2 ? 2 * full : full;
		}
		if (room_for(&ps->corner, &ps->corner_room, n + 8, sizeof *ps->corner))
			return NUM_MEMORY;
		column_of(ps, p, at);
		for (int k = 0; k < 8; k++) {
			double z = (k & 4 ? p->bottom : p->top) - e->top;

			if (p->covered & (covered_bit(X, k & 1, k >> 2) |
						 covered_bit(Y, k >> 1 & 1, k >> 2)))
				continue;
			ps->corner[n++] = (struct hull_point){ {
				at[X] - e->low[X] + (k & 1),
				at[Y] - e->low[Y] + (k >> 1 & 1),
				(int32_t)lround(z / unit),
			} };
		}
	}
	*count = n;
	return NUM_OK;
}

static enum num_status measure_hull(
	struct particles *ps, const struct extent *e, struct particle *p)
{
	double range = e->bottom - e->top,
	       unit = ps->par.dz > 0 ? ps->par.dz : range / STEPS;
	const double step[3] = { ps->par.dx, ps->par.dy, unit };
	enum hull_status status = HULL_LARGE;
	size_t corners;

	p->length = p->width = p->aspect = p->solidity = NAN;
	if (!p->endless && range / unit <= HULL_SPAN) {
		if (put_corners(ps, e, unit, &corners))
			return NUM_MEMORY;
		status = hull_build(ps->hull, ps->corner, corners);
	}
	if (status == HULL_LARGE)
		return NUM_OK;
	if (status != HULL_OK ||
		chords_measure(ps->chords, ps->hull, step, &p->length, &p->width))
		return NUM_MEMORY;
	p->aspect = p->length / p->width;
	p->solidity = 6 * p->volume /
		      (hull_volume6(ps->hull) * (ps->par.dx * ps->par.dy * unit));
	return NUM_OK;
}

/* Whole periods that bring the centroid back onto the grid. */
static double home(const struct particles *ps, double at, int n)
{
	return ps->par.periodic ? n * floor(at / n) : 0;
}

static void place(const struct particles *ps, const struct extent *e,
	const double mean[3], struct particle *p)
{
	const int points[2] = { ps->par.nx, ps->par.ny };
	const double step[2] = { ps->par.dx, ps->par.dy };
	double at[2];

	for (int k = X; k <= Y; k++) {
		double back = home(ps, e->low[k] + mean[k], points[k]);

		at[k] = (e->low[k] + mean[k] - back) * step[k];
		p->low[k] = (e->low[k] - back) * step[k];
		p->high[k] = (e->high[k] - back) * step[k];
		if (ps->winds[k]) {
			at[k] = NAN;
			p->low[k] = 0;
			p->high[k] = points[k] * step[k];
		}
	}
	p->x = at[X];
	p->y = at[Y];
	p->z = e->top + mean[Z];
	p->low[Z] = e->top;
	p->high[Z] = e->bottom;
}

static enum num_status measure(struct particles *ps)
{
	const struct piece *first = &ps->piece[ps->body[0]];
	struct extent e = extent_of(ps);
	struct particle *p;
	double mean[3], volume;

	if (room_for(&ps->done, &ps->done_room, ps->ndone + 1, sizeof *ps->done))
		return NUM_MEMORY;
	p = &ps->done[ps->ndone];
	*p = (struct particle){ .columns = ps->members,
		.area = ps->area,
		.first = { (int)first->x, (int)first->y },
		.endless = ps->winds[X] || ps->winds[Y] };
	volume = centroid(ps, &e, mean);
	p->volume = volume * (ps->par.dx * ps->par.dy);
	p->diameter = cbrt(6 * p->volume / M_PI);
	place(ps, &e, mean, p);
	p->elongation = p->azimuth = p->dip = NAN;
	if (!p->endless)
		measure_moments(ps, &e, mean, volume, p);
	if (measure_hull(ps, &e, p))
		return NUM_MEMORY;
	ps->ndone++;
	return NUM_OK;
}

static int in_order(const void *a, const void *b)
{
	const struct particle *p = a, *q = b;

	if (p->volume != q->volume)
		return p->volume > q->volume ? -1 : 1;
	for (int k = Y; k >= X; k--)
		if (p->first[k] != q->first[k])
			return p->first[k] < q->first[k] ? -1 : 1;
	return p->low[Z] < q->low[Z] ? -1 : 1;
}

enum num_status particles_find(struct particles *ps, const struct stretch *stretch,
	size_t count, const struct particle **list, size_t *n)
{
	ps->ndone = 0;
	*list = NULL;
	*n = 0;
	if (sort_by_column(ps, stretch, count))
		return NUM_MEMORY;
	for (size_t i = 0; i < count; i++) {
		if (ps->piece[i].reached)
			continue;
		fill(ps, i);
		if (measure(ps))
			return NUM_MEMORY;
	}
	if (ps->ndone > 0)
		qsort(ps->done, ps->ndone, sizeof *ps->done, in_order);
	*list = ps->done;
	*n = ps->ndone;
	return NUM_OK;
}
