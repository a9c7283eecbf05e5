/* Contacts whose solution is known: a pressure and a gap are chosen, and the height is
 * what makes them the contact, h = K p - g - exact_approach.  K is applied here by plain
 * transforms of its own: 2 / (E* q) for each wave, or Love's closed form zero-padded.
 * Strips, primes, deep holes, hardnesses, by both boundaries; each row states iterations
 * and the error of the pressure, sum |p - p*| / sum p*. */
#ifndef EXACT_SCENE_H
#define EXACT_SCENE_H

#include "contact/solver.h"
#include "num/fft.h"
#include "num/philox.h"
#include "tap.h"
#include <complex.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum exact_shape {
	NOISE,  /* cells at random, pressures at random */
	PATCHES /* patches of waves of many lengths, pressure like a root at their rims */
};

static const double exact_modulus = 1e11, exact_cell = 1e-6, exact_approach = 3e-6;

static double exact_draw(size_t i, uint32_t what)
{
	return philox_uniform(7, what, RNG_NOISE, i);
}

/* Of many lengths down to 8 cells, about -1 to 1. */
static double exact_waves(int x, int y)
{
	static const double length[] = { 8.7, 13.1, 29.3, 61.7, 211.9 };
	double sum = 0;

	for (int k = 0; k < 5; k++) {
		double q = 2 * M_PI / length[k];

		sum += 0.5 * cos(q * (x * cos(k + 0.4) + y * sin(k + 0.4)) + k) /
		       sqrt(k + 1);
	}
	return sum;
}

/* Love's displacement of a unit exact_cell of unit pressure, times pi E*. */
static double exact_love(double x, double y)
{
	double sum = 0;

	for (int i = 0; i < 2; i++)
		for (int j = 0; j < 2; j++) {
			double a = x + i - 0.5, b = y + j - 0.5, r = hypot(a, b);

			sum += (i == j ? 1 : -1) * (a * log(b + r) + b * log(a + r));
		}
	return sum;
}

/* u = K p by transforms of px * py points, the kernel in k there. */
static void exact_apply(int nx, int ny, int px, int py, const double complex *k,
	const double *p, double *u)
{
	struct fft *fft = fft_new((size_t)px, (size_t)py);
	size_t points = (size_t)px * (size_t)py,
	       waves = ((size_t)px / 2 + 1) * (size_t)py;
	double *plane = fft_alloc(points);
	double complex *image = fft_alloc_complex(waves);

	memset(plane, 0, points * sizeof(*plane));
	for (int y = 0; y < ny; y++)
		memcpy(plane + (size_t)y * (size_t)px, p + (size_t)y * (size_t)nx,
			(size_t)nx * sizeof(*p));
	fft_forward(fft, plane, image);
	for (size_t i = 0; i < waves; i++)
		image[i] *= k[i] / (double)points;
	fft_inverse(fft, image, plane);
	for (int y = 0; y < ny; y++)
		memcpy(u + (size_t)y * (size_t)nx, plane + (size_t)y * (size_t)px,
			(size_t)nx * sizeof(*u));
	fft_done(fft);
	fft_free(plane);
	fft_free(image);
}

static void exact_displace(
	int nx, int ny, enum contact_boundary boundary, const double *p, double *u)
{
	int is_free = boundary == CONTACT_FREE;
	int px = is_free ? (int)fft_good_size((size_t)(2 * nx)) : nx,
	    py = is_free ? (int)fft_good_size((size_t)(2 * ny)) : ny;
	double complex *k = fft_alloc_complex(((size_t)px / 2 + 1) * (size_t)py);

	if (is_free) {
		double *plane = fft_alloc((size_t)px * (size_t)py);
		struct fft *fft = fft_new((size_t)px, (size_t)py);

		for (int y = 0; y < py; y++)
			for (int x = 0; x < px; x++)
				plane[(size_t)y * (size_t)px + (size_t)x] =
					exact_cell / (M_PI * exact_modulus) *
					exact_love(x < px - x ? x : px - x,
						y < py - y ? y : py - y);
		fft_forward(fft, plane, k);
		fft_done(fft);
		fft_free(plane);
	} else {
		for (int y = 0; y < py; y++)
			for (int x = 0; x <= px / 2; x++) {
				double qx = 2 * M_PI * x / (px * exact_cell);
				double qy = 2 * M_PI * (y < py - y ? y : py - y) /
					    (py * exact_cell);
				double q = hypot(qx, qy);

				k[(size_t)y * ((size_t)px / 2 + 1) + (size_t)x] =
					q > 0 ? 2 / (exact_modulus * q) : 0;
			}
	}
	exact_apply(nx, ny, px, py, k, p, u);
	fft_free(k);
}

