#include "debris/chords.h"
#include "num/room.h"
#include "num/status.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { X, Y, Z };

/* A corner at its height along the longest chord, and the first of its rising edges. */
struct level {
	double height;
	size_t corner, rising;
};

struct chords {
	const struct hull_edge *edge; /* the hull's */
	size_t edges, corners;
	double (*corner)[3]; /* of the hull, m */
	struct level *level; /* of the corners, by height, and one behind them */
	double *height;      /* of the corners */
	size_t *rising;      /* edges by their lower corner, in the order of level */
	size_t *crossed;     /* edges that a section may cross */
	double (*cut)[3];    /* corners of a section */
	size_t corner_room, level_room, height_room, rising_room, crossed_room, cut_room;
};

struct chords *chords_new(void)
{
	struct chords *c = calloc(1, sizeof *c);

	return c;
}

void chords_free(struct chords *c)
{
	if (!c)
		return;
	free(c->corner);
	free(c->level);
	free(c->height);
	free(c->rising);
	free(c->crossed);
	free(c->cut);
	free(c);
}

static double distance2(const double a[3], const double b[3])
{
	double u = a[X] - b[X], v = a[Y] - b[Y], w = a[Z] - b[Z];

	return u * u + v * v + w * w;
}

/* Middle of count points, and the distance of the farthest from it, rounded up. */
static double reach_of(double (*p)[3], size_t count, double middle[3])
{
	double most = 0;

	middle[X] = middle[Y] = middle[Z] = 0;
	for (size_t i = 0; i < count; i++)
		for (int k = X; k <= Z; k++)
			middle[k] += p[i][k] / (double)count;
	for (size_t i = 0; i < count; i++) {
		double d = distance2(p[i], middle);

		most = d > most ? d : most;
	}
	return sqrt(most) * (1 + 1e-12);
}

/* The largest distance of two of count points, or least if that is larger (squared).
 * Points too near the middle to be an end of it are skipped. */
static double farthest(double (*p)[3], size_t count, double least)
{
	double middle[3], reach = reach_of(p, count, middle);

	for (size_t i = 0; i < count; i++) {
		double most = sqrt(distance2(p[i], middle)) + reach;

		if (most * most < least)
			continue;
		for (size_t j = 0; j < i; j++) {
			double d = distance2(p[i], p[j]);

			least = d > least ? d : least;
		}
	}
	return least;
}

static int by_height(const void *a, const void *b)
{
	const struct level *p = a, *q = b;

	if (p->height != q->height)
		return p->height < q->height ? -1 : 1;
	return p->corner < q->corner ? -1 : 1;
}

/* Corners in the order of their heights along the longest chord, with the edges that rise
 * from each.  Edges at one height belong to none. */
static void sort_levels(struct chords *c, const double along[3])
{
	size_t *count = c->crossed, sum = 0; /* of each corner; free until the sweep */

	for (size_t i = 0; i < c->corners; i++) {
		const double *p = c->corner[i];

		c->height[i] = p[X] * along[X] + p[Y] * along[Y] + p[Z] * along[Z];
		c->level[i] = (struct level){ c->height[i], i, 0 };
		count[i] = 0;
	}
	qsort(c->level, c->corners, sizeof *c->level, by_height);
	for (size_t i = 0; i < c->edges; i++) {
		const struct hull_edge *e = &c->edge[i];
		double a = c->height[e->from], b = c->height[e->to];

		if (a != b)
			count[a < b ? e->from : e->to]++;
	}
	for (size_t i = 0; i < c->corners; i++) {
		size_t corner = c->level[i].corner;

		c->level[i].rising = sum;
		sum += count[corner];
		count[corner] = c->level[i].rising;
	}
	c->level[c->corners] = (struct level){ INFINITY, 0, sum };
	for (size_t i = 0; i < c->edges; i++) {
		const struct hull_edge *e = &c->edge[i];
		double a = c->height[e->from], b = c->height[e->to];

		if (a != b)
			c->rising[count[a < b ? e->from : e->to]++] = i;
	}
}

