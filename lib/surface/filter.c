#include "surface/filter.h"
#include "num/fft.h"
#include "num/status.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Gaussian filters ---- */

/* Width of the weights over the nesting index: 2^-1 at the index itself. */
static double width(enum filter_ends ends)
{
	/* pi a^2 = ln 2; for order 2 (1 + x) exp(-x) = 1/2 with x = pi a^2 */
	return sqrt((ends == FILTER_PARABOLA ? 1.6783469900166605 : log(2.0)) / M_PI);
}

enum { TERMS = 3 };
/* Weight over the largest from which on weights are left out: together these change the
 * output by less than 1e-12 of the heights. */
static const double least = 1e-12;

/* The filter along one direction. */
struct kernel {
	int n, reach, order, periodic;
	int mean;       /* longer than the period: only the mean passes */
	double *weight; /* [reach + 1], by distance */
	double *row;    /* [2 reach + 1]: of one point, divided by their sum */
};

/* 1 if every periodic wave of the line passes with less than 5e-13. */
static int is_mean(double step, double nesting, int n)
{
	return width(FILTER_PERIODIC) * nesting > 3 * n * step;
}

static int reach_of(double step, double nesting, enum filter_ends ends, int n)
{
	double reach = width(ends) * nesting * sqrt(-log(least) / M_PI) / step;

	/* Beyond the line there are no points, unless it is periodic. */
	if (ends != FILTER_PERIODIC)
		return (int)fmin(reach, n - 1);
	return is_mean(step, nesting, n) ? n / 2 : (int)reach;
}

static enum num_status kernel_make(
	struct kernel *k, int n, double step, double nesting, enum filter_ends ends)
{
	double a = width(ends) * nesting / step;

	k->n = n;
	k->reach = reach_of(step, nesting, ends, n);
	k->periodic = ends == FILTER_PERIODIC;
	k->mean = k->periodic && is_mean(step, nesting, n);
	k->order = ends == FILTER_LINE ? 1 : ends == FILTER_PARABOLA ? 2 : 0;
	k->weight = calloc(3 * (size_t)k->reach + 2, sizeof *k->weight);
	if (!k->weight)
		return NUM_MEMORY;
	k->row = k->weight + k->reach + 1;
	for (int i = 0; i <= k->reach; i++)
		k->weight[i] = exp(-M_PI * (i / a) * (i / a));
	return NUM_OK;
}

/* Solves the normal equations of the polynomial; m: moments 0 to 2 order.  c: what the
 * powers of the distance count in its value at the point. */
static void local_polynomial(int order, const double *m, double *c)
{
	double a[TERMS][TERMS + 1] = { { 0 } };
	int n = order + 1;

	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			a[i][j] = m[i + j];
		a[i][n] = i == 0;
	}
	for (int i = 0; i < n; i++)
		for (int k = i + 1; k < n; k++) {
			double f = a[i][i] > 0 ? a[k][i] / a[i][i] : 0;

			for (int j = i; j <= n; j++)
				a[k][j] -= f * a[i][j];
		}
	for (int i = n - 1; i >= 0; i--) {
		double sum = a[i][n];

		for (int j = i + 1; j < n; j++)
			sum -= a[i][j] * c[j];
		/* Fewer points than terms leave a pivot of rounding, some 1e-16 of the
		 * moment: the polynomial has a lower order. */
		c[i] = a[i][i] > 1e-13 * fmax(m[2 * i], 1e-300) ? sum / a[i][i] : 0;
	}
}

/* Weights of the neighbours from -below to above for the value at one point. */
static void point_weights(struct kernel *k, int below, int above)
{
	double m[2 * TERMS - 1] = { 0 }, c[TERMS] = { 0 };
	double scale = k->reach > 0 ? k->reach : 1;

	for (int j = -below; j <= above; j++) {
		double power = k->weight[abs(j)];

		for (int t = 0; t <= 2 * k->order; t++, power *= j / scale)
			m[t] += power;
	}
	local_polynomial(k->order, m, c);
	for (int j = -below; j <= above; j++) {
		double x = j / scale;

		k->row[j + below] = k->weight[abs(j)] * (c[0] + x * (c[1] + x * c[2]));
	}
}

static void average_lines(const struct kernel *k, const double *in, double *out,
	size_t stride, size_t step, int count)
{
	for (int l = 0; l < count; l++) {
		double sum = 0;

		for (int i = 0; i < k->n; i++)
			sum += in[(size_t)i * stride + (size_t)l * step];
		for (int i = 0; i < k->n; i++)
			out[(size_t)i * stride + (size_t)l * step] = sum / k->n;
	}
}

/* Filters count lines whose points are stride apart and which begin step apart; all lines
 * share the weights of a point. */
