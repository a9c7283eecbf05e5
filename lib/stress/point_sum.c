#include "stress/point_sum.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "num/room.h"
#include "stress/influence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	BLOCK = 4, /* cells to the side of the smallest square */
	SIZES = 20,
	/* Cells to the side of a tile.  The surrogate takes the same time within 3 % with
	 * 8 and 16 (least of 15 runs, 128 x 128 to 1536 x 1536 cells), and volumes of 88
	 * surfaces have rms errors of 1.75 and 1.73 %. */
	TILE_SIDE = 4 * BLOCK,
	/* Depths at which cells nearby act as elements, and loads far away in proportion
	 * to the depth: SHALLOW where cells are square, one more for each doubling of
	 * their longer side. */
	SHALLOW = 8,
	MOST_SHALLOW = SHALLOW + 8
};
/* Sides of a square: ones farther away, over the surface or in half the depth, act as
 * points.  Right below it a square must be farther than beside it, since the spread of
 * its load then only lowers the stress.  Of 2500 volumes one in a hundred is off by more
 * than 3.1, 1.7, 1.3 and 1.3 % with 1.5, 2, 2.5 and 3, in the same time within 2 %. */
static const double FAR = 2.5;
/* From the nearest edge of a tile, whose cells are on average half its side farther away;
 * DEEP_FAR: at depths that are not SHALLOW.  On tiles of 8 cells volumes of 88 surfaces
 * have rms errors of 1.9, 1.8, 1.7 and 1.7 % with 0.75, 1, 1.25 and 1.5; the surrogate
 * executes 3.1e9, 3.2e9, 3.4e9 and 3.6e9 instructions where it finds 19005 particles.
 * From 8 cells on stresses have rms errors of 2.6, 1.9, 1.7 and 1.3 % with DEEP_FAR
 * 1, 1.25, 1.5 and 2.
 */
static const double TILE_FAR = 1, DEEP_FAR = 2;
/* From a single point, of careful sums.  Of 3400 small particles whose volumes are off by
 * 2 thousandths (nine in ten) those by careful sums are by .6, .3 and .2 thousandths with
 * 3, 4 and 6. */
static const double CAREFUL_FAR = 6;
/* Longer sides of a cell: farther elements act as points, which are off by more and cost
 * more.  Of 160 rough surfaces what the sums have in common is off by .43 and .37
 * thousandths of the mean pressure (nine in ten) with 6 and 8, in 2 % less time. */
static const double NEAR = 8;
/* Loads at more than so many times a depth act in proportion to it.  The volume of 19005
 * particles of 1536 x 1536 cells differs by .06, .025 and .014 % with 6, 8 and 12 from
 * that with 20. */
static const double FLAT = 8;
/* First depth, in shorter sides of a cell; each is sqrt(2) times the one before, as those
 * of wear.c. */
static const double SHALLOWEST = 0.125;

/* Single precision is enough beside the error of squares and points, and the surrogate
 * takes four fifths of the time with it.  Lengths are in cells, so that powers of them
 * stay within its range. */
typedef int32_t four_bits __attribute__((vector_size(16)));

/* The loads of two by two squares of one size, and their centroids. */
struct squares {
	four x, y, load;
};

/* Eight loads and where they are from the centre of a tile, or from a point, along and
 * across the shear. */
enum { EIGHT = 8 };
struct loads {
	eight x, y, load;
};

/* Squares of BLOCK cells, twice as many, ...: one for the whole grid at last. */
struct size {
	int nx, ny; /* fours of squares */
	float side;
	struct squares *square;
};

/* What loads add to the stress; x along the shear; xx and yy less zz. */
struct sums {
	eight xx, yy, xy, xz, yz;
};

/* That as far as it is linear in the depth: on the surface, and per cell. */
struct flat {
	eight xx, yy, xy;
	struct sums rise;
};

/* A cell near a point, at one of the offsets, and the numbers of the stress by it. */
struct element {
	int offset;
	float load;
};
struct effect {
	eight number;
};

/* offset: from the first cell of the grid. */
struct cell {
	float load, x, y;
	int offset;
};

