/* surface.c - see surface.h */
#include "surface/surface.h"
#include "num/dot.h"
#include "num/grid.h"
#include "num/status.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- missing samples ---- */

size_t surface_missing(int nx, int ny, const double *z)
{
	size_t missing = 0;

	for (size_t i = 0; i < grid_size(nx, ny); i++)
		missing += isnan(z[i]) != 0;
	return missing;
}

/* The unknown samples and their neighbours: sample place[k], unknown or known. */
struct holes {
	size_t nx, ny, n;
	size_t *place;
	size_t *index;        /* of a sample: its unknown, or n where it is known */
	double along, across; /* weights of the neighbours along x and y */
	double *x, *r, *p, *q;
};

struct neighbour {
	size_t place;
	double weight;
};

/* Neighbours of a sample; returns how many. */
static int neighbours(const struct holes *h, size_t place, struct neighbour next[4])
{
	size_t ix = place % h->nx, iy = place / h->nx;
	int n = 0;

	if (ix > 0)
		next[n++] = (struct neighbour){ place - 1, h->along };
	if (ix + 1 < h->nx)
		next[n++] = (struct neighbour){ place + 1, h->along };
	if (iy > 0)
		next[n++] = (struct neighbour){ place - h->nx, h->across };
	if (iy + 1 < h->ny)
		next[n++] = (struct neighbour){ place + h->nx, h->across };
	return n;
}

/* y = -dx dy times the Laplacian of the unknowns v: the fluxes through the sides of the
 * cells; with z, known neighbours count too. */
static void laplacian(const struct holes *h, const double *v, const double *z, double *y)
{
	struct neighbour next[4];

	for (size_t k = 0; k < h->n; k++) {
		int n = neighbours(h, h->place[k], next);
		double sum = 0;

		for (int j = 0; j < n; j++) {
			size_t m = h->index[next[j].place];
			double there = m < h->n ? v[m] : z ? z[next[j].place] : 0;

			sum += next[j].weight * (v[k] - there);
		}
		y[k] = sum;
	}
}

/* The number of steps grows with the width of the widest hole in samples, and is no more
 * than that of the unknowns in exact arithmetic; twice that leaves room for rounding. */
static int solve_holes(struct holes *h, const double *z, double *residual)
{
	double rr, first, most = 2 * (double)h->n;
	int step;

	laplacian(h, h->x, z, h->r);
	for (size_t k = 0; k < h->n; k++)
		h->p[k] = h->r[k] = -h->r[k];
	first = rr = dot(h->r, h->r, h->n);
	for (step = 0; rr > SURFACE_FILLED * SURFACE_FILLED * first && step < most;
		step++) {
		double alpha, beta;

		laplacian(h, h->p, NULL, h->q);
		alpha = rr / dot(h->p, h->q, h->n);
		for (size_t k = 0; k < h->n; k++) {
			h->x[k] += alpha * h->p[k];
			h->r[k] -= alpha * h->q[k];
		}
		beta = rr;
		rr = dot(h->r, h->r, h->n);
		beta = rr / beta;
		for (size_t k = 0; k < h->n; k++)
			h->p[k] = h->r[k] + beta * h->p[k];
	}
	*residual = first > 0 ? sqrt(rr / first) : 0;
	return step;
}

enum num_status surface_fill(int nx, int ny, double dx, double dy, double *z,
	int *iterations, double *residual)
{
	size_t n = grid_size(nx, ny), missing = surface_missing(nx, ny, z), k = 0;
	struct holes h = { .nx = (size_t)nx,
		.ny = (size_t)ny,
		.n = missing,
		.along = dy / dx,
		.across = dx / dy };
	enum num_status status = NUM_MEMORY;
	double mean = 0;

	*iterations = 0;
	*residual = 0;
	if (missing == 0)
		return NUM_OK;
	h.place = calloc(missing, sizeof *h.place);
	h.index = malloc(n * sizeof *h.index);
	h.x = malloc(4 * missing * sizeof *h.x);
	if (h.place && h.index && h.x) {
		h.r = h.x + missing;
		h.p = h.r + missing;
		h.q = h.p + missing;
		for (size_t i = 0; i < n; i++) {
			h.index[i] = isnan(z[i]) ? k : missing;
			if (isnan(z[i]))
				h.place[k++] = i;
			else
				mean += z[i] / (double)(n - missing);
		}
		for (k = 0; k < missing; k++)
			h.x[k] = mean;
		*iterations = solve_holes(&h, z, residual);
		for (k = 0; k < missing; k++)
			z[h.place[k]] = h.x[k];
		status = NUM_OK;
	}
	free(h.place);
	free(h.index);
	free(h.x);
	return status;
}

/* ---- plane, crop, crown ---- */

/* Coordinates from the middle make the normal equations diagonal. */
void surface_level(int nx, int ny, double *z)
{
	double mean = surface_mean(nx, ny, z), sx = 0, sy = 0, xx, yy;

	for (int iy = 0; iy < ny; iy++) {
		double row = 0, moment = 0;

		for (int ix = 0; ix < nx; ix++) {
			double d = z[grid_at(nx, ix, iy)] - mean;

			row += d;
			moment += d * (ix - 0.5 * (nx - 1));
		}
		sx += moment;
		sy += row * (iy - 0.5 * (ny - 1));
	}
	xx = (double)ny * nx * ((double)nx * nx - 1) / 12;
	yy = (double)nx * ny * ((double)ny * ny - 1) / 12;
	sx = xx > 0 ? sx / xx : 0;
	sy = yy > 0 ? sy / yy : 0;
	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++)
			z[grid_at(nx, ix, iy)] -= mean + sx * (ix - 0.5 * (nx - 1)) +
						  sy * (iy - 0.5 * (ny - 1));
}

