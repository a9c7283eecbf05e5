#include "debris/chords.h"
#include "num/room.h"
#include "num/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { X, Y, Z };

struct chords {
	const struct hull_edge *edge; /* the hull's */
	size_t edges, corners;
	double (*corner)[3]; /* of the hull, m */
	double *height;      /* of the corners along the longest chord */
	double (*cut)[3];    /* corners of a section */
	size_t corner_room, height_room, cut_room;
};

struct chords *chords_new(void)
{
	return calloc(1, sizeof(struct chords));
}

void chords_free(struct chords *c)
{
	if (!c)
		return;
	free(c->corner);
	free(c->height);
	free(c->cut);
	free(c);
}

static double distance2(const double a[3], const double b[3])
{
	double u = a[X] - b[X], v = a[Y] - b[Y], w = a[Z] - b[Z];

	return u * u + v * v + w * w;
}

/* The farthest two of count points, if farther than least (squared); the square of their
 * distance. Points too near the middle to be one of them are skipped. */
static double farthest(double (*p)[3], size_t count, double least, size_t end[2])
{
	double middle[3] = { 0, 0, 0 }, reach = 0;

	for (size_t i = 0; i < count; i++)
		for (int k = X; k <= Z; k++)
			middle[k] += p[i][k] / (double)count;
	for (size_t i = 0; i < count; i++) {
		double d = distance2(p[i], middle);

		reach = d > reach ? d : reach;
	}
	reach = sqrt(reach) * (1 + 1e-12);
	for (size_t i = 0; i < count; i++) {
		double most = sqrt(distance2(p[i], middle)) + reach;

		if (most * most < least)
			continue;
		for (size_t j = 0; j < i; j++) {
			double d = distance2(p[i], p[j]);

			if (d > least) {
				least = d;
				end[0] = i;
				end[1] = j;
			}
		}
	}
	return least;
}

/* Largest distance between two corners; along: the unit vector there. */
static double longest(const struct chords *c, double along[3])
{
	size_t end[2] = { 0, 0 };
	double most = sqrt(farthest(c->corner, c->corners, 0, end));

	for (int k = X; k <= Z; k++)
		along[k] = (c->corner[end[0]][k] - c->corner[end[1]][k]) / most;
	return most;
}

/* Corners, in c->cut, of the section at a height along the longest chord. */
static size_t section(struct chords *c, double level)
{
	size_t count = 0;

	for (size_t i = 0; i < c->corners; i++)
		if (c->height[i] == level)
			memcpy(c->cut[count++], c->corner[i], sizeof *c->cut);
	for (size_t i = 0; i < c->edges; i++) {
		const struct hull_edge *e = &c->edge[i];
		const double *p = c->corner[e->from], *q = c->corner[e->to];
		double a = c->height[e->from] - level, b = c->height[e->to] - level;

		if (!((a < 0 && b > 0) || (a > 0 && b < 0)))
			continue;
		for (int k = X; k <= Z; k++)
			c->cut[count][k] = p[k] + (q[k] - p[k]) * (a / (a - b));
		count++;
	}
	return count;
}

/* Longest chord perpendicular to the longest of all.  Between two corners of the hull the
 * corners of the section move linearly with height, so its diameter is a convex function
 * of height: the largest is at the height of a corner. */
static double widest(struct chords *c, const double along[3])
{
	double most = 0;
	size_t end[2];

	for (size_t i = 0; i < c->corners; i++) {
		const double *p = c->corner[i];

		c->height[i] = p[X] * along[X] + p[Y] * along[Y] + p[Z] * along[Z];
	}
	for (size_t i = 0; i < c->corners; i++)
		most = farthest(c->cut, section(c, c->height[i]), most, end);
	return sqrt(most);
}

enum num_status chords_measure(struct chords *c, const struct hull *h,
	const double step[3], double *length, double *width)
{
	const struct hull_point *p = hull_points(h, &c->corners);
	double along[3];

	c->edge = hull_edges(h, &c->edges);
	if (room_for(&c->corner, &c->corner_room, c->corners, sizeof *c->corner) ||
		room_for(&c->height, &c->height_room, c->corners, sizeof *c->height) ||
		room_for(&c->cut, &c->cut_room, c->corners + c->edges, sizeof *c->cut))
		return NUM_MEMORY;
	for (size_t i = 0; i < c->corners; i++)
		for (int k = X; k <= Z; k++)
			c->corner[i][k] = ((double)p[i].v[k] - p[0].v[k]) * step[k];
	*length = longest(c, along);
	*width = widest(c, along);
	return NUM_OK;
}
