/* Particles of known shape: measures, connectivity, memory of two layers, periodic grids.
 */
#include "debris/particles.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>

typedef int (*shape)(double x, double y, double z);

/* Stretches of the cells of a mask [z][y][x], so high. */
static size_t find(struct particles *ps, const unsigned char *mask, int nx, int ny,
	int nz, double dz, const struct particle **list)
{
	size_t columns = (size_t)nx * (size_t)ny, count = 0, n;
	struct stretch *s = malloc((columns * (size_t)nz + 1) * sizeof *s);

	/* In the order of layers, as a search from the surface down finds them. */
	for (int z = 0; z < nz; z++)
		for (size_t i = 0; i < columns; i++) {
			int end = z;

			if (!mask[(size_t)z * columns + i] ||
				(z && mask[(size_t)(z - 1) * columns + i]))
				continue;
			while (end < nz && mask[(size_t)end * columns + i])
				end++;
			s[count++] = (struct stretch){ i, z * dz, end * dz };
		}
	particles_find(ps, s, count, list, &n);
	free(s);
	return n;
}

/* Particles of the cells whose centres are in the shape. */
static size_t scan(struct particles *ps, int nx, int ny, int nz, double dz, shape in,
	const struct particle **list)
{
	unsigned char *mask = malloc((size_t)nx * (size_t)ny * (size_t)nz);
	size_t n;

	for (int z = 0; z < nz; z++)
		for (int y = 0; y < ny; y++)
			for (int x = 0; x < nx; x++)
				mask[(z * ny + y) * nx + x] =
					(unsigned char)in(x + 0.5, y + 0.5, z + 0.5);
	n = find(ps, mask, nx, ny, nz, dz, list);
	free(mask);
	return n;
}

/* Cells of a particle, by its volume. */
static double cells(const struct particle *p, const struct particles_par *par)
{
	return round(p->volume / (par->dx * par->dy * par->dz));
}

static int box(double x, double y, double z)
{
	return x > 3 && x < 10 && y > 2 && y < 5 && z > 1 && z < 3;
}

static void test_box(void)
{
	struct particles_par par = { .nx = 16, .ny = 12, .dx = 2, .dy = 1, .dz = 0.5 };
	struct particles *ps = particles_new(&par);
	const struct particle *p;

	/* 7 x 3 x 2 cells: 14 x 3 x 1 in length. */
	ok(scan(ps, 16, 12, 6, par.dz, box, &p) == 1, "a box is one particle");
	near(cells(p, &par), 42, 0, "box: the number of cells is right");
	near(p->volume, 42, 0, "box: the volume is right");
	near(p->diameter, cbrt(6 * 42 / M_PI), 1e-14,
		"box: the equivalent diameter is right");
	near(p->area, 2 * (14 * 3 + 14 + 3), 1e-12, "box: the area is that of its faces");
	near(p->length, sqrt(14 * 14 + 9 + 1), 1e-12,
		"box: the length is the largest Feret diameter");
	near(p->width, sqrt(3 * 3 + 1), 0.2,
		"box: the width is the largest chord perpendicular to it");
	near(p->solidity, 1, 1e-14, "box: the solidity is 1");
	near(p->elongation, 1 - 3. / 14, 1e-12,
		"box: the elongation follows from its two longest sides");
	near(p->azimuth, 0, 1e-12, "box: the azimuth is right");
	near(p->dip, 0, 1e-12, "box: the dip is right");
	near(p->x, 13, 1e-12, "box: the centroid is right in x");
	near(p->y, 3.5, 1e-12, "box: the centroid is right in y");
	near(p->z, 1, 1e-12, "box: the centroid is right in z");
	ok(p->low[0] == 6 && p->high[0] == 20 && p->low[1] == 2 && p->high[1] == 5 &&
			p->low[2] == 0.5 && p->high[2] == 1.5,
		"box: the bounding box is right");
	ok(p->first[0] == 3 && p->first[1] == 2, "box: the address is its first column");
	particles_free(ps);
}

static int cube(double x, double y, double z)
{
	return (int)x == 2 && (int)y == 2 && (int)z == 0;
}

