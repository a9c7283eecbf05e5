/* Stress below a surface: Hertz with friction in closed form, sums on coarse points
 * against full ones, periodic waves, nodes that may be omitted. */
#include "stress/stress.h"
#include "contact/solver.h"
#include "num/philox.h"
#include "stress/free_sum.h"
#include "stress/influence.h"
#include "stress/point_sum.h"
#include "stress/stress_kernel.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>

static struct stress_par plain(int nx, int ny, double mu)
{
	struct stress_par par = {
		.nx = nx, .ny = ny, .dx = 1, .dy = 1, .nu = 0.3, .mu = mu
	};

	return par;
}

static size_t whole_grid(const struct stress_par *par, struct stress_span *span)
{
	for (int y = 0; y < par->ny; y++)
		span[y] = (struct stress_span){ y, 0, par->nx };
	return (size_t)par->ny;
}

/* Hertz pressure p0 = a = 1 on n x n cells of side h, at their centres. */
static double *hertz(int n, double h)
{
	double *p = calloc((size_t)n * (size_t)n, sizeof *p);

	for (int i = 0; i < n * n; i++) {
		double x = (i % n + 0.5 - 0.5 * n) * h, y = (i / n + 0.5 - 0.5 * n) * h;

		p[i] = sqrt(fmax(0, 1 - x * x - y * y));
	}
	return p;
}

/* On the axis of the Hertz contact, Z = z / a. */
static double axis_mises(double Z, double nu, double mu)
{
	double zz = -1 / (1 + Z * Z);
	double rr = -(1 + nu) * (1 - Z * atan(1 / Z)) + 1 / (2 * (1 + Z * Z));
	double xz = -mu * (1 - 1.5 * Z * atan(1 / Z) + Z * Z / (2 * (1 + Z * Z)));

	return sqrt((zz - rr) * (zz - rr) + 3 * xz * xz);
}

/* An odd grid has a node on the axis. */
static double hertz_error(int n, double mu, double *surface)
{
	struct stress_par par = plain(n, n, mu);
	double *p = hertz(n, 4. / n), *m = malloc((size_t)n * (size_t)n * sizeof *m),
	       error = 0;
	struct stress_span *span = malloc((size_t)n * sizeof *span);
	struct stress *s;

	par.dx = par.dy = 4. / n;
	s = stress_new(&par);
	stress_load(s, p);
	for (int k = 0; k <= 30; k++) {
		double e;

		stress_at(s, 0.05 * k, span, whole_grid(&par, span), m);
		e = k ? fabs(m[(size_t)n * (size_t)n / 2] - axis_mises(0.05 * k, 0.3, mu))
		      : 0;
		if (k == 0)
			*surface = m[(size_t)n * (size_t)n / 2];
		if (k >= 10)
			error = tap_max(error, e);
	}
	stress_free(s);
	free(span);
	free(m);
	free(p);
	return error;
}

static void test_hertz(void)
{
	double surface, coarse, fine;

	coarse = hertz_error(65, 0.3, &surface);
	fine = hertz_error(129, 0.3, &surface);
	/* The element widens a load by h^2 / 6, against h^2 / 12 of a cell. */
	ok(fine < 2e-4,
		"Hertz with friction: the von Mises stress on the axis from a/2 on is right at 129 points to %.1e p0",
		fine);
	ok(coarse / fine > 3.3,
		"the stress converges with the square of the spacing: %.1e, %.1e", coarse,
		fine);
	/* Under the middle sxx = syy = -(1 + 2 nu)/2, szz = -1, sxz = -mu. */
	near(surface, sqrt(0.04 + 3 * 0.09), 2e-3,
		"the stress in the middle of the surface is right");
}

/* The surface of a Hertz contact with friction, radius a = 1 and p0 = 1, within 0.9 a:
 * normal stresses as in Johnson, Contact Mechanics, 3.42, those of the shear as in
 * Hamilton, Proc. Inst. Mech. Eng. 197C (1983), linear in x and y. */
static double surface_mises(double x, double y, double nu, double mu)
{
	double r2 = x * x + y * y, p = sqrt(1 - r2);
	double f = r2 > 0 ? (1 - 2 * nu) / 3 * (1 - p * p * p) / r2 : (1 - 2 * nu) / 2;
	double rr = f - p, tt = -f - 2 * nu * p, c = r2 > 0 ? x * x / r2 : 1;
	double cs = r2 > 0 ? x * y / r2 : 0, q = mu * M_PI / 8;
	double t[6];

	t[STRESS_XX] = rr * c + tt * (1 - c) - q * (4 + nu) * x;
	t[STRESS_YY] = rr * (1 - c) + tt * c - q * 3 * nu * x;
	t[STRESS_ZZ] = -p;
	t[STRESS_XY] = (rr - tt) * cs - q * (2 - nu) * y;
	t[STRESS_XZ] = -mu * p;
	t[STRESS_YZ] = 0;
	return stress_von_mises(t);
}

