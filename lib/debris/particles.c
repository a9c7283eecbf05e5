/* Union-find over runs of cells.  Every run starts a body of its own; bodies that touch
 * are united, the smaller one taken into the frame of the larger (on a periodic grid
 * frames differ by whole periods).  A body no run of the newest layer belongs to is
 * complete: it is measured and its place used again. */
#include "debris/particles.h"
#include "debris/chords.h"
#include "debris/hull.h"
#include "debris/tally.h"
#include "num/room.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { X, Y, Z, NONE = -1, REDUCE_FROM = 4096 };

struct body {
	int parent;    /* itself for a root */
	int period[2]; /* of this frame in the parent's */
	int layer;     /* of the newest run; NONE: the place is free */
	struct tally cells;
	int corner, last;     /* list of corners */
	int corners, reduced; /* their number now and when last reduced */
};

struct run {
	int begin, end;
	int body, period[2]; /* the grid's frame in the body's */
};

struct sheet {
	struct run *run;
	size_t count, room;
	size_t *row; /* of ny + 1: where the runs of a row start */
};

struct corner {
	struct hull_point at;
	int next;
};

struct particles {
	struct particles_par par;
	int layer;
	struct sheet now, before;
	struct body *body;
	size_t bodies, body_room;
	int *idle; /* free places of body[] */
	size_t nidle, idle_room;
	int *taken; /* bodies taken up by others in this layer */
	size_t ntaken, taken_room;
	struct corner *corner;
	size_t corners, corner_room;
	int free_corner;
	struct hull *hull;
	struct chords *chords;
	struct hull_point *scratch;
	size_t scratch_room;
	struct particle *done;
	size_t ndone, done_room;
};

struct particles *particles_new(const struct particles_par *par)
{
	struct particles *ps;
	int limit = HULL_SPAN;

	if (par->nx < 1 || par->ny < 1 || par->nx > limit || par->ny > limit ||
		!(par->ax > 0) || !(par->ay > 0) || !(par->az > 0)) {
		errno = EDOM;
		return NULL;
	}
	ps = calloc(1, sizeof(*ps));
	if (!ps)
		return NULL;
	ps->par = *par;
	ps->now.row = calloc((size_t)par->ny + 1, sizeof(*ps->now.row));
	ps->before.row = calloc((size_t)par->ny + 1, sizeof(*ps->before.row));
	ps->hull = hull_new();
	ps->chords = chords_new();
	if (!ps->now.row || !ps->before.row || !ps->hull || !ps->chords) {
		particles_free(ps);
		errno = ENOMEM;
		return NULL;
	}
	particles_begin(ps);
	return ps;
}

void particles_free(struct particles *ps)
{
	if (!ps)
		return;
	free(ps->now.run);
	free(ps->now.row);
	free(ps->before.run);
	free(ps->before.row);
	free(ps->body);
	free(ps->idle);
	free(ps->taken);
	free(ps->corner);
	hull_free(ps->hull);
	chords_free(ps->chords);
	free(ps->scratch);
	free(ps->done);
	free(ps);
}

void particles_begin(struct particles *ps)
{
	ps->layer = 0;
	ps->now.count = ps->before.count = 0;
	memset(ps->now.row, 0, ((size_t)ps->par.ny + 1) * sizeof(*ps->now.row));
	ps->bodies = ps->nidle = ps->ntaken = ps->corners = ps->ndone = 0;
	ps->free_corner = NONE;
}

/* Corners */

static int put_corner(struct particles *ps, struct body *b, int x, int y, int z)
{
	int at = ps->free_corner;

	if (at != NONE) {
		ps->free_corner = ps->corner[at].next;
	} else {
		if (room_for(&ps->corner, &ps->corner_room, ps->corners + 1,
			    sizeof(*ps->corner)))
			return -1;
		at = (int)ps->corners++;
	}
	ps->corner[at].at = (struct hull_point){ { x, y, z } };
	ps->corner[at].next = b->corner;
	if (b->corner == NONE)
		b->last = at;
	b->corner = at;
	b->corners++;
	return 0;
}