static void test_cube(void)
{
	struct particles_par par = { .nx = 5, .ny = 5, .dx = 1, .dy = 1, .dz = 1 };
	struct particles *ps = particles_new(&par);
	const struct particle *p;

	scan(ps, 5, 5, 1, par.dz, cube, &p);
	near(p->length, sqrt(3), 1e-15, "cube: the length is the space diagonal");
	/* Half-way along its diagonal its section is a regular hexagon of side 1/sqrt(2);
	 * the corners lie at a third and two thirds, with triangles of side sqrt(2). */
	near(p->width, sqrt(2), 1e-15, "cube: the width is the diagonal of a face");
	near(p->aspect, sqrt(1.5), 1e-15, "cube: the aspect ratio is right");
	near(p->elongation, 0, 1e-12, "cube: the elongation is 0");
	ok(isnan(p->azimuth) && isnan(p->dip), "cube: the direction is missing");
	particles_free(ps);
}

enum { R = 20 };

static int ball(double x, double y, double z)
{
	x -= R + 1, y -= R + 1, z -= R + 1;
	return x * x + y * y + z * z < R * R;
}

static void test_ball(void)
{
	int n = 2 * R + 2;
	struct particles_par par = { .nx = n, .ny = n, .dx = 1, .dy = 1, .dz = 1 };
	struct particles *ps = particles_new(&par);
	const struct particle *p;

	ok(scan(ps, n, n, n, par.dz, ball, &p) == 1, "a ball is one particle");
	/* Cells stand out by up to half a diagonal: 0.87 of the radius 20. */
	near(p->diameter, 2 * R, 0.1, "ball: the equivalent diameter is right");
	near(p->length, 2 * R, 1.8, "ball: the length is the diameter");
	near(p->aspect, 1, 0.02, "ball: the aspect ratio is 1");
	near(p->elongation, 0, 1e-9, "ball: the elongation is 0");
	near(p->area / (4 * M_PI * R * R), 1.5, 0.03,
		"ball: the exposed faces are 3/2 of the sphere");
	ok(p->solidity < 1 && p->solidity > 0.9, "ball: the solidity %g is below 1",
		p->solidity);
	near(p->x, R + 1, 1e-9, "ball: the centroid is the centre");
	particles_free(ps);
}

/* A rod along (1, 1, 0) that dips: cells around a line. */
static int rod(double x, double y, double z)
{
	double d[3] = { cos(0.6) * cos(0.4), sin(0.6) * cos(0.4), sin(0.4) };
	double u[3] = { x - 30, y - 30, z - 20 };
	double t = u[0] * d[0] + u[1] * d[1] + u[2] * d[2];
	double r = u[0] * u[0] + u[1] * u[1] + u[2] * u[2] - t * t;

	return fabs(t) < 24 && r < 9;
}

static void test_rod(void)
{
	struct particles_par par = { .nx = 60, .ny = 60, .dx = 1, .dy = 1, .dz = 1 };
	struct particles *ps = particles_new(&par);
	const struct particle *p;

	ok(scan(ps, 60, 60, 40, par.dz, rod, &p) == 1, "a slanted rod is one particle");
	near(p->azimuth, 0.6, 0.01, "rod: the azimuth is right");
	near(p->dip, 0.4, 0.01, "rod: the dip is right");
	/* Length 48, width 6: the diagonal and a cell more. */
	near(p->length, 48.4, 1.5, "rod: the length is right");
	ok(p->aspect > 6.5 && p->aspect < 8,
		"rod: the aspect ratio %g is between 6.5 and 8", p->aspect);
	/* Moments 48^2/12 and 3^2/4. */
	near(p->elongation, 1 - sqrt(9. / 4 / 192), 0.01, "rod: the elongation is right");
	particles_free(ps);
}

/* A flat bar with its own signs of direction and a place on the grid; periods of the grid
 * are added so that it may lie across its border. */
static struct pose {
	double x, y, z, azimuth, dip;
	int nx, ny; /* of a periodic grid, or 0 */
	int cubes;  /* cells are cubes */
	double along[3], across[3];
} pose;

