/* contact - one solve of a defined surface, timed: error, work and memory as a TSV row
 *
 * usage: contact SCENE N PRESSURE SOLVER TOLERANCE [REFERENCE]
 *
 * SCENE: per (self-affine, periodic), free (rough paraboloid), hertz (paraboloid) or
 * wave (a cosine of amplitude 0.1 in one direction); side 1, E* 1.  Noise is splitmix64
 * and Box-Muller, so that any language can make the same surfaces.  SOLVER: bccg, pk,
 * mlms (bccg with multi-level multi-summation), or save, which writes the pressure to
 * the file REFERENCE; with the others that file is what the pressure is compared with.
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
		       angle = 2 * M_PI * uniform(&seed);

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
			 pow(cabs(s[i]), 2) * pow(2 * M_PI * k, 2);
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

static void make_surface(const char *scene, double *h, int nx, int ny)
{
	size_t cells = (size_t)nx * (size_t)ny;
	int is_round = strcmp(scene, "hertz") == 0 || strcmp(scene, "free") == 0;
	double scale = 0;

	if (strcmp(scene, "per") == 0)
		scale = 0.1 / fill_rough(h, nx, 42, 4, 4, nx / 8.0);
	if (strcmp(scene, "free") == 0) {
		fill_rough(h, nx, 7, 8, 8, nx / 8.0);
		scale = 0.004 / rms(h, cells);
	}
	for (size_t i = 0; i < cells; i++) {
		double x = ((double)(i % (size_t)nx) + 0.5) / nx - 0.5;
		double y = ((double)(i / (size_t)nx) + 0.5) / ny - 0.5;

		h[i] *= scale;
		if (is_round)
			h[i] -= (x * x + y * y) / 2;
		if (strcmp(scene, "wave") == 0)
			h[i] = 0.1 * cos(2 * M_PI * x);
	}
}

/* Closed forms: Hertz for radius 1, and Westergaard. */
static double exact_pressure(const char *scene, double mean, double x, double y)
{
	if (strcmp(scene, "hertz") == 0) {
		double a2 = pow(0.75 * mean, 2.0 / 3), p0 = 2 * sqrt(a2) / M_PI;

		return p0 * sqrt(fmax(1 - (x * x + y * y) / a2, 0));
	}
	if (strcmp(scene, "wave") == 0) {
		double s2 = mean / (0.1 * M_PI), sx = sin(M_PI * x);

		return 2 * mean * cos(M_PI * x) / s2 * sqrt(fmax(s2 - sx * sx, 0));
	}
	return NAN;
}

static double now(void)
{
	struct timespec t;

	/* Processor time of the only thread, independent of other load. */
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Largest resident memory, megabytes. */
static double memory_used(void)
{
	struct rusage usage;

	getrusage(RUSAGE_SELF, &usage);
	return (double)usage.ru_maxrss / 1024;
}

/* Pressures of a file, or NULL. */
static double *read_pressure(const char *path, size_t cells)
{
	FILE *f = path ? fopen(path, "rb") : NULL;
	double *q = f ? fft_alloc(cells) : NULL;

	if (q && fread(q, sizeof *q, cells, f) != cells) {
		fft_free(q);
		q = NULL;
	}
	if (f)
		fclose(f);
	return q;
}

static int write_pressure(const char *path, const double *p, size_t cells)
{
	FILE *f = fopen(path, "wb");

	return !f || fwrite(p, sizeof *p, cells, f) != cells || fclose(f) != 0;
}

/* Mean absolute differences over the mean pressure, and of areas: to a reference, and
 * to the closed form. */
static void compare(const char *scene, const struct contact_par *par, double mean,
	const double *p, const double *q, double error[3])
{
	size_t nx = (size_t)par->nx, cells = nx * (size_t)par->ny;
	double sum[3] = { 0 };

	for (size_t i = 0; i < cells; i++) {
		double x = ((double)(i % nx) + 0.5) * par->dx - 0.5;
		double y = ((double)(i / nx) + 0.5) * par->dy - 0.5;

		sum[0] += q ? fabs(p[i] - q[i]) / mean : NAN;
		sum[1] += q ? (double)((p[i] > 0) - (q[i] > 0)) : NAN;
		sum[2] += fabs(p[i] - exact_pressure(scene, mean, x, y)) / mean;
	}
	for (int k = 0; k < 3; k++)
		error[k] = sum[k] / (double)cells;
}

int main(int argc, char **argv)
{
	struct contact_par par = { .estar = 1, .max_iterations = 20000 };
	const struct contact_result *r;
	struct contact *c;
	double *h, *p, *q, start, setup, solve, memory, mean, error[3];
	size_t cells;

	if (argc < 6) {
		fprintf(stderr,
			"usage: contact SCENE N PRESSURE SOLVER TOLERANCE [REFERENCE]\n");
		return 2;
	}
	par.nx = atoi(argv[2]);
	par.ny = strcmp(argv[1], "wave") == 0 ? 1 : par.nx;
	par.dx = 1.0 / par.nx;
	par.dy = 1.0 / par.ny;
	mean = atof(argv[3]);
	par.solver = strcmp(argv[4], "pk") == 0 ? CONTACT_PK : CONTACT_BCCG;
	par.boundary = strcmp(argv[1], "per") == 0 || par.ny == 1 ? CONTACT_PERIODIC
								  : CONTACT_FREE;
	par.multiply = strcmp(argv[4], "mlms") == 0 ? CONTACT_MLMS : CONTACT_FFT;
	par.tolerance = atof(argv[5]);
	cells = (size_t)par.nx * (size_t)par.ny;
	h = fft_alloc(cells);
	p = fft_alloc(cells);
	make_surface(argv[1], h, par.nx, par.ny);
	start = now();
	c = contact_new(&par);
	if (!c)
		return 1;
	setup = now() - start;
	start = now();
	contact_solve(c, h, CONTACT_PRESSURE, mean, p, NULL);
	solve = now() - start;
	memory = memory_used();
	r = contact_result(c);
	if (strcmp(argv[4], "save") == 0)
		return write_pressure(argv[6], p, cells);
	q = read_pressure(argc > 6 ? argv[6] : NULL, cells);
	compare(argv[1], &par, mean, p, q, error);
	printf("%s\t%d\t%g\t%s\t%g\t%.3g\t%.3g\t%.3g\t%.3g\t%.5f\t%.4f\t%.4f\t%ld\t%ld\t%.1f\t%.1f\n",
		argv[1], par.nx, mean, argv[4], par.tolerance, r->optimality_gap,
		error[0], error[1], error[2], r->area, setup, solve, r->iterations,
		r->transforms, r->work, memory);
	contact_free(c);
	fft_free(h);
	fft_free(p);
	fft_free(q);
	return 0;
}
