/* Incremental hull: a point outside removes the faces visible from it and is connected to
 * their boundary. Visibility is strict and exact, so a face in whose plane the point lies
 * stays, and no face of zero area arises. */
#include "debris/hull.h"
#include "num/room.h"
#include "num/status.h"

#include <stdlib.h>
#include <string.h>

struct face {
	int v[3];     /* counter-clockwise from outside */
	int64_t n[3]; /* outward normal */
};

struct hull {
	struct hull_point *point; /* all while building, then the corners */
	size_t points, point_room;
	struct face *face;
	size_t nfaces, face_room;
	struct hull_edge *edge; /* the boundary while building, then the edges */
	size_t edges, edge_room;
	int *place; /* of the points among the corners */
	size_t place_room;
	double volume6;
};

struct hull *hull_new(void)
{
	struct hull *h = calloc(1, sizeof *h);

	return h;
}

void hull_free(struct hull *h)
{
	if (!h)
		return;
	free(h->point);
	free(h->face);
	free(h->edge);
	free(h->place);
	free(h);
}

/* n . (p - o) */
static int64_t height(
	const int64_t n[3], const struct hull_point *p, const struct hull_point *o)
{
	int64_t sum = 0;

	for (int k = 0; k < 3; k++)
		sum += n[k] * ((int64_t)p->v[k] - o->v[k]);
	return sum;
}

static void normal(const struct hull_point *a, const struct hull_point *b,
	const struct hull_point *c, int64_t n[3])
{
	int64_t u[3], w[3];

	for (int k = 0; k < 3; k++) {
		u[k] = (int64_t)b->v[k] - a->v[k];
		w[k] = (int64_t)c->v[k] - a->v[k];
	}
	n[0] = u[1] * w[2] - u[2] * w[1];
	n[1] = u[2] * w[0] - u[0] * w[2];
	n[2] = u[0] * w[1] - u[1] * w[0];
}

static enum num_status add_face(struct hull *h, int a, int b, int c)
{
	struct face *f;

	if (room_for(&h->face, &h->face_room, h->nfaces + 1, sizeof *f))
		return NUM_MEMORY;
	f = &h->face[h->nfaces++];
	f->v[0] = a, f->v[1] = b, f->v[2] = c;
	normal(&h->point[a], &h->point[b], &h->point[c], f->n);
	return NUM_OK;
}

static enum num_status add_edge(struct hull *h, int from, int to)
{
	if (room_for(&h->edge, &h->edge_room, h->edges + 1, sizeof *h->edge))
		return NUM_MEMORY;
	h->edge[h->edges++] = (struct hull_edge){ from, to };
	return NUM_OK;
}

/* Adds an edge of a removed face to the boundary, or cancels it with its twin. */
static enum num_status toggle_edge(struct hull *h, int from, int to)
{
	for (size_t i = 0; i < h->edges; i++)
		if (h->edge[i].from == to && h->edge[i].to == from) {
			h->edge[i] = h->edge[--h->edges];
			return NUM_OK;
		}
	return add_edge(h, from, to);
}

static enum num_status add_point(struct hull *h, int p)
{
	const struct hull_point *at = &h->point[p];
	size_t kept = 0;

	h->edges = 0;
	for (size_t i = 0; i < h->nfaces; i++) {
		struct face f = h->face[i];

		if (height(f.n, at, &h->point[f.v[0]]) <= 0) {
			h->face[kept++] = f;
			continue;
		}
		for (int k = 0; k < 3; k++)
			if (toggle_edge(h, f.v[k], f.v[(k + 1) % 3]))
				return NUM_MEMORY;
	}
	h->nfaces = kept;
	for (size_t i = 0; i < h->edges; i++)
		if (add_face(h, h->edge[i].from, h->edge[i].to, p))
			return NUM_MEMORY;
	return NUM_OK;
}

/* Order plane by plane across an axis, in each along the next axis and then the last. */
static int compare(const struct hull_point *p, const struct hull_point *q, int axis)
{
	for (int k = 0; k < 3; k++) {
		int at = (axis + k) % 3;

		if (p->v[at] != q->v[at])
			return p->v[at] < q->v[at] ? -1 : 1;
	}
	return 0;
}

static int compare_x(const void *a, const void *b)
{
	return compare(a, b, 0);
}

static int compare_y(const void *a, const void *b)
{
	return compare(a, b, 1);
}

static int compare_z(const void *a, const void *b)
{
	return compare(a, b, 2);
}

/* Direction in which a path in a plane turns at q: > 0 to the left. */
static int64_t turn(const struct hull_point *p, const struct hull_point *q,
	const struct hull_point *r, int axis)
{
	int u = (axis + 1) % 3, w = (axis + 2) % 3;

	return ((int64_t)q->v[u] - p->v[u]) * ((int64_t)r->v[w] - q->v[w]) -
	       ((int64_t)q->v[w] - p->v[w]) * ((int64_t)r->v[u] - q->v[u]);
}

/* Of the sorted points of a plane those that are corners of their hull, in to; returns
 * how many. */
static size_t plane_hull(
	const struct hull_point *point, size_t count, struct hull_point *to, int axis)
{
	size_t kept = 0, lower;

	for (size_t i = 0; i < count; i++) {
		while (kept > 1 &&
			turn(&to[kept - 2], &to[kept - 1], &point[i], axis) <= 0)
			kept--;
		to[kept++] = point[i];
	}
	lower = kept;
	for (size_t i = count - 1; i-- > 0;) {
		while (kept > lower &&
			turn(&to[kept - 2], &to[kept - 1], &point[i], axis) <= 0)
			kept--;
		to[kept++] = point[i];
	}
	/* The path comes back to where it began. */
	return kept > 1 ? kept - 1 : kept;
}