/* The pressure of that contact as the grid of it solves it, or at the centres of cells.
 */
static double *pressed(int n, double h)
{
	struct contact_par par = { .nx = n,
		.ny = n,
		.dx = h,
		.dy = h,
		.estar = 1,
		.tolerance = 1e-10,
		.max_iterations = 1000 };
	struct contact *c = contact_new(&par);
	double *p = calloc((size_t)n * (size_t)n, sizeof *p);
	double *height = malloc((size_t)n * (size_t)n * sizeof *height);

	/* p0 = 2 E* a / (pi R), load = 2 / 3 pi p0 a^2. */
	for (int i = 0; i < n * n; i++) {
		double x = (i % n + 0.5 - 0.5 * n) * h, y = (i / n + 0.5 - 0.5 * n) * h;

		height[i] = -M_PI / 4 * (x * x + y * y);
	}
	contact_solve(
		c, height, CONTACT_PRESSURE, 2. / 3 * M_PI / (n * h * n * h), p, NULL);
	contact_free(c);
	free(height);
	return p;
}

static double surface_error(int cells, double mu, double within, int solved)
{
	int n = 2 * cells + 8;
	struct stress_par par = plain(n, n, mu);
	double h = 1. / cells, *p = solved ? pressed(n, h) : hertz(n, h),
	       *m = malloc((size_t)n * (size_t)n * sizeof *m);
	struct stress_span *span = malloc((size_t)n * sizeof *span);
	struct stress *s;
	double error = 0;

	par.dx = par.dy = h;
	s = stress_new(&par);
	stress_load(s, p);
	stress_at(s, 0, span, whole_grid(&par, span), m);
	for (int i = 0; i < n * n; i++) {
		double x = (i % n + 0.5 - 0.5 * n) * h, y = (i / n + 0.5 - 0.5 * n) * h;

		if (x * x + y * y < within * within)
			error = tap_max(error, fabs(m[i] - surface_mises(x, y, 0.3, mu)));
	}
	stress_free(s);
	free(span);
	free(m);
	free(p);
	return error;
}

static void test_surface_order(double mu)
{
	double e10 = surface_error(10, mu, 0.6, 0), e40 = surface_error(40, mu, 0.6, 0);
	double rim = surface_error(40, mu, 0.9, 0), pressed20, pressed80;

	/* Cells of constant pressure would leave 0.13 mu h / a. */
	ok(e40 < 2e-4 * (1 + mu) && e10 / e40 > (mu > 0 ? 12 : 8),
		"the stress on the surface at friction %g is of second order within 0.6 a: %.1e, %.1e p0",
		mu, e10, e40);
	/* A root that is sampled at the centres of cells misplaces h^1.5 of load at the
	 * edge; the pressure that the cells solve for does not. */
	ok(rim < 4e-4 + 1.4e-3 * mu, "the error on the surface within 0.9 a is %.1e p0",
		rim);
	pressed20 = surface_error(20, mu, 0.9, 1);
	pressed80 = surface_error(80, mu, 0.9, 1);
	ok(pressed80 < 3e-5 + 9e-5 * mu && pressed20 / pressed80 > 11.5,
		"with a solved pressure the stress on the surface is of second order: %.1e, %.1e",
		pressed20, pressed80);
}

/* Largest stress on the plane y = 0, where and how large (1001 points, sampled). */
static void test_hertz_peak(void)
{
	enum { NODES = 257 };
	struct stress_par par = plain(NODES, NODES, 0.3);
	double h = 1. / 64, lead, trail, most = 0, x = 0, z = 0;
	double *p = hertz(NODES, h), *m = malloc(sizeof *m * NODES * NODES);
	struct stress_span row = { NODES / 2, 0, NODES };
	struct stress *s;

	par.dx = par.dy = h;
	s = stress_new(&par);
	stress_load(s, p);
	for (int k = 30; k <= 60; k++) {
		stress_at(s, 0.01 * k, &row, 1, m);
		for (int i = 0; i < NODES; i++)
			if (m[NODES / 2 * NODES + i] > most) {
				most = m[NODES / 2 * NODES + i];
				x = (i - NODES / 2) * h;
				z = 0.01 * k;
			}
	}
	near(most, 0.65975605, 2e-4,
		"at mu = 0.3 the largest stress below the surface is right");
	near(x, 0.3188, h, "the largest stress is ahead of the centre");
	near(z, 0.4282, 0.01, "the largest stress is at the reference depth");
	stress_at(s, 0, &row, 1, m);
	/* Nodes on the rim, where the pressure rises like a square root. */
	trail = m[NODES / 2 * NODES + NODES / 2 - 64];
	lead = m[NODES / 2 * NODES + NODES / 2 + 64];
	ok(trail > 1.8 * lead,
		"on the surface the stress is larger at the trailing edge (%.3f) than at the leading one (%.3f)",
		trail, lead);
	near(trail, 0.65399507, 0.05, "the stress at the trailing edge is right");
	near(lead, 0.327516568, 0.04, "the stress at the leading edge is right");
	stress_free(s);
	free(m);
	free(p);
}

