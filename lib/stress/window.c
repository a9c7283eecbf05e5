#include "stress/window.h"
#include "num/fft.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/status.h"

#include <stdlib.h>
#include <string.h>

/* Points to the side of a tile.  A wear step of debrisgen on 512 x 512 cells, 9 % of them
 * loaded, potential rule, takes 1.07 s of processor time with 128, and 1.40, 1.16, 1.24,
 * 1.46, 1.48 s with 96, 112, 160, 192, 256 (least of five runs each). */
enum { TILE = 128 };

/* Points of a plane up to which transformed kernels are kept: of the windows that
 * free_sum.c makes on more than a few cells, all. */
enum { KEPT_POINTS = 256 * 256 };

/* Loads of a tile up to which they are summed one by one; the more the fewer of its nodes
 * are wanted.  The surrogate takes the same time within 3 % with 32 to 192 on 128 x 128
 * and 512 x 512 cells; with none it takes 9 % more where 0.3 % of 512 x 512 cells are
 * loaded.  A span costs as much as so many more nodes. */
enum { MOST_FEW = 16 * WINDOW_FEW, SPAN_NODES = 8 };

/* Nodes that are summed together, in vectors of HALF. */
enum { HALF = 4, TOGETHER = 2 * HALF };

/* Tiles along an axis: count of them, each of so many nodes, on so many points. */
struct cut {
	int count, nodes, lead; /* lead: points before the first node */
	size_t points;
};

struct tiling {
	const struct window *w;
	struct cut x, y;
	int reach_x, reach_y; /* of the kernel */
	struct fft_plane *fft;
	size_t stride, room, spectrum; /* of the points; coefficients */
	/* For each worker: */
	double *load, *plane; /* loads; the sums of all numbers */
	double complex *image, *product, *work;
	double complex *kernel[STRESS_NUMBERS];
	double *table; /* of each number, 2 reach_y + 1 rows of table_width(); or NULL */
	unsigned char *wanted; /* tiles; NULL: all */
	unsigned char *row;    /* for each worker, the rows of points that are wanted */
	double *transforms;    /* of each tile */
	int made;              /* kernels transformed */
};

/* Points of a plane.  Kernels and plans that are kept serve more windows if the sizes are
 * few: 2^k and 3 2^k, or those of tiles and 2^k above. */
static size_t plane_side(const struct window *w, int points)
{
	size_t need = (size_t)points, side = w->tiles ? TILE : 16;

	if (w->name == WINDOW_NAMELESS)
		return 8 * fft_good_size((need + 7) / 8);
	while (side < need)
		side *= 2;
	return 3 * side / 4 >= need && !w->tiles ? 3 * side / 4 : side;
}

/* A single tile needs zeros behind its nodes only, one of many the loads on both sides.
 */
static struct cut cut_axis(const struct window *w, int m, int reach)
{
	int nodes = TILE - 2 * reach;
	struct cut c = { 1, m, 0, plane_side(w, m + reach) };

	if (c.points <= TILE || nodes < TILE / 2)
		return c;
	c.count = (m + nodes - 1) / nodes;
	c.nodes = (m + c.count - 1) / c.count;
	c.lead = reach;
	c.points = TILE;
	return c;
}

/* The reach of the kernel, if all points are in reach of each other: in quarters of the
 * largest that fits on the plane, so that few kernels serve all. */
static int kernel_reach(const struct cut *c, int m, int reach)
{
	int quarter = (int)c->points / 8;

	return c->count == 1 && reach == m - 1 ? (reach / quarter + 1) * quarter - 1
					       : reach;
}

/* A kernel on the plane, negative offsets wrapped around.  On a line of symmetry what
 * is odd across it vanishes. */
static void put_kernel(struct tiling *t, const struct influence *kernel,
	enum stress_number number, double scale)
{
	const struct influence_par *par = t->w->par;
	size_t px = t->x.points, py = t->y.points;
	double normal[4], shear[4]; /* signs of the mirror images, shear times mu */