/* A smallest square. */
struct block {
	float x, y, load;
	size_t at; /* row by row */
};

/* A load far away, and to how many depths it acts in proportion. */
struct far {
	float x, y, load;
	int flat;
};

/* Squares that are far from all cells of a tile, and the smallest ones that are not. */
struct tile {
	int row;                    /* of tiles; -1: none */
	float apart;                /* sides of a square that is far */
	float x, y, half_x, half_y; /* its centre, half its sides */
	/* Those far away in the order of the depths to which they act in proportion:
	 * eights[i] hold those that do to i depths at most, and a few beside them. */
	struct loads *loads;
	int eights[MOST_SHALLOW + 1];
	int near;
	struct block *block;
};

/* A cell below which the stress is wanted, and what acts there. */
struct point {
	int deep; /* by the lists of depths that are not shallow */
	const struct tile *tile;
	int ix, iy; /* -1: none */
	float x, y;
	float u, v;           /* from the tile's, along and across the shear */
	struct loads *points; /* near it, from there */
	int count;            /* of them */
	float nearest;        /* the distance squared */
	int flat_points;      /* depths to which all act in proportion */
	/* Nearest, and one of no load where their number is odd. */
	struct element *element;
	int elements;
	struct flat flat[MOST_SHALLOW]; /* all that acts in proportion to the depth */
};

struct point_sum {
	struct stress_par par;
	struct influence_par influence;
	double cell;  /* the longer side, m, by which lengths are divided */
	float dx, dy; /* sides of a cell over that */
	double first; /* depth over that */
	float flat;  /* 2 over the square of the distance at which loads are flat there */
	int shallow; /* depths */
	/* All pressures, and what turns a pressure into its load: in these, over 2 pi. */
	double total, share;
	const double *pressure;
	/* The loaded cells of each smallest square, those of square i from begin[i] to
	 * begin[i + 1]. */
	struct cell *loaded;
	size_t loaded_room;
	size_t *begin;
	int nx, ny; /* smallest squares */
	struct size size[SIZES];
	int sizes;
	struct squares *squares; /* of all sizes */
	struct tile *tile; /* one for each column of tiles: the last that was used */
	int tiles;
	int careful;         /* sums */
	struct tile alone;   /* of one point, for these */
	struct loads *loads; /* of all tiles */
	struct block *block; /* of all tiles */
	struct far *far;     /* of the tile of which they are listed */
	int count;           /* of them */
	/* Elements are at most so many cells away along either axis. */
	int around_x, around_y, offsets;
	struct effect *effect; /* at each depth, of a cell at each offset */
	int known[2 * MOST_SHALLOW];
	struct point point;
};

static int halves(int n)
{
	return (n + 1) / 2;
}

static double depth_of(const struct point_sum *s, int k)
{
	return (k % 2 ? s->first * M_SQRT2 : s->first) * (double)(1LL << k / 2);
}

/* Two depths share what is summed from squares, and how. */
static int level_of(int k)
{
	return (k + 1) / 2;
}

/* Squares of a size but the smallest along an axis that may not be far from a tile: those
 * that it lies on, and those on either side whose nearest edge is not; no more than there
 * are smallest ones. */
static size_t most_near(double width, double apart, int squares)
{
	const int below = TILE_SIDE / (2 * BLOCK);

	return (size_t)fmin(below + 2 * ceil(apart / width), squares);
}

/* Fours of squares of one size that may be listed for a tile. */
static size_t most_fours(const struct point_sum *s, double apart)
{
	return most_near(s->dx, apart, s->nx) * most_near(s->dy, apart, s->ny);
}

/* Eights of loads that may be far from a tile. */
static size_t most_eights(const struct point_sum *s, size_t fours)
{
	return (4 * fours * (size_t)s->sizes + EIGHT - 1) / EIGHT;
}