/* Largest difference of sums on coarse points from full ones, over the largest pressure,
 * at depths of every kind of sum; a rough pressure, some share of it zero. */
static double coarse_error(
	struct stress_par par, double share, const struct stress_criterion *criterion)
{
	static const double depth[] = { 0, 1, 7, 13.99, 14, 20, 28, 56 };
	size_t n = (size_t)par.nx * (size_t)par.ny;
	double *p = malloc(3 * n * sizeof *p), *a = p + n, *b = a + n, error = 0;
	double side = fmax(par.dx, par.dy), most = 0;
	struct stress_span *span = malloc((size_t)par.ny * sizeof *span);
	struct stress *s, *full;

	par.criterion = criterion;
	s = stress_new(&par);
	par.method = STRESS_FULL;
	full = stress_new(&par);
	for (size_t i = 0; i < n; i++) {
		double x = 2 * M_PI * (double)(i % (size_t)par.nx) / 50,
		       y = 2 * M_PI * (double)(i / (size_t)par.nx) / 50;
		double h = cos(2 * x + 3 * y + 1) + cos(7 * x - 2 * y) + cos(5 * y) +
			   0.5 * cos(13 * x + 11 * y + 2) + 0.3 * cos(21 * x - 17 * y);

		p[i] = fmax(0, h - share);
		most = tap_max(most, p[i]);
	}
	stress_load(s, p);
	stress_load(full, p);
	for (size_t k = 0; k < sizeof(depth) / sizeof *depth; k++) {
		size_t rows = whole_grid(&par, span);

		stress_at(s, depth[k] * side, span, rows, a);
		stress_at(full, depth[k] * side, span, rows, b);
		for (size_t i = 0; i < n; i++)
			error = tap_max(error, fabs(a[i] - b[i]) / most);
	}
	stress_free(s);
	stress_free(full);
	free(span);
	free(p);
	return error;
}

static void test_coarse(void)
{
	static const char *const dense[] = { "few cells loaded",
		"half of the cells loaded" };

	for (int k = 0; k < 8; k++) {
		struct stress_par par = plain(k & 1 ? 150 : 131, k & 1 ? 97 : 160, 0.4);
		double share = k & 1 ? 0 : 1.9, error;

		par.axis = k >> 1 & 1;
		par.periodic = k >> 2 & 1;
		par.dx = 1e-6;
		par.dy = k & 1 ? 1e-6 : 1.7e-6;
		error = coarse_error(par, share, NULL);
		ok(error < 5e-6,
			"%s, %s, shear along %c: coarse sums are within %.1e of p_max",
			par.periodic ? "periodic" : "free", dense[k & 1], "xy"[par.axis],
			error);
	}
	{
		struct stress_par par = plain(120, 120, 0.4);
		double error = coarse_error(par, 1, &stress_tresca_criterion);

		ok(error < 5e-6, "coarse sums by Tresca's criterion are within %.1e",
			error);
		/* 48 cells of 280 x 150, up to 16 of them within reach of a tile */
		par = plain(280, 150, 0.4);
		error = coarse_error(par, 3.4, NULL);
		ok(error < 5e-6, "loads summed one by one are within %.1e", error);
		par = plain(80, 40, 0.2);
		par.dy = 30;
		error = coarse_error(par, 1, NULL);
		ok(error < 1e-13, "elongated cells are summed in full (%.1e)", error);
	}
}

