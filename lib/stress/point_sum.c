#include "stress/point_sum.h"
#include "num/lanes.h"
#include "num/lesser.h"
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
	AROUND = 5, /* elements are at most so many cells away along either axis */
	FOURS = 2   /* sets of four depths of which the first is less than NEAR cells
		     * deep */
};
/* Sides of a square: ones farther away, over the surface or in half the depth, act as
 * points.  Right below it a square must be farther than beside it, since the spread of
 * its load then only lowers the stress.  Volumes of 441 surfaces have rms errors of 2.3
 * and 1.9 % with 1 and 1.5; with 2 a sum takes a third longer. */
static const double FAR = 1.5;
/* From the nearest edge of a tile, whose cells are on average half its side farther away;
 * DEEP_FAR: at points deeper than NEAR.  On tiles of 8 cells volumes of 88 surfaces have
 * rms errors of 1.9, 1.8, 1.7 and 1.7 % with 0.75, 1, 1.25 and 1.5; the surrogate
 * executes 3.1e9, 3.2e9, 3.4e9 and 3.6e9 instructions where it finds 19005 particles.
 * From 8 cells on stresses have rms errors of 2.6, 1.9, 1.7 and 1.3 % with DEEP_FAR
 * 1, 1.25, 1.5 and 2.
 */
static const double TILE_FAR = 1, DEEP_FAR = 2;
/* Cells: farther elements act as points. */
static const double NEAR = 6;
/* Loads at more than so many times the deepest of four depths act in proportion to the
 * depth.  The volume of 512 x 512 cells of Sq 0.8 um differs by .22, .06 and .001 % with
 * 6, 8 and 12 from that with 20. */
static const double FLAT = 8;
/* First depth; each is twice the one before, and the fourth is one cell. */
static const double SHALLOWEST = 0.125;

/* What belongs to four depths or points.  Single precision is enough beside the error of
 * squares and points, and the surrogate takes four fifths of the time with it.  Lengths
 * are in cells, so that powers of them stay within its range. */
typedef float four __attribute__((vector_size(16)));
typedef int32_t four_bits __attribute__((vector_size(16)));
_Static_assert(sizeof(four) == POINT_SUM_DEPTHS * sizeof(float), "a depth for each lane");

/* Four loads and where they are: the centroids of two by two squares of one size, or,
 * from the centre of a tile, of squares that are far from it, along and across the
 * shear. */
struct loads {
	four x, y, load;
};

/* Squares of BLOCK cells, twice as many, ...: one for the whole grid at last. */
struct size {
	int nx, ny; /* fours of squares */
	float side;
	struct loads *square;
};

struct list {
	int count;
	struct loads *loads;
};

/* A smallest square. */
struct block {
	float x, y, load;
	int ix, iy; /* its first cell */
};

/* Squares that are far from all cells of a tile, and the smallest ones that are not.
 * far[i]: so far that they act in proportion to the depths of i sets, not of more. */
struct tile {
	int row;                    /* of tiles; -1: none */
	float apart;                /* sides of a square that is far */
	float x, y, half_x, half_y; /* its centre, half its sides */
	struct list far[FOURS + 1];
	int near;
	struct block *block;
};

struct point_sum {
	struct stress_par par;
	struct influence_par influence;
	double cell;  /* the longer side, m, by which lengths are divided */
	float dx, dy; /* sides of a cell over that */
	/* All pressures, and what turns a pressure into its load: in these, over 2 pi. */
	double total, share;
	const double *pressure;
	/* Places of the loaded cells in their smallest square, those of square i from
	 * begin[i] to begin[i + 1]. */
	unsigned char *place;
	size_t *begin;
	int nx, ny; /* smallest squares */
	struct size size[SIZES];
	int sizes;
	struct loads *squares; /* of all sizes */
	struct tile *tile;     /* one for each column of tiles: the last that was used */
	int tiles;
	struct loads *loads; /* of the lists of all tiles */
	struct block *block; /* of all tiles */
	/* Stress by a cell at each depth, next to it or on it. */
	four element[FOURS][2 * AROUND + 1][2 * AROUND + 1][STRESS_DEVIATOR];
	int known[FOURS];
};