	for (int m = 0; m < 4; m++) {
		int odd = ((m & 1) && influence_odd(number, 0)) ^
			  ((m >> 1) && influence_odd(number, 1));

		normal[m] = odd ? -scale : scale;
		shear[m] = (odd ^ (par->axis ? m >> 1 : m & 1)) ? -par->mu * scale
								: par->mu * scale;
	}
	memset(t->plane, 0, t->room * sizeof *t->plane);
	for (int j = 0; j <= t->reach_y; j++)
		for (int i = 0; i <= t->reach_x; i++, kernel++) {
			double n = kernel->normal[number], s = kernel->shear[number];
			double share = (i ? 1 : 0.5) * (j ? 1 : 0.5);

			for (int m = 0; m < 4; m++) {
				size_t x = (m & 1) && i ? px - (size_t)i : (size_t)i;
				size_t y = (m >> 1) && j ? py - (size_t)j : (size_t)j;

				t->plane[y * t->stride + x] +=
					share * (normal[m] * n + shear[m] * s);
			}
		}
}

/* The points of a plane on which loads lie that are within reach of a tile. */
struct extent {
	int left, low; /* of the window: the first point */
	int begin, stop, bottom, top;
};

static struct extent extent_of(const struct tiling *t, int x0, int y0)
{
	const struct window *w = t->w;
	int left = x0 - t->x.lead, low = y0 - t->y.lead;

	return (struct extent){ left, low, larger_int(left, 0),
		lesser_int(left + (int)t->x.points, w->mx), larger_int(low, 0),
		lesser_int(low + (int)t->y.points, w->my) };
}

/* The loads of a tile, if they are few. */
struct few {
	int count, most; /* most + 1: there are more */
	int x[MOST_FEW + 1], y[MOST_FEW + 1];
	double load[MOST_FEW + 1];
	ptrdiff_t at[MOST_FEW]; /* less the place of what it adds in a table */
};

static void find_few(const struct tiling *t, const struct extent *e, struct few *f)
{
	const struct window *w = t->w;
	size_t stop = (size_t)e->stop, begin = (size_t)e->begin;

	f->count = 0;
	for (int y = e->bottom; y < e->top && f->count <= f->most; y++) {
		const double *row = w->load + (size_t)y * w->load_stride;

		for (size_t x = lanes_next(row, begin, stop);
			x < stop && f->count <= f->most;
			x = lanes_next(row, x + 1, stop)) {
			f->x[f->count] = (int)x - e->left;
			f->y[f->count] = y - e->low;
			f->load[f->count++] = w->scale * row[x];
		}
	}
}

/* Loads on the rows of the plane where any are. */
LANES_CLONES static void put_loads(
	const struct tiling *t, const struct extent *e, double *plane)
{
	const struct window *w = t->w;

	for (int y = e->bottom; y < e->top; y++) {
		const double *from = w->load + (size_t)y * w->load_stride + e->begin;
		double *row = plane + (size_t)(y - e->low) * t->stride,
		       *to = row + (e->begin - e->left);
		int count = e->stop - e->begin, x = 0;

		memset(row, 0, (size_t)(e->begin - e->left) * sizeof *row);
		for (; x + 4 <= count; x += 4) {
			lanes4 load;

			memcpy(&load, from + x, sizeof load);
			load *= w->scale;
			memcpy(to + x, &load, sizeof load);
		}
		for (; x < count; x++)
			to[x] = w->scale * from[x];
		memset(to + count, 0,
			(t->x.points - (size_t)(e->stop - e->left)) * sizeof *to);
	}
}

/* The product of complex numbers, an even number of them. */
LANES_CLONES static void multiply(const double complex *a, const double complex *b,
	double complex *to, size_t count)
{
	const lanes4 sign = { -1, 1, -1, 1 };

	for (size_t i = 0; i < count; i += 2) {
		lanes4 u, v, turned, real, imaginary;

		memcpy(&u, a + i, sizeof u);
		memcpy(&v, b + i, sizeof v);
		turned = __builtin_shufflevector(u, u, 1, 0, 3, 2);
		real = __builtin_shufflevector(v, v, 0, 0, 2, 2);
		imaginary = __builtin_shufflevector(v, v, 1, 1, 3, 3);
		u = u * real + turned * (imaginary * sign);
		memcpy(to + i, &u, sizeof u);
	}
}