static int bar_at(double x, double y, double z)
{
	const double *d = pose.along, *side = pose.across;
	double u[3] = { x - pose.x, y - pose.y, z - pose.z };

	if (u[0] * u[0] + u[1] * u[1] + u[2] * u[2] > 16 * 16)
		return 0;
	double along = u[0] * d[0] + u[1] * d[1] + u[2] * d[2];
	double across = u[0] * side[0] + u[1] * side[1];
	double up =
		u[0] * u[0] + u[1] * u[1] + u[2] * u[2] - along * along - across * across;

	return fabs(along) < 15 && fabs(across) < 4 && up < 5;
}

static int bar(double x, double y, double z)
{
	for (int i = -1; i <= 1; i++)
		for (int j = -1; j <= 1; j++)
			if ((pose.nx || (!i && !j)) &&
				bar_at(x + i * pose.nx, y + j * pose.ny, z))
				return 1;
	return 0;
}

/* The bar of a pose; all measures except those of its position are compared. */
static struct particle measured_bar(int nx, int ny, struct pose p)
{
	struct particles_par par = { .nx = nx, .ny = ny, .dx = 1.5, .dy = 1, .dz = 0.5 };
	const struct particle *list;
	struct particles *ps;
	struct particle got = { .columns = 0 };

	par.periodic = p.nx > 0;
	if (p.cubes)
		par.dx = par.dz = 1;
	ps = particles_new(&par);
	pose = p;
	pose.along[0] = cos(p.azimuth) * cos(p.dip);
	pose.along[1] = sin(p.azimuth) * cos(p.dip);
	pose.along[2] = sin(p.dip);
	pose.across[0] = -sin(p.azimuth);
	pose.across[1] = cos(p.azimuth);
	if (scan(ps, nx, ny, 40, par.dz, bar, &list) == 1)
		got = list[0];
	particles_free(ps);
	return got;
}

static int same(double a, double b)
{
	return fabs(a - b) <= 1e-13 * fabs(b);
}

static int same_shape(const struct particle *a, const struct particle *b)
{
	return a->columns == b->columns && same(a->volume, b->volume) &&
	       same(a->area, b->area) && same(a->length, b->length) &&
	       same(a->width, b->width) && same(a->aspect, b->aspect) &&
	       same(a->elongation, b->elongation) && same(a->solidity, b->solidity) &&
	       same(a->dip, b->dip);
}

static void test_pose(void)
{
	struct pose p = { .x = 20, .y = 20, .z = 20 }, q;
	struct particle here, there;
	int bad = 0, out = 0, mirrored = 0, far = 0, over = 0;
	double off = 0;

	for (int k = 0; k < 40; k += 3) {
		p.azimuth = -1.5 + 0.075 * k;
		p.dip = 1.3 * sin(3. * k);
		here = measured_bar(40, 40, p);
		bad += here.columns < 30;
		out += !(here.dip >= 0 && here.dip <= M_PI / 2);
		q = p;
		q.cubes = 1;
		there = measured_bar(40, 40, q);
		off = tap_max(off, acos(cos(there.dip) * cos(p.dip) *
						   cos(there.azimuth - p.azimuth) +
					   sin(there.dip) * sin(fabs(p.dip))));
		q = p;
		q.azimuth = -p.azimuth;
		there = measured_bar(40, 40, q);
		mirrored +=
			!same_shape(&here, &there) || !same(here.azimuth, -there.azimuth);
		q.dip = -p.dip;
		there = measured_bar(40, 40, q);
		mirrored +=
			!same_shape(&here, &there) || !same(here.azimuth, -there.azimuth);
		q = p;
		q.x += 1000;
		there = measured_bar(1040, 40, q);
		far += !same_shape(&here, &there) || !same(here.azimuth, there.azimuth);
		q = p;
		q.nx = q.ny = 40;
		q.x = 39 - k, q.y = k;
		there = measured_bar(40, 40, q);
		over += !same_shape(&here, &there) ||
			!same(here.azimuth, there.azimuth) ||
			fabs(there.x - 1.5 * (19 - k < 0 ? 59 - k : 19 - k) -
				(here.x - 30)) > 60 ||
			!(there.x >= 0 && there.x < 60 && there.y >= 0 && there.y < 40);
	}
	ok(bad == 0, "bars of 14 directions are one particle each");
	ok(out == 0, "their dips are from 0 to pi/2");
	ok(off < 0.03, "their directions are those of the bars, in cubes to %.3f", off);
	ok(mirrored == 0,
		"mirrored bars have mirrored directions and the same shape (%d do not)",
		mirrored);
	ok(far == 0, "a bar 1000 cells further has the same row (%d have not)", far);
	ok(over == 0,
		"a bar has the same row across the border of a periodic grid, with its centroid on the grid (%d have not)",
		over);
}

