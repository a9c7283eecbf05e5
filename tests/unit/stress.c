/* Stress below a surface: Hertz with friction in closed form, direct sums against
 * transforms, periodic waves, what may be left out. */
#include "stress/stress.h"
#include "stress/stress_kernel.h"
#include "num/philox.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>

static struct stress_par plain(int nx, int ny, double mu)
{
	struct stress_par par = { .nx = nx,
		.ny = ny,
		.ax = 1,
		.ay = 1,
		.dz = 1,
		.nu = 0.3,
		.mu = mu,
		.memory = (size_t)1 << 28 };

	return par;
}

static size_t whole_grid(const struct stress_par *par, struct stress_span *span)
{
	for (int y = 0; y < par->ny; y++)
		span[y] = (struct stress_span){ y, 0, par->nx };
	return par->ny;
}

/* Hertz pressure p0 = a = 1 on n x n cells of side h, at their centres. */
static double *hertz(int n, double h)
{
	double *p = calloc((size_t)n * n, sizeof(*p));

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
	double *p = hertz(n, 4. / n), *m = malloc((size_t)n * n * sizeof(*m)), error = 0;
	struct stress_span *span = malloc(n * sizeof(*span));
	struct stress *s;

	par.ax = par.ay = 4. / n;
	par.dz = 0.05;
	s = stress_new(&par);
	stress_load(s, p);
	for (int k = 0; k <= 30; k++) {
		double e;

		stress_mises(s, k, span, whole_grid(&par, span), m);
		e = k ? fabs(m[(size_t)n * n / 2] - axis_mises(0.05 * k, 0.3, mu)) : 0;
		if (k == 0)
			*surface = m[(size_t)n * n / 2];
		if (k >= 10)
			error = fmax(error, e);
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
	ok(fine < 1e-4,
		"Hertz with friction: von Mises on the axis from a/2 on, 129 points: %.1e p0",
		fine);
	ok(coarse / fine > 3.3, "and converges with the square of the grid: %.1e, %.1e",
		coarse, fine);
	/* Under the middle sxx = syy = -(1 + 2 nu)/2, szz = -1, sxz = -mu. */
	near(surface, sqrt(0.04 + 3 * 0.09), 2e-3, "surface in the middle");
}

/* Largest stress on the plane y = 0, where and how large (1001 points, sampled). */
static void test_hertz_peak(void)
{
	enum { NODES = 257 };
	struct stress_par par = plain(NODES, NODES, 0.3);
	double h = 1. / 64, lead, trail, most = 0, x = 0, z = 0;
	double *p = hertz(NODES, h), *m = malloc(sizeof(*m) * NODES * NODES);
	struct stress_span row = { NODES / 2, 0, NODES };
	struct stress *s;

	par.ax = par.ay = h;
	par.dz = 0.01;
	s = stress_new(&par);
	stress_load(s, p);
	for (int k = 30; k <= 60; k++) {
		stress_mises(s, k, &row, 1, m);
		for (int i = 0; i < NODES; i++)
			if (m[NODES / 2 * NODES + i] > most) {
				most = m[NODES / 2 * NODES + i];
				x = (i - NODES / 2) * h;
				z = 0.01 * k;
			}
	}
	near(most, 0.65975605, 2e-4, "mu = 0.3: largest stress below the surface");
	near(x, 0.3188, h, "lies ahead of the middle");
	near(z, 0.4282, 0.01, "at this depth");
	stress_mises(s, 0, &row, 1, m);
	/* Nodes on the rim, where the pressure rises like a square root. */
	trail = m[NODES / 2 * NODES + NODES / 2 - 64];
	lead = m[NODES / 2 * NODES + NODES / 2 + 64];
	ok(trail > 1.8 * lead,
		"surface: the trailing edge (%.3f) is the worse one (%.3f)", trail, lead);
	near(trail, 0.65399507, 0.05, "trailing edge");
	near(lead, 0.327516568, 0.04, "leading edge");
	stress_free(s);
	free(m);
	free(p);
}

/* The same layer by many spans (direct) and by the tensor (transform). */
static void test_direct(int nx, int ny, double mu, int axis)
{
	struct stress_par par = plain(nx, ny, mu);
	size_t n = (size_t)nx * ny;
	double *p = calloc(n, sizeof(*p)), *m = malloc(n * sizeof(*m)), error = 0;
	double *t = malloc(6 * n * sizeof(*t));
	struct stress_span *span = malloc(ny * sizeof(*span));
	struct stress *s;

	par.ax = 1.5e-6, par.ay = 1e-6, par.dz = 0.7e-6, par.axis = axis;
	par.method = STRESS_DIRECT;
	s = stress_new(&par);
	for (int k = 0; k < 6; k++)
		p[(size_t)(n * philox_uniform(3, nx, RNG_NOISE, k))] = 1e9 * (k + 1);
	stress_load(s, p);
	for (int layer = 0; layer < 4; layer++) {
		stress_mises(s, layer, span, whole_grid(&par, span), m);
		stress_tensor(s, layer, t);
		for (size_t i = 0; i < n; i++) {
			double v[6];

			for (int c = 0; c < 6; c++)
				v[c] = t[c * n + i];
			error = fmax(error, fabs(stress_von_mises(v) - m[i]) / 6e9);
		}
	}
	ok(stress_work(s).direct_layers == 4 && error < 1e-14,
		"%dx%d, mu %g along %c: direct sums and transforms agree to %.1e", nx, ny,
		mu, "xy"[axis], error);
	stress_free(s);
	free(span);
	free(t);
	free(m);
	free(p);
}

/* One loaded cell: the sum is the patch. */
static void test_patch(void)
{
	struct stress_par par = plain(9, 7, 0.4);
	double p[63] = { 0 }, t[6 * 63], n[6], s[6], turned[6], error = 0;
	struct stress *st = stress_new(&par);

	p[3 * 9 + 4] = 2;
	stress_load(st, p);
	stress_tensor(st, 2, t);
	for (int i = 0; i < 63; i++) {
		stress_patch(0.5, 0.5, 0.3, i % 9 - 4, i / 9 - 3, 2, n, s);
		for (int c = 0; c < 6; c++)
			error = fmax(
				error, fabs(t[c * 63 + i] - 2 * (n[c] + 0.4 * s[c])));
	}
	near(error, 0, 1e-15, "one cell: the tensor of the patch, shear along x");
	stress_free(st);
	par.axis = 1;
	st = stress_new(&par);
	stress_load(st, p);
	stress_tensor(st, 2, t);
	error = 0;
	for (int i = 0; i < 63; i++) {
		stress_patch(0.5, 0.5, 0.3, i % 9 - 4, i / 9 - 3, 2, n, s);
		stress_patch(0.5, 0.5, 0.3, i / 9 - 3, i % 9 - 4, 2, turned, s);
		turned[STRESS_XX] = s[STRESS_YY], turned[STRESS_YY] = s[STRESS_XX];
		turned[STRESS_ZZ] = s[STRESS_ZZ], turned[STRESS_XY] = s[STRESS_XY];
		turned[STRESS_XZ] = s[STRESS_YZ], turned[STRESS_YZ] = s[STRESS_XZ];
		for (int c = 0; c < 6; c++)
			error = fmax(error,
				fabs(t[c * 63 + i] - 2 * (n[c] + 0.4 * turned[c])));
	}
	near(error, 0, 1e-15, "one cell: the tensor of the patch, shear along y");
	stress_free(st);
}

/* No node outside the spans reaches the limit. */
static void test_reach(double mu)
{
	enum { SIDE = 96 };
	struct stress_par par = plain(SIDE, SIDE, mu);
	struct stress *s = stress_new(&par);
	double p[SIDE * SIDE] = { 0 }, m[SIDE * SIDE];
	struct stress_span *span = malloc(stress_spans_max(s) * sizeof(*span)), all[SIDE];
	int missed = 0;
	double nodes = 0, kept = 0, failed = 0;

	for (int k = 0; k < 40; k++)
		p[(int)(SIDE * SIDE * philox_uniform(5, 0, RNG_NOISE, k))] = 1;
	stress_load(s, p);
	for (int layer = 0; layer < 6; layer++) {
		static unsigned char in[SIDE * SIDE];
		size_t n = stress_reach(s, layer, 0.2, span);

		memset(in, 0, sizeof(in));
		for (size_t i = 0; i < n; i++) {
			memset(in + span[i].y * SIDE + span[i].begin, 1,
				span[i].end - span[i].begin);
			kept += span[i].end - span[i].begin;
		}
		stress_mises(s, layer, all, whole_grid(&par, all), m);
		for (int i = 0; i < SIDE * SIDE; i++) {
			missed += m[i] > 0.2 && !in[i];
			failed += m[i] > 0.2;
		}
		nodes += SIDE * SIDE;
	}
	ok(missed == 0 && failed > 0 && kept < nodes,
		"mu %g: no node over the limit is passed over (%.0f over, %.0f of %.0f searched)",
		mu, failed, kept, nodes);
	ok(stress_reach(s, 1000, 0.2, span) == 0, "nothing to search far below");
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
		error = fmax(error, fabs(t[i] - (-0.3 / 0.7 - (1 - q * z) * e * c)));
		error = fmax(error, fabs(t[(int)n + i] - (-0.3 / 0.7 - 0.6 * e * c)));
		error = fmax(error, fabs(t[2 * (int)n + i] - (-1 - (1 + q * z) * e * c)));
	}
	near(error, 0, 1e-14, "periodic: a wave of pressure");
	stress_free(s);
}

