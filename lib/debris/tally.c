#include "debris/tally.h"
#include "num/sym3.h"
#include <math.h>
#include <string.h>

enum { X, Y, Z };

struct tally tally_run(int begin, int end, int y, int z)
{
	double n = end - begin, last = end - 1, first = begin,
	       sum = n * (first + last) / 2;
	/* n mean^2 + n (n^2 - 1) / 12 */
	double square = n * ((first + last) * (first + last) / 4 + (n * n - 1) / 12);

	return (struct tally){ .nodes = n,
		.sum = { sum, n * y, n * z },
		.square = { square, n * y * y, n * z * z, sum * y, sum * z, n * y * z },
		.faces = { 2, 2 * n, 2 * n },
		.low = { begin, y, z },
		.high = { end - 1, y, z },
		.first = { begin, y, z } };
}

void tally_shift(struct tally *t, int dx, int dy)
{
	t->square[0] += 2 * dx * t->sum[X] + t->nodes * dx * dx;
	t->square[1] += 2 * dy * t->sum[Y] + t->nodes * dy * dy;
	t->square[3] += dy * t->sum[X] + dx * t->sum[Y] + t->nodes * dx * dy;
	t->square[4] += dx * t->sum[Z];
	t->square[5] += dy * t->sum[Z];
	t->sum[X] += t->nodes * dx;
	t->sum[Y] += t->nodes * dy;
	t->low[X] += dx, t->high[X] += dx;
	t->low[Y] += dy, t->high[Y] += dy;
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
	t->nodes += other->nodes;
	for (int k = 0; k < 6; k++)
		t->square[k] += other->square[k];
	if (tally_precedes(other->first, t->first))
		memcpy(t->first, other->first, sizeof(t->first));
	for (int k = X; k <= Z; k++) {
		t->sum[k] += other->sum[k];
		t->faces[k] += other->faces[k];
		t->low[k] = t->low[k] < other->low[k] ? t->low[k] : other->low[k];
		t->high[k] = t->high[k] > other->high[k] ? t->high[k] : other->high[k];
	}
}

/* Elongation and direction, by the moments of inertia. */
static void measure_moments(
	const struct tally *t, const double step[3], struct particle *p)
{
	static const int first[6] = { X, Y, Z, X, X, Y },
			 second[6] = { X, Y, Z, Y, Z, Z };
	double m[6], value[3], axis[3][3];

	for (int k = 0; k < 6; k++) {
		int i = first[k], j = second[k];
		/* A cell's own moment is that of a box: 1/12. */
		double own = i == j ? 1. / 12 : 0;

		m[k] = step[i] * step[j] *
		       (t->square[k] / t->nodes -
			       t->sum[i] / t->nodes * (t->sum[j] / t->nodes) + own);
	}
	sym3_eigen(m, value, axis);
	p->elongation = 1 - sqrt(value[1] / value[0]);
	p->azimuth = p->dip = NAN;
	if (value[0] - value[1] < 1e-9 * value[0])
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
		at[k] = t->sum[k] / t->nodes + 0.5;
		back[k] = k == Z ? 0 : home(grid, at[k], k == X ? grid->nx : grid->ny);
		p->low[k] = (t->low[k] - back[k]) * step[k];
		p->high[k] = (t->high[k] + 1 - back[k]) * step[k];
		p->first[k] = t->first[k];
	}
	p->x = (at[X] - back[X]) * ax;
	p->y = (at[Y] - back[Y]) * ay;
	p->z = at[Z] * az;
	measure_moments(t, step, p);
}