/* Four equal cubes: in order of y and x. */
static int equals(double x, double y, double z)
{
	return ((int)x == 6 && (int)y == 1 && (int)z == 1) ||
	       ((int)x == 1 && (int)y == 4 && (int)z == 0) ||
	       ((int)x == 5 && (int)y == 4 && (int)z == 0) ||
	       ((int)x == 7 && (int)y == 2 && (int)z == 0);
}

/* Three equal cells, one below the other. */
static int shelf(double x, double y, double z)
{
	(void)y;
	return (int)x == 1 && (int)z % 3 == 0;
}

static void test_order(void)
{
	static const int want[4][2] = { { 6, 1 }, { 7, 2 }, { 1, 4 }, { 5, 4 } };
	struct particles_par par = { .nx = 9, .ny = 6, .dx = 1, .dy = 1, .dz = 1 };
	struct particles *ps = particles_new(&par);
	const struct particle *p;
	int bad = scan(ps, 9, 6, 2, par.dz, equals, &p) != 4;

	for (int i = 0; i < 4 && !bad; i++)
		for (int k = 0; k < 2; k++)
			bad += p[i].first[k] != want[i][k];
	ok(bad == 0, "equal particles come in order of their first cells");
	bad = scan(ps, 3, 1, 9, par.dz, shelf, &p) != 3;
	for (int i = 0; i < 3 && !bad; i++)
		bad += p[i].low[2] != 3 * i;
	ok(bad == 0, "equal particles of one column come in order of their depth");
	particles_free(ps);
}

/* Stripes that wind about a torus: 3 periods of x for one of y, then a straight ridge. */
static int stripe(double x, double y, double z)
{
	(void)z;
	return ((int)x + 3 * (int)(y / 2)) % 24 < 4;
}

static int ring(double x, double y, double z)
{
	return (int)y == 3 && z < 2 && x >= 0;
}

static void test_endless(void)
{
	struct particles_par par = {
		.nx = 24, .ny = 16, .dx = 1, .dy = 1, .dz = 1, .periodic = 1
	};
	struct particles *ps = particles_new(&par);
	const struct particle *p;

	ok(scan(ps, 24, 16, 1, par.dz, stripe, &p) == 1 && p->endless && p->columns == 64,
		"a stripe that winds about a periodic grid is endless");
	ok(isnan(p->length) && isnan(p->width) && isnan(p->solidity) &&
			isnan(p->azimuth) && isnan(p->elongation) && isnan(p->x) &&
			isnan(p->y) && p->volume == 64,
		"an endless stripe has a volume per period and no shape");
	ok(p->low[0] == 0 && p->high[0] == 24 && p->low[1] == 0 && p->high[1] == 16,
		"the bounding box of an endless stripe is the grid");
	ok(scan(ps, 24, 16, 2, par.dz, ring, &p) == 1 && p->endless && isnan(p->x),
		"a straight ridge across the grid is endless");
	near(p->y, 3.5, 1e-15, "an endless ridge has a centroid across its direction");
	near(p->area, 2 * 24 * 3, 0,
		"the area of an endless ridge is that of one period");
	ok(p->low[1] == 3 && p->high[1] == 4,
		"the bounding box of an endless ridge has its width");
	particles_free(ps);
	par.periodic = 0;
	ps = particles_new(&par);
	ok(scan(ps, 24, 16, 2, par.dz, ring, &p) == 1 && !p->endless,
		"on a free grid the same cells are a bar");
	particles_free(ps);
}