/* Criteria against principal stresses. */
static void test_criteria(void)
{
	double mises = 0, tresca = 0, over = 0;

	for (int k = 0; k < 1000; k++) {
		double t[6], v[STRESS_DEVIATOR], p[3], a, b, c, norm = 0;

		for (int i = 0; i < 6; i++)
			t[i] = 2 * philox_uniform(
					   7, 0, RNG_NOISE, (uint64_t)(6 * k + i)) -
			       1;
		v[DEV_X] = t[STRESS_XX] - t[STRESS_ZZ],
		v[DEV_Y] = t[STRESS_YY] - t[STRESS_ZZ];
		v[DEV_XY] = t[STRESS_XY], v[DEV_XZ] = t[STRESS_XZ],
		v[DEV_YZ] = t[STRESS_YZ];
		stress_principal(t, p);
		for (int i = 0; i < 3; i++)
			norm += p[i] * p[i];
		norm = sqrt(norm);
		a = p[0] - p[1], b = p[1] - p[2], c = p[2] - p[0];
		mises = tap_max(mises, fabs(stress_von_mises_criterion.value(v) -
					       sqrt((a * a + b * b + c * c) / 2)));
		tresca = tap_max(tresca, fabs(stress_tresca_criterion.value(v) + c));
		over = tap_max(over, stress_von_mises_criterion.value(v) /
					     (stress_von_mises_criterion.norm * norm));
		over = tap_max(over, stress_tresca_criterion.value(v) /
					     (stress_tresca_criterion.norm * norm));
	}
	near(mises, 0, 1e-14,
		"von Mises' stress follows from the three differences of principal stresses");
	near(tresca, 0, 1e-14, "Tresca's stress is the largest difference");
	ok(over <= 1 && over > 0.98, "the bounds of both by the norm hold (%.4f)", over);
}

/* One loaded cell: its pyramid by quadrature of uniformly loaded cells that shrink to
 * strips, and its load from afar. */
static void test_element(void)
{
	struct influence_par par = { .dx = 1, .dy = 1, .nu = 0.3, .mu = 0.4 };
	double error = 0, far = 0;

	for (int k = 0; k < 60; k++) {
		double x = (k % 4) - 0.0, y = k / 4 % 3, z = 0.2 + 0.7 * (k / 12),
		       sum[6] = { 0 };
		struct influence f = influence_element(&par, x, y, z), g;
		int parts = 120;

		for (int i = 0; i < parts; i++)
			for (int j = 0; j < parts; j++) {
				double u = (i + 0.5) / parts * 2 - 1,
				       v = (j + 0.5) / parts * 2 - 1;
				double n[6], s[6], w = (1 - fabs(u)) * (1 - fabs(v));

				stress_patch(1. / parts, 1. / parts, 0.3, x - u, y - v, z,
					n, s);
				for (int c = 0; c < 6; c++)
					sum[c] += w * (n[c] + 0.4 * s[c]);
			}
		error = tap_max(error,
			fabs(influence_image(&par, &f, DEV_XY, 0, 0) - sum[STRESS_XY]));
		error = tap_max(error,
			fabs(influence_image(&par, &f, DEV_XZ, 0, 0) - sum[STRESS_XZ]));
		error = tap_max(error, fabs(influence_image(&par, &f, DEV_X, 0, 0) -
					       (sum[STRESS_XX] - sum[STRESS_ZZ])));
		g = influence_element(&par, 40 + x, y, 30);
		f = influence_point(&par, 40 + x, y, 30);
		far = tap_max(far, fabs(g.shear[DEV_X] / f.shear[DEV_X] - 1));
	}
	/* Parts of 1/60 of the side replace slopes by steps. */
	ok(error < 3e-4,
		"a loaded element is within %.1e of a sum over 14400 parts of it", error);
	ok(far > 0 && far < 1e-3, "a distant element acts as a point load (%.1e)", far);
}

/* No node outside the spans reaches the limit. */
static void test_reach(double mu)
{
	enum { SIDE = 96 };
	struct stress_par par = plain(SIDE, SIDE, mu);
	struct stress *s = stress_new(&par);
	double p[SIDE * SIDE] = { 0 }, m[SIDE * SIDE];
	struct stress_span *span = malloc(stress_spans_max(s) * sizeof *span), all[SIDE];
	int missed = 0;
	double nodes = 0, kept = 0, failed = 0;

	for (int k = 0; k < 40; k++)
		p[(int)(SIDE * SIDE * philox_uniform(5, 0, RNG_NOISE, (uint64_t)k))] = 1;
	stress_load(s, p);
	for (int layer = 0; layer < 6; layer++) {
		static unsigned char in[SIDE * SIDE];
		size_t n = stress_reach(s, layer, 0.2, span);

		memset(in, 0, sizeof(in));
		for (size_t i = 0; i < n; i++) {
			memset(in + span[i].y * SIDE + span[i].begin, 1,
				(size_t)(span[i].end - span[i].begin));
			kept += span[i].end - span[i].begin;
		}
		stress_at(s, layer, all, whole_grid(&par, all), m);
		for (int i = 0; i < SIDE * SIDE; i++) {
			missed += m[i] > 0.2 && !in[i];
			failed += m[i] > 0.2;
		}
		nodes += SIDE * SIDE;
	}
	ok(missed == 0 && failed > 0 && kept < nodes,
		"mu %g: the search omits no node over the limit (%.0f over, %.0f of %.0f searched)",
		mu, failed, kept, nodes);
	ok(stress_reach(s, 1000, 0.2, span) == 0,
		"far below the surface no node is searched");
	stress_free(s);
	free(span);
}