static void drop_corners(struct particles *ps, struct body *b)
{
	if (b->corner == NONE)
		return;
	ps->corner[b->last].next = ps->free_corner;
	ps->free_corner = b->corner;
	b->corner = NONE;
	b->corners = 0;
}

static enum hull_status build_hull(struct particles *ps, const struct body *b)
{
	size_t n = 0;

	if (room_for(&ps->scratch, &ps->scratch_room, b->corners, sizeof(*ps->scratch)))
		return HULL_MEMORY;
	for (int at = b->corner; at != NONE; at = ps->corner[at].next)
		ps->scratch[n++] = ps->corner[at].at;
	return hull_build(ps->hull, ps->scratch, n);
}

/* Leaves a body with many corners those of its convex hull. */
static int reduce(struct particles *ps, struct body *b)
{
	const struct hull_point *p;
	size_t n;

	if (b->corners < REDUCE_FROM || b->corners < 2 * b->reduced)
		return 0;
	switch (build_hull(ps, b)) {
	case HULL_OK:
		break;
	case HULL_LARGE:
		return 0;
	default:
		return -1;
	}
	p = hull_points(ps->hull, &n);
	drop_corners(ps, b);
	for (size_t i = 0; i < n; i++)
		if (put_corner(ps, b, p[i].v[X], p[i].v[Y], p[i].v[Z]))
			return -1;
	b->reduced = (int)n;
	return 0;
}

/* Bodies */

static int body_new(struct particles *ps)
{
	if (ps->nidle > 0)
		return ps->idle[--ps->nidle];
	if (room_for(&ps->body, &ps->body_room, ps->bodies + 1, sizeof(*ps->body)))
		return NONE;
	return (int)ps->bodies++;
}

static int set_idle(struct particles *ps, int body)
{
	if (room_for(&ps->idle, &ps->idle_room, ps->nidle + 1, sizeof(*ps->idle)))
		return -1;
	ps->body[body].layer = NONE;
	ps->idle[ps->nidle++] = body;
	return 0;
}

/* A body of the cells [begin, end) of row y in the present layer. */
static int body_of_run(struct particles *ps, int y, int begin, int end)
{
	int id = body_new(ps), z = ps->layer;
	struct body *b;

	if (id == NONE)
		return NONE;
	b = &ps->body[id];
	memset(b, 0, sizeof(*b));
	b->parent = id;
	b->layer = z;
	b->cells = tally_run(begin, end, y, z);
	b->corner = NONE;
	for (int k = 0; k < 8; k++)
		if (put_corner(
			    ps, b, k & 1 ? end : begin, y + (k >> 1 & 1), z + (k >> 2)))
			return NONE;
	return id;
}

/* Root of a body and, added to period, where its frame lies in the root's. */
static int find(struct particles *ps, int id, int period[2])
{
	int root = id, total[2] = { 0, 0 };

	while (ps->body[root].parent != root) {
		total[X] += ps->body[root].period[X];
		total[Y] += ps->body[root].period[Y];
		root = ps->body[root].parent;
	}
	period[X] += total[X];
	period[Y] += total[Y];
	while (ps->body[id].parent != root && id != root) {
		struct body *b = &ps->body[id];
		int next = b->parent, step[2] = { b->period[X], b->period[Y] };

		b->parent = root;
		b->period[X] = total[X];
		b->period[Y] = total[Y];
		total[X] -= step[X];
		total[Y] -= step[Y];
		id = next;
	}
	return root;
}

/* Moves a body by (dx, dy) cells. */
static void shift(struct particles *ps, struct body *b, int dx, int dy)
{
	if (dx == 0 && dy == 0)
		return;
	tally_shift(&b->cells, dx, dy);
	for (int at = b->corner; at != NONE; at = ps->corner[at].next) {
		ps->corner[at].at.v[X] += dx;
		ps->corner[at].at.v[Y] += dy;
	}
}

/* The body meets itself so many periods away: it has no end, and no hull. */
static void wind(struct particles *ps, struct body *b, const int periods[2])
{
	for (int k = X; k <= Y; k++)
		b->cells.winds[k] |= periods[k] != 0;
	drop_corners(ps, b);
}

static int is_endless(const struct tally *t)
{
	return t->winds[X] || t->winds[Y];
}

