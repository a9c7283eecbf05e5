#include "stress/point_sum.h"
#include "num/lanes.h"
#include "num/lesser.h"
#include "stress/influence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	BLOCK = 4,  /* cells to the side of the smallest square */
	LIST = 256, /* points whose stress is summed together; a multiple of four */
	SIZES = 20,
	TILE = 2, /* size of the squares that are tiles */
	TILE_SIDE = BLOCK << TILE,
	NEAR_LIST = 64,
	AROUND = 5, /* elements are at most so many cells away along either axis */
	FOURS = 2   /* sets of four depths of which the first is less than NEAR cells deep
		     */
};
/* Sides of a square: ones farther away, over the surface or in half the depth, act as
 * points.  Right below it a square must be farther than beside it, since the spread of
 * its load then only lowers the stress.  Volumes of 441 surfaces have rms errors of 2.3
 * and 1.9 % with 1 and 1.5; with 2 a sum takes a third longer. */
static const double FAR = 1.5;
/* From the nearest edge of a tile, whose cells are on average half its side farther away.
 * Of 88 surfaces the volumes have an rms error of 1.8 % with 1, 1.25 and 1.5; that of
 * 19005 particles of 1536 x 1536 cells changes by 0.1 % from 1.25 to 1. */
static const double TILE_FAR = 1.25;
/* Cells: farther elements act as points. */
static const double NEAR = 6;
/* Loads at more than so many times the deepest of four depths act in proportion to the
 * depth.  The volume of 512 x 512 cells of Sq 0.8 um differs by .22, .06 and .001 % with
 * 6, 8 and 12 from that with 20, which is what add_loads() allows at most. */
static const double FLAT = 12;
/* First depth, cells; each is twice the one before. */
static const double SHALLOWEST = 0.125;

/* What belongs to four depths.  Single precision is enough beside the error of squares
 * and points, and the surrogate takes four fifths of the time with it.  Lengths are in
 * cells, so that powers of them stay within its range. */
typedef float four __attribute__((vector_size(16)));
typedef int32_t four_bits __attribute__((vector_size(16)));
_Static_assert(sizeof(four) == POINT_SUM_DEPTHS * sizeof(float), "a depth for each lane");

struct square {
	double load, x, y; /* sum of pressures and their centroid, m */
};

/* Squares of BLOCK cells, twice as many, ...: one for the whole grid at last. */
struct size {
	int nx, ny;
	double side; /* m */
	struct square *square;
};

/* Points: their offsets along and across the shear, in cells, and loads. */
struct points {
	int count;
	float along[LIST], across[LIST], load[LIST];
};

/* Squares that are far from all cells of a tile, as points from its centre, and those of
 * its own size that are not.  flat: so far that they act in proportion to depths of up to
 * TILE_SIDE cells. */
struct tile {
	int row;  /* of tiles; -1: none */
	int full; /* a list is: use none of them */
	struct points far, flat;
	int near, x[NEAR_LIST], y[NEAR_LIST];
};

struct point_sum {
	struct stress_par par;
	struct influence_par influence;
	double cell, per_cell; /* the longer side, and its inverse */
	/* All pressures, by which others are divided, and the load of one of them in
	 * square cells over that and 2 pi. */
	double total, share;
	const double *pressure;
	/* Places of the loaded cells in their smallest square, those of square i from
	 * begin[i] to begin[i + 1]. */
	unsigned char *place;
	size_t *begin;
	struct size size[SIZES];
	int sizes;
	struct square *squares; /* of all sizes */
	struct tile *tile;      /* one for each column of tiles: the last that was used */
	int tiles;
	struct points list, flat; /* still to be summed; flat: as of a tile */
	/* Stress by a cell at each depth, next to it or on it. */
	four element[FOURS][2 * AROUND + 1][2 * AROUND + 1][STRESS_NUMBERS];
	int known[FOURS];
};

/* Four depths, one below the other, at which the stress is wanted, and what has been
 * summed of it. */