struct exact_scene {
	int nx, ny;
	enum contact_boundary boundary;
	enum exact_shape shape;
	double level;    /* contact where the waves are higher; noise: part in contact */
	double hardness; /* 0: none; pressures are up to 1e9 */
	double hole;     /* depth of one, m */
	long iterations; /* at most */
};

static void exact_choose(const struct exact_scene *s, double *p, double *gap)
{
	for (int y = 0; y < s->ny; y++)
		for (int x = 0; x < s->nx; x++) {
			size_t i = (size_t)y * (size_t)s->nx + (size_t)x;
			double over = exact_waves(x, y) - s->level, u = exact_draw(i, 1);
			int in = s->shape == NOISE ? exact_draw(i, 2) < s->level
						   : over > 0;

			p[i] = !in                 ? 0
			       : s->shape == NOISE ? 1e9 * (0.01 + u)
						   : 1e9 * sqrt(over);
			gap[i] = in                  ? 0
				 : s->shape == NOISE ? 1e-7 * u
						     : 1e-6 * pow(-over, 1.5);
			if (s->hardness > 0 && p[i] >= s->hardness) {
				gap[i] = -1e-7 * (p[i] / s->hardness - 1);
				p[i] = s->hardness;
			}
		}
	for (size_t i = 0; i < (size_t)s->nx * (size_t)s->ny && s->hole > 0; i++)
		if (p[i] <= 0) {
			gap[i] = s->hole;
			break;
		}
}

static void exact_solve(const struct exact_scene *s)
{
	size_t n = (size_t)s->nx * (size_t)s->ny;
	double *p = fft_alloc(n), *gap = fft_alloc(n), *h = fft_alloc(n),
	       *found = fft_alloc(n), sum = 0, error = 0, cells = 0;
	struct contact_par par = { .nx = s->nx,
		.ny = s->ny,
		.dx = exact_cell,
		.dy = exact_cell,
		.estar = exact_modulus,
		.hardness = s->hardness,
		.boundary = s->boundary,
		.tolerance = 1e-8,
		.max_iterations = 1000 };
	struct contact *c = contact_new(&par);
	enum contact_status status;

	exact_choose(s, p, gap);
	exact_displace(s->nx, s->ny, s->boundary, p, h);
	for (size_t i = 0; i < n; i++) {
		h[i] -= gap[i] + exact_approach;
		sum += p[i];
		cells += p[i] > 0;
	}
	memset(found, 0, n * sizeof(*found));
	status = contact_solve(c, h, CONTACT_PRESSURE, sum / (double)n, found, NULL);
	for (size_t i = 0; i < n; i++)
		error += fabs(found[i] - p[i]);
	ok(status == CONTACT_OK && error <= 1e-6 * sum &&
			contact_result(c)->iterations <= s->iterations,
		"the scene \"%dx%d %s, %s on %.0f %%%s%s\" leads to \"%ld iterations\" where \"the solver finds the chosen pressure in %ld iterations\" is expected (error %.1e)",
		s->nx, s->ny, s->boundary == CONTACT_FREE ? "free" : "periodic",
		s->shape == NOISE ? "noise" : "patches", 100 * cells / (double)n,
		s->hardness > 0 ? ", a hardness" : "", s->hole > 0 ? ", a hole" : "",
		contact_result(c)->iterations, s->iterations, error / sum);
	contact_free(c);
	fft_free(p);
	fft_free(gap);
	fft_free(h);
	fft_free(found);
}

#endif