/* Two arms that meet only at the bottom, and a third that does not. */
static int fork(double x, double y, double z)
{
	if (y < 3 || y > 4)
		return 0;
	if (z > 7)
		return x > 1 && x < 8;
	return (x > 1 && x < 2) || (x > 7 && x < 8) || (x > 9 && x < 10);
}

static void test_fork(void)
{
	struct particles_par par = { .nx = 12, .ny = 8, .dx = 1, .dy = 1, .dz = 1 };
	struct particles *ps = particles_new(&par);
	const struct particle *p;

	ok(scan(ps, 12, 8, 8, par.dz, fork, &p) == 2,
		"arms that meet below the surface are one particle");
	near(cells(&p[0], &par), 7 + 7 + 7, 0, "fork: the number of cells is right");
	near(cells(&p[1], &par), 7, 0, "free arm: the number of cells is right");
	near(p[0].solidity, 21. / 56, 1e-14, "fork: the solidity is right");
	near(p[0].area,
		2 * (7 * 8 - 5 * 7) + 2 * 8 + 4 * 7 - 2 * 7 + 5 * 2 + 2 * 2 + 2 * 7 - 14,
		0, "fork: the area is right");
	particles_free(ps);
}

static int checker(double x, double y, double z)
{
	return ((int)x + (int)y + (int)z) % 2;
}

/* Corner neighbours of a layer are separated or joined as requested. */
static void test_corners(void)
{
	struct particles_par par = { .nx = 31, .ny = 17, .dx = 1, .dy = 1, .dz = 1 };
	struct particles *ps = particles_new(&par);
	const struct particle *p;
	size_t n = scan(ps, 31, 17, 9, par.dz, checker, &p);

	ok(n == 31 * 17 * 9 / 2, "a checkerboard falls into single cells");
	ok(cells(&p[n - 1], &par) == 1, "each particle of a checkerboard has one cell");
	particles_free(ps);
	par.corners = 1;
	ps = particles_new(&par);
	ok(scan(ps, 31, 17, 1, par.dz, checker, &p) == 1,
		"joined over corners a checkerboard is one particle");
	particles_free(ps);
}

static int wrapped(double x, double y, double z)
{
	(void)z;
	return (x < 2 || x > 7) && (y < 1 || y > 5);
}

static void test_periodic(void)
{
	struct particles_par par = {
		.nx = 10, .ny = 8, .dx = 1, .dy = 1, .dz = 1, .periodic = 1
	};
	struct particles *ps = particles_new(&par);
	const struct particle *p;

	/* 5 x 4 cells around the corner of the grid: from 7 to 12 and from 5 to 9. */
	ok(scan(ps, 10, 8, 2, par.dz, wrapped, &p) == 1,
		"periodic: a body over the corner of the grid is one particle");
	near(cells(p, &par), 40, 0, "periodic: the number of cells is right");
	near(p->length, sqrt(25 + 16 + 4), 1e-12, "periodic: the length is right");
	near(p->area, 2 * (20 + 8 + 10), 1e-12, "periodic: the area is right");
	near(p->solidity, 1, 1e-12, "periodic: the solidity is 1");
	near(p->x, 9.5, 1e-12, "periodic: the centroid is right in x");
	near(p->y, 7, 1e-12, "periodic: the centroid is right in y");
	near(p->low[0], 7, 1e-12, "periodic: the bounding box is right");
	particles_free(ps);
}

/* Against a flood fill on random sets, all connectivities. */
static size_t flood(unsigned char *c, int nx, int ny, int nz, int corners, int periodic)
{
	int *stack = malloc(sizeof *stack * (size_t)nx * (size_t)ny * (size_t)nz);
	size_t count = 0;

	for (int i = 0; i < nx * ny * nz; i++) {
		int top = 0;

		if (!c[i])
			continue;
		count++;
		c[i] = 0;
		stack[top++] = i;
		while (top) {
			int at = stack[--top], x = at % nx, y = at / nx % ny,
			    z = at / nx / ny;

			for (int d = 0; d < 27; d++) {
				int dx = d % 3 - 1, dy = d / 3 % 3 - 1, dz = d / 9 - 1;
				int u = x + dx, v = y + dy, w = z + dz;

				if (abs(dx) + abs(dy) + abs(dz) != 1 &&
					!(corners && dz == 0 && dx && dy))
					continue;
				if (periodic) {
					u = (u + nx) % nx;
					v = (v + ny) % ny;
				}
				if (u < 0 || u >= nx || v < 0 || v >= ny || w < 0 ||
					w >= nz)
					continue;
				if (c[(w * ny + v) * nx + u]) {
					c[(w * ny + v) * nx + u] = 0;
					stack[top++] = (w * ny + v) * nx + u;
				}
			}
		}
	}
	free(stack);
	return count;
}