/* Stress at all four depths; x along the shear; xx and yy less zz. */
struct sums {
	four xx, yy, xy, xz, yz;
};

/* Four depths, one below the other, at which the stress is wanted, and what has been
 * summed of it: of points, and of elements. */
struct point {
	int ix, iy, set;
	float x, y;
	four z;
	struct sums sums;
	four number[STRESS_DEVIATOR];
};

static int halves(int n)
{
	return (n + 1) / 2;
}

static double depth_of(int k)
{
	return SHALLOWEST * (double)(1L << k);
}

/* Squares of a size but the smallest along an axis that may not be far from a tile: those
 * that it lies on, and those on either side whose nearest edge is not. */
static size_t most_near(double width)
{
	return TILE_SIDE / (2 * BLOCK) + 2 * (size_t)ceil(DEEP_FAR / width);
}

/* Memory for the lists of tiles, which hold parts of squares that are not far. */
static int new_tiles(struct point_sum *s)
{
	size_t tiles = (size_t)(s->par.nx + TILE_SIDE - 1) / TILE_SIDE;
	size_t fours = most_near(s->dx) * most_near(s->dy);
	size_t loads = fours * (size_t)s->sizes;

	s->tiles = (int)tiles;
	s->tile = calloc(tiles, sizeof *s->tile);
	s->block = malloc(4 * fours * tiles * sizeof *s->block);
	s->loads = malloc((FOURS + 1) * loads * tiles * sizeof *s->loads);
	for (size_t i = 0; s->tile && s->block && s->loads && i < tiles; i++) {
		s->tile[i].block = s->block + 4 * fours * i;
		for (size_t k = 0; k <= FOURS; k++)
			s->tile[i].far[k].loads =
				s->loads + ((FOURS + 1) * i + k) * loads;
	}
	return s->tile && s->block && s->loads;
}