/* The next wanted nodes of a part, counted from its first; next: the first span that may
 * lie in it, then that after it.  0 if there are none. */
static int next_run(const struct tiling *t, const struct stress_part *part,
	const struct stress_span **next, struct stress_span *run)
{
	const struct stress_want *want = t->w->want;
	int x0 = t->w->x0 + part->x0, y0 = t->w->y0 + part->y0;
	int width = part->x1 - part->x0;

	for (; *next < want->span + want->count && (*next)->y < t->w->y0 + part->y1;
		++*next) {
		*run = (struct stress_span){ (*next)->y - y0,
			larger_int((*next)->begin - x0, 0),
			lesser_int((*next)->end - x0, width) };
		if (run->begin < run->end) {
			++*next;
			return 1;
		}
	}
	return 0;
}

/* How many loads of a part may be summed one by one. */
static int most_few(const struct tiling *t, const struct stress_part *part)
{
	double all = (double)(part->x1 - part->x0) * (part->y1 - part->y0), nodes = 0;
	const struct stress_span *next;
	struct stress_span run;

	if (!t->w->want)
		return t->w->few;
	next = span_first(t->w->want, t->w->y0 + part->y0);
	while (next_run(t, part, &next, &run))
		nodes += run.end - run.begin + SPAN_NODES;
	return nodes * MOST_FEW > t->w->few * all ? (int)(t->w->few * all / nodes)
						  : MOST_FEW;
}

/* Points to a row of the table of a number: zeros on both sides, so that several nodes
 * beside each other take what a load adds without a look at its reach. */
static int table_width(const struct tiling *t)
{
	return 2 * t->reach_x + 1 + 2 * (TOGETHER - 1);
}

static size_t table_size(const struct tiling *t)
{
	return (size_t)table_width(t) * (size_t)(2 * t->reach_y + 1);
}

/* A load near nodes, and what it adds to the first number of the first of them. */
struct near {
	const double *table;
	double load;
};

/* Of the loads [first, end), whose rows are in reach, those that are of nodes from (x, y)
 * on. */
static int list_near(const struct tiling *t, const struct few *few, int first, int end,
	int x, int y, struct near *near)
{
	int width = table_width(t), count = 0;
	int left = x + t->x.lead + t->reach_x + TOGETHER - 1,
	    low = y + t->y.lead + t->reach_y;
	const double *table = t->table + low * width + left;
	unsigned last = (unsigned)(width - TOGETHER);

	for (int i = first; i < end; i++) {
		/* Half of them are: a branch would often be guessed wrongly. */
		near[count] = (struct near){ table - few->at[i], few->load[i] };
		count += (unsigned)(left - few->x[i]) <= last;
	}
	return count;
}

/* The sums of a number: for the first nodes of those together. */
LANES_CLONES static void add_near(const struct tiling *t, const struct near *near,
	int count, int c, double *node, int nodes)
{
	size_t at = (size_t)c * table_size(t);
	lanes4 sum = { 0 }, other = { 0 }, add;

	for (int i = 0; i < count; i++) {
		const double *from = near[i].table + at;
		double load = near[i].load;

		memcpy(&add, from, sizeof add);
		sum += load * add;
		memcpy(&add, from + HALF, sizeof add);
		other += load * add;
	}
	node += (size_t)c * t->room;
	memcpy(node, &sum, (size_t)lesser_int(nodes, HALF) * sizeof *node);
	if (nodes > HALF)
		memcpy(node + HALF, &other, (size_t)(nodes - HALF) * sizeof *node);
}

/* Adds the loads [first, end) to a run of nodes; node: its row of the first number. */
static void add_to_run(const struct tiling *t, const struct few *few, int first, int end,
	const struct stress_span *run, double *node)
{
	struct near near[MOST_FEW + 1];

	for (int x = run->begin; x < run->end; x += TOGETHER) {
		int count = list_near(t, few, first, end, x, run->y, near);

		for (int c = 0; c < t->w->numbers; c++)
			add_near(t, near, count, c, node + x,
				lesser_int(TOGETHER, run->end - x));
	}
}