static void filter_lines(struct kernel *k, const double *in, double *out, size_t stride,
	size_t step, int count)
{
	int shared = -1;

	if (k->mean) {
		average_lines(k, in, out, stride, step, count);
		return;
	}
	for (int i = 0; i < k->n; i++) {
		int below = k->reach, above = k->reach;

		if (!k->periodic) {
			below = i < k->reach ? i : k->reach;
			above = k->n - 1 - i < k->reach ? k->n - 1 - i : k->reach;
		}
		/* Away from the ends all points have the same weights. */
		if (below < k->reach || above < k->reach || !shared || shared < 0) {
			point_weights(k, below, above);
			shared = below == k->reach && above == k->reach;
		}
		for (int l = 0; l < count; l++)
			out[(size_t)i * stride + (size_t)l * step] = 0;
		for (int j = -below; j <= above; j++) {
			double w = k->row[j + below];
			int at = k->periodic ? ((i + j) % k->n + k->n) % k->n : i + j;
			const double *from = in + (size_t)at * stride;
			double *to = out + (size_t)i * stride;

			for (int l = 0; l < count; l++)
				to[(size_t)l * step] += w * from[(size_t)l * step];
		}
	}
}

enum num_status surface_gauss(int nx, int ny, double dx, double dy, const double *z,
	double nesting, enum filter_ends ends, double *out)
{
	struct kernel kx = { 0 }, ky = { 0 };
	size_t n = (size_t)nx * (size_t)ny;
	double *half = malloc(n * sizeof *half);
	enum num_status status = NUM_MEMORY;

	if (half && !kernel_make(&kx, nx, dx, nesting, ends) &&
		!kernel_make(&ky, ny, dy, nesting, ends)) {
		filter_lines(&ky, z, half, (size_t)nx, 1, nx);
		/* One row at a time fits in the cache. */
		for (int iy = 0; iy < ny; iy++)
			filter_lines(&kx, half + (size_t)iy * (size_t)nx,
				out + (size_t)iy * (size_t)nx, 1, 1, 1);
		status = NUM_OK;
	}
	free(kx.weight);
	free(ky.weight);
	free(half);
	return status;
}

enum num_status surface_gauss_excess(
	double step, double nesting, enum filter_ends ends, double *excess)
{
	double a = width(ends) * nesting / step, x = M_PI * a * a / 4;
	struct kernel k = { 0 };

	*excess = 0;
	if (nesting > 6 * step) /* 2^-9 of these waves pass at most */
		return NUM_OK;
	if (kernel_make(&k, INT_MAX, step, nesting,
		    ends == FILTER_PERIODIC ? FILTER_MEAN : ends))
		return NUM_MEMORY;
	point_weights(&k, k.reach, k.reach);
	for (int j = 0; j <= 2 * k.reach; j++)
		*excess += (j - k.reach) % 2 ? -k.row[j] : k.row[j];
	*excess -= (ends == FILTER_PARABOLA ? 1 + x : 1) * exp(-x);
	free(k.weight);
	return NUM_OK;
}

double surface_gauss_products(
	int nx, int ny, double dx, double dy, double nesting, enum filter_ends ends)
{
	return (double)nx * ny *
	       (2.0 * reach_of(dx, nesting, ends, nx) +
		       2.0 * reach_of(dy, nesting, ends, ny) + 2);
}

/* ---- form ---- */

/* Polynomials of the places of n points, orthonormal over them: p[k * n + i]. */
static enum num_status orthonormal(int n, int degree, double *p)
{
	for (int k = 0; k <= degree; k++) {
		double *q = p + (size_t)k * (size_t)n, norm = 0;

		for (int i = 0; i < n; i++) {
			double x = n > 1 ? 2.0 * i / (n - 1) - 1 : 0;

			q[i] = k ? x * q[i - n] : 1;
		}
		/* twice, because rounding remains after the first time */
		for (int turn = 0; turn < 2; turn++)
			for (int j = 0; j < k; j++) {
				const double *r = p + (size_t)j * (size_t)n;
				double dot = 0;

				for (int i = 0; i < n; i++)
					dot += q[i] * r[i];
				for (int i = 0; i < n; i++)
					q[i] -= dot * r[i];
			}
		for (int i = 0; i < n; i++)
			norm += q[i] * q[i];
		norm = sqrt(norm);
		/* Rounding leaves some 1e-16 of a polynomial that depends on the others.
		 */
		if (!(norm > 1e-10))
			return NUM_DOMAIN;
		for (int i = 0; i < n; i++)
			q[i] /= norm;
	}
	return NUM_OK;
}

/* Coefficient of px py in z. */
static double project(int nx, int ny, const double *px, const double *py, const double *z)
{
	double sum = 0;

	for (int iy = 0; iy < ny; iy++) {
		double row = 0;

		for (int ix = 0; ix < nx; ix++)
			row += px[ix] * z[(size_t)iy * (size_t)nx + (size_t)ix];
		sum += py[iy] * row;
	}
	return sum;
}

static void subtract(
	int nx, int ny, const double *px, const double *py, double c, double *z)
{
	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++)
			z[(size_t)iy * (size_t)nx + (size_t)ix] -= c * py[iy] * px[ix];
}