struct point {
	int ix, iy, k;
	double x, y, top; /* top: the first depth, m */
	four z;
	four number[STRESS_NUMBERS];
	float flat_from; /* square of the least distance of flat points */
};

static int halves(int n)
{
	return (n + 1) / 2;
}

struct point_sum *point_sum_new(const struct stress_par *par)
{
	struct point_sum *s = calloc(1, sizeof *s);
	int nx = (par->nx + BLOCK - 1) / BLOCK, ny = (par->ny + BLOCK - 1) / BLOCK;
	size_t count = 0;
	struct square *next;

	if (!s)
		return NULL;
	s->par = *par;
	s->influence = (struct influence_par){ .dx = par->dx,
		.dy = par->dy,
		.nu = par->nu,
		.mu = par->mu,
		.axis = par->axis };
	s->cell = fmax(par->dx, par->dy);
	s->per_cell = 1 / s->cell;
	for (double side = BLOCK * s->cell;; side *= 2) {
		s->size[s->sizes++] = (struct size){ .nx = nx, .ny = ny, .side = side };
		count += (size_t)nx * (size_t)ny;
		if (nx == 1 && ny == 1)
			break;
		nx = halves(nx);
		ny = halves(ny);
	}
	s->squares = next = calloc(count, sizeof *s->squares);
	s->begin =
		calloc((size_t)s->size->nx * (size_t)s->size->ny + 1, sizeof *s->begin);
	s->place = calloc((size_t)par->nx * (size_t)par->ny, 1);
	s->tiles = (par->nx + TILE_SIDE - 1) / TILE_SIDE;
	s->tile = malloc((size_t)s->tiles * sizeof *s->tile);
	if (!next || !s->begin || !s->place || !s->tile) {
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
	free(s->place);
	free(s->tile);
	free(s);
}

double point_sum_depth(const struct point_sum *s, int k)
{
	return k < 0 ? 0 : ldexp(SHALLOWEST * s->cell, k);
}

int point_sum_above(const struct point_sum *s, double z)
{
	double k = log2(z / point_sum_depth(s, 0));

	return k > 0 ? (int)k : 0;
}

static double centre(int cell, double width)
{
	return ((double)cell + 0.5) * width;
}

static double pressure_at(const struct point_sum *s, int x, int y)
{
	return s->pressure[(size_t)y * (size_t)s->par.nx + (size_t)x];
}

static void add_load(struct square *to, double load, double x, double y)
{
	to->load += load;
	to->x += load * x;
	to->y += load * y;
}

static void find_centroids(struct size *size)
{
	for (int i = 0; i < size->nx * size->ny; i++)
		if (size->square[i].load > 0) {
			size->square[i].x /= size->square[i].load;
			size->square[i].y /= size->square[i].load;
		}
}

/* 1 if n cells of a row carry no load. */
static int is_free(const struct point_sum *s, int x, int y, int n)
{
	const double *p = s->pressure + (size_t)y * (size_t)s->par.nx + (size_t)x;
	lanes most = lanes_all(0);

	for (int i = 0; i < n; i += 2)
		most = lanes_max(lanes_load(p + i, i + 1 < n ? 2 : 1), most);
	return !(most[0] > 0) && !(most[1] > 0);
}

/* Lists the loaded cells, and adds them to the squares, which are empty. */
static void list_cells(struct point_sum *s)
{
	const struct stress_par *g = &s->par;
	const struct size *small = s->size;
	size_t n = 0;

	for (int square = 0; square < small->nx * small->ny; square++) {
		int x0 = square % small->nx * BLOCK, y0 = square / small->nx * BLOCK;
		int wx = lesser_int(BLOCK, g->nx - x0),
		    wy = lesser_int(BLOCK, g->ny - y0);

		s->begin[square] = n;
		for (int y = 0; y < wy; y++)
			for (int x = is_free(s, x0, y0 + y, wx) ? wx : 0; x < wx; x++) {
				double p = pressure_at(s, x0 + x, y0 + y);

				if (!(p > 0))
					continue;
				s->place[n++] = (unsigned char)(y * BLOCK + x);
				add_load(&small->square[square], p, centre(x0 + x, g->dx),
					centre(y0 + y, g->dy));
			}
	}
	s->begin[small->nx * small->ny] = n;
}

void point_sum_load(struct point_sum *s, const double *pressure)
{
	struct size *small = s->size, *large;

	for (int l = 0; l < s->sizes; l++)
		memset(s->size[l].square, 0,
			(size_t)s->size[l].nx * (size_t)s->size[l].ny *
				sizeof *s->size[l].square);
	for (int i = 0; i < s->tiles; i++)
		s->tile[i].row = -1;
	s->pressure = pressure;
	list_cells(s);
	find_centroids(small);
	for (; small + 1 < s->size + s->sizes; small = large) {
		large = small + 1;
		for (int i = 0; i < small->nx * small->ny; i++) {
			const struct square *q = &small->square[i];
			int x = i % small->nx / 2, y = i / small->nx / 2;

			add_load(&large->square[y * large->nx + x], q->load, q->x, q->y);
		}
		find_centroids(large);
	}
	s->total = small->square->load;
	s->share =
		s->par.dx * s->par.dy * s->per_cell * s->per_cell / (2 * M_PI * s->total);
}

/* Stress of points on the list at all four depths: the sum of pressure and friction as
 * stress_point() gives it. */
struct sums {
	four xx, yy, xy, xz, yz; /* x along the shear; xx and yy less zz */
};

static inline four all_four(float x)
{
	return (four){ x, x, x, x };
}

/* 1 / sqrt(x) to 5e-6: a line through the logarithm, which the bits of a float are
 * nearly, and two steps of Newton's method. */
static inline four inverse_root(four x)
{
	four y = (four)(0x5f375a86 - ((four_bits)x >> 1));

	y *= 1.5f - 0.5f * x * y * y;
	return y * (1.5f - 0.5f * x * y * y);
}

static inline void sum_one(
	float x, float y, float p, four z, float k, float mu, struct sums *t)
{
	four r2 = x * x + y * y + z * z, ir = inverse_root(r2), r = r2 * ir;
	four id = 1 / (r + z), ir3 = ir * ir * ir, h = k * ir * id * id;
	four f = 3 * ir3 * ir * ir;
	four m = h * ir * ir * (2 * r + z) - f * z, l = k * (z * ir3 - ir * id);
	four sm = h * ir * ir * id * (3 * r + z) - f, sk = k * ir3 - h;
	four zz = f * (z + mu * x) * z;

	t->xx += p * (m * x * x + l + mu * x * (sm * x * x + sk - 2 * h) + zz * z);
	t->yy += p * (m * y * y + l + mu * x * (sm * y * y + sk) + zz * z);
	t->xy += p * y * (m * x + mu * (sm * x * x - h));
	t->xz -= p * zz * x;
	t->yz -= p * zz * y;
}

static void take_sums(const struct point_sum *s, const struct sums *t, struct point *at)
{
	int swap = s->par.axis;

	at->number[swap ? DEV_Y : DEV_X] += t->xx;
	at->number[swap ? DEV_X : DEV_Y] += t->yy;
	at->number[DEV_XY] += t->xy;
	at->number[swap ? DEV_YZ : DEV_XZ] += t->xz;
	at->number[swap ? DEV_XZ : DEV_YZ] += t->yz;
}

/* Of points that are u and v farther away. */
static void sum_list(const struct point_sum *s, const struct points *l, float u, float v,
	struct point *at)
{
	float k = (float)(1 - 2 * s->par.nu), mu = (float)s->par.mu;
	struct sums t = { .xx = all_four(0) };