/* Memory for the lists of tiles, which hold parts of squares that are not far. */
static int new_tiles(struct point_sum *s)
{
	size_t tiles = (size_t)(s->par.nx + TILE_SIDE - 1) / TILE_SIDE;
	size_t fours = most_fours(s, DEEP_FAR), most = most_fours(s, CAREFUL_FAR);
	size_t eights = most_eights(s, fours);

	s->tiles = (int)tiles;
	s->tile = calloc(tiles, sizeof *s->tile);
	s->block = malloc(4 * (fours * tiles + most) * sizeof *s->block);
	s->point.points = malloc(most * BLOCK * BLOCK * sizeof *s->loads);
	s->loads = malloc((eights * tiles + most_eights(s, most)) * sizeof *s->loads);
	s->far = malloc(EIGHT * most_eights(s, most) * sizeof *s->far);
	if (!s->tile || !s->block || !s->loads || !s->far || !s->point.points)
		return 0;
	for (size_t i = 0; i < tiles; i++) {
		s->tile[i].block = s->block + 4 * fours * i;
		s->tile[i].loads = s->loads + eights * i;
	}
	s->alone.block = s->block + 4 * fours * tiles;
	s->alone.loads = s->loads + eights * tiles;
	return 1;
}

/* Memory for the elements and what they do. */
static int new_elements(struct point_sum *s)
{
	s->around_x = (int)fmin(ceil(NEAR / s->dx), s->par.nx) - 1;
	s->around_y = (int)fmin(ceil(NEAR / s->dy), s->par.ny) - 1;
	s->offsets = (2 * s->around_x + 1) * (2 * s->around_y + 1);
	s->effect = aligned_alloc(sizeof *s->effect,
		2 * (size_t)s->shallow * (size_t)s->offsets * sizeof *s->effect);
	s->point.element = malloc(((size_t)s->offsets + 1) * sizeof *s->point.element);
	return s->effect && s->point.element;
}

struct point_sum *point_sum_new(const struct stress_par *par)
{
	struct point_sum *s = calloc(1, sizeof *s);
	size_t count = 0, blocks;
	struct squares *next;

	if (!s)
		return NULL;
	s->par = *par;
	s->influence = (struct influence_par){ .dx = par->dx,
		.dy = par->dy,
		.nu = par->nu,
		.mu = par->mu,
		.axis = par->axis };
	s->cell = fmax(par->dx, par->dy);
	s->dx = (float)(par->dx / s->cell);
	s->dy = (float)(par->dy / s->cell);
	s->first = SHALLOWEST * fmin(par->dx, par->dy) / s->cell;
	s->flat = (float)(2 / ((FLAT * s->first) * (FLAT * s->first)));
	s->shallow = lesser_int(
		SHALLOW + (int)ceil(log2(SHALLOWEST / s->first)), MOST_SHALLOW);
	s->nx = (par->nx + BLOCK - 1) / BLOCK;
	s->ny = (par->ny + BLOCK - 1) / BLOCK;
	for (int nx = s->nx, ny = s->ny, last = 0; !last; s->sizes++) {
		last = nx == 1 && ny == 1;
		nx = halves(nx);
		ny = halves(ny);
		s->size[s->sizes] = (struct size){
			.nx = nx, .ny = ny, .side = (float)(BLOCK << s->sizes)
		};
		count += (size_t)nx * (size_t)ny;
	}
	blocks = (size_t)s->nx * (size_t)s->ny;
	s->squares = next = malloc(count * sizeof *s->squares);
	s->begin = calloc(blocks + 1, sizeof *s->begin);
	if (!next || !s->begin || !new_tiles(s) || !new_elements(s)) {
		point_sum_free(s);
		return NULL;
	}
	for (int l = 0; l < s->sizes; l++) {
		s->size[l].square = next;
		next += (size_t)s->size[l].nx * (size_t)s->size[l].ny;
	}
	return s;
}

void point_sum_free(struct point_sum *s)
{
	if (!s)
		return;
	free(s->squares);
	free(s->begin);
	free(s->loaded);
	free(s->tile);
	free(s->loads);
	free(s->far);
	free(s->point.points);
	free(s->point.element);
	free(s->effect);
	free(s->block);
	free(s);
}