/* A wave of pressure and shear: stress at depth in closed form, and equilibrium. */
static void test_periodic(void)
{
	enum { SIDE = 32 };
	struct stress_par par = plain(SIDE, SIDE, 0);
	double p[SIDE * SIDE], t[6 * SIDE * SIDE], q = 2 * M_PI * 3 / SIDE, z = 2,
						   error = 0;
	struct stress *s;

	par.periodic = 1;
	s = stress_new(&par);
	for (int i = 0; i < SIDE * SIDE; i++)
		p[i] = 1 + cos(q * (i % SIDE));
	stress_load(s, p);
	stress_tensor(s, 2, t);
	for (int i = 0; i < SIDE * SIDE; i++) {
		double c = cos(q * (i % SIDE)), e = exp(-q * z), n = SIDE * SIDE;

		/* Plane strain (Johnson, Contact Mechanics, 13.1) on a confined mean. */
		error = tap_max(error, fabs(t[i] - (-0.3 / 0.7 - (1 - q * z) * e * c)));
		error = tap_max(error, fabs(t[(int)n + i] - (-0.3 / 0.7 - 0.6 * e * c)));
		error = tap_max(
			error, fabs(t[2 * (int)n + i] - (-1 - (1 + q * z) * e * c)));
	}
	near(error, 0, 1e-14, "the stress of a periodic wave of pressure is right");
	stress_free(s);
}

/* A periodic grid whose load sits in a small patch feels its images weakly: near the
 * patch the free half-space must come out.  Loads are smooth, as the series is. */
static void test_periodic_free(double mu, int axis)
{
	enum { SIDE = 128, MID = SIDE / 2 };
	struct stress_par par = plain(SIDE, SIDE, mu);
	size_t n = SIDE * SIDE;
	double *p = calloc(n, sizeof *p), *a = malloc(12 * n * sizeof *a), *b = a + 6 * n;
	double error = 0, most = 0;
	struct stress *s;

	for (size_t i = 0; i < n; i++) {
		double x = (double)(i % SIDE) - MID, y = (double)(i / SIDE) - MID;

		p[i] = exp(-(x * x + y * y) / 32);
	}
	for (par.periodic = 0; par.periodic < 2; par.periodic++) {
		par.axis = axis;
		s = stress_new(&par);
		stress_load(s, p);
		stress_tensor(s, 3, par.periodic ? b : a);
		stress_free(s);
	}
	for (int c = 0; c < 6; c++)
		for (int k = -6; k <= 6; k++) {
			size_t at = (size_t)c * n + (size_t)(MID + k) * SIDE + MID + 4;

			error = tap_max(error, fabs(a[at] - b[at]));
			most = tap_max(most, fabs(a[at]));
		}
	/* The images' mean pressure is 100 / 128^2 = 0.006 of the peak; cells against
	 * points are 1/100 of it apart. */
	ok(error < 0.012 && most > 0.3,
		"periodic and free sums agree near a patch, mu %g along %c: %.1e", mu,
		"xy"[axis], error);
	free(a);
	free(p);
}

/* The bound on waves holds and ends the search. */
static void test_periodic_reach(void)
{
	enum { SIDE = 32 };
	struct stress_par par = plain(SIDE, SIDE, 0.3);
	double p[SIDE * SIDE] = { 0 }, m[SIDE * SIDE], limit = 0.3;
	struct stress_span span[SIDE * 4], all[SIDE];
	struct stress *s;
	int last = -1, end = -1;

	par.periodic = 1;
	s = stress_new(&par);
	for (int k = 0; k < 12; k++)
		p[(int)(SIDE * SIDE * philox_uniform(6, 0, RNG_NOISE, (uint64_t)k))] =
			1 + k;
	stress_load(s, p);
	for (int layer = 0; layer < 60; layer++) {
		stress_at(s, layer, all, whole_grid(&par, all), m);
		for (int i = 0; i < SIDE * SIDE; i++)
			last = m[i] > limit ? layer : last;
		if (stress_reach(s, layer, limit, span))
			end = layer;
	}
	ok(last > 2 && end >= last && end < 59,
		"periodic: all layers with nodes over the limit, down to %d, are searched, down to %d",
		last, end);
	stress_free(s);
}

