#include "debris/tally.h"
#include "num/sym3.h"
#include <float.h>
#include <math.h>
#include <string.h>

enum { X, Y, Z };

struct tally tally_run(int begin, int end, int y, int z)
{
	double n = end - begin;

	return (struct tally){ .nodes = n,
		.sum = { n * (n - 1) / 2, 0, 0 },
		.square = { n * (n - 1) * (2 * n - 1) / 6, 0, 0, 0, 0, 0 },
		.faces = { 2, 2 * n, 2 * n },
		.low = { begin, y, z },
		.high = { end - 1, y, z },
		.first = { begin, y, z } };
}

void tally_shift(struct tally *t, int dx, int dy)
{
	t->low[X] += dx, t->high[X] += dx;
	t->low[Y] += dy, t->high[Y] += dy;
}

/* Axes of the members of square[]. */
static const int first_axis[6] = { X, Y, Z, X, X, Y },
		 second_axis[6] = { X, Y, Z, Y, Z, Z };

/* Sums of coordinates that are larger by d. */
static void recount(
	const struct tally *t, const double d[3], double sum[3], double square[6])
{
	for (int k = 0; k < 6; k++) {
		int i = first_axis[k], j = second_axis[k];

		square[k] = t->square[k] + d[i] * t->sum[j] + d[j] * t->sum[i] +
			    t->nodes * d[i] * d[j];
	}
	for (int k = X; k <= Z; k++)
		sum[k] = t->sum[k] + t->nodes * d[k];
}

int tally_precedes(const int a[3], const int b[3])
{
	for (int k = Z; k > X; k--)
		if (a[k] != b[k])
			return a[k] < b[k];
	return a[X] < b[X];
}

void tally_add(struct tally *t, const struct tally *other)
{
	double mine[3], theirs[3], sum[2][3], square[2][6];

	for (int k = X; k <= Z; k++) {
		int low = t->low[k] < other->low[k] ? t->low[k] : other->low[k];

		mine[k] = (double)t->low[k] - low;
		theirs[k] = (double)other->low[k] - low;
		t->low[k] = low;
		t->high[k] = t->high[k] > other->high[k] ? t->high[k] : other->high[k];
		t->faces[k] += other->faces[k];
	}
	recount(t, mine, sum[0], square[0]);
	recount(other, theirs, sum[1], square[1]);
	t->nodes += other->nodes;
	for (int k = 0; k < 6; k++)
		t->square[k] = square[0][k] + square[1][k];
	for (int k = X; k <= Z; k++)
		t->sum[k] = sum[0][k] + sum[1][k];
	for (int k = X; k <= Y; k++)
		t->winds[k] |= other->winds[k];
	if (tally_precedes(other->first, t->first))
		memcpy(t->first, other->first, sizeof(t->first));
}

/* Elongation and direction, by the moments of inertia. */
static void measure_moments(
	const struct tally *t, const double step[3], struct particle *p)
{
	double m[6], value[3], axis[3][3], centre[3], sum[3], square[6];

	/* About the cell next to the centroid, in whole numbers still: nothing cancels
	 * in the rest. */
	for (int k = X; k <= Z; k++)
		centre[k] = -floor(t->sum[k] / t->nodes + 0.5);
	recount(t, centre, sum, square);
	for (int k = 0; k < 6; k++) {
		int i = first_axis[k], j = second_axis[k];
		/* A cell's own moment is that of a box: 1/12. */
		double own = i == j ? 1. / 12 : 0;

		m[k] = step[i] * step[j] *
		       (square[k] / t->nodes - sum[i] / t->nodes * (sum[j] / t->nodes) +
			       own);
	}
	sym3_eigen(m, value, axis);
	p->elongation = 1 - sqrt(value[1] / value[0]);
	p->azimuth = p->dip = NAN;
	/* Moments are right to some units of the last place. */
	if (value[0] - value[1] < 64 * DBL_EPSILON * value[0])
		return;
	if (axis[0][X] < 0 || (axis[0][X] == 0 && axis[0][Y] < 0))
		for (int k = X; k <= Z; k++)
			axis[0][k] = -axis[0][k];
	p->azimuth = atan2(axis[0][Y], axis[0][X]);
	p->dip = atan2(fabs(axis[0][Z]), hypot(axis[0][X], axis[0][Y]));
}

/* Whole periods that bring the centroid back onto the grid. */
static double home(const struct particles_par *grid, double centroid, int n)
{
	return grid->periodic ? n * floor(centroid / n) : 0;
}

void tally_measure(
	const struct tally *t, const struct particles_par *grid, struct particle *p)
{
	double ax = grid->ax, ay = grid->ay, az = grid->az;
	double step[3] = { ax, ay, az }, at[3], back[3];

	p->nodes = t->nodes;
	p->volume = t->nodes * (ax * ay * az);
	p->diameter = cbrt(6 * p->volume / M_PI);
	p->area = t->faces[X] * ay * az + t->faces[Y] * ax * az + t->faces[Z] * ax * ay;
	for (int k = X; k <= Z; k++) {
		at[k] = t->low[k] + t->sum[k] / t->nodes + 0.5;
		back[k] = k == Z ? 0 : home(grid, at[k], k == X ? grid->nx : grid->ny);
		p->low[k] = (t->low[k] - back[k]) * step[k];
		p->high[k] = (t->high[k] + 1 - back[k]) * step[k];
		p->first[k] = t->first[k];
	}
	p->x = (at[X] - back[X]) * ax;
	p->y = (at[Y] - back[Y]) * ay;
	p->z = at[Z] * az;
	p->endless = t->winds[X] || t->winds[Y];
	if (!t->winds[X] && !t->winds[Y])
		measure_moments(t, step, p);
	else
		p->elongation = p->azimuth = p->dip = NAN;
	if (t->winds[X]) {
		p->x = NAN;
		p->low[X] = 0, p->high[X] = grid->nx * ax;
	}
	if (t->winds[Y]) {
		p->y = NAN;
		p->low[Y] = 0, p->high[Y] = grid->ny * ay;
	}
}