double point_sum_depth(const struct point_sum *s, int k)
{
	return k < 0 ? 0 : s->cell * depth_of(s, k);
}

int point_sum_above(const struct point_sum *s, double z)
{
	double k = 2 * log2(z / point_sum_depth(s, 0));

	return k > 0 ? (int)k : 0;
}

static float centre(int cell, float width)
{
	return ((float)cell + 0.5f) * width;
}

static inline float sum_four(four x)
{
	return (x[0] + x[1]) + (x[2] + x[3]);
}

static inline float sum_eight(const eight *x)
{
	return (((*x)[0] + (*x)[1]) + ((*x)[2] + (*x)[3])) +
	       (((*x)[4] + (*x)[5]) + ((*x)[6] + (*x)[7]));
}

static double pressure_at(const struct point_sum *s, int x, int y)
{
	return s->pressure[(size_t)y * (size_t)s->par.nx + (size_t)x];
}

static void put_square(
	const struct size *size, int x, int y, float load, float sum_x, float sum_y)
{
	struct squares *to = &size->square[y / 2 * size->nx + x / 2];
	int i = y % 2 * 2 + x % 2;

	to->load[i] = load;
	to->x[i] = sum_x / load;
	to->y[i] = sum_y / load;
}

/* Offsets in a row. */
static int offsets_across(const struct point_sum *s)
{
	return 2 * s->around_x + 1;
}

/* Lists the loaded cells of a smallest square and adds them up; returns how many cells
 * are listed now. */
static size_t list_cells(struct point_sum *s, int block_x, int block_y, size_t n)
{
	int x0 = block_x * BLOCK, y0 = block_y * BLOCK;
	int x1 = lesser_int(x0 + BLOCK, s->par.nx),
	    y1 = lesser_int(y0 + BLOCK, s->par.ny);
	int across = offsets_across(s);
	double load = 0, sum_x = 0, sum_y = 0;

	for (int y = y0; y < y1; y++)
		for (int x = x0; x < x1; x++) {
			double p = pressure_at(s, x, y);
			float u = centre(x, s->dx), v = centre(y, s->dy);

			if (!(p > 0))
				continue;
			s->loaded[n++] = (struct cell){ (float)(s->share * p), u, v,
				y * across + x };
			load += p;
			sum_x += p * u;
			sum_y += p * v;
		}
	if (load > 0)
		put_square(s->size, block_x, block_y, (float)(load * s->share),
			(float)(sum_x * s->share), (float)(sum_y * s->share));
	return n;
}

/* Adds up the loads and marks the smallest squares that hold some; returns how many
 * cells are loaded. */
static size_t find_blocks(
	struct point_sum *s, const struct stress_span *loads, size_t count)
{
	size_t cells = 0;

	memset(s->begin, 0, (size_t)s->nx * (size_t)s->ny * sizeof *s->begin);
	s->total = 0;
	for (size_t k = 0; k < count; k++) {
		size_t row = (size_t)(loads[k].y / BLOCK) * (size_t)s->nx;

		cells += (size_t)(loads[k].end - loads[k].begin);
		for (int x = loads[k].begin; x < loads[k].end; x++)
			s->total += pressure_at(s, x, loads[k].y);
		for (int x = loads[k].begin / BLOCK; x <= (loads[k].end - 1) / BLOCK; x++)
			s->begin[row + (size_t)x] = 1;
	}
	return cells;
}