/* The loads of cells at random, 0 on most. */
static void fill_loads(double *p, size_t n, int stream)
{
	for (size_t i = 0; i < n; i++)
		p[i] = fmax(philox_uniform(11, (uint32_t)stream, RNG_NOISE, i) - 0.7, 0);
}

static double at_node(
	const double *field, const struct stress_par *par, const struct stress_node *node)
{
	return field[(size_t)node->iy * (size_t)par->nx + (size_t)node->ix];
}

/* The nodes found above a limit are those of the whole surface, with their values. */
static void test_above(struct stress *s, const struct stress_par *par, const double *all)
{
	size_t n = (size_t)par->nx * (size_t)par->ny, above = 0, wrong = 0, found;
	struct stress_node *node = malloc(n * sizeof *node);
	struct stress_span span[120];
	double limit = 0;

	for (size_t i = 0; i < n; i++)
		limit = tap_max(limit, 0.8 * all[i]);
	for (size_t i = 0; i < n; i++)
		above += all[i] > limit;
	stress_above(s, limit, span, whole_grid(par, span), node, &found);
	for (size_t i = 0; i < found; i++)
		wrong += !(at_node(all, par, &node[i]) > limit &&
			   node[i].value == at_node(all, par, &node[i]));
	ok(above > 0 && found == above && wrong == 0,
		"axis %d, periodic %d: all %zu nodes above a limit are found", par->axis,
		par->periodic, above);
	free(node);
}

/* Few loads are summed one by one where nodes may exceed the limit; the spans of the
 * surface alone contain all nodes that do. */
static void test_few(int axis, double mu)
{
	enum { SIDE = 200, CELLS = SIDE * SIDE };
	struct stress_par par = plain(SIDE, SIDE, mu);
	double *p = calloc(CELLS, sizeof *p), *all = malloc(CELLS * sizeof *all);
	struct stress_node *node = malloc(CELLS * sizeof *node);
	struct stress_span span[CELLS], deep[CELLS];
	struct stress *s, *full;
	size_t count, found, wanted = 0, above = 0, missed = 0;
	double limit = 0, worst = 0;

	par.axis = axis;
	s = stress_new(&par);
	par.method = STRESS_FULL;
	full = stress_new(&par);
	for (int k = 0; k < 150; k++)
		p[(k * 7919 + k * k * 31) % CELLS] = 0.25 + k % 4 * 0.25;
	stress_load(full, p);
	stress_at(full, 0, span, whole_grid(&par, span), all);
	for (size_t i = 0; i < CELLS; i++)
		limit = tap_max(limit, 0.3 * all[i]);
	stress_load(s, p);
	count = stress_reach_surface(s, limit, span);
	for (size_t k = 0; k < count; k++)
		wanted += (size_t)(span[k].end - span[k].begin);
	stress_above(s, limit, span, count, node, &found);
	for (size_t i = 0; i < CELLS; i++)
		above += all[i] > limit;
	for (size_t i = 0; i < found; i++)
		worst = tap_max(
			worst, fabs(node[i].value - at_node(all, &par, &node[i])));
	ok(above > 100 && found == above && worst < 5e-6,
		"axis %d, friction %g: all %zu nodes above a limit are in the spans of the surface, to %.1e",
		axis, mu, above, worst);
	count = stress_reach(s, 0, limit, deep);
	for (size_t k = 0; k < count; k++)
		missed += (size_t)(deep[k].end - deep[k].begin);
	ok(0 < wanted && wanted < missed,
		"the spans of the surface have %zu nodes of %zu", wanted, missed);
	stress_free(s);
	stress_free(full);
	free(node);
	free(all);
	free(p);
}

/* Nodes received, and those of them that exceed the limit without their tractions, so
 * that the limit is less than what they have. */
struct received {
	double limit;
	long nodes, above;
};

static double size_of(void *context, const double number[STRESS_NUMBERS])
{
	(void)context;
	return stress_von_mises_criterion.value(number);
}

static void count_nodes(void *context, const struct stress_span *span,
	const double *const number[STRESS_NUMBERS])
{
	struct received *r = context;

	r->nodes += span->end - span->begin;
	for (int x = 0; x < span->end - span->begin; x++) {
		const double v[STRESS_NUMBERS] = { number[DEV_X][x], number[DEV_Y][x],
			number[DEV_XY][x] };

		r->above += stress_von_mises_criterion.value(v) > r->limit;
	}
}

/* A request with a limit receives all nodes that exceed it, and of the rest a part: the
 * bound neglects that loads on opposite sides of a node cancel, and tractions.  Without
 * bounds all would be received. */
