#include "stress/window.h"
#include "num/fft.h"
#include "num/status.h"

#include <stdlib.h>
#include <string.h>

/* Points to the side of a tile.  Sums for 512 x 512 cells with a reach of 17 take
 * TILESWEEP */
enum { TILE = 128 };

/* Tiles along an axis: count of them, each of so many nodes, on so many points. */
struct cut {
	int count, nodes, lead; /* lead: points before the first node */
	size_t points;
};

struct tiling {
	const struct window *w;
	struct cut x, y;
	struct fft *fft;
	size_t room, spectrum; /* points and coefficients, that arrays stay aligned */
	double *plane;         /* one for each worker */
	double complex *image, *product;
	double complex *kernel[STRESS_NUMBERS];
	unsigned char *wanted;
	double *transforms; /* of each tile */
};

/* A single tile needs zeros behind its nodes only, one of many the loads on both sides.
 */
static struct cut cut_axis(int m, int reach)
{
	int nodes = TILE - 2 * reach;
	struct cut c = { 1, m, 0, fft_good_size((size_t)m + (size_t)reach) };

	if (c.points <= TILE || nodes < TILE / 2)
		return c;
	c.count = (m + nodes - 1) / nodes;
	c.nodes = (m + c.count - 1) / c.count;
	c.lead = reach;
	c.points = fft_good_size((size_t)c.nodes + 2 * (size_t)reach);
	return c;
}

/* A kernel on the plane, negative offsets wrapped around.  On a line of symmetry what
 * is odd across it vanishes. */
static void put_kernel(struct tiling *t, enum stress_number number)
{
	const struct influence_par *par = t->w->par;
	const struct influence *kernel = t->w->kernel;
	size_t px = t->x.points, py = t->y.points;
	double normal[4], shear[4]; /* signs of the mirror images, shear times mu */

	for (int m = 0; m < 4; m++) {
		int odd = ((m & 1) && influence_odd(number, 0)) ^
			  ((m >> 1) && influence_odd(number, 1));

		normal[m] = odd ? -1 : 1;
		shear[m] = (odd ^ (par->axis ? m >> 1 : m & 1)) ? -par->mu : par->mu;
	}
	memset(t->plane, 0, px * py * sizeof *t->plane);
	for (int j = 0; j <= t->w->reach_y; j++)
		for (int i = 0; i <= t->w->reach_x; i++, kernel++) {
			double n = kernel->normal[number], s = kernel->shear[number];
			double share = (i ? 1 : 0.5) * (j ? 1 : 0.5);

			for (int m = 0; m < 4; m++) {
				size_t x = (m & 1) && i ? px - (size_t)i : (size_t)i;
				size_t y = (m >> 1) && j ? py - (size_t)j : (size_t)j;

				t->plane[y * px + x] +=
					share * (normal[m] * n + shear[m] * s);
			}
		}
}

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

static int larger(int a, int b)
{
	return a > b ? a : b;
}

/* The loads within reach of a tile whose first node is (x0, y0); 0 if there are none. */
static int put_loads(const struct tiling *t, int x0, int y0, double *plane)
{
	const struct window *w = t->w;
	int left = x0 - t->x.lead, low = y0 - t->y.lead, any = 0;
	int begin = larger(left, 0), end = smaller(left + (int)t->x.points, w->mx);

	memset(plane, 0, t->x.points * t->y.points * sizeof *plane);
	for (int y = larger(low, 0); y < smaller(low + (int)t->y.points, w->my); y++) {
		const double *from = w->load + (size_t)y * w->load_stride + begin;
		double *to = plane + (size_t)(y - low) * t->x.points + (begin - left);

		for (int x = 0; x < end - begin; x++) {
			to[x] = from[x];
			any |= from[x] != 0;
		}
	}
	return any;
}

static void sum_tile(void *context, size_t tile, int worker)
{
	const struct tiling *t = context;
	const struct window *w = t->w;
	double *plane = t->plane + (size_t)worker * t->room;
	double complex *image = t->image + (size_t)worker * t->spectrum,
		       *product = t->product + (size_t)worker * t->spectrum;
	int x0 = (int)(tile % (size_t)t->x.count) * t->x.nodes,
	    y0 = (int)(tile / (size_t)t->x.count) * t->y.nodes;
	int nx = smaller(t->x.nodes, w->mx - x0), ny = smaller(t->y.nodes, w->my - y0);

	if ((t->wanted && !t->wanted[tile]) || !put_loads(t, x0, y0, plane))
		return;
	fft_forward(t->fft, plane, image);
	for (int c = 0; c < w->numbers; c++) {
		const double *from =
			plane + (size_t)t->y.lead * t->x.points + (size_t)t->x.lead;
		double *to = w->out[c] + (size_t)y0 * w->stride + x0;

		for (size_t i = 0; i < t->spectrum; i++)
			product[i] = t->kernel[c][i] * image[i];
		fft_inverse(t->fft, product, plane);
		for (int y = 0; y < ny; y++)
			memcpy(to + (size_t)y * w->stride, from + (size_t)y * t->x.points,
				(size_t)nx * sizeof *to);
	}
	t->transforms[tile] = 1 + w->numbers;
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

static enum num_status prepare(struct tiling *t)
{
	const struct window *w = t->w;
	size_t points = t->x.points * t->y.points,
	       tiles = (size_t)t->x.count * (size_t)t->y.count,
	       workers = (size_t)pool_threads(w->pool);
	double scale = 1. / (double)points;

	t->room = (points + 7) / 8 * 8;
	t->spectrum = ((t->x.points / 2 + 1) * t->y.points + 3) / 4 * 4;
	t->plane = fft_alloc(workers * t->room);
	t->image = fft_alloc_complex(workers * t->spectrum);
	t->product = fft_alloc_complex(workers * t->spectrum);
	t->transforms = calloc(tiles, sizeof *t->transforms);
	t->fft = fft_new(t->x.points, t->y.points);
	if (w->want)
		t->wanted = calloc(tiles, 1);
	if (!t->plane || !t->image || !t->product || !t->transforms || !t->fft ||
		(w->want && !t->wanted))
		return NUM_MEMORY;
	if (w->want)
		mark_wanted(t);
	for (int c = 0; c < w->numbers; c++) {
		t->kernel[c] = fft_alloc_complex(t->spectrum);
		if (!t->kernel[c])
			return NUM_MEMORY;
		put_kernel(t, (enum stress_number)c);
		fft_forward(t->fft, t->plane, t->kernel[c]);
		for (size_t i = 0; i < t->spectrum; i++)
			t->kernel[c][i] *= scale;
	}
	return NUM_OK;
}

enum num_status window_sum(const struct window *w, double *transforms)
{
	struct tiling t = {
		.w = w, .x = cut_axis(w->mx, w->reach_x), .y = cut_axis(w->my, w->reach_y)
	};
	size_t tiles = (size_t)t.x.count * (size_t)t.y.count;
	enum num_status status = prepare(&t);

	if (!status) {
		pool_run(w->pool, tiles, sum_tile, &t);
		*transforms = w->numbers;
		for (size_t i = 0; i < tiles; i++)
			*transforms += t.transforms[i];
	}
	fft_free(t.plane);
	fft_free(t.image);
	fft_free(t.product);
	for (int c = 0; c < w->numbers; c++)
		fft_free(t.kernel[c]);
	if (t.fft)
		fft_done(t.fft);
	free(t.wanted);
	free(t.transforms);
	return status;
}