/* Sums load by load the nodes that are wanted. */
static void add_loads(const struct tiling *t, const struct stress_part *part,
	struct few *few, double *plane)
{
	size_t at = (size_t)t->y.lead * t->stride + (size_t)t->x.lead;
	const struct stress_span *next = NULL;
	struct stress_span run = { -1, 0, part->x1 - part->x0 };
	int first = 0, end = 0;

	for (int i = 0; i < few->count; i++)
		few->at[i] = (ptrdiff_t)few->y[i] * table_width(t) + few->x[i];
	if (t->w->want)
		next = span_first(t->w->want, t->w->y0 + part->y0);
	while (next ? next_run(t, part, &next, &run) : ++run.y < part->y1 - part->y0) {
		int y = run.y + t->y.lead;

		while (first < few->count && few->y[first] < y - t->reach_y)
			first++;
		while (end < few->count && few->y[end] <= y + t->reach_y)
			end++;
		add_to_run(
			t, few, first, end, &run, plane + at + (size_t)run.y * t->stride);
	}
}

/* Flags the rows of points with wanted nodes of a part. */
static void mark_rows(
	const struct tiling *t, const struct stress_part *part, unsigned char *row)
{
	size_t rows = (size_t)(part->y1 - part->y0);
	const struct stress_span *next;
	struct stress_span run;

	memset(row, 0, t->y.points);
	if (!t->w->want) {
		memset(row + t->y.lead, 1, rows);
		return;
	}
	next = span_first(t->w->want, t->w->y0 + part->y0);
	while (next_run(t, part, &next, &run))
		row[run.y + t->y.lead] = 1;
}

static void sum_tile(void *context, size_t tile, int worker)
{
	const struct tiling *t = context;
	const struct window *w = t->w;
	size_t at = (size_t)worker, lead = (size_t)t->y.lead;
	double *load = t->load + at * t->room,
	       *plane = t->plane + at * t->room * (size_t)w->numbers;
	double complex *image = t->image + at * t->spectrum,
		       *product = t->product + at * t->spectrum,
		       *work = t->work + at * t->spectrum;
	const double *number[STRESS_NUMBERS] = { NULL };
	struct stress_part part = { .x0 = (int)(tile % (size_t)t->x.count) * t->x.nodes,
		.y0 = (int)(tile / (size_t)t->x.count) * t->y.nodes,
		.stride = t->stride };
	struct extent e;
	struct few few;

	part.x1 = lesser_int(part.x0 + t->x.nodes, w->mx);
	part.y1 = lesser_int(part.y0 + t->y.nodes, w->my);
	if (t->wanted && !t->wanted[tile])
		return;
	e = extent_of(t, part.x0, part.y0);
	few.most = t->table ? most_few(t, &part) : 0;
	find_few(t, &e, &few);
	if (few.count > 0) {
		part.number = number;
		for (int c = 0; c < w->numbers; c++)
			number[c] = plane + (size_t)c * t->room + lead * t->stride +
				    t->x.lead;
	}
	if (few.count > 0 && few.count <= few.most) {
		add_loads(t, &part, &few, plane);
	} else if (few.count > 0) {
		unsigned char *row = t->row + at * t->y.points;

		put_loads(t, &e, load);
		mark_rows(t, &part, row);
		fft_plane_forward(t->fft, load, (size_t)(e.bottom - e.low),
			(size_t)(e.top - e.low), image, work);
		for (int c = 0; c < w->numbers; c++, plane += t->room) {
			multiply(image, t->kernel[c], product, t->spectrum);
			fft_plane_inverse(t->fft, product, plane, row, work);
		}
		t->transforms[tile] = 1 + w->numbers;
	}
	w->take(w->context, &part, worker);
}

