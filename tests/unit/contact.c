/* The contact solvers against closed forms: Hertz, Westergaard, a wavy surface, and
 * cases small enough to solve by hand. */
#include "contact/kernel.h"
#include "contact/solver.h"
#include "num/fft.h"
#include "num/pool.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

static const char *const solver_name[] = { "bccg", "pk" };

static struct contact_par parameters(
	int nx, int ny, double dx, enum contact_boundary b, enum contact_solver s)
{
	return (struct contact_par){ .nx = nx,
		.ny = ny,
		.dx = dx,
		.dy = dx,
		.estar = 1,
		.boundary = b,
		.solver = s,
		.tolerance = 1e-10,
		.max_iterations = 5000 };
}

/* Paraboloid of radius 10 mm under 50 N on a square of side 4 a: errors in the largest
 * pressure, in the approach, and on average over the contact, against the bounds that
 * the discretisation allows. */
static void hertz(int n, enum contact_solver solver, double e_peak, double e_approach,
	double e_mean)
{
	double radius = 10e-3, estar = 115.4e9, load = 50;
	double a = cbrt(3 * load * radius / (4 * estar)),
	       p0 = 3 * load / (2 * M_PI * a * a);
	double side = 4 * a, peak = 0, sum = 0;
	size_t cells = (size_t)n * (size_t)n, inside = 0;
	double *h = fft_alloc(cells), *p = fft_alloc(cells);
	struct contact_par par = parameters(n, n, side / n, CONTACT_FREE, solver);
	struct contact *c;

	par.estar = estar;
	par.tolerance = 1e-9;
	c = contact_new(&par);
	for (size_t i = 0; i < cells; i++) {
		double x = ((double)(i % (size_t)n) + 0.5) * par.dx - side / 2;
		double y = ((double)(i / (size_t)n) + 0.5) * par.dx - side / 2;

		h[i] = -(x * x + y * y) / (2 * radius);
	}
	contact_solve(c, h, CONTACT_PRESSURE, load / (side * side), p, NULL);
	for (size_t i = 0; i < cells; i++) {
		double r2 = -2 * radius * h[i],
		       hertz = p0 * sqrt(fmax(1 - r2 / (a * a), 0));

		peak = tap_max(peak, p[i]);
		if (r2 < a * a) {
			sum += fabs(p[i] - hertz) / p0;
			inside++;
		}
	}
	ok(fabs(peak / p0 - 1) < e_peak,
		"Hertz on %d cells, %s: the error of the peak pressure is %.2e", n,
		solver_name[solver], peak / p0 - 1);
	ok(fabs(contact_result(c)->approach / (a * a / radius) - 1) < e_approach,
		"Hertz on %d cells, %s: the error of the approach is %.2e", n,
		solver_name[solver], contact_result(c)->approach / (a * a / radius) - 1);
	ok(sum / (double)inside < e_mean,
		"Hertz on %d cells, %s: the mean error of the pressure is %.2e p0", n,
		solver_name[solver], sum / (double)inside);
	near(contact_result(c)->load, load, 1e-12 * load,
		"the solution carries the prescribed load");
	/* Energy of a Hertz contact is 2/5 F delta. */
	ok(fabs(contact_result(c)->energy / (0.4 * load * a * a / radius) - 1) < 3e-4,
		"Hertz on %d cells, %s: the energy is 2/5 F delta to %.1e", n,
		solver_name[solver],
		contact_result(c)->energy / (0.4 * load * a * a / radius) - 1);
	contact_free(c);
	fft_free(h);
	fft_free(p);
}

/* One wave of height cos: area (2 / pi) asin sqrt(p / p*), peak as Westergaard. */
static void westergaard(enum contact_solver solver)
{
	enum { N = 2048 };
	static const double loads[] = { 0.02, 0.1, 0.3, 0.5, 0.8, 0.95 };
	double *h = fft_alloc(N), *p = fft_alloc(N);
	struct contact_par par = parameters(N, 1, 1.0 / N, CONTACT_PERIODIC, solver);
	struct contact *c = contact_new(&par);
	double worst_area = 0, worst_peak = 0;

	for (int i = 0; i < N; i++)
		h[i] = cos(2 * M_PI * (i + 0.5) / N);
	for (size_t k = 0; k < sizeof(loads) / sizeof(loads[0]); k++) {
		double mean = loads[k] * M_PI, peak = 0;
		double half = asin(sqrt(loads[k])); /* pi a / lambda */

		memset(p, 0, N * sizeof *p);
		contact_solve(c, h, CONTACT_PRESSURE, mean, p, NULL);
		for (int i = 0; i < N; i++)
			peak = tap_max(peak, p[i]);
		worst_area = tap_max(
			worst_area, fabs(contact_result(c)->area - 2 / M_PI * half));
		worst_peak = tap_max(worst_peak, fabs(peak * sin(half) / (2 * mean) - 1));
	}
	/* Half a cell at each end of the contact, and one for the staircase. */
	ok(worst_area <= 2.0 / N,
		"Westergaard, %s: the error of the contact area is %.1e",
		solver_name[solver], worst_area);
	ok(worst_peak < 1e-3, "Westergaard, %s: the error of the peak pressure is %.1e",
		solver_name[solver], worst_peak);
	/* Above p* the contact is full and p = mean + p* cos exactly. */
	memset(p, 0, N * sizeof *p);
	contact_solve(c, h, CONTACT_PRESSURE, 1.5 * M_PI, p, NULL);
	worst_peak = 0;
	for (int i = 0; i < N; i++)
		worst_peak = tap_max(worst_peak, fabs(p[i] / M_PI - 1.5 - h[i]));
	ok(worst_peak < 1e-4 && contact_result(c)->area == 1,
		"full contact, %s: the error of the pressure is %.1e p*",
		solver_name[solver], worst_peak);
	contact_free(c);
	fft_free(h);
	fft_free(p);
}