/* Adds b, already in a's frame, to a. */
static void absorb(struct particles *ps, struct body *a, struct body *b)
{
	a->layer = a->layer > b->layer ? a->layer : b->layer;
	tally_add(&a->cells, &b->cells);
	if (is_endless(&a->cells)) {
		drop_corners(ps, a);
		drop_corners(ps, b);
	}
	if (b->corner == NONE)
		return;
	ps->corner[b->last].next = a->corner;
	if (a->corner == NONE)
		a->last = b->last;
	a->corner = b->corner;
	a->corners += b->corners;
	a->reduced = a->reduced > b->reduced ? a->reduced : b->reduced;
	b->corner = NONE;
}

/* Cells of run p touch cells of run q, seen (px, py) periods further; across the faces
 * along axis they share so many. */
static int unite(struct particles *ps, const struct run *p, const struct run *q, int px,
	int py, int axis, int shared)
{
	int in_a[2] = { p->period[X], p->period[Y] },
	    in_b[2] = { q->period[X], q->period[Y] };
	int a = find(ps, p->body, in_a), b = find(ps, q->body, in_b);
	int move[2] = { in_a[X] + px - in_b[X], in_a[Y] + py - in_b[Y] };

	ps->body[a].cells.faces[axis] -= 2 * shared;
	if (a == b) {
		if (move[X] || move[Y])
			wind(ps, &ps->body[a], move);
		return 0;
	}
	if (ps->body[a].corners < ps->body[b].corners) {
		int t = a;

		a = b;
		b = t;
		move[X] = -move[X];
		move[Y] = -move[Y];
	}
	shift(ps, &ps->body[b], move[X] * ps->par.nx, move[Y] * ps->par.ny);
	absorb(ps, &ps->body[a], &ps->body[b]);
	ps->body[b].parent = a;
	ps->body[b].period[X] = move[X];
	ps->body[b].period[Y] = move[Y];
	if (room_for(&ps->taken, &ps->taken_room, ps->ntaken + 1, sizeof(*ps->taken)))
		return -1;
	ps->taken[ps->ntaken++] = b;
	return reduce(ps, &ps->body[a]);
}

/* Layers */

static int scan_row(struct particles *ps, const unsigned char *mask, int y)
{
	const unsigned char *end = mask + ps->par.nx, *at = mask;
	struct sheet *s = &ps->now;

	while ((at = memchr(at, 1, end - at))) {
		const unsigned char *stop = memchr(at, 0, end - at);
		struct run r = { .begin = (int)(at - mask) };

		at = stop ? stop : end;
		r.end = (int)(at - mask);
		r.body = body_of_run(ps, y, r.begin, r.end);
		if (r.body == NONE ||
			room_for(&s->run, &s->room, s->count + 1, sizeof(*s->run)))
			return -1;
		s->run[s->count++] = r;
	}
	return 0;
}

/* Unites touching runs of two rows; b's row is seen (px, py) periods further and its
 * runs reach corner cells beyond their ends. */
static int join_rows(struct particles *ps, const struct sheet *sa, size_t ya,
	const struct sheet *sb, size_t yb, int px, int py, int axis, int corner)
{
	size_t i = sa->row[ya], iend = sa->row[ya + 1];
	size_t j = sb->row[yb], jend = sb->row[yb + 1];
	int far = px * ps->par.nx;

	while (i < iend && j < jend) {
		const struct run *a = &sa->run[i], *b = &sb->run[j];
		int begin = a->begin > b->begin + far ? a->begin : b->begin + far;
		int end = a->end < b->end + far ? a->end : b->end + far;

		if (end + corner > begin &&
			unite(ps, a, b, px, py, axis, end > begin ? end - begin : 0))
			return -1;
		if (a->end < b->end + far)
			i++;
		else
			j++;
	}
	return 0;
}

/* Row y of the new layer with row other of the same layer, next to it. */
static int join_neighbour(struct particles *ps, int y, int other, int py)
{
	const struct sheet *s = &ps->now;
	int wrap = ps->par.periodic && ps->par.corners;

	if (join_rows(ps, s, y, s, other, 0, py, Y, ps->par.corners))
		return -1;
	return wrap && (join_rows(ps, s, y, s, other, 1, py, Y, 1) ||
			       join_rows(ps, s, y, s, other, -1, py, Y, 1))
		       ? -1
		       : 0;
}