	for (int i = 0; i < l->count; i++)
		sum_one(l->along[i] + u, l->across[i] + v, l->load[i], at->z, k, mu, &t);
	take_sums(s, &t, at);
}

static inline four load_four(const float *x)
{
	four v;

	memcpy(&v, x, sizeof v);
	return v;
}

static inline float sum_four(four x)
{
	return (x[0] + x[1]) + (x[2] + x[3]);
}

/* The same as far as it is linear in the depth, four points at a time. */
static void sum_flat(const struct point_sum *s, const struct points *l, float u, float v,
	struct point *at)
{
	float k = (float)(1 - 2 * s->par.nu), mu = (float)s->par.mu;
	struct sums t = { .xx = all_four(0) }, rise = t; /* on the surface, and per cell
							  */

	for (int i = 0; i < l->count; i += 4) {
		four x = load_four(l->along + i) + u, y = load_four(l->across + i) + v;
		four p = load_four(l->load + i), ir = inverse_root(x * x + y * y);
		four ir2 = ir * ir, h = k * ir2 * ir, g = h * ir, f = 3 * ir2 * ir2 * ir;
		four m = -3 * h * ir2 - f, sm = 3 * h * ir2 - f, sn = -8 * g * ir2;

		t.xx += p * (2 * g * x * x - k * ir2 + mu * x * (sm * x * x - 2 * h));
		t.yy += p * (2 * g * y * y - k * ir2 + mu * x * sm * y * y);
		t.xy += p * y * (2 * g * x + mu * (sm * x * x - h));
		rise.xx += p * (m * x * x + 2 * h + mu * x * (sn * x * x + 6 * g));
		rise.yy += p * (m * y * y + 2 * h + mu * x * (sn * y * y + 2 * g));
		rise.xy += p * y * (m * x + mu * (sn * x * x + 2 * g));
		rise.xz -= p * f * mu * x * x;
		rise.yz -= p * f * mu * x * y;
	}
	t = (struct sums){ .xx = sum_four(t.xx) + at->z * sum_four(rise.xx),
		.yy = sum_four(t.yy) + at->z * sum_four(rise.yy),
		.xy = sum_four(t.xy) + at->z * sum_four(rise.xy),
		.xz = at->z * sum_four(rise.xz),
		.yz = at->z * sum_four(rise.yz) };
	take_sums(s, &t, at);
}

/* 0 if there are too many. */
static int list_point(struct points *l, float along, float across, float load)
{
	if (l->count == LIST)
		return 0;
	l->along[l->count] = along;
	l->across[l->count] = across;
	l->load[l->count++] = load;
	return 1;
}

/* Fills up the last four with loads of nothing, outside the tile. */
static void fill_four(struct points *l)
{
	while (l->count % 4)
		list_point(l, 2 * TILE_SIDE, 0, 0);
}

static void sum_lists(struct point_sum *s, struct point *at)
{
	fill_four(&s->flat);
	sum_list(s, &s->list, 0, 0, at);
	sum_flat(s, &s->flat, 0, 0, at);
	s->list.count = s->flat.count = 0;
}

static void add_point(
	struct point_sum *s, struct point *at, double load, double x, double y)
{
	float u = (float)((at->x - x) * s->per_cell),
	      v = (float)((at->y - y) * s->per_cell);
	struct points *l = u * u + v * v >= at->flat_from ? &s->flat : &s->list;