enum num_status point_sum_load(struct point_sum *s, const double *pressure,
	const struct stress_span *loads, size_t runs)
{
	size_t n = 0, block = 0, count = 0;

	s->pressure = pressure;
	s->point.ix = -1;
	if (room_for(&s->loaded, &s->loaded_room, find_blocks(s, loads, runs),
		    sizeof *s->loaded))
		return NUM_MEMORY;
	s->share = (double)s->dx * s->dy / (2 * M_PI * s->total);
	for (int l = 0; l < s->sizes; l++)
		count += (size_t)s->size[l].nx * (size_t)s->size[l].ny;
	memset(s->squares, 0, count * sizeof *s->squares);
	for (int i = 0; i < s->tiles; i++)
		s->tile[i].row = -1;
	for (int y = 0; y < s->ny; y++)
		for (int x = 0; x < s->nx; x++, block++) {
			int loaded = s->begin[block] > 0;

			s->begin[block] = n;
			if (loaded)
				n = list_cells(s, x, y, n);
		}
	s->begin[block] = n;
	for (struct size *size = s->size; size + 1 < s->size + s->sizes; size++)
		for (int i = 0; i < size->nx * size->ny; i++) {
			const struct squares *q = &size->square[i];
			float load = sum_four(q->load);

			if (load > 0)
				put_square(size + 1, i % size->nx, i / size->nx, load,
					sum_four(q->load * q->x),
					sum_four(q->load * q->y));
		}
	return NUM_OK;
}

/* 1 / sqrt(x) to 5e-6: a line through the logarithm, which the bits of a float are
 * nearly, and two steps of Newton's method. */
static ALWAYS_INLINE void inverse_root(const eight *x, eight *root)
{
	eight y = (eight)(0x5f375a86 - ((eight_bits)*x >> 1)), half = 0.5f * *x;

	y *= 1.5f - half * y * y;
	*root = y * (1.5f - half * y * y);
}

/* Pressure and friction of points, u and v farther away, as stress_point() gives them. */
static ALWAYS_INLINE void add_points(const struct point_sum *s, const struct loads *from,
	const struct loads *end, float u, float v, float z, struct sums *sums)
{
	const float k = (float)(1 - 2 * s->par.nu), mu = (float)s->par.mu;
	struct sums t = *sums;

	for (; from < end; from++) {
		eight x = from->x + u, y = from->y + v, p = from->load, ir;
		eight r2 = (x * x + y * y) + z * z, r, id, ir2, ir3, mx = mu * x;
		eight f, g, h, zz, m, e;

		inverse_root(&r2, &ir);
		r = r2 * ir;
		id = 1 / (r + z);
		ir2 = ir * ir;
		ir3 = ir2 * ir;
		h = k * ir * id * id;
		f = 3 * ir3 * ir2;
		g = h * ir2;
		zz = f * (z + mx) * z;
		m = g * (2 * r + z) - f * z + mx * (g * id * (3 * r + z) - f);
		e = k * (z * ir3 - ir * id) + mx * (k * ir3 - h) + zz * z;
		h *= mu;
		t.xx += p * (x * (m * x - 2 * h) + e);
		t.yy += p * (y * y * m + e);
		t.xy += p * y * (m * x - h);
		zz *= p;
		t.xz -= zz * x;
		t.yz -= zz * y;
	}
	*sums = t;
}

/* The same as far as it is linear in the depth. */
static ALWAYS_INLINE void add_flat(const struct point_sum *s, const struct loads *from,
	const struct loads *end, float u, float v, struct flat *flat)
{
	const float k = (float)(1 - 2 * s->par.nu), mu = (float)s->par.mu;
	struct flat t = *flat;

	for (; from < end; from++) {
		eight x = from->x + u, y = from->y + v, p = from->load, ir;
		eight r2 = x * x + y * y, ir2, kir2, f, g, h, m, n, q, px, py, mx;

		inverse_root(&r2, &ir);
		ir2 = ir * ir;
		kir2 = k * ir2;
		h = kir2 * ir;
		g = 2 * h * ir;
		f = 3 * ir2 * ir2 * ir;
		mx = mu * x;
		q = p * f * mx;
		m = g + mx * (3 * h * ir2 - f);
		n = -3 * h * ir2 - f - 4 * mx * g * ir2;
		px = p * x;
		py = p * y;
		t.xx += px * (m * x - 2 * mu * h) - p * kir2;
		t.yy += py * m * y - p * kir2;
		t.xy += py * (m * x - mu * h);
		t.rise.xx += px * n * x + p * (2 * h + 3 * mx * g);
		t.rise.yy += py * n * y + p * (2 * h + mx * g);
		t.rise.xy += py * (n * x + mu * g);
		t.rise.xz -= q * x;
		t.rise.yz -= q * y;
	}
	*flat = t;
}