static int join_layer(struct particles *ps)
{
	const struct sheet *s = &ps->now;
	int ny = ps->par.ny, nx = ps->par.nx;

	for (int y = 0; y < ny; y++) {
		size_t a = s->row[y], b = s->row[y + 1];

		if (y > 0 && join_neighbour(ps, y, y - 1, 0))
			return -1;
		if (join_rows(ps, s, y, &ps->before, y, 0, 0, Z, 0))
			return -1;
		if (ps->par.periodic && b > a && s->run[a].begin == 0 &&
			s->run[b - 1].end == nx &&
			unite(ps, &s->run[b - 1], &s->run[a], 1, 0, X, 1))
			return -1;
	}
	return ps->par.periodic ? join_neighbour(ps, 0, ny - 1, -1) : 0;
}

/* Measures */

static int measure_hull(struct particles *ps, const struct body *b, struct particle *p)
{
	const double step[3] = { ps->par.ax, ps->par.ay, ps->par.az };
	enum hull_status status = is_endless(&b->cells) ? HULL_LARGE : build_hull(ps, b);

	p->length = p->width = p->aspect = p->convexity = NAN;
	if (status == HULL_LARGE)
		return 0;
	if (status != HULL_OK ||
		chords_measure(ps->chords, ps->hull, step, &p->length, &p->width))
		return -1;
	p->aspect = p->length / p->width;
	p->convexity = 6 * b->cells.nodes / hull_volume6(ps->hull);
	return 0;
}

static int measure(struct particles *ps, const struct body *b)
{
	struct particle *p;

	if (room_for(&ps->done, &ps->done_room, ps->ndone + 1, sizeof(*ps->done)))
		return -1;
	p = &ps->done[ps->ndone];
	tally_measure(&b->cells, &ps->par, p);
	if (measure_hull(ps, b, p))
		return -1;
	ps->ndone++;
	return 0;
}

/* Points the runs of the new layer at their roots, closes the bodies of the layer before
 * that did not reach the new one, and frees the places of those taken up by others. */
static int settle(struct particles *ps)
{
	for (size_t i = 0; i < ps->now.count; i++) {
		struct run *r = &ps->now.run[i];

		r->body = find(ps, r->body, r->period);
	}
	for (size_t i = 0; i < ps->before.count; i++) {
		int period[2] = { 0, 0 }, root = find(ps, ps->before.run[i].body, period);
		struct body *b = &ps->body[root];

		if (b->layer == NONE || b->layer == ps->layer)
			continue;
		if (measure(ps, b) || set_idle(ps, root))
			return -1;
		drop_corners(ps, b);
	}
	while (ps->ntaken > 0)
		if (set_idle(ps, ps->taken[--ps->ntaken]))
			return -1;
	return 0;
}

int particles_layer(struct particles *ps, const unsigned char *mask)
{
	struct sheet t = ps->before;

	ps->before = ps->now;
	ps->now = t;
	ps->now.count = 0;
	for (int y = 0; y < ps->par.ny; y++) {
		ps->now.row[y] = ps->now.count;
		if (mask && scan_row(ps, mask + (size_t)y * ps->par.nx, y))
			return -1;
	}
	ps->now.row[ps->par.ny] = ps->now.count;
	if (join_layer(ps) || settle(ps))
		return -1;
	ps->layer++;
	return 0;
}

/* Largest first, equal ones in order of their first cell. */
static int in_order(const void *a, const void *b)
{
	const struct particle *p = a, *q = b;

	if (p->nodes != q->nodes)
		return p->nodes > q->nodes ? -1 : 1;
	return tally_precedes(p->first, q->first) ? -1 : 1;
}

size_t particles_end(struct particles *ps, const struct particle **list)
{
	/* An empty layer closes whatever is open. */
	if (particles_layer(ps, NULL))
		return (size_t)-1;
	if (ps->ndone > 0)
		qsort(ps->done, ps->ndone, sizeof(*ps->done), in_order);
	*list = ps->done;
	return ps->ndone;
}