/* Marks the tiles of wanted nodes. */
static void mark_wanted(struct tiling *t)
{
	const struct stress_want *want = t->w->want;

	for (size_t i = 0; i < want->count; i++) {
		const struct stress_span *s = &want->span[i];
		int row = (s->y - t->w->y0) / t->y.nodes;

		for (int k = (s->begin - t->w->x0) / t->x.nodes;
			k <= (s->end - 1 - t->w->x0) / t->x.nodes; k++)
			t->wanted[row * t->x.count + k] = 1;
	}
}

void window_forget(struct window_kept *kept)
{
	for (int i = 0; i < WINDOW_KEPT; i++) {
		fft_plane_done(kept->plan[i].fft);
		fft_free(kept->spectra[i].memory);
	}
	fft_free(kept->memory);
	*kept = (struct window_kept){ 0 };
}

/* The plan for a plane: that of an earlier window, or in place of the one that has not
 * been used for longest. */
static struct fft_plane *plan_for(struct window_kept *kept, size_t nx, size_t ny)
{
	struct window_plan *p = kept->plan;

	for (int i = 0; i < WINDOW_KEPT; i++) {
		struct window_plan *q = &kept->plan[i];

		if (q->fft && q->nx == nx && q->ny == ny) {
			q->used = kept->windows;
			return q->fft;
		}
		if (q->used < p->used)
			p = q;
	}
	fft_plane_done(p->fft);
	*p = (struct window_plan){ fft_plane_new(nx, ny), nx, ny, kept->windows };
	return p->fft;
}

static enum num_status keep_memory(struct window_kept *kept, size_t size)
{
	if (size <= kept->size)
		return NUM_OK;
	fft_free(kept->memory);
	kept->memory = fft_alloc_unset(size);
	kept->size = kept->memory ? size : 0;
	return kept->memory ? NUM_OK : NUM_MEMORY;
}

/* Rows and columns are whole cache lines, and so is every part of the memory. */
static enum num_status share_memory(struct tiling *t, struct window_kept *kept)
{
	size_t workers = (size_t)pool_threads(t->w->pool);
	size_t numbers = (size_t)t->w->numbers;
	double complex *spectra;

	if (keep_memory(kept, workers * (1 + numbers) * t->room +
				      2 * (3 * workers + numbers) * t->spectrum))
		return NUM_MEMORY;
	t->load = kept->memory;
	t->plane = t->load + workers * t->room;
	spectra = (double complex *)(t->plane + workers * numbers * t->room);
	t->image = spectra;
	t->product = t->image + workers * t->spectrum;
	t->work = t->product + workers * t->spectrum;
	for (size_t c = 0; c < numbers; c++)
		t->kernel[c] = t->work + (workers + c) * t->spectrum;
	return NUM_OK;
}

/* The kernel of a number from the plane that put_kernel() filled. */
static void put_table(const struct tiling *t, double scale, double *table)
{
	memset(table, 0, table_size(t) * sizeof *table);
	for (int j = -t->reach_y; j <= t->reach_y; j++, table += table_width(t)) {
		size_t y = j < 0 ? t->y.points - (size_t)-j : (size_t)j;
		double *row = table + TOGETHER - 1 + t->reach_x;

		for (int i = -t->reach_x; i <= t->reach_x; i++) {
			size_t x = i < 0 ? t->x.points - (size_t)-i : (size_t)i;

			row[i] = scale * t->plane[y * t->stride + x];
		}
	}
}

static enum num_status make_kernels(struct tiling *t)
{
	const struct window *w = t->w;
	struct influence *kernel = w->make(w->maker, t->reach_x, t->reach_y);
	double points = (double)t->x.points * (double)t->y.points;

	if (!kernel)
		return NUM_MEMORY;
	for (int c = 0; c < w->numbers; c++) {
		put_kernel(t, kernel, (enum stress_number)c, 1 / points);
		if (t->table)
			put_table(t, points, t->table + (size_t)c * table_size(t));
		fft_plane_forward(
			t->fft, t->plane, 0, t->y.points, t->kernel[c], t->work);
	}
	t->made = w->numbers;
	free(kernel);
	return NUM_OK;
}

