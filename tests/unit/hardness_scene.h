/* hardness_scene.h - random contacts with a hardness, most of them where load over
 * hardness is a whole number of cells, and an independent bound on the error of a
 * solution.  Those of a second set have white noise for heights and prime numbers of
 * cells, those of a third are strips as long as a few waves. */
#ifndef HARDNESS_SCENE_H
#define HARDNESS_SCENE_H

#include "contact/solver.h"
#include "num/fft.h"
#include "num/philox.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

enum hardness_set { HARDNESS_SHAPES, HARDNESS_NOISE, HARDNESS_STRIPS, HARDNESS_SETS };
/* Random numbers of the scenes of a set: those of its first on. */
enum { HARDNESS_STREAMS = 1 << 20 };

struct hardness_scene {
	struct contact_par par;
	double *height, mean;
};

static double hardness_draw(int number, uint64_t place)
{
	return philox_uniform(11, (uint32_t)number, RNG_NOISE, place);
}

static double hardness_range(int number, uint64_t place, double low, double high)
{
	return low * pow(high / low, hardness_draw(number, place));
}

/* Noise, waves, a paraboloid, steps, levels that tie, a tilted plane, spikes, a flat. */
static double hardness_height(int k, int kind, int nx, int ny, int x, int y)
{
	double u = hardness_draw(k, 1000 + (uint64_t)(y * nx + x));
	double wave = sin(x * 0.31 + 0.1) * cos(y * 0.23) + 0.3 * cos(x * 1.1 - y * 0.7);

	switch (kind) {
	case 0:
		return u;
	case 1:
		return wave;
	case 2:
		return -(pow(x - nx / 2.0, 2) + pow(y - ny / 2.0, 2)) /
		       (nx * nx + ny * ny);
	case 3:
		return x < nx / 2;
	case 4:
		return floor(4 * wave) / 4;
	case 5:
		return x + 0.01 * y;
	case 6:
		return u < 0.1;
	case 7:
		return 0.5;
	default:
		return wave + 0.3 * u;
	}
}

static int hardness_prime(int k, uint64_t place)
{
	static const int prime[] = { 2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43 };

	return prime[(size_t)(hardness_draw(k, place) * sizeof prime / sizeof *prime)];
}

/* Waves along a strip of 1 to 9 rows, and noise. */
static struct hardness_scene hardness_strip(int k)
{
	struct hardness_scene s = { .par = { .nx = (int)hardness_range(k, 1, 100, 2000),
					    .ny = (int)(1 + 9 * hardness_draw(k, 2)),
					    .dx = 1e-6,
					    .dy = 1e-6,
					    .estar = 1e11,
					    .tolerance = 1e-8,
					    .max_iterations = 5000 } };
	double amplitude = hardness_range(k, 5, 1e-7, 3e-6),
	       noise = fmax(0.1, hardness_draw(k, 3));
	double waves = floor(1 + 3 * hardness_draw(k, 4));
	int cells = s.par.nx * s.par.ny;

	s.par.boundary = hardness_draw(k, 6) < 0.3 ? CONTACT_FREE : CONTACT_PERIODIC;
	s.mean = s.par.estar * amplitude / s.par.dx * hardness_range(k, 7, 1e-3, 0.3);
	s.par.hardness = s.mean * hardness_range(k, 8, 1.1, 22);
	s.height = fft_alloc((size_t)cells);
	for (int i = 0; i < cells; i++)
		s.height[i] =
			amplitude *
			(cos(6.283185307179586 * waves * (i % s.par.nx) / s.par.nx) +
				noise * (4 * hardness_draw(k, 1000 + (uint64_t)i) - 2));
	return s;
}

static struct hardness_scene hardness_small(int k, enum hardness_set set)
{
	struct hardness_scene s = { .par = { .nx = (int)hardness_range(k, 1, 1, 44),
					    .ny = (int)hardness_range(k, 2, 2, 44),
					    .dx = hardness_range(k, 3, 1e-8, 1e-3),
					    .estar = hardness_range(k, 4, 1e8, 1e12),
					    .tolerance = 1e-8,
					    .max_iterations = 5000 } };
	double amplitude = hardness_range(k, 6, 1e-9, 1e-2), loaded;
	int kind = set == HARDNESS_NOISE ? 0 : (int)(9 * hardness_draw(k, 7)), cells;

	if (set == HARDNESS_NOISE) {
		s.par.nx = hardness_prime(k, 1);
		s.par.ny = hardness_prime(k, 2);
	}
	cells = s.par.nx * s.par.ny;
	s.par.dy = s.par.dx * (hardness_draw(k, 8) < 0.7 ? 1 : 2.5);
	s.par.boundary = hardness_draw(k, 5) < 0.5 ? CONTACT_FREE : CONTACT_PERIODIC;
	s.par.hardness =
		s.par.estar * amplitude / s.par.dx * hardness_range(k, 9, 1e-4, 10);
	s.height = fft_alloc((size_t)cells);
	for (int i = 0; i < cells; i++)
		s.height[i] = amplitude * hardness_height(k, kind, s.par.nx, s.par.ny,
						  i % s.par.nx, i / s.par.nx);
	/* One in four: not whole, or off it by rounding. */
	loaded = floor(1 + hardness_draw(k, 10) * (cells - 1));
	if (k % 8 == 1)
		loaded -= 0.999 * hardness_draw(k, 11);
	if (k % 16 == 3)
		loaded *= 1 - 1e-13;
	if (k % 16 == 11 && loaded < cells - 1)
		loaded *= 1 + 1e-13;
	s.mean = fmin(loaded, cells - 0.5) / cells * s.par.hardness;
	return s;
}