/* Loads of 0, away from all points. */
static void clear_eight(struct loads *to)
{
	*to = (struct loads){ 0 };
	to->x += 2 * TILE_SIDE;
}

/* Load i of a list, which is this far away. */
static inline void put_load(const struct point_sum *s, struct loads *list, int i,
	float load, float x, float y)
{
	struct loads *to = &list[i / EIGHT];

	to->x[i % EIGHT] = s->par.axis ? y : x;
	to->y[i % EIGHT] = s->par.axis ? x : y;
	to->load[i % EIGHT] = load;
}

static int eights_of(int loads)
{
	return (loads + EIGHT - 1) / EIGHT;
}

static int offset(const struct point_sum *s, int i, int j)
{
	return (s->around_y + j) * offsets_across(s) + s->around_x + i;
}

static struct effect *effects_of(struct point_sum *s, int depth)
{
	return s->effect + (size_t)depth * (size_t)s->offsets;
}

/* Of all cells at i, j or mirrored, at a depth. */
static void know_effect(struct point_sum *s, int i, int j, int depth)
{
	struct influence f = influence_rough_element(
		&s->influence, i * s->par.dx, j * s->par.dy, point_sum_depth(s, depth));
	/* As loads are in units of 2 pi times their pressure. */
	double unit = 2 * M_PI / (s->dx * s->dy);

	for (int m = 0; m < 4; m++) {
		int mx = m & 1, my = m >> 1;
		eight *to =
			&effects_of(s, depth)[offset(s, mx ? -i : i, my ? -j : j)].number;

		for (int c = 0; c < STRESS_DEVIATOR; c++)
			(*to)[c] = (float)(unit * influence_image(&s->influence, &f,
							  (enum stress_number)c, mx && i,
							  my && j));
	}
}

static const struct effect *effects_at(struct point_sum *s, int depth)
{
	for (int j = 0; j <= s->around_y && !s->known[depth]; j++)
		for (int i = 0; i <= s->around_x; i++)
			know_effect(s, i, j, depth);
	s->known[depth] = 1;
	return effects_of(s, depth);
}

/* A load near the point, this far away. */
static ALWAYS_INLINE void list_near(
	const struct point_sum *s, struct point *at, float load, float x, float y)
{
	float square = x * x + y * y;

	put_load(s, at->points, at->count++, load, x, y);
	at->nearest = square < at->nearest ? square : at->nearest;
}

/* The cells of a smallest square one by one. */
static ALWAYS_INLINE void list_each(
	const struct point_sum *s, struct point *at, const struct block *b)
{
	const float near = at->deep ? 0 : (float)NEAR;
	const int own = offset(s, at->ix, at->iy);

	for (size_t n = s->begin[b->at]; n < s->begin[b->at + 1]; n++) {
		const struct cell *c = &s->loaded[n];
		float x = at->x - c->x, y = at->y - c->y;

		if (x * x + y * y < near * near)
			at->element[at->elements++] =
				(struct element){ own - c->offset, c->load };
		else
			list_near(s, at, c->load, x, y);
	}
}

/* The smallest squares near the tile, or their cells one by one. */
static void list_blocks(const struct point_sum *s, struct point *to)
{
	const float far = (float)(s->careful ? CAREFUL_FAR : FAR) * BLOCK;
	const struct tile *tile = to->tile;
	struct point at = *to; /* the compiler knows that nothing else changes it */

	at.elements = at.count = 0;
	at.nearest = INFINITY;
	for (const struct block *b = tile->block; b < tile->block + tile->near; b++) {
		float u = at.x - b->x, v = at.y - b->y;

		if (u * u + v * v >= far * far)
			list_near(s, &at, b->load, u, v);
		else
			list_each(s, &at, b);
	}
	to->elements = at.elements;
	to->count = at.count;
	to->nearest = at.nearest;
	for (; at.count % EIGHT > 0; at.count++)
		put_load(s, at.points, at.count, 0, 2 * TILE_SIDE, 0);
}

/* Tiles */