static int is_kept(const struct window_spectra *s, const struct tiling *t)
{
	return s->memory && s->name == t->w->name && s->numbers == t->w->numbers &&
	       s->nx == t->x.points && s->ny == t->y.points && s->reach_x == t->reach_x &&
	       s->reach_y == t->reach_y;
}

/* The kernels of an earlier window, or new ones in place of those that have not been used
 * for longest. */
static enum num_status find_kernels(struct tiling *t, struct window_kept *kept)
{
	struct window_spectra *s = kept->spectra;
	size_t spectra = 2 * (size_t)t->w->numbers * t->spectrum, table = 0;
	int found = 0;

	/* By what the kernels are found: all that are alike have it. */
	if (4 * (size_t)t->reach_x < t->x.points && 4 * (size_t)t->reach_y < t->y.points)
		table = (size_t)t->w->numbers * table_size(t);
	for (int i = 0; i < WINDOW_KEPT && !found; i++) {
		struct window_spectra *q = &kept->spectra[i];

		found = is_kept(q, t);
		if (found || q->used < s->used)
			s = q;
	}
	if (!found) {
		fft_free(s->memory);
		*s = (struct window_spectra){ .memory = fft_alloc_unset(spectra + table),
			.nx = t->x.points,
			.ny = t->y.points,
			.name = t->w->name,
			.numbers = t->w->numbers,
			.reach_x = t->reach_x,
			.reach_y = t->reach_y };
		if (!s->memory)
			return NUM_MEMORY;
	}
	s->used = kept->windows;
	for (int c = 0; c < t->w->numbers; c++)
		t->kernel[c] = (double complex *)s->memory + (size_t)c * t->spectrum;
	t->table = table ? s->memory + spectra : NULL;
	if (found || !make_kernels(t))
		return NUM_OK;
	fft_free(s->memory);
	*s = (struct window_spectra){ 0 };
	return NUM_MEMORY;
}

static enum num_status prepare(struct tiling *t, struct window_kept *kept)
{
	const struct window *w = t->w;
	size_t tiles = (size_t)t->x.count * (size_t)t->y.count;

	kept->windows++;
	t->fft = plan_for(kept, t->x.points, t->y.points);
	if (!t->fft)
		return NUM_MEMORY;
	t->stride = fft_plane_stride(t->fft);
	t->room = t->stride * t->y.points;
	t->spectrum = fft_plane_size(t->fft);
	if (share_memory(t, kept))
		return NUM_MEMORY;
	t->transforms = calloc(tiles, sizeof *t->transforms);
	t->row = malloc((size_t)pool_threads(w->pool) * t->y.points);
	if (w->want)
		t->wanted = calloc(tiles, 1);
	if (!t->transforms || !t->row || (w->want && !t->wanted))
		return NUM_MEMORY;
	if (w->want)
		mark_wanted(t);
	return w->name != WINDOW_NAMELESS && t->x.points * t->y.points <= KEPT_POINTS
		       ? find_kernels(t, kept)
		       : make_kernels(t);
}

enum num_status window_sum(
	const struct window *w, struct window_kept *kept, double *transforms)
{
	struct tiling t = {
		.w = w,
		.x = cut_axis(w, w->mx, w->reach_x),
		.y = cut_axis(w, w->my, w->reach_y),
	};
	size_t tiles = (size_t)t.x.count * (size_t)t.y.count;
	enum num_status status;

	t.reach_x = w->reach_x;
	t.reach_y = w->reach_y;
	if (w->name != WINDOW_NAMELESS) {
		t.reach_x = kernel_reach(&t.x, w->mx, w->reach_x);
		t.reach_y = kernel_reach(&t.y, w->my, w->reach_y);
	}
	status = prepare(&t, kept);
	if (!status) {
		pool_run(w->pool, tiles, sum_tile, &t);
		*transforms = t.made;
		for (size_t i = 0; i < tiles; i++)
			*transforms += t.transforms[i];
	}
	free(t.wanted);
	free(t.row);
	free(t.transforms);
	return status;
}
