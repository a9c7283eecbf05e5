#include "debris/chords.h"
#include "num/room.h"
#include "num/status.h"

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
	return calloc(1, sizeof(struct chords));
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

/* Longest chord perpendicular to the longest of all.  Between two corners of the hull the
 * corners of the section move linearly with height, so its diameter is a convex function
 * of height: the largest is at the height of a corner. */
static double widest(struct chords *c, const double along[3])
{
	double most = 0;
	size_t crossed = 0, end[2];

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
		most = farthest(c->cut, count, most, end);
		for (size_t k = c->level[i].rising; k < c->level[next].rising; k++)
			c->crossed[crossed++] = c->rising[k];
	}
	return sqrt(most);
}

enum num_status chords_measure(struct chords *c, const struct hull *h,
	const double step[3], double *length, double *width)
{
	const struct hull_point *p = hull_points(h, &c->corners);
	double along[3];

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
	*length = longest(c, along);
	*width = widest(c, along);
	return NUM_OK;
}