void surface_crop(int nx, const double *z, int x0, int y0, int mx, int my, double *out)
{
	for (int iy = 0; iy < my; iy++)
		memcpy(out + grid_at(mx, 0, iy), z + grid_at(nx, x0, y0 + iy),
			(size_t)mx * sizeof *out);
}

void surface_crown(int nx, int ny, double dx, double dy, double drop, double *z)
{
	double corner = 0.25 * (nx * dx * nx * dx + ny * dy * ny * dy);

	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++) {
			double x = (ix + 0.5 - 0.5 * nx) * dx,
			       y = (iy + 0.5 - 0.5 * ny) * dy;

			z[grid_at(nx, ix, iy)] -= drop * ((x * x + y * y) / corner);
		}
}

/* ---- resampling, one direction at a time ---- */

/* Sample i of n with the rim continued so that quadratics stay exact (Keys, eq. 19). */
static double sample(const double *z, size_t stride, int n, int i)
{
	if (n == 1)
		return z[0];
	if (n == 2 && (i < 0 || i > 1))
		return i < 0 ? 2 * z[0] - z[stride] : 2 * z[stride] - z[0];
	if (i < 0)
		return 3 * z[0] - 3 * z[stride] + z[2 * stride];
	if (i >= n)
		return 3 * z[(size_t)(n - 1) * stride] - 3 * z[(size_t)(n - 2) * stride] +
		       z[(size_t)(n - 3) * stride];
	return z[(size_t)i * stride];
}

/* Cubic convolution at position x (in samples, 0 at the first); the end pieces continue
 * beyond the first and last sample. */
static double interpolate(const double *z, size_t stride, int n, double x)
{
	int i = (int)floor(x);
	double t, a, b, c, d;

	if (i < 0)
		i = 0;
	if (i > n - 2)
		i = n > 1 ? n - 2 : 0;
	t = x - i;
	a = sample(z, stride, n, i - 1);
	b = sample(z, stride, n, i);
	c = sample(z, stride, n, i + 1);
	d = sample(z, stride, n, i + 2);
	return b + 0.5 * t *
			   (c - a +
				   t * (2 * a - 5 * b + 4 * c - d +
					       t * (3 * (b - c) + d - a)));
}

/* Mean over [begin, end], in cells, cell i reaching from i to i + 1. */
static double average(const double *z, size_t stride, int n, double begin, double end)
{
	double sum = 0;

	for (int i = (int)begin; i < n && i < end; i++) {
		double low = i > begin ? i : begin, high = i + 1 < end ? i + 1 : end;

		if (high > low)
			sum += (high - low) * z[(size_t)i * stride];
	}
	return sum / (end - begin);
}

static void resample_line(
	const double *z, int n, size_t stride, double *out, int m, size_t out_stride)
{
	double ratio = (double)n / m;

	for (int i = 0; i < m; i++)
		out[(size_t)i * out_stride] =
			m < n ? average(z, stride, n, i * ratio, (i + 1) * ratio)
			      : interpolate(z, stride, n, (i + 0.5) * ratio - 0.5);
}

enum num_status surface_resample(
	int nx, int ny, const double *z, int mx, int my, double *out)
{
	double *half = malloc(grid_size(mx, ny) * sizeof *half);

	if (!half)
		return NUM_MEMORY;
	for (int iy = 0; iy < ny; iy++)
		resample_line(
			z + grid_at(nx, 0, iy), nx, 1, half + grid_at(mx, 0, iy), mx, 1);
	for (int ix = 0; ix < mx; ix++)
		resample_line(half + ix, ny, (size_t)mx, out + ix, my, (size_t)mx);
	free(half);
	return NUM_OK;
}

/* ---- mean heights ---- */

/* Sum over the surface, row by row so that rounding grows with the side only. */
static double sum_rows(int nx, int ny, const double *z,
	double (*term)(double z, double mean), double mean)
{
	double sum = 0;

	for (int iy = 0; iy < ny; iy++) {
		double row = 0;

		for (int ix = 0; ix < nx; ix++)
			row += term(z[grid_at(nx, ix, iy)], mean);
		sum += row;
	}
	return sum;
}

static double deviation(double z, double mean)
{
	return z - mean;
}

static double magnitude(double z, double mean)
{
	return fabs(z - mean);
}

static double square(double z, double mean)
{
	return (z - mean) * (z - mean);
}

double surface_mean(int nx, int ny, const double *z)
{
	double n = (double)nx * ny;
	double mean = sum_rows(nx, ny, z, deviation, 0) / n;

	/* A second sum removes the rounding of a mean far from 0. */
	return mean + sum_rows(nx, ny, z, deviation, mean) / n;
}

double surface_sa(int nx, int ny, const double *z)
{
	return sum_rows(nx, ny, z, magnitude, surface_mean(nx, ny, z)) /
	       ((double)nx * ny);
}

double surface_sq(int nx, int ny, const double *z)
{
	return sqrt(
		sum_rows(nx, ny, z, square, surface_mean(nx, ny, z)) / ((double)nx * ny));
}