static struct hardness_scene hardness_scene(int k, enum hardness_set set)
{
	return set == HARDNESS_STRIPS ? hardness_strip(k) : hardness_small(k, set);
}

static int hardness_order(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* The duality gap of pressures at the approach where it is least, found by sorting, over
 * their elastic work; infinite where a pressure is out of bounds or the load is not kept.
 */
static double hardness_gap(
	struct contact *c, const struct hardness_scene *s, const double *p)
{
	size_t n = (size_t)s->par.nx * (size_t)s->par.ny, rank;
	double *g = fft_alloc(n), *sorted = fft_alloc(n);
	double length = fmax(s->par.nx * s->par.dx, s->par.ny * s->par.dy);
	double sum = 0, gap = 0, work = 0, least = 0, size, approach;

	size = s->mean * s->mean * length / s->par.estar;

	contact_displacement(c, p, g);
	for (size_t i = 0; i < n; i++) {
		if (!(p[i] >= 0 && p[i] <= s->par.hardness))
			gap = INFINITY;
		sum += p[i];
		work += p[i] * g[i];
		least = fmin(least, g[i]);
		size = tap_max(size, p[i] * (fabs(g[i]) + fabs(s->height[i])));
		g[i] -= s->height[i];
		sorted[i] = g[i];
	}
	work -= sum * least;
	qsort(sorted, n, sizeof *sorted, hardness_order);
	rank = (size_t)ceil(sum / s->par.hardness - 1e-9);
	approach = sorted[rank > 0 ? rank - 1 : 0];
	for (size_t i = 0; i < n; i++)
		gap += p[i] * fmax(g[i] - approach, 0) +
		       (s->par.hardness - p[i]) * fmax(approach - g[i], 0);
	if (!(fabs(sum / (s->mean * (double)n) - 1) < 1e-12))
		gap = INFINITY;
	fft_free(g);
	fft_free(sorted);
	/* What rounding alone makes, as on a flat in full periodic contact. */
	return gap <= 1e-14 * size * (double)n ? 0 : gap / work;
}

struct hardness_outcome {
	int solved;
	double worst; /* gap found here */
	long most;    /* iterations */
};

static void hardness_solve(int k, enum hardness_set set, enum contact_solver solver,
	struct hardness_outcome *o)
{
	struct hardness_scene s = hardness_scene(k + (int)set * HARDNESS_STREAMS, set);
	double *p = fft_alloc((size_t)s.par.nx * (size_t)s.par.ny), gap;
	enum contact_status status;
	struct contact *c;

	s.par.solver = solver;
	c = contact_new(&s.par);
	status = contact_solve(c, s.height, CONTACT_PRESSURE, s.mean, p, NULL);
	gap = hardness_gap(c, &s, p);
	if (status == CONTACT_OK && gap < 2e-8)
		o->solved++;
	else
		printf("# scene %d: %dx%d, %s, load %.17g cells, optimality gap %g after %ld "
		       "iterations, gap %g\n",
			k, s.par.nx, s.par.ny,
			s.par.boundary == CONTACT_FREE ? "free" : "periodic",
			s.mean / s.par.hardness * s.par.nx * s.par.ny,
			contact_result(c)->optimality_gap, contact_result(c)->iterations,
			gap);
	o->worst = tap_max(o->worst, gap);
	if (contact_result(c)->iterations > o->most)
		o->most = contact_result(c)->iterations;
	contact_free(c);
	fft_free(p);
	fft_free(s.height);
}

/* Solves scenes first to last - 1 of each set by both solvers. */
static inline void hardness_scan(int first, int last)
{
	static const char *const name[] = { "the default", "Polonsky and Keer's" };
	static const char *const what[] = { "scenes with a hardness",
		"scenes of white noise on prime numbers of cells with a hardness",
		"scenes of waves along strips with a hardness" };

	for (int i = 0; i < 2 * HARDNESS_SETS; i++) {
		struct hardness_outcome o = { 0 };

		for (int k = first; k < last; k++)
			hardness_solve(k, (enum hardness_set)(i / 2),
				(enum contact_solver)(i % 2), &o);
		ok(o.solved == last - first,
			"%s solver solves %d of %d %s; the gap is at most %.1e of the elastic work, with at most %ld iterations",
			name[i % 2], o.solved, last - first, what[i / 2], o.worst,
			o.most);
	}
}

#endif