struct point_sum *point_sum_new(const struct stress_par *par)
{
	struct point_sum *s = calloc(1, sizeof *s);
	size_t count = 0, blocks;
	struct loads *next;

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
	s->squares = next = calloc(count, sizeof *s->squares);
	s->begin = calloc(blocks + 1, sizeof *s->begin);
	s->place = calloc((size_t)par->nx * (size_t)par->ny, 1);
	if (!next || !s->begin || !s->place || !new_tiles(s)) {
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
	free(s->loads);
	free(s->block);
	free(s);
}

double point_sum_depth(const struct point_sum *s, int k)
{
	return k < 0 ? 0 : s->cell * depth_of(k);
}

int point_sum_above(const struct point_sum *s, double z)
{
	double k = log2(z / point_sum_depth(s, 0));

	return k > 0 ? (int)k : 0;
}

static float centre(int cell, float width)
{
	return ((float)cell + 0.5f) * width;
}

static inline four all_four(float x)
{
	return (four){ x, x, x, x };
}

static inline float sum_four(four x)
{
	return (x[0] + x[1]) + (x[2] + x[3]);
}

static double pressure_at(const struct point_sum *s, int x, int y)
{
	return s->pressure[(size_t)y * (size_t)s->par.nx + (size_t)x];
}

static void put_square(
	const struct size *size, int x, int y, float load, float sum_x, float sum_y)
{
	struct loads *to = &size->square[y / 2 * size->nx + x / 2];
	int i = y % 2 * 2 + x % 2;

	to->load[i] = load;
	to->x[i] = sum_x / load;
	to->y[i] = sum_y / load;
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

/* Lists the loaded cells of a smallest square and adds them up; returns how many cells
 * are listed now. */
static size_t list_cells(struct point_sum *s, int block_x, int block_y, size_t n)
{
	int x0 = block_x * BLOCK, y0 = block_y * BLOCK;
	int x1 = lesser_int(x0 + BLOCK, s->par.nx),
	    y1 = lesser_int(y0 + BLOCK, s->par.ny);
	double load = 0, sum_x = 0, sum_y = 0;

	for (int y = y0; y < y1; y++)
		for (int x = is_free(s, x0, y, x1 - x0) ? x1 : x0; x < x1; x++) {
			double p = pressure_at(s, x, y);

			if (!(p > 0))
				continue;
			s->place[n++] = (unsigned char)((y - y0) * BLOCK + x - x0);
			load += p;
			sum_x += p * centre(x, s->dx);
			sum_y += p * centre(y, s->dy);
		}
	if (load > 0)
		put_square(s->size, block_x, block_y, (float)(load * s->share),
			(float)(sum_x * s->share), (float)(sum_y * s->share));
	return n;
}

static double total_of(const double *x, size_t n)
{
	lanes sum = lanes_all(0);

	for (size_t i = 0; i < n; i += 2)
		lanes_add(&sum, lanes_load(x + i, i + 1 < n ? 2 : 1), i + 1 < n ? 2 : 1);
	return sum[0] + sum[1];
}

void point_sum_load(struct point_sum *s, const double *pressure)
{
	size_t n = 0, block = 0, count = 0;

	s->pressure = pressure;
	s->total = total_of(pressure, (size_t)s->par.nx * (size_t)s->par.ny);
	s->share = (double)s->dx * s->dy / (2 * M_PI * s->total);
	for (int l = 0; l < s->sizes; l++)
		count += (size_t)s->size[l].nx * (size_t)s->size[l].ny;
	memset(s->squares, 0, count * sizeof *s->squares);
	for (int i = 0; i < s->tiles; i++)
		s->tile[i].row = -1;
	for (int y = 0; y < s->ny; y++)
		for (int x = 0; x < s->nx; x++) {
			s->begin[block++] = n;
			n = list_cells(s, x, y, n);
		}
	s->begin[block] = n;
	for (struct size *size = s->size; size + 1 < s->size + s->sizes; size++)
		for (int i = 0; i < size->nx * size->ny; i++) {
			const struct loads *q = &size->square[i];
			float load = sum_four(q->load);

			if (load > 0)
				put_square(size + 1, i % size->nx, i / size->nx, load,
					sum_four(q->load * q->x),
					sum_four(q->load * q->y));
		}
}

/* 1 / sqrt(x) to 5e-6: a line through the logarithm, which the bits of a float are
 * nearly, and two steps of Newton's method. */
static inline four inverse_root(four x)
{
	four y = (four)(0x5f375a86 - ((four_bits)x >> 1)), half = 0.5f * x;

	y *= 1.5f - half * y * y;
	return y * (1.5f - half * y * y);
}

/* Pressure and friction of a point as stress_point() gives them. */
static inline void sum_one(
	float x, float y, float p, four z, float k, float mu, struct sums *t)
{
	four r2 = (x * x + y * y) + z * z, ir = inverse_root(r2), r = r2 * ir;
	four id = 1 / (r + z), ir2 = ir * ir, ir3 = ir2 * ir, h = k * ir * id * id;
	four f = 3 * ir3 * ir2, g = h * ir2, zz = f * (z + mu * x) * z;
	four m = g * (2 * r + z) - f * z + mu * x * (g * id * (3 * r + z) - f);
	four l = k * (z * ir3 - ir * id) + mu * x * (k * ir3 - h) + zz * z;

	h *= mu;
	t->xx += p * (x * (m * x - 2 * h) + l);
	t->yy += p * (y * y * m + l);
	t->xy += p * y * (m * x - h);
	zz *= p;
	t->xz -= zz * x;
	t->yz -= zz * y;
}

/* Those of a list, u and v farther away. */
static void add_list(const struct point_sum *s, const struct list *l, float u, float v,
	struct point *at)
{
	float k = (float)(1 - 2 * s->par.nu), mu = (float)s->par.mu;
	struct sums t = at->sums;

	for (int i = 0; i < l->count; i++) {
		const struct loads *p = &l->loads[i / 4];

		sum_one(p->x[i % 4] + u, p->y[i % 4] + v, p->load[i % 4], at->z, k, mu,
			&t);
	}
	at->sums = t;
}

/* The same as far as it is linear in the depth, four points at a time. */
static void add_flat(const struct point_sum *s, const struct list *l, float u, float v,
	struct point *at)
{
	float k = (float)(1 - 2 * s->par.nu), mu = (float)s->par.mu;
	struct sums t = { .xx = all_four(0) }, rise = t; /* on the surface, and per cell
							  */

	for (int i = 0; i < l->count; i += 4) {
		four x = l->loads[i / 4].x + u, y = l->loads[i / 4].y + v;
		four p = l->loads[i / 4].load, ir = inverse_root(x * x + y * y);
		four ir2 = ir * ir, kir2 = k * ir2, h = kir2 * ir, g = 2 * h * ir;
		four f = 3 * ir2 * ir2 * ir, mx = mu * x, q = p * f * mx;
		four m = g + mx * (3 * h * ir2 - f),
		     n = -3 * h * ir2 - f - 4 * mx * g * ir2;
		four px = p * x, py = p * y;

		t.xx += px * (m * x - 2 * mu * h) - p * kir2;
		t.yy += py * m * y - p * kir2;
		t.xy += py * (m * x - mu * h);
		rise.xx += px * n * x + p * (2 * h + 3 * mx * g);
		rise.yy += py * n * y + p * (2 * h + mx * g);
		rise.xy += py * (n * x + mu * g);
		rise.xz -= q * x;
		rise.yz -= q * y;
	}
	at->sums.xx += sum_four(t.xx) + at->z * sum_four(rise.xx);
	at->sums.yy += sum_four(t.yy) + at->z * sum_four(rise.yy);
	at->sums.xy += sum_four(t.xy) + at->z * sum_four(rise.xy);
	at->sums.xz += at->z * sum_four(rise.xz);
	at->sums.yz += at->z * sum_four(rise.yz);
}

static void add_point(
	const struct point_sum *s, struct point *at, float load, float x, float y)
{
	float u = at->x - x, v = at->y - y;

	sum_one(s->par.axis ? v : u, s->par.axis ? u : v, load, at->z,
		(float)(1 - 2 * s->par.nu), (float)s->par.mu, &at->sums);
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

		for (int c = 0; c < STRESS_DEVIATOR; c++)
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
static void add_element(struct point_sum *s, struct point *at, float load, int i, int j)
{
	const four *element;

	if (!s->known[at->set])
		know_elements(s, at->set);
	element = s->element[at->set][AROUND + i][AROUND + j];
	for (int c = 0; c < STRESS_DEVIATOR; c++)
		at->number[c] += load * element[c];
}

/* A smallest square, or its cells one by one. */
static void add_block(struct point_sum *s, struct point *at, const struct block *b)
{
	const float far = (float)FAR * BLOCK, near = (float)NEAR;
	float u = at->x - b->x, v = at->y - b->y, z2 = at->z[0] * at->z[0];
	int block = b->iy / BLOCK * s->nx + b->ix / BLOCK;

	if (u * u + v * v + 0.25f * z2 >= far * far) {
		add_point(s, at, b->load, b->x, b->y);
		return;
	}
	for (size_t n = s->begin[block]; n < s->begin[block + 1]; n++) {
		int ix = b->ix + s->place[n] % BLOCK, iy = b->iy + s->place[n] / BLOCK;
		int i = at->ix - ix, j = at->iy - iy;
		float load = (float)(s->share * pressure_at(s, ix, iy));

		if ((float)(i * i + j * j) + z2 < near * near)
			add_element(s, at, load, i, j);
		else
			add_point(s, at, load, centre(ix, s->dx), centre(iy, s->dy));
	}
}

/* Tiles */

/* From points to the nearest edge of a tile along an axis. */
static inline four beyond(four away, float half)
{
	four x = (four)((four_bits)away & 0x7fffffff) - half;

	return (four)((four_bits)x & (x > 0));
}

static void list_far(const struct point_sum *s, struct tile *t, float load, float x,
	float y, float square)
{
	struct list *l = t->far;
	struct loads *to;

	for (float z = (float)FLAT; l < t->far + FOURS && square >= z * z;
		z *= 1 << POINT_SUM_DEPTHS)
		l++;
	to = &l->loads[l->count / 4];
	if (l->count % 4 == 0) /* the last four may remain loads of 0, outside the tile */
		*to = (struct loads){ .x = all_four(2 * TILE_SIDE) };
	to->x[l->count % 4] = s->par.axis ? y : x;
	to->y[l->count % 4] = s->par.axis ? x : y;
	to->load[l->count++ % 4] = load;
}

/* Two by two squares of size l, or those that they consist of. */
static void list_squares(const struct point_sum *s, struct tile *t, int l, int x, int y)
{
	const struct size *size = &s->size[l];
	const struct loads *q = &size->square[y * size->nx + x];
	const float far = t->apart * size->side;
	four away_x = t->x - q->x, away_y = t->y - q->y;
	four u = beyond(away_x, t->half_x), v = beyond(away_y, t->half_y);
	four square = u * u + v * v;

	for (int i = 0; i < 4; i++) {
		int ix = 2 * x + i % 2, iy = 2 * y + i / 2;

		if (!(q->load[i] > 0))
			continue;
		if (square[i] >= far * far)
			list_far(s, t, q->load[i], away_x[i], away_y[i], square[i]);
		else if (l > 0)
			list_squares(s, t, l - 1, ix, iy);
		else
			t->block[t->near++] = (struct block){ q->x[i], q->y[i],
				q->load[i], ix * BLOCK, iy * BLOCK };
	}
}

static const struct tile *tile_of(struct point_sum *s, const struct point *at)
{
	int column = at->ix / TILE_SIDE, row = at->iy / TILE_SIDE;
	float apart = (float)(at->set < FOURS ? TILE_FAR : DEEP_FAR);
	struct tile *t = &s->tile[column];

	if (t->row != row || t->apart != apart) {
		t->row = row;
		t->apart = apart;
		t->half_x = 0.5f * TILE_SIDE * s->dx;
		t->half_y = 0.5f * TILE_SIDE * s->dy;
		t->x = centre(column, TILE_SIDE * s->dx);
		t->y = centre(row, TILE_SIDE * s->dy);
		t->near = 0;
		for (int i = 0; i <= FOURS; i++)
			t->far[i].count = 0;
		list_squares(s, t, s->sizes - 1, 0, 0);
	}
	return t;
}

static void add_loads(struct point_sum *s, struct point *at)
{
	const struct tile *t = tile_of(s, at);
	float u = at->x - t->x, v = at->y - t->y;

	for (int i = 0; i <= FOURS; i++)
		(i > at->set ? add_flat : add_list)(
			s, &t->far[i], s->par.axis ? v : u, s->par.axis ? u : v, at);
	for (int i = 0; i < t->near; i++)
		add_block(s, at, &t->block[i]);
}

void point_sum_at(
	struct point_sum *s, size_t cell, int k, double stress[POINT_SUM_DEPTHS])
{
	const struct stress_par *g = &s->par;
	const struct stress_criterion *criterion =
		g->criterion ? g->criterion : &stress_von_mises_criterion;
	struct point at = { .ix = (int)(cell % (size_t)g->nx),
		.iy = (int)(cell / (size_t)g->nx),
		.set = k / POINT_SUM_DEPTHS };
	const struct sums *t = &at.sums;
	float of_element = 2 * (float)M_PI / (s->dx * s->dy);

	at.x = centre(at.ix, s->dx);
	at.y = centre(at.iy, s->dy);
	for (int d = 0; d < POINT_SUM_DEPTHS; d++)
		at.z[d] = (float)depth_of(k + d);
	add_loads(s, &at);
	for (int c = 0; c < STRESS_DEVIATOR; c++)
		at.number[c] *= of_element;
	at.number[DEV_X] += g->axis ? t->yy : t->xx;
	at.number[DEV_Y] += g->axis ? t->xx : t->yy;
	at.number[DEV_XY] += t->xy;
	at.number[DEV_XZ] += g->axis ? t->yz : t->xz;
	at.number[DEV_YZ] += g->axis ? t->xz : t->yz;
	for (int d = 0; d < POINT_SUM_DEPTHS; d++) {
		double number[STRESS_DEVIATOR];

		for (int c = 0; c < STRESS_DEVIATOR; c++)
			number[c] = s->total * at.number[c][d];
		stress[d] = criterion->value(number);
	}
}