/* A periodic grid whose load sits in a small patch feels its images weakly: near the
 * patch the free half-space must come out.  Loads are smooth, as the series is. */
static void test_periodic_free(double mu, int axis)
{
	enum { SIDE = 128, MID = SIDE / 2 };
	struct stress_par par = plain(SIDE, SIDE, mu);
	size_t n = SIDE * SIDE;
	double *p = calloc(n, sizeof(*p)), *a = malloc(12 * n * sizeof(*a)),
	       *b = a + 6 * n;
	double error = 0, most = 0;
	struct stress *s;

	for (size_t i = 0; i < n; i++) {
		double x = i % SIDE - MID, y = (double)(i / SIDE) - MID;

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
			size_t at = c * n + (MID + k) * SIDE + MID + 4;

			error = fmax(error, fabs(a[at] - b[at]));
			most = fmax(most, fabs(a[at]));
		}
	/* The images' mean pressure is 100 / 128^2 = 0.006 of the peak; cells against
	 * points are 1/100 of it apart. */
	ok(error < 0.012 && most > 0.3,
		"periodic and free agree near a patch, mu %g along %c: %.1e", mu,
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
		p[(int)(SIDE * SIDE * philox_uniform(6, 0, RNG_NOISE, k))] = 1 + k;
	stress_load(s, p);
	for (int layer = 0; layer < 60; layer++) {
		stress_mises(s, layer, all, whole_grid(&par, all), m);
		for (int i = 0; i < SIDE * SIDE; i++)
			last = m[i] > limit ? layer : last;
		if (stress_reach(s, layer, limit, span))
			end = layer;
	}
	ok(last > 2 && end >= last && end < 59,
		"periodic: nodes over the limit down to layer %d, searched down to %d",
		last, end);
	stress_free(s);
}

static void test_refusals(void)
{
	struct stress_par par = plain(8, 8, 0.3);
	double p[64] = { 0 };
	struct stress *s = stress_new(&par);

	p[5] = NAN;
	ok(stress_load(s, p) == -1, "a pressure that is no number");
	p[5] = 0;
	ok(stress_load(s, p) == 0, "no load at all");
	{
		struct stress_span span[64];

		ok(stress_reach(s, 0, 1, span) == 0, "needs no node");
	}
	stress_free(s);
	par.nu = 0.6;
	ok(!stress_new(&par), "Poisson's ratio over one half");
	par.nu = 0.3;
	par.dz = 0;
	ok(!stress_new(&par), "no depth step");
}

int main(void)
{
	test_hertz();
	test_hertz_peak();
	test_patch();
	test_direct(17, 9, 0.3, 0);
	test_direct(12, 33, 0.3, 1);
	test_direct(16, 16, 0, 0);
	test_direct(40, 1, 5, 0);
	test_reach(0);
	test_reach(0.3);
	test_periodic();
	test_periodic_reach();
	test_periodic_free(0, 0);
	test_periodic_free(0.5, 0);
	test_periodic_free(0.5, 1);
	test_refusals();
	return tap_done();
}