static void test_limit(int few, int axis)
{
	enum { SIDE = 210, CELLS = SIDE * SIDE };
	struct influence_par par = { 1, 1, 0.3, 0.3, axis };
	struct free_sum *s = free_sum_new(&par, SIDE, SIDE, 0, NULL);
	double *p = calloc(CELLS, sizeof *p);
	struct received r = { .limit = 0.25 }, all = r;
	struct stress_span span[SIDE];
	struct stress_want want = { .span = span,
		.count = SIDE,
		.numbers = DEV_XZ,
		.put = count_nodes,
		.context = &all };
	const struct stress_box box = { 0, SIDE - 1, 0, SIDE - 1 };

	for (int y = 0; y < SIDE; y++)
		span[y] = (struct stress_span){ y, 0, SIDE };
	/* Squares of four by four cells. */
	for (int k = 0; k < few; k++)
		for (int i = 0; i < 16; i++)
			p[(k * 7919 + k * k * 31) % (CELLS - 4 * SIDE) + i % 4 +
				i / 4 * SIDE] = 0.5 + 0.25 * (k % 3);
	free_sum_load(s, p, 1, span, SIDE, &box);
	free_sum_at(s, 0, &want);
	want.context = &r;
	want.size = size_of;
	want.limit = r.limit;
	free_sum_at(s, 0, &want);
	ok(all.nodes == CELLS && all.above > 16 * few / 4 && r.above == all.above &&
			r.nodes < 5 * r.above,
		"%d loads, axis %d: of %ld nodes above a limit %ld are among the %ld received",
		16 * few, axis, all.above, r.above, r.nodes);
	free_sum_free(s);
	free(p);
}

/* On the surface the tractions are those of the load; and what is kept of one load and of
 * one part of the grid does not show in the next. */
static void test_surface(int axis, int periodic)
{
	enum { SIDE = 120, CELLS = SIDE * SIDE };
	struct stress_par par = plain(SIDE, SIDE, 0.3);
	double *p = calloc(CELLS, sizeof *p), *few = calloc(CELLS, sizeof *few);
	double *t = malloc(STRESS_COMPONENTS * CELLS * sizeof *t);
	double *first = malloc(CELLS * sizeof *first), *m = malloc(CELLS * sizeof *m);
	struct stress_span span[SIDE];
	struct stress *s;
	double worst = 0;

	par.axis = axis;
	par.periodic = periodic;
	s = stress_new(&par);
	fill_loads(p, CELLS, axis);
	fill_loads(few, SIDE * 50, 2);
	stress_load(s, p);
	stress_at(s, 0, span, whole_grid(&par, span), first);
	stress_tensor(s, 0, t);
	for (size_t i = 0; i < CELLS; i++) {
		double xz = t[STRESS_XZ * CELLS + i], yz = t[STRESS_YZ * CELLS + i];

		worst = tap_max(worst, fabs(t[STRESS_ZZ * CELLS + i] + p[i]));
		worst = tap_max(worst, fabs((axis ? yz : xz) + par.mu * p[i]));
		worst = tap_max(worst, fabs(axis ? xz : yz));
	}
	ok(par.mu != 0 && worst < 1e-15,
		"axis %d, periodic %d: surface tractions are those of the load to %.1e",
		axis, periodic, worst);
	stress_load(s, few);
	stress_at(s, 0, span, whole_grid(&par, span), m);
	stress_at(s, 3, span, whole_grid(&par, span), m);
	stress_load(s, p);
	stress_at(s, 0, span, whole_grid(&par, span), m);
	ok(memcmp(m, first, CELLS * sizeof *m) == 0,
		"axis %d, periodic %d: the same load gives the same bytes after another",
		axis, periodic);
	test_above(s, &par, first);
	stress_free(s);
	free(m);
	free(first);
	free(t);
	free(few);
	free(p);
}

/* Direct sums below the middles of contacts of one to five cells radius against layers.
 */