/* Share of x^2, in units of length, along the polynomial of degree 2. */
static double square_along(int n, double step, const double *p)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += p[i] * (i * step) * (i * step);
	return sum;
}

enum num_status surface_form(
	int nx, int ny, double dx, double dy, enum form form, double *z)
{
	int degree = form == FORM_PLANE ? 1 : form == FORM_PARABOLOID ? 2 : (int)form;
	int bowl = form == FORM_PARABOLOID;
	size_t terms = (size_t)degree + 1;
	double *px = malloc(terms * (size_t)nx * sizeof *px);
	double *py = malloc(terms * (size_t)ny * sizeof *py);
	/* A profile has a form only along its direction. */
	int along_x = nx > 1 ? degree : 0, along_y = ny > 1 ? degree : 0;
	enum num_status status = px && py ? NUM_OK : NUM_MEMORY;

	if (!status)
		status = orthonormal(nx, along_x, px);
	if (!status)
		status = orthonormal(ny, along_y, py);
	for (int i = 0; !status && i <= along_x; i++)
		for (int j = 0; j <= along_y && j <= degree - i; j++) {
			const double *qx = px + (size_t)i * (size_t)nx;
			const double *qy = py + (size_t)j * (size_t)ny;

			if (bowl && i + j == 2 && along_x && along_y)
				continue;
			subtract(nx, ny, qx, qy, project(nx, ny, qx, qy, z), z);
		}
	if (!status && bowl && along_x && along_y) {
		/* x^2 + y^2 less what the plane holds: a X2(x) Y0 + b X0 Y2(y) */
		const double *x2 = px + 2 * (size_t)nx, *y2 = py + 2 * (size_t)ny;
		double a = square_along(nx, dx, x2) * sqrt(ny);
		double b = square_along(ny, dy, y2) * sqrt(nx), c;

		c = (a * project(nx, ny, x2, py, z) + b * project(nx, ny, px, y2, z)) /
		    (a * a + b * b);
		subtract(nx, ny, x2, py, c * a, z);
		subtract(nx, ny, px, y2, c * b, z);
	}
	free(px);
	free(py);
	return status;
}

/* ---- power spectrum ---- */

static double hann(int i, int n, int window)
{
	double s = sin(M_PI * (i + 0.5) / n);

	return window ? s * s : 1;
}

/* Heights less their mean under the window, times the window; returns its mean square. */
static double windowed(int nx, int ny, const double *z, int window, double *out)
{
	double sum = 0, weight = 0, square = 0;

	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++) {
			double w = hann(ix, nx, window) * hann(iy, ny, window);

			sum += w * z[(size_t)iy * (size_t)nx + (size_t)ix];
			weight += w;
			square += w * w;
		}
	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++) {
			size_t i = (size_t)iy * (size_t)nx + (size_t)ix;

			out[i] = (z[i] - sum / weight) * hann(ix, nx, window) *
				 hann(iy, ny, window);
		}
	return square / ((double)nx * ny);
}

enum num_status surface_spectrum(int nx, int ny, double dx, double dy, const double *z,
	int window, struct ring *ring, int *rings)
{
	size_t n = (size_t)nx * (size_t)ny, columns = (size_t)nx / 2 + 1;
	double lx = nx * dx, ly = ny * dy, step = 1 / fmin(lx, ly), square;
	enum num_status status = NUM_MEMORY;
	int most = (int)hypot(nx, ny) + 2;
	double *x = fft_alloc(n);
	double complex *q = fft_alloc_complex(columns * (size_t)ny);
	struct fft *fft = fft_new((size_t)nx, (size_t)ny);

	*rings = 0;
	if (x && q && fft) {
		square = windowed(nx, ny, z, window, x);
		fft_forward(fft, x, q);
		memset(ring, 0, (size_t)most * sizeof *ring);
		for (int iy = 0; iy < ny; iy++)
			for (size_t ix = 0; ix < columns; ix++) {
				int ky = iy <= ny / 2 ? iy : iy - ny;
				double f = hypot((double)ix / lx, ky / ly);
				int k = (int)floor(f / step + 0.5) - 1;
				double complex c = q[(size_t)iy * columns + ix];
				double p = creal(c) * creal(c) + cimag(c) * cimag(c);
				/* the other half of the plane has the same power */
				double twice = ix > 0 && 2 * ix != (size_t)nx ? 2 : 1;

				if (k < 0 || k >= most)
					continue;
				ring[k].frequency += twice * f;
				ring[k].power += twice * p * lx * ly /
						 ((double)n * (double)n * square);
				ring[k].waves += twice;
				*rings = k + 1 > *rings ? k + 1 : *rings;
			}
		for (int k = 0; k < *rings; k++) {
			ring[k].frequency /= ring[k].waves;
			ring[k].power /= ring[k].waves;
		}
		status = NUM_OK;
	}
	if (fft)
		fft_done(fft);
	fft_free(q);
	fft_free(x);
	return status;
}