/* From points to the nearest edge of a tile along an axis. */
static inline four beyond(four away, float half)
{
	four x = (four)((four_bits)away & 0x7fffffff) - half;

	return (four)((four_bits)x & (x > 0));
}

/* At how many depths loads at distances act in proportion to them; of careful sums none
 * is taken to do so. */
static inline four_bits flat_depths(const struct point_sum *s, four square)
{
	const int most = s->careful ? 0 : s->shallow;
	/* Each depth is twice the one before: half the exponent of the square of the
	 * distance counts them. */
	four_bits k = ((four_bits)(square * s->flat) >> 24) - 63;

	k &= k > 0;
	return k - ((k - most) & (k > most));
}

/* Two by two squares of size l, or those that they consist of. */
static void list_squares(struct point_sum *s, struct tile *t, int l, int x, int y)
{
	const struct size *size = &s->size[l];
	const struct squares *q = &size->square[y * size->nx + x];
	const float far = t->apart * size->side;
	four away_x = t->x - q->x, away_y = t->y - q->y;
	four u = beyond(away_x, t->half_x), v = beyond(away_y, t->half_y);
	four square = u * u + v * v;
	four_bits flat = flat_depths(s, square);

	for (int i = 0; i < 4; i++) {
		int ix = 2 * x + i % 2, iy = 2 * y + i / 2;

		if (!(q->load[i] > 0))
			continue;
		if (square[i] >= far * far)
			s->far[s->count++] =
				(struct far){ away_x[i], away_y[i], q->load[i], flat[i] };
		else if (l > 0)
			list_squares(s, t, l - 1, ix, iy);
		else
			t->block[t->near++] = (struct block){ q->x[i], q->y[i],
				q->load[i], (size_t)iy * (size_t)s->nx + (size_t)ix };
	}
}

/* Puts what is far away from a tile in order. */
static void sort_far(const struct point_sum *s, struct tile *t)
{
	int place[MOST_SHALLOW + 2] = { 0 };

	for (int i = 0; i < s->count; i++)
		place[s->far[i].flat + 1]++;
	for (int k = 0; k <= s->shallow; k++) {
		place[k + 1] += place[k];
		t->eights[k] = eights_of(place[k + 1]);
	}
	if (s->count > 0)
		clear_eight(&t->loads[t->eights[s->shallow] - 1]);
	for (const struct far *f = s->far; f < s->far + s->count; f++)
		put_load(s, t->loads, place[f->flat]++, f->load, f->x, f->y);
}

/* Side: of the tile, in cells. */
static void make_tile(
	struct point_sum *s, struct tile *t, int column, int row, float side, float apart)
{
	t->row = row;
	t->apart = apart;
	t->half_x = 0.5f * side * s->dx;
	t->half_y = 0.5f * side * s->dy;
	t->x = centre(column, side * s->dx);
	t->y = centre(row, side * s->dy);
	t->near = s->count = 0;
	list_squares(s, t, s->sizes - 1, 0, 0);
	sort_far(s, t);
}

static const struct tile *tile_of(struct point_sum *s, int ix, int iy, float apart)
{
	int column = ix / TILE_SIDE, row = iy / TILE_SIDE;
	struct tile *t = &s->tile[column];

	if (t->row != row || t->apart != apart)
		make_tile(s, t, column, row, TILE_SIDE, apart);
	return t;
}

/* From the centre of the cell itself. */
static const struct tile *tile_alone(struct point_sum *s, int ix, int iy)
{
	struct tile *t = &s->alone;

	make_tile(s, t, ix, iy, 1, (float)CAREFUL_FAR);
	return t;
}