/* Height cos cos, p* = sqrt2 pi E*: area of a periodic solution at 512 points. */
static void wavy(enum contact_solver solver)
{
	enum { N = 128 };
	static const double reference[][2] = { { 0.02, 0.059143 }, { 0.1, 0.191193 },
		{ 0.3, 0.514893 }, { 0.6, 0.776917 }, { 0.9, 0.950928 } };
	double *h = fft_alloc((size_t)N * N), *p = fft_alloc((size_t)N * N), worst = 0;
	struct contact_par par = parameters(N, N, 1.0 / N, CONTACT_PERIODIC, solver);
	struct contact *c = contact_new(&par);

	for (int i = 0; i < N * N; i++)
		h[i] = cos(2 * M_PI * (i % N) / N) * cos(2 * M_PI * (i / N) / N);
	for (size_t k = 0; k < sizeof(reference) / sizeof(reference[0]); k++) {
		double mean = reference[k][0] * sqrt(2) * M_PI;

		memset(p, 0, sizeof *p * N * N);
		contact_solve(c, h, CONTACT_PRESSURE, mean, p, NULL);
		worst = tap_max(worst, fabs(contact_result(c)->area - reference[k][1]));
	}
	/* A ring of cells: perimeter / N is about 0.04 here, a part of it is on. */
	ok(worst < 0.012, "wavy surface, %s: the error of the contact area is %.4f",
		solver_name[solver], worst);
	contact_free(c);
	fft_free(h);
	fft_free(p);
}

/* One and two cells by hand: signs and units. */
static void by_hand(enum contact_solver solver)
{
	struct contact_par par = parameters(1, 1, 2, CONTACT_FREE, solver);
	double k0 = kernel_patch(2, 2, 0, 0) / (M_PI * 4),
	       k1 = kernel_patch(2, 2, 2, 0) / (M_PI * 4);
	double h[3] = { 0.5, 0.5, 0.5 }, p[3] = { 0 }, g[3];
	struct contact *c;

	par.estar = 4;
	c = contact_new(&par);
	ok(contact_solve(c, h, CONTACT_PRESSURE, 3, p, g) == CONTACT_OK && p[0] == 3,
		"one cell, %s: it carries the load", solver_name[solver]);
	near(contact_result(c)->approach, k0 * 3 - 0.5, 1e-15,
		"the approach of one cell is u - h");
	near(contact_result(c)->indentation, k0 * 3, 1e-15,
		"the indentation of one cell is u");
	near(contact_result(c)->load, 12, 1e-14, "the load of one cell is p dx dy");
	p[0] = 0;
	contact_solve(c, h, CONTACT_APPROACH, 0.25, p, g);
	near(p[0], 0.75 / k0, 1e-8,
		"under a given approach the pressure of one cell is (h + approach) / K");
	contact_free(c);

	par.nx = 2;
	c = contact_new(&par);
	h[1] = 0.4;
	p[0] = p[1] = 0;
	contact_solve(c, h, CONTACT_PRESSURE, 1, p, g);
	near(p[0] - p[1], 0.1 / (k0 - k1), 1e-8,
		"of two cells the higher one carries more");
	near(p[0] + p[1], 2, 1e-15, "two cells carry the load together");
	h[1] = -1;
	p[0] = p[1] = 0;
	contact_solve(c, h, CONTACT_PRESSURE, 0.5, p, g);
	ok(fabs(p[0] - 1) < 1e-15 && p[1] == 0,
		"of two cells the low one does not touch under a light load");
	near(g[1], 1.5 - (k0 - k1), 1e-14,
		"the gap of the low cell is the step minus the difference of the displacements");
	contact_free(c);
}

/* Pressure stops at the hardness; control by load and control by approach give the same
 * solution. */
