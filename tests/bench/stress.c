/* Rows for stress.sh: see there. */
#include "stress/stress.h"
#include "debris/debris.h"
#include "num/philox.h"
#include "stress/stress_kernel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static double seconds(void)
{
	struct timespec t;

	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void row(
	const char *scene, const char *way, double knob, double error, double time)
{
	struct rusage u;

	getrusage(RUSAGE_SELF, &u);
	printf("%s\t%s\t%g\t%.3g\t%.4g\t%.1f\n", scene, way, knob, error, time,
		(double)u.ru_maxrss / 1024);
	fflush(stdout);
}

static struct stress_par grid(int n, double side)
{
	struct stress_par par = {
		.nx = n, .ny = n, .dx = side / n, .dy = side / n, .nu = 0.3, .mu = 0.3
	};

	return par;
}

/* Hertz pressure p0 = a = 1 at the cell centres. */
static double *hertz(const struct stress_par *par)
{
	size_t n = (size_t)par->nx * (size_t)par->ny;
	double *p = calloc(n, sizeof *p);

	for (size_t i = 0; i < n; i++) {
		double x = ((int)(i % (size_t)par->nx) + 0.5 - 0.5 * par->nx) * par->dx;
		double y = ((int)(i / (size_t)par->nx) + 0.5 - 0.5 * par->ny) * par->dy;

		p[i] = sqrt(fmax(0, 1 - x * x - y * y));
	}
	return p;
}

static size_t whole(const struct stress_par *par, struct stress_span **span)
{
	*span = malloc((size_t)par->ny * sizeof(**span));
	for (int y = 0; y < par->ny; y++)
		(*span)[y] = (struct stress_span){ y, 0, par->nx };
	return (size_t)par->ny;
}

/* On the axis below a Hertz contact with friction. */
static double axis_mises(double Z, double nu, double mu)
{
	double zz = -1 / (1 + Z * Z);
	double rr = -(1 + nu) * (1 - Z * atan(1 / Z)) + 1 / (2 * (1 + Z * Z));
	double xz = -mu * (1 - 1.5 * Z * atan(1 / Z) + Z * Z / (2 * (1 + Z * Z)));

	return sqrt((zz - rr) * (zz - rr) + 3 * xz * xz);
}

/* Error of the von Mises stress on the axis, z = a/2 to 3a/2, against the grid. */
static void bench_grid(int n)
{
	struct stress_par par = grid(n, 4);
	double *p = hertz(&par), *m = malloc(sizeof *m * (size_t)n * (size_t)n),
	       error = 0, time;
	struct stress_span *span;
	size_t count = whole(&par, &span);
	struct stress *s = stress_new(&par);

	time = seconds();
	stress_load(s, p);
	for (int k = 10; k <= 30; k++) {
		stress_at(s, 0.05 * k, span, count, m);
		error = fmax(error, fabs(m[(size_t)n * (size_t)n / 2] -
					    axis_mises(0.05 * k, 0.3, 0.3)));
	}
	row("hertz", "free", n, error, (seconds() - time) / 21);
	stress_free(s);
	free(span);
	free(m);
	free(p);
}

/* The free half-space by a periodic one with the load in a window of 1 / factor of its
 * side: error over the window. */
static void bench_padding(double factor)
{
	enum { N = 65 };
	struct stress_par par = grid(N, 4), wide = par;
	double *p = hertz(&par), *q, *m = malloc(sizeof *m * N * N), *w, error = 0, time;
	struct stress_span *span, *wspan;
	size_t count = whole(&par, &span), wcount;
	struct stress *s = stress_new(&par), *ws;
	int side = (int)(N * factor), at = (side - N) / 2;

	wide.nx = wide.ny = side;
	wide.periodic = 1;
	wcount = whole(&wide, &wspan);
	q = calloc((size_t)side * (size_t)side, sizeof *q);
	w = malloc((size_t)side * (size_t)side * sizeof *w);
	for (int y = 0; y < N; y++)
		memcpy(q + (size_t)(y + at) * (size_t)side + at, p + y * N,
			N * sizeof *p);
	stress_load(s, p);
	ws = stress_new(&wide);
	time = seconds();
	stress_load(ws, q);
	for (int k = 10; k <= 30; k += 10) {
		stress_at(s, 0.05 * k, span, count, m);
		stress_at(ws, 0.05 * k, wspan, wcount, w);
		for (int i = 0; i < N * N; i++)
			error = fmax(
				error, fabs(m[i] - w[(size_t)(i / N + at) * (size_t)side +
							   (size_t)(i % N + at)]));
	}
	row("padding", "periodic", factor, error, (seconds() - time) / 3);
	stress_free(s);
	stress_free(ws);
	free(p);
	free(q);
	free(m);
	free(w);
	free(span);
	free(wspan);
}

/* One depth, in cells, of n x n nodes with a share of the cells loaded at random: coarse
 * sums, with their difference from full ones, and full ones. */
static void bench_way(int n, double depth, double share)
{
	struct stress_par par = grid(n, n);
	double *p = calloc((size_t)n * (size_t)n, sizeof *p), *m[2], time[2], error = 0;
	struct stress_span *span;
	size_t count = whole(&par, &span);
	char scene[64];

	for (int k = 0; k < n * n; k++)
		p[k] = philox_uniform(1, 0, RNG_NOISE, (uint64_t)k) < share;
	for (int way = 0; way < 2; way++) {
		struct stress *s;

		m[way] = calloc((size_t)n * (size_t)n, sizeof(**m));
		par.method = way ? STRESS_FULL : STRESS_COARSE;
		s = stress_new(&par);
		stress_load(s, p);
		time[way] = seconds();
		stress_at(s, depth, span, count, m[way]);
		time[way] = seconds() - time[way];
		stress_free(s);
	}
	for (int i = 0; i < n * n; i++)
		error = fmax(error, fabs(m[0][i] - m[1][i]));
	snprintf(scene, sizeof(scene), "way_%d_%g", n, share);
	row(scene, "coarse", depth, error, time[0]);
	row(scene, "full", depth, 0, time[1]);
	for (int way = 0; way < 2; way++)
		free(m[way]);
	free(span);
	free(p);
}

/* Worn volume of a smooth contact against the height of a layer, over the value for the
 * finest; a = 1, p0 three times yield. */
static double worn(double dz, double offset, enum wear_rule rule, double *time)
{
	struct debris_par par = { .yield = 1. / 3, .rule = rule, .stress = grid(65, 4) };
	double *p = hertz(&par.stress), *h = calloc(65 * 65, sizeof *h);
	struct debris_step step;
	struct debris *d;

	par.cell = dz;
	par.offset = offset;
	d = debris_new(&par);
	*time = seconds();
	debris_step(d, h, p, &step);
	*time = seconds() - *time;
	debris_free(d);
	free(p);
	free(h);
	return step.volume;
}

static void bench_layers(void)
{
	static const char *const rules[] = { "column", "potential" };
	char way[64];
	double time;

	for (int rule = 0; rule < 2; rule++) {
		double best = worn(0.001, 0, (enum wear_rule)rule, &time), v;

		for (int mid = 0; mid < 2; mid++)
			for (int k = 1; k <= 32; k *= 2) {
				v = worn(0.32 / k, mid ? 0.5 : 0, (enum wear_rule)rule,
					&time);
				snprintf(way, sizeof(way), "%s_%s", rules[rule],
					mid ? "mid" : "top");
				row("layers", way, 0.32 / k, fabs(v / best - 1), time);
			}
		v = worn(0, 0, (enum wear_rule)rule, &time);
		snprintf(way, sizeof(way), "%s_interpolated", rules[rule]);
		row("layers", way, 0, fabs(v / best - 1), time);
	}
}

int main(void)
{
	puts("scene\tway\tknob\terror\tseconds\tmemory");
	for (int n = 17; n <= 513; n = 2 * n - 1)
		bench_grid(n);
	for (double f = 1; f <= 16; f *= 2)
		bench_padding(f);
	bench_layers();
	for (int n = 64; n <= 512; n *= 2)
		for (int depth = 1; depth <= n / 4; depth *= 4) {
			bench_way(n, depth, 0.03);
			bench_way(n, depth, 0.5);
		}
	return 0;
}