/* What acts on the point in proportion to the depth. */
LANES_CLONES static void find_flat(const struct point_sum *s, struct point *at)
{
	const struct loads *loads = at->tile->loads;
	const int *eights = at->tile->eights;
	struct flat flat = { .xx = { 0 } };

	for (int i = s->shallow; i > 0; i--) {
		struct flat *to = &at->flat[i - 1];

		add_flat(
			s, loads + eights[i - 1], loads + eights[i], at->u, at->v, &flat);
		if (i == at->flat_points)
			add_flat(s, at->points, at->points + eights_of(at->count), 0, 0,
				&flat);
		/* One by one: a copy of the whole takes a quarter of the time of the
		 * sums. */
		to->xx = flat.xx;
		to->yy = flat.yy;
		to->xy = flat.xy;
		to->rise.xx = flat.rise.xx;
		to->rise.yy = flat.rise.yy;
		to->rise.xy = flat.rise.xy;
		to->rise.xz = flat.rise.xz;
		to->rise.yz = flat.rise.yz;
	}
}

static void find_point(struct point_sum *s, int ix, int iy, int deep)
{
	struct point *at = &s->point;
	float x, y;

	at->deep = deep;
	at->ix = ix;
	at->iy = iy;
	at->x = centre(ix, s->dx);
	at->y = centre(iy, s->dy);
	at->tile = s->careful ? tile_alone(s, ix, iy)
			      : tile_of(s, ix, iy, (float)(deep ? DEEP_FAR : TILE_FAR));
	list_blocks(s, at);
	at->element[at->elements] = (struct element){ 0, 0 };
	x = at->x - at->tile->x;
	y = at->y - at->tile->y;
	at->u = s->par.axis ? y : x;
	at->v = s->par.axis ? x : y;
	at->flat_points = flat_depths(s, (four){ at->nearest })[0];
	if (!deep)
		find_flat(s, at);
}

/* The numbers at a depth: loads and elements near the point, and what is flat there;
 * effect: of elements. */
LANES_CLONES static void sum_point(const struct point_sum *s, const struct effect *effect,
	int k, float number[EIGHT])
{
	const struct point *at = &s->point;
	const struct tile *tile = at->tile;
	struct sums t = { .xx = { 0 } };
	eight e = { 0 }, other = { 0 };
	float z = (float)depth_of(s, k);
	int level = level_of(k);

	add_points(s, tile->loads,
		tile->loads + tile->eights[lesser_int(level, s->shallow)], at->u, at->v,
		z, &t);
	if (at->deep || level >= at->flat_points)
		add_points(s, at->points, at->points + eights_of(at->count), 0, 0, z, &t);
	if (!at->deep) {
		const struct flat *flat = &at->flat[level];

		t.xx += flat->xx + z * flat->rise.xx;
		t.yy += flat->yy + z * flat->rise.yy;
		t.xy += flat->xy + z * flat->rise.xy;
		t.xz += z * flat->rise.xz;
		t.yz += z * flat->rise.yz;
		/* The processor adds to the two side by side. */
		for (int i = 0; i < at->elements; i += 2) {
			const struct element *a = &at->element[i];

			e += a[0].load * effect[a[0].offset].number;
			other += a[1].load * effect[a[1].offset].number;
		}
		e += other;
	}
	memcpy(number, &e, sizeof e);
	number[DEV_X] += sum_eight(s->par.axis ? &t.yy : &t.xx);
	number[DEV_Y] += sum_eight(s->par.axis ? &t.xx : &t.yy);
	number[DEV_XY] += sum_eight(&t.xy);
	number[DEV_XZ] += sum_eight(s->par.axis ? &t.yz : &t.xz);
	number[DEV_YZ] += sum_eight(s->par.axis ? &t.xz : &t.yz);
}

void point_sum_take_care(struct point_sum *s, int careful)
{
	s->careful = careful;
	s->point.ix = -1;
}

double point_sum_at(struct point_sum *s, int ix, int iy, int k)
{
	const struct stress_criterion *criterion =
		s->par.criterion ? s->par.criterion : &stress_von_mises_criterion;
	double number[STRESS_DEVIATOR];
	float sum[EIGHT];
	int deep = level_of(k) >= s->shallow;

	if (s->point.ix != ix || s->point.iy != iy || s->point.deep != deep)
		find_point(s, ix, iy, deep);
	sum_point(s, deep ? NULL : effects_at(s, k), k, sum);
	for (int c = 0; c < STRESS_DEVIATOR; c++)
		number[c] = s->total * sum[c];
	return criterion->value(number);
}