/* Puts the point of an edge at a height into c->cut[count]; 0 if the edge ends there or
 * below. */
static int cross(struct chords *c, size_t edge, double level, size_t count)
{
	const struct hull_edge *e = &c->edge[edge];
	const double *p = c->corner[e->from], *q = c->corner[e->to];
	double a = c->height[e->from] - level, b = c->height[e->to] - level;

	if (a <= 0 && b <= 0)
		return 0;
	for (int k = X; k <= Z; k++)
		c->cut[count][k] = p[k] + (q[k] - p[k]) * (a / (a - b));
	return 1;
}

/* Longest chord perpendicular to a direction, or most if that is longer (squared).
 * Between two corners of the hull the corners of the section move linearly with height,
 * so its diameter is a convex function of height: the largest is at the height of a
 * corner. */
static double widest(struct chords *c, const double along[3], double most)
{
	size_t crossed = 0;

	sort_levels(c, along);
	for (size_t i = 0, next; i < c->corners; i = next) {
		double level = c->level[i].height;
		size_t count = 0, kept = 0;

		for (next = i; c->level[next].height == level; next++)
			memcpy(c->cut[count++], c->corner[c->level[next].corner],
				sizeof *c->cut);
		for (size_t k = 0; k < crossed; k++)
			if (cross(c, c->crossed[k], level, count)) {
				c->crossed[kept++] = c->crossed[k];
				count++;
			}
		crossed = kept;
		most = farthest(c->cut, count, most);
		for (size_t k = c->level[i].rising; k < c->level[next].rising; k++)
			c->crossed[crossed++] = c->rising[k];
	}
	return most;
}

/* Longest chord perpendicular to one of the longest (squared).  On a lattice several are
 * often equally long, such as mirror images of each other; the order of the corners must
 * not decide between them.  Squares of equal distances differ by the rounding of three
 * differences of coordinates, their squares and sums, some ten units in the last place;
 * 64 are more than that. */
static double perpendicular(struct chords *c, double longest)
{
	double middle[3], reach = reach_of(c->corner, c->corners, middle), most = 0;
	double least = longest * (1 - 64 * DBL_EPSILON);

	for (size_t i = 0; i < c->corners; i++) {
		double *p = c->corner[i], away = sqrt(distance2(p, middle)) + reach;

		if (away * away < least)
			continue;
		for (size_t j = 0; j < i; j++) {
			double *q = c->corner[j], d = distance2(p, q), along[3];

			if (d < least)
				continue;
			for (int k = X; k <= Z; k++)
				along[k] = (p[k] - q[k]) / sqrt(d);
			most = widest(c, along, most);
		}
	}
	return most;
}

enum num_status chords_measure(struct chords *c, const struct hull *h,
	const double step[3], double *length, double *width)
{
	const struct hull_point *p = hull_points(h, &c->corners);
	double most;

	c->edge = hull_edges(h, &c->edges);
	if (room_for(&c->corner, &c->corner_room, c->corners, sizeof *c->corner) ||
		room_for(&c->level, &c->level_room, c->corners + 1, sizeof *c->level) ||
		room_for(&c->height, &c->height_room, c->corners, sizeof *c->height) ||
		room_for(&c->rising, &c->rising_room, c->edges, sizeof *c->rising) ||
		room_for(&c->crossed, &c->crossed_room, c->corners + c->edges,
			sizeof *c->crossed) ||
		room_for(&c->cut, &c->cut_room, c->corners + c->edges, sizeof *c->cut))
		return NUM_MEMORY;
	for (size_t i = 0; i < c->corners; i++)
		for (int k = X; k <= Z; k++)
			c->corner[i][k] = ((double)p[i].v[k] - p[0].v[k]) * step[k];
	most = farthest(c->corner, c->corners, 0);
	*length = sqrt(most);
	*width = sqrt(perpendicular(c, most));
	return NUM_OK;
}