/* Drops repeated points and those that are no corners of the hull of their plane across
 * an axis, which cannot be corners of the body.  Bodies made of cells have many. */
static enum num_status drop_inside(
	struct hull *h, struct hull_point *point, size_t *count, int axis)
{
	static int (*const order[3])(
		const void *, const void *) = { compare_x, compare_y, compare_z };
	size_t kept = 0, first = 0, unique = 0;

	qsort(point, *count, sizeof *point, order[axis]);
	for (size_t i = 0; i < *count; i++)
		if (!unique || compare(&point[unique - 1], &point[i], axis))
			point[unique++] = point[i];
	for (size_t i = 1; i <= unique; i++) {
		size_t n;

		if (i < unique && point[i].v[axis] == point[first].v[axis])
			continue;
		if (room_for(&h->point, &h->point_room, 2 * (i - first), sizeof *point))
			return NUM_MEMORY;
		n = plane_hull(point + first, i - first, h->point, axis);
		memcpy(point + kept, h->point, n * sizeof *point);
		kept += n;
		first = i;
	}
	*count = kept;
	return NUM_OK;
}

enum num_status hull_thin(struct hull *h, struct hull_point *point, size_t *count)
{
	enum num_status status = drop_inside(h, point, count, 1);

	status = status == NUM_OK ? drop_inside(h, point, count, 2) : status;
	return status == NUM_OK ? drop_inside(h, point, count, 0) : status;
}

/* Four points that span space as the first faces; 0 if there are none. */
static int start(struct hull *h, size_t count, int corner[4])
{
	int64_t n[3];
	size_t i = 2;

	corner[0] = 0, corner[1] = 1;
	for (; i < count; i++) {
		normal(&h->point[0], &h->point[1], &h->point[i], n);
		if (n[0] || n[1] || n[2])
			break;
	}
	if (i >= count)
		return 0;
	corner[2] = (int)i;
	for (i++; i < count; i++) {
		int64_t side = height(n, &h->point[i], &h->point[0]);

		if (side == 0)
			continue;
		corner[3] = (int)i;
		if (side > 0) {
			corner[1] = corner[2];
			corner[2] = 1;
		}
		return 1;
	}
	return 0;
}

static double volume6(const struct hull *h)
{
	const struct hull_point *o = &h->point[h->face[0].v[0]];
	double sum = 0;

	for (size_t i = 0; i < h->nfaces; i++)
		sum -= (double)height(h->face[i].n, o, &h->point[h->face[i].v[0]]);
	return sum;
}

/* Keeps the points that are corners of a face, and lists the edges. */
static enum num_status collect(struct hull *h)
{
	int *place;
	size_t kept = 0;

	if (room_for(&h->place, &h->place_room, h->points, sizeof *place))
		return NUM_MEMORY;
	place = h->place;
	memset(place, 0, h->points * sizeof *place);
	for (size_t i = 0; i < h->nfaces; i++)
		for (int k = 0; k < 3; k++)
			place[h->face[i].v[k]] = 1;
	for (size_t i = 0; i < h->points; i++)
		if (place[i]) {
			place[i] = (int)kept;
			h->point[kept++] = h->point[i];
		}
	h->points = kept;
	h->edges = 0;
	for (size_t i = 0; i < h->nfaces; i++)
		for (int k = 0; k < 3; k++) {
			int a = h->face[i].v[k], b = h->face[i].v[(k + 1) % 3];

			/* Every edge is met once from either side. */
			if (a < b && add_edge(h, place[a], place[b]))
				return NUM_MEMORY;
		}
	return NUM_OK;
}

static int too_large(const struct hull_point *point, size_t count)
{
	for (int k = 0; k < 3; k++) {
		int64_t low = INT32_MAX, high = INT32_MIN;

		for (size_t i = 0; i < count; i++) {
			low = point[i].v[k] < low ? point[i].v[k] : low;
			high = point[i].v[k] > high ? point[i].v[k] : high;
		}
		if (high - low > HULL_SPAN)
			return 1;
	}
	return 0;
}

enum hull_status hull_build(struct hull *h, struct hull_point *point, size_t count)
{
	struct hull_point *p;
	int c[4];

	if (too_large(point, count))
		return HULL_LARGE;
	if (hull_thin(h, point, &count) ||
		room_for(&h->point, &h->point_room, count, sizeof *p))
		return HULL_MEMORY;
	p = h->point;
	h->points = count;
	memcpy(p, point, h->points * sizeof *p);
	h->nfaces = 0;
	if (h->points < 4 || !start(h, h->points, c))
		return HULL_FLAT;
	if (add_face(h, c[0], c[1], c[2]) || add_face(h, c[0], c[3], c[1]) ||
		add_face(h, c[1], c[3], c[2]) || add_face(h, c[2], c[3], c[0]))
		return HULL_MEMORY;
	for (size_t i = 1; i < h->points; i++)
		if (add_point(h, (int)i))
			return HULL_MEMORY;
	h->volume6 = volume6(h);
	return collect(h) ? HULL_MEMORY : HULL_OK;
}

const struct hull_point *hull_points(const struct hull *h, size_t *count)
{
	*count = h->points;
	return h->point;
}

const struct hull_edge *hull_edges(const struct hull *h, size_t *count)
{
	*count = h->edges;
	return h->edge;
}

double hull_volume6(const struct hull *h)
{
	return h->volume6;
}
