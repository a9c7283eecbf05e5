/* contact - one solve of a defined surface, timed: error, work and memory as a TSV row
 *
 * usage: contact SCENE N PRESSURE SOLVER TOLERANCE [REFERENCE]
 *
 * SCENE: per (self-affine, periodic), free (rough paraboloid) or hertz (paraboloid);
 * side 1, E* 1.  Noise is splitmix64 and Box-Muller, so that any language can make the
 * same surfaces.  With a REFERENCE tolerance the solution is compared with one of it.
 */
#include "contact/solver.h"
#include "num/fft.h"
#include <complex.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

static const double pi = 3.14159265358979323846;

static double uniform(uint64_t *state)
{
	uint64_t z = *state += 0x9E3779B97F4A7C15u;

	z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
	z = (z ^ z >> 27) * 0x94D049BB133111EBu;
	z ^= z >> 31;
	return (double)(z >> 11) * 0x1p-53;
}

static void fill_noise(double *x, size_t n, uint64_t seed)
{
	for (size_t i = 0; i + 1 < n; i += 2) {
		double r = sqrt(-2 * log1p(-uniform(&seed))),
		       angle = 2 * pi * uniform(&seed);

		x[i] = r * cos(angle);
		x[i + 1] = r * sin(angle);
	}
}

/* Filters noise to a self-affine surface of Hurst exponent 0.8; wave numbers low to
 * high in cycles per side, flat up to roll.  Returns the spectral rms slope. */
static double fill_rough(
	double *h, int n, uint64_t seed, double low, double roll, double high)
{
	size_t cells = (size_t)n * (size_t)n, half = (size_t)n / 2 + 1;
	struct fft *fft = fft_new((size_t)n, (size_t)n);
	double complex *s = fft_alloc_complex(half * (size_t)n);
	double slope = 0;

	fill_noise(h, cells, seed);
	fft_forward(fft, h, s);
	for (size_t i = 0; i < half * (size_t)n; i++) {
		double kx = (double)(i % half), ky = (double)(i / half);
		double k = hypot(kx, ky > n / 2 ? ky - n : ky);
		double a = k < low || k > high ? 0 : k < roll ? 1 : pow(k / roll, -1.8);

		s[i] *= a / (double)cells;
		slope += (i % half == 0 || i % half == half - 1 ? 1 : 2) *
			 pow(cabs(s[i]), 2) * pow(2 * pi * k, 2);
	}
	fft_inverse(fft, s, h);
	fft_free(s);
	fft_done(fft);
	return sqrt(slope);
}

static double rms(const double *h, size_t n)
{
	double sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += h[i] * h[i];
	return sqrt(sum / (double)n);
}

static void make_surface(const char *scene, double *h, int n)
{
	size_t cells = (size_t)n * (size_t)n;
	double scale = 0;

	if (strcmp(scene, "per") == 0)
		scale = 0.1 / fill_rough(h, n, 42, 4, 4, n / 8.0);
	if (strcmp(scene, "free") == 0) {
		fill_rough(h, n, 7, 8, 8, n / 8.0);
		scale = 0.004 / rms(h, cells);
	}
	for (size_t i = 0; i < cells; i++) {
		double x = ((double)(i % (size_t)n) + 0.5) / n - 0.5;
		double y = ((double)(i / (size_t)n) + 0.5) / n - 0.5;

		h[i] *= scale;
		if (strcmp(scene, "per") != 0)
			h[i] -= (x * x + y * y) / 2;
	}
}

static double now(void)
{
	struct timespec t;

	/* One thread: its own time, whatever else the machine does. */
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char **argv)
{
	struct contact_par par = { .estar = 1, .max_iterations = 20000 };
	struct contact *c;
	const struct contact_result *r;
	double *h, *p, *q, start, setup, solve, difference = NAN, area_error = NAN;
	double memory, pressure;
	struct rusage usage;
	size_t cells;

	if (argc < 6) {
		fprintf(stderr,
			"usage: contact SCENE N PRESSURE SOLVER TOLERANCE [REFERENCE]\n");
		return 2;
	}
	par.nx = par.ny = atoi(argv[2]);
	par.dx = par.dy = 1.0 / par.nx;
	pressure = atof(argv[3]);
	par.solver = strcmp(argv[4], "pk") == 0 ? CONTACT_PK : CONTACT_BCCG;
	par.boundary = strcmp(argv[1], "per") == 0 ? CONTACT_PERIODIC : CONTACT_FREE;
	par.tolerance = atof(argv[5]);
	cells = (size_t)par.nx * (size_t)par.nx;
	h = fft_alloc(cells);
	p = fft_alloc(cells);
	make_surface(argv[1], h, par.nx);
	start = now();
	c = contact_new(&par);
	if (!c)
		return 1;
	setup = now() - start;
	start = now();
	contact_solve(c, h, CONTACT_PRESSURE, pressure, p, NULL);
	solve = now() - start;
	getrusage(RUSAGE_SELF, &usage);
	memory = (double)usage.ru_maxrss / 1024;
	r = contact_result(c);
	if (argc > 6) {
		struct contact *best;

		par.tolerance = atof(argv[6]);
		par.solver = CONTACT_BCCG;
		best = contact_new(&par);
		q = fft_alloc(cells);
		memcpy(q, p, cells * sizeof(*q));
		contact_solve(best, h, CONTACT_PRESSURE, pressure, q, NULL);
		difference = 0;
		for (size_t i = 0; i < cells; i++)
			difference += fabs(p[i] - q[i]);
		difference /= pressure * (double)cells;
		area_error = r->area - contact_result(best)->area;
		contact_free(best);
		fft_free(q);
	}
	printf("%s\t%d\t%g\t%s\t%g\t%.3g\t%.3g\t%.3g\t%.5f\t%.4f\t%.4f\t%ld\t%ld\t%.1f\t%.1f\n",
		argv[1], par.nx, pressure, argv[4], atof(argv[5]), r->certificate,
		difference, area_error, r->area, setup, solve, r->iterations,
		r->transforms, r->work, memory);
	contact_free(c);
	fft_free(h);
	fft_free(p);
	return 0;
}