static void test_points(double oblong)
{
	enum { SIDE = 200, BUMPS = 40 };
	struct stress_par par = plain(SIDE, SIDE, 0.3);
	double *p = calloc(SIDE * SIDE, sizeof *p), *m = malloc(SIDE * SIDE * sizeof *m);
	struct stress_span span[SIDE];
	size_t middle[BUMPS];
	double all = 0, deep = 0, count = 0;
	const struct stress_span *loads;
	size_t runs;
	struct stress *s;
	struct point_sum *points;

	par.dy *= oblong;
	s = stress_new(&par);
	points = point_sum_new(&par);
	for (int k = 0; k < BUMPS; k++) {
		int radius = 1 + k % 5, side = SIDE - 2 * radius - 1;
		int x = radius +
			(int)(side * philox_uniform(7, 0, RNG_NOISE, (uint64_t)(2 * k)));
		int y = radius + (int)(side * philox_uniform(7, 0, RNG_NOISE,
						      (uint64_t)(2 * k + 1)));

		middle[k] = (size_t)(y * SIDE + x);
		for (int j = -radius; j <= radius; j++)
			for (int i = -radius; i <= radius; i++) {
				double r2 = (double)(i * i + j * j) / (radius * radius);
				double *at = &p[(y + j) * SIDE + x + i];

				*at = fmax(*at, sqrt(fmax(0, 1 - 0.9 * r2)));
			}
	}
	stress_load(s, p);
	loads = stress_loads(s, &runs);
	point_sum_load(points, p, loads, runs);
	for (int k = 0; point_sum_depth(points, k) < SIDE; k++) {
		double z = point_sum_depth(points, k);

		stress_at(s, z, span, whole_grid(&par, span), m);
		for (int i = 0; i < BUMPS; i++) {
			double error = fabs(point_sum_at(points, (int)middle[i] % SIDE,
						    (int)middle[i] / SIDE, k) -
					    m[middle[i]]);

			all = tap_max(all, error);
			if (z >= 8) {
				error /= m[middle[i]];
				deep += error * error;
				count++;
			}
		}
	}

	ok(all < 0.01,
		"cells of 1 by %g: direct sums are within %.1e of the largest pressure",
		oblong, all);
	deep = sqrt(deep / count);
	ok(deep < 0.02, "from 8 cells on they are off by %.1e of the stress (rms)", deep);
	near(point_sum_depth(points, 0), fmin(par.dx, par.dy) / 8, 1e-15,
		"the first depth is an eighth of the shorter side of a cell");
	ok(point_sum_above(points, 1.3 * point_sum_depth(points, 5)) == 5 &&
			point_sum_above(points, 0) == 0,
		"the depth above another one is found");
	point_sum_free(points);
	stress_free(s);
	free(m);
	free(p);
}

/* A small part of the grid, then all of it: the sums do not depend on those before.  Both
 * take planes of 128 x 128 points, in one piece and in tiles. */
static void test_sequence(void)
{
	enum { SIDE = 240, PART = 106 };
	struct stress_par par = plain(SIDE, SIDE, 0.3);
	double *p = calloc(3 * SIDE * SIDE, sizeof *p), *a = p + SIDE * SIDE,
	       *b = a + SIDE * SIDE;
	struct stress_span span[SIDE];
	struct stress *used = stress_new(&par), *fresh = stress_new(&par);
	size_t rows;

	whole_grid(&par, span);
	p[0] = p[PART * SIDE - SIDE + PART - 1] = 1;
	for (int y = 0; y < PART; y++)
		span[y].end = PART;
	stress_load(used, p);
	stress_at(used, 0, span, PART, a);
	rows = whole_grid(&par, span);
	p[150 * SIDE + 170] = p[SIDE * SIDE - 1] = 2;
	stress_load(used, p);
	stress_load(fresh, p);
	stress_at(used, 0, span, rows, a);
	stress_at(fresh, 0, span, rows, b);
	ok(memcmp(a, b, SIDE * SIDE * sizeof *a) == 0,
		"the stress after another sum is that of the first sum");
	stress_free(used);
	stress_free(fresh);
	free(p);
}

static void test_refusals(void)
{
	struct stress_par par = plain(8, 8, 0.3);
	double p[64] = { 0 };
	struct stress *s = stress_new(&par);

	p[5] = NAN;
	ok(stress_load(s, p) == NUM_DOMAIN, "a pressure that is not a number is refused");
	p[5] = 0;
	ok(stress_load(s, p) == 0, "a load of zero is accepted");
	{
		struct stress_span span[64];

		ok(stress_reach(s, 0, 1, span) == 0, "a load of zero needs no node");
	}
	stress_free(s);
	par.nu = 0.6;
	ok(!stress_new(&par), "a Poisson's ratio above one half is refused");
}

int main(void)
{
	test_hertz();
	test_hertz_peak();
	test_surface_order(0);
	test_surface_order(0.3);
	test_surface_order(1);
	test_element();
	test_criteria();
	test_coarse();
	test_reach(0);
	test_reach(0.3);
	test_periodic();
	test_periodic_reach();
	test_periodic_free(0, 0);
	test_periodic_free(0.5, 0);
	test_periodic_free(0.5, 1);
	for (int k = 0; k < 4; k++)
		test_surface(k & 1, k >> 1);
	test_few(0, 0.3);
	test_few(1, 0);
	test_limit(20, 0);
	test_limit(20, 1);
	test_limit(100, 1);
	test_points(1);
	test_points(0.1);
	test_sequence();
	test_refusals();
	return tap_done();
}