static void controls(enum contact_solver solver, enum contact_boundary boundary)
{
	enum { N = 64, CELLS = N * N };
	double *h = fft_alloc(CELLS), *p = fft_alloc(CELLS), *q = fft_alloc(CELLS);
	double *g = fft_alloc(CELLS), approach, worst = 0, peak = 0, overlap = 0;
	struct contact_par par = parameters(N, N, 1.0 / N, boundary, solver);
	struct contact *c = contact_new(&par);
	const char *name = boundary == CONTACT_FREE ? "free" : "periodic";
	enum contact_status status;

	for (int i = 0; i < CELLS; i++)
		h[i] = 0.02 * cos(4 * M_PI * (i % N) / N) *
			       sin(2 * M_PI * (i / N) / N + 1) +
		       0.003 * sin(20 * M_PI * (i % N) / N + i / N);
	contact_solve(c, h, CONTACT_PRESSURE, 0.02, p, g);
	approach = contact_result(c)->approach;
	for (int i = 0; i < CELLS; i++)
		worst = tap_max(worst, fabs(p[i] * g[i]) / 0.02);
	ok(worst < 1e-6, "%s, %s: pressure times gap is 0 to %.1e", solver_name[solver],
		name, worst);
	status = contact_solve(c, h, CONTACT_APPROACH, approach, q, g);
	ok(status == CONTACT_OK && fabs(contact_result(c)->pressure / 0.02 - 1) < 1e-5,
		"%s, %s: the approach found gives the load within %.1e",
		solver_name[solver], name, contact_result(c)->pressure / 0.02 - 1);
	memcpy(q, p, CELLS * sizeof *p);
	status = contact_solve(c, h, CONTACT_PRESSURE, 0.02, q, NULL);
	ok(status == CONTACT_OK && contact_result(c)->iterations <= 1,
		"%s, %s: a solution as the first guess needs no iteration",
		solver_name[solver], name);
	status = contact_solve(c, h, CONTACT_APPROACH, -1, q, g);
	ok(status == CONTACT_OK && contact_result(c)->load == 0,
		"%s, %s: an approach that does not reach the surface gives no load",
		solver_name[solver], name);
	contact_free(c);

	par.hardness = 0.1;
	c = contact_new(&par);
	memset(q, 0, CELLS * sizeof *q);
	status = contact_solve(c, h, CONTACT_PRESSURE, 0.02, q, g);
	for (int i = 0; i < CELLS; i++) {
		peak = tap_max(peak, q[i]);
		overlap = tap_max(overlap, q[i] < 0.1 ? -g[i] : 0);
	}
	ok(status == CONTACT_OK && peak == 0.1 && contact_result(c)->plastic > 0,
		"%s %s: %.0f %% of the cells stop at the hardness", solver_name[solver],
		name, 100 * contact_result(c)->plastic);
	ok(overlap < 1e-6, "%s, %s: only cells at the hardness overlap, %.1e",
		solver_name[solver], name, overlap);
	near(contact_result(c)->pressure, 0.02, 1e-14,
		"cells at the hardness do not change the load");
	ok(contact_solve(c, h, CONTACT_PRESSURE, 0.1, q, g) == CONTACT_OVERLOAD,
		"a mean pressure at the hardness is refused");
	contact_free(c);
	fft_free(h);
	fft_free(p);
	fft_free(q);
	fft_free(g);
}

/* A ball that sinks in by less than 1e-10 of the height it lies at, both exact in binary
 * digits: the height above 0 takes no digit of the pressure or of the indentation. */
static void far_from_zero(enum contact_solver solver, enum contact_boundary boundary)
{
	enum { N = 32 };
	const double unit = 0x1p-60, far = 0x1p-10;
	struct contact_par par = parameters(N, N, 0x1p-40, boundary, solver);
	double h[2][N * N], p[2][N * N] = { { 0 } }, approach[2], depth[2];
	struct contact *c = contact_new(&par);

	for (int i = 0; i < N * N; i++) {
		h[0][i] = -unit *
			  (pow(i % N - N / 2, 2) + pow(floor((double)i / N) - N / 2, 2)) *
			  64;
		h[1][i] = far + h[0][i];
	}
	for (int k = 0; k < 2; k++) {
		contact_solve(c, h[k], CONTACT_PRESSURE, 1e-3, p[k], NULL);
		approach[k] = contact_result(c)->approach;
		depth[k] = contact_result(c)->indentation;
	}
	ok(depth[0] > 0 && depth[0] < 1e-10 * far && depth[1] == depth[0] &&
			!memcmp(p[0], p[1], sizeof p[0]),
		"%s, %s: a ball at a height %.0e of its indentation has the same pressure and indentation as at 0, to the last digit",
		solver_name[solver], boundary == CONTACT_FREE ? "free" : "periodic",
		far / depth[0]);
	ok(approach[1] == approach[0] - far,
		"the approach of a raised ball is lower by its height");
	contact_free(c);
}

int main(void)
{
	static const enum contact_solver solvers[] = { CONTACT_PK, CONTACT_BCCG };

	for (size_t i = 0; i < sizeof(solvers) / sizeof(solvers[0]); i++) {
		hertz(128, solvers[i], 2.2e-4, 5.0e-5, 8.5e-4);
		hertz(256, solvers[i], 5.5e-5, 1.35e-5, 2.9e-4);
		westergaard(solvers[i]);
		wavy(solvers[i]);
		by_hand(solvers[i]);
		controls(solvers[i], CONTACT_FREE);
		controls(solvers[i], CONTACT_PERIODIC);
		far_from_zero(solvers[i], CONTACT_FREE);
		far_from_zero(solvers[i], CONTACT_PERIODIC);
	}
	return tap_done();
}