static void test_random(void)
{
	int bad = 0, cells = 0;
	unsigned state = 1;

	for (int trial = 0; trial < 200; trial++) {
		int nx = 1 + trial % 13, ny = 1 + trial % 7, nz = 1 + trial % 5;
		struct particles_par par = { .nx = nx,
			.ny = ny,
			.dx = 1,
			.dy = 1,
			.dz = 1,
			.corners = trial % 2,
			.periodic = trial / 2 % 2 };
		struct particles *ps = particles_new(&par);
		const struct particle *p;
		unsigned char *c = malloc((size_t)(nx * ny * nz));
		size_t n, nodes = 0, sum = 0;

		for (int i = 0; i < nx * ny * nz; i++) {
			state = state * 1664525 + 1013904223;
			c[i] = (state >> 16) % 10 < 3u + (unsigned)trial % 4;
			nodes += c[i];
		}
		n = find(ps, c, nx, ny, nz, 1, &p);
		for (size_t i = 0; i < n; i++) {
			sum += (size_t)round(p[i].volume);
			bad += !(p[i].endless
					 ? isnan(p[i].length)
					 : p[i].length > 0 && p[i].solidity <= 1 + 1e-12);
		}
		bad += sum != nodes ||
		       n != flood(c, nx, ny, nz, trial % 2, trial / 2 % 2);
		cells += (int)nodes;
		free(c);
		particles_free(ps);
	}
	ok(bad == 0 && cells > 1000, "200 random sets agree with a flood fill (%d wrong)",
		bad);
}

/* Patches of all sizes, as a contact has them; periodic, so that they go over the border.
 */
static void test_map(void)
{
	enum { NX = 256, NY = 192 };
	static unsigned char map[NX * NY], copy[NX * NY];
	double cells = 0;

	for (int i = 0; i < NX * NY; i++) {
		double x = 2 * M_PI * (i % NX) / NX, y = 2 * M_PI * (i / NX) / NY;
		double z = cos(3 * x + 5 * y) + cos(11 * x - 7 * y + 1) +
			   cos(19 * x + 2 * y + 2) + cos(6 * x - 23 * y + 3) +
			   cos(41 * x + 37 * y + 4);

		map[i] = z > 1.2;
		cells += map[i];
	}
	for (int rule = 0; rule < 4; rule++) {
		struct particles_par par = { .nx = NX,
			.ny = NY,
			.dx = 1,
			.dy = 1,
			.dz = 1,
			.corners = rule % 2,
			.periodic = rule / 2 };
		struct particles *ps = particles_new(&par);
		const struct particle *p;
		double nodes = 0, largest = 0;
		size_t n, want;

		memcpy(copy, map, sizeof(copy));
		want = flood(copy, NX, NY, 1, par.corners, par.periodic);
		n = find(ps, map, NX, NY, 1, 1, &p);
		for (size_t i = 0; i < n; i++) {
			nodes += p[i].volume;
			largest = tap_max(largest, p[i].volume);
		}
		ok(n == want && n > 100,
			"contact map: %zu patches are found, want %zu%s%s", n, want,
			par.corners ? ", over corners" : "",
			par.periodic ? ", over borders" : "");
		ok(nodes == cells && largest > 100,
			"contact map: all cells belong to patches of up to %g", largest);
		particles_free(ps);
	}
}

int main(void)
{
	test_box();
	test_cube();
	test_ball();
	test_rod();
	test_pose();
	test_order();
	test_endless();
	test_fork();
	test_corners();
	test_periodic();
	test_random();
	test_map();
	return tap_done();
}