	if (l->count == LIST)
		sum_lists(s, at);
	list_point(l, s->par.axis ? v : u, s->par.axis ? u : v, (float)(load * s->share));
}

/* Of all cells at i, j or mirrored, at one of the depths. */
static void know_element(struct point_sum *s, int i, int j, int set, int depth)
{
	struct influence f = influence_rough_element(&s->influence, i * s->par.dx,
		j * s->par.dy, point_sum_depth(s, set * POINT_SUM_DEPTHS + depth));

	for (int m = 0; m < 4; m++) {
		int mx = m & 1, my = m >> 1;
		four *to =
			s->element[set][AROUND + (mx ? -i : i)][AROUND + (my ? -j : j)];

		for (int c = 0; c < STRESS_NUMBERS; c++)
			to[c][depth] = (float)influence_image(&s->influence, &f,
				(enum stress_number)c, mx && i, my && j);
	}
}

static void know_elements(struct point_sum *s, int set)
{
	for (int j = 0; j <= AROUND; j++)
		for (int i = 0; i <= AROUND; i++)
			for (int depth = 0; depth < POINT_SUM_DEPTHS; depth++)
				know_element(s, i, j, set, depth);
	s->known[set] = 1;
}

/* A cell that is i, j cells before the point. */
static void add_element(struct point_sum *s, struct point *at, double load, int i, int j)
{
	int set = at->k / POINT_SUM_DEPTHS;
	float share = (float)(load / s->total);
	const four *element;

	if (!s->known[set])
		know_elements(s, set);
	element = s->element[set][AROUND + i][AROUND + j];
	for (int c = 0; c < STRESS_NUMBERS; c++)
		at->number[c] += share * element[c];
}

/* Cell by cell of a smallest square. */
static void add_cells(struct point_sum *s, struct point *at, int x, int y)
{
	double depth = at->top * s->per_cell;
	int square = y * s->size->nx + x;

	for (size_t n = s->begin[square]; n < s->begin[square + 1]; n++) {
		int ix = x * BLOCK + s->place[n] % BLOCK,
		    iy = y * BLOCK + s->place[n] / BLOCK;
		int i = at->ix - ix, j = at->iy - iy;
		double p = pressure_at(s, ix, iy);

		if (i * i + j * j + depth * depth < NEAR * NEAR)
			add_element(s, at, p, i, j);
		else
			add_point(s, at, p, centre(ix, s->par.dx), centre(iy, s->par.dy));
	}
}

/* A square of size l, or the smaller ones that it consists of. */
static void add_square(struct point_sum *s, struct point *at, int l, int x, int y)
{
	const struct size *size = &s->size[l];
	const struct square *q = &size->square[y * size->nx + x];
	double u = at->x - q->x, v = at->y - q->y;

	if (!(q->load > 0))
		return;
	if (u * u + v * v + 0.25 * at->top * at->top >=
		FAR * FAR * size->side * size->side) {
		add_point(s, at, q->load, q->x, q->y);
		return;
	}
	if (l == 0) {
		add_cells(s, at, x, y);
		return;
	}
	for (int j = 2 * y; j < 2 * y + 2 && j < s->size[l - 1].ny; j++)
		for (int i = 2 * x; i < 2 * x + 2 && i < s->size[l - 1].nx; i++)
			add_square(s, at, l - 1, i, j);
}

/* Tiles */

/* From a point to a row of cells along an axis. */
static double beyond(double x, int first, double width)
{
	double low = first * width - x, high = x - (first + TILE_SIDE) * width;

	return low > 0 ? low : high > 0 ? high : 0;
}

static void list_far(const struct point_sum *s, struct tile *t, int column,
	const struct square *q, double distance)
{
	float u = (float)(((column + 0.5) * TILE_SIDE * s->par.dx - q->x) * s->per_cell),
	      v = (float)(((t->row + 0.5) * TILE_SIDE * s->par.dy - q->y) * s->per_cell);

	t->full |= !list_point(
		distance >= FLAT * TILE_SIDE * s->cell ? &t->flat : &t->far,
		s->par.axis ? v : u, s->par.axis ? u : v, (float)(q->load * s->share));
}

static void list_near(struct tile *t, int x, int y)
{
	t->full |= t->near == NEAR_LIST;
	if (t->full)
		return;
	t->x[t->near] = x;
	t->y[t->near++] = y;
}

/* A square of size l, or those that it consists of. */
static void list_square(
	const struct point_sum *s, struct tile *t, int column, int l, int x, int y)
{
	const struct size *size = &s->size[l];
	const struct square *q = &size->square[y * size->nx + x];
	double u = beyond(q->x, column * TILE_SIDE, s->par.dx),
	       v = beyond(q->y, t->row * TILE_SIDE, s->par.dy);

	if (!(q->load > 0))
		return;
	if (u * u + v * v >= TILE_FAR * TILE_FAR * size->side * size->side) {
		list_far(s, t, column, q, sqrt(u * u + v * v));
		return;
	}
	if (l == TILE) {
		list_near(t, x, y);
		return;
	}
	for (int j = 2 * y; j < 2 * y + 2 && j < s->size[l - 1].ny; j++)
		for (int i = 2 * x; i < 2 * x + 2 && i < s->size[l - 1].nx; i++)
			list_square(s, t, column, l - 1, i, j);
}

/* The tile of a cell; NULL if it has too many squares, or the grid too few. */
static const struct tile *tile_of(struct point_sum *s, int ix, int iy)
{
	int column = ix / TILE_SIDE, row = iy / TILE_SIDE;
	struct tile *t = &s->tile[column];

	if (s->sizes <= TILE)
		return NULL;
	if (t->row != row) {
		t->row = row;
		t->far.count = t->flat.count = t->near = t->full = 0;
		list_square(s, t, column, s->sizes - 1, 0, 0);
		fill_four(&t->far);
		fill_four(&t->flat);
	}
	return t->full ? NULL : t;
}

/* All loads: those far from the tile by its list.  A depth of more than the tile's side
 * needs fewer. */
static void add_loads(struct point_sum *s, struct point *at)
{
	const struct tile *t =
		at->k < 2 * POINT_SUM_DEPTHS ? tile_of(s, at->ix, at->iy) : NULL;
	float u, v;

	if (!t) {
		add_square(s, at, s->sizes - 1, 0, 0);
		return;
	}
	u = (float)((at->ix % TILE_SIDE - 0.5 * (TILE_SIDE - 1)) * s->par.dx *
		    s->per_cell);
	v = (float)((at->iy % TILE_SIDE - 0.5 * (TILE_SIDE - 1)) * s->par.dy *
		    s->per_cell);
	if (s->par.axis) {
		float swap = u;

		u = v;
		v = swap;
	}
	/* The far ones are TILE_FAR TILE_SIDE = 20 times as far as the first four depths
	 * are deep, or more. */
	if (at->k == 0)
		sum_flat(s, &t->far, u, v, at);
	else
		sum_list(s, &t->far, u, v, at);
	sum_flat(s, &t->flat, u, v, at);
	for (int i = 0; i < t->near; i++)
		add_square(s, at, TILE, t->x[i], t->y[i]);
}

void point_sum_at(
	struct point_sum *s, size_t cell, int k, double stress[POINT_SUM_DEPTHS])
{
	const struct stress_par *g = &s->par;
	const struct stress_criterion *criterion =
		g->criterion ? g->criterion : &stress_von_mises_criterion;
	struct point at = { .ix = (int)(cell % (size_t)g->nx),
		.iy = (int)(cell / (size_t)g->nx),
		.k = k,
		.top = point_sum_depth(s, k) };
	double deepest;

	at.x = centre(at.ix, g->dx);
	at.y = centre(at.iy, g->dy);
	for (int d = 0; d < POINT_SUM_DEPTHS; d++)
		at.z[d] = (float)(point_sum_depth(s, k + d) / s->cell);
	deepest = FLAT * at.z[POINT_SUM_DEPTHS - 1];
	at.flat_from = (float)(deepest * deepest);
	add_loads(s, &at);
	sum_lists(s, &at);
	for (int d = 0; d < POINT_SUM_DEPTHS; d++) {
		double number[STRESS_NUMBERS];

		for (int c = 0; c < STRESS_NUMBERS; c++)
			number[c] = s->total * at.number[c][d];
		stress[d] = criterion->value(number);
	}
}
