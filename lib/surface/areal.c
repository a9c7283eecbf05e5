#include "surface/areal.h"
#include "num/fft.h"
#include "num/grid.h"
#include "num/status.h"
#include "surface/surface.h"
#include <complex.h>
#include <math.h>
#include <stdlib.h>

/* ---- heights ---- */

/* Heights in units of Sq, so that no power of them over- or underflows. */
static void measure_heights(int nx, int ny, const double *z, struct surface_parameters *p)
{
	double mean = surface_mean(nx, ny, z), m3 = 0, m4 = 0;

	p->sa = surface_sa(nx, ny, z);
	p->sq = surface_sq(nx, ny, z);
	p->sp = p->sv = 0;
	for (int iy = 0; iy < ny; iy++) {
		double r3 = 0, r4 = 0;

		for (int ix = 0; ix < nx; ix++) {
			double d = z[grid_at(nx, ix, iy)] - mean, t = d / p->sq;

			r3 += t * t * t;
			r4 += t * t * t * t;
			p->sp = fmax(p->sp, d);
			p->sv = fmax(p->sv, -d);
		}
		m3 += r3;
		m4 += r4;
	}
	p->sz = p->sp + p->sv;
	p->ssk = p->sq > 0 ? m3 / ((double)nx * ny) : NAN;
	p->sku = p->sq > 0 ? m4 / ((double)nx * ny) : NAN;
}

/* ---- gradient ---- */

struct mean_square {
	double sum;
	size_t n;
};

static void count(struct mean_square *m, double value)
{
	m->sum += value * value;
	m->n++;
}

static double mean_of(const struct mean_square *m)
{
	return m->n ? m->sum / (double)m->n : NAN;
}

/* A profile has one direction: the absent derivative counts as 0. */
static double gradient(double x, double y, int nx, int ny)
{
	if (nx == 1 && ny == 1)
		return NAN;
	return sqrt((nx > 1 ? x : 0) + (ny > 1 ? y : 0));
}

static void measure_neighbours(int nx, int ny, double dx, double dy, const double *z,
	struct surface_parameters *p)
{
	struct mean_square fx = { 0, 0 }, fy = fx, cx = fx, cy = fx, mx = fx, my = fx;

	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++) {
			const double *a = z + grid_at(nx, ix, iy);
			int right = ix + 1 < nx, down = iy + 1 < ny;

			if (right)
				count(&fx, (a[1] - a[0]) / dx);
			if (down)
				count(&fy, (a[nx] - a[0]) / dy);
			if ((right || nx == 1) && (down || ny == 1)) {
				count(&cx, right ? (a[1] - a[0]) / dx : 0);
				count(&cy, down ? (a[nx] - a[0]) / dy : 0);
			}
			if (right && down) {
				count(&mx, 0.5 * (a[1] + a[nx + 1] - a[0] - a[nx]) / dx);
				count(&my, 0.5 * (a[nx] + a[nx + 1] - a[0] - a[1]) / dy);
			}
		}
	p->sdq = gradient(mean_of(&fx), mean_of(&fy), nx, ny);
	p->sdq_cell = gradient(mean_of(&cx), mean_of(&cy), nx, ny);
	p->sdq_2x2 = sqrt(mean_of(&mx) + mean_of(&my));
}

/* Mean square of an antisymmetric formula sum_k c[k] (z[k+1] - z[-k-1]) / d over the
 * samples that have all their neighbours in both directions. */
static double measure_formula(
	int nx, int ny, double dx, double dy, const double *z, const double *c, int reach)
{
	struct mean_square fx = { 0, 0 }, fy = fx;
	int rx = nx > 1 ? reach : 0, ry = ny > 1 ? reach : 0;

	for (int iy = ry; iy < ny - ry; iy++)
		for (int ix = rx; ix < nx - rx; ix++) {
			const double *a = z + grid_at(nx, ix, iy);
			double x = 0, y = 0;

			for (int k = 0; k < reach; k++) {
				ptrdiff_t sx = k + 1, sy = (ptrdiff_t)(k + 1) * nx;

				if (rx)
					x += c[k] * (a[sx] - a[-sx]);
				if (ry)
					y += c[k] * (a[sy] - a[-sy]);
			}
			count(&fx, x / dx);
			count(&fy, y / dy);
		}
	return gradient(mean_of(&fx), mean_of(&fy), nx, ny);
}

/* Area of the triangle spanned by slopes u and v over its projection, less 1, without
 * loss for small slopes. */
static double excess(double u, double v)
{
	double s = u * u + v * v;

	return s / (sqrt(1 + s) + 1);
}

/* Each cell of four samples is cut along one diagonal and along the other; the mean
 * of the two areas favours no direction. */
static double measure_area(int nx, int ny, double dx, double dy, const double *z)
{
	double sum = 0;

	if (nx == 1 || ny == 1) {
		size_t n = grid_size(nx, ny) - 1;

		for (size_t i = 0; i < n; i++)
			sum += excess((z[i + 1] - z[i]) / (ny == 1 ? dx : dy), 0);
		return n ? sum / (double)n : NAN;
	}
	for (int iy = 0; iy + 1 < ny; iy++) {
		double row = 0;

		for (int ix = 0; ix + 1 < nx; ix++) {
			const double *a = z + grid_at(nx, ix, iy);
			double top = (a[1] - a[0]) / dx,
			       bottom = (a[nx + 1] - a[nx]) / dx;
			double left = (a[nx] - a[0]) / dy,
			       right = (a[nx + 1] - a[1]) / dy;

			row += excess(top, left) + excess(bottom, right) +
			       excess(top, right) + excess(bottom, left);
		}
		sum += row;
	}
	return sum / (4.0 * (nx - 1) * (ny - 1));
}

/* ---- autocorrelation ---- */

/* Normalised autocorrelation at lags of half the size and less. */
struct correlation {
	int hx, hy; /* largest lags */
	double dx, dy;
	double *r; /* r[(jy + hy) * (2 hx + 1) + jx + hx] */
};

static double *at(const struct correlation *c, int jx, int jy)
{
	return c->r + grid_at(2 * c->hx + 1, jx + c->hx, jy + c->hy);
}

/* Transform of z - mean with zeros behind, squared, transformed back; each lag is
 * divided by the number of products in it. */
static enum num_status correlate(struct correlation *c, int nx, int ny, const double *z)
{
	size_t px = fft_good_size((size_t)(nx + c->hx)),
	       py = fft_good_size((size_t)(ny + c->hy));
	size_t columns = px / 2 + 1;
	double mean = surface_mean(nx, ny, z), zero, *pad = fft_alloc(px * py);
	double complex *spectrum = fft_alloc_complex(columns * py);
	struct fft *fft = fft_new(px, py);
	enum num_status status = NUM_MEMORY;

	if (pad && spectrum && fft && c->r) {
		for (int iy = 0; iy < ny; iy++)
			for (int ix = 0; ix < nx; ix++)
				pad[(size_t)iy * px + (size_t)ix] =
					z[grid_at(nx, ix, iy)] - mean;
		fft_forward(fft, pad, spectrum);
		for (size_t i = 0; i < columns * py; i++) {
			double re = creal(spectrum[i]), im = cimag(spectrum[i]);

			spectrum[i] = re * re + im * im;
		}
		fft_inverse(fft, spectrum, pad);
		zero = pad[0] / ((double)nx * ny);
		for (int jy = -c->hy; jy <= c->hy; jy++)
			for (int jx = -c->hx; jx <= c->hx; jx++) {
				size_t x = jx < 0 ? px - (size_t)-jx : (size_t)jx;
				size_t y = jy < 0 ? py - (size_t)-jy : (size_t)jy;
				double many = (double)(nx - abs(jx)) * (ny - abs(jy));

				*at(c, jx, jy) = pad[y * px + x] / many / zero;
			}
		status = NUM_OK;
	}
	fft_free(pad);
	fft_free(spectrum);
	fft_done(fft);
	return status;
}

/* Lag along one axis where the correlation falls to level; nan if it does not. */
static double first_fall(const struct correlation *c, int along_y, double level)
{
	int most = along_y ? c->hy : c->hx;

	for (int j = 1; j <= most; j++) {
		double before = along_y ? *at(c, 0, j - 1) : *at(c, j - 1, 0);
		double after = along_y ? *at(c, 0, j) : *at(c, j, 0);

		if (after <= level)
			return (j - 1 + (before - level) / (before - after)) *
			       (along_y ? c->dy : c->dx);
	}
	return NAN;
}

/* Shortest and longest lag at which the central lobe, the connected lags above level,
 * ends; crossings are interpolated between neighbouring lags.  Where the lobe runs
 * into the largest lag, the longest is not known. */
static enum num_status measure_lobe(
	const struct correlation *c, double level, double *shortest, double *longest)
{
	static const int step[4][2] = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
	size_t width = 2 * (size_t)c->hx + 1, n = width * (2 * (size_t)c->hy + 1),
	       top = 0;
	unsigned char *seen = calloc(n, 1);
	size_t *stack = malloc(n * sizeof *stack);
	enum num_status status = NUM_MEMORY;
	int open = 0;

	*shortest = INFINITY;
	*longest = 0;
	if (seen && stack) {
		stack[top++] = grid_at(2 * c->hx + 1, c->hx, c->hy);
		seen[stack[0]] = 1;
		status = NUM_OK;
	}
	while (top) {
		size_t i = stack[--top];
		int jx = (int)(i % width) - c->hx, jy = (int)(i / width) - c->hy;

		for (int k = 0; k < 4; k++) {
			int kx = jx + step[k][0], ky = jy + step[k][1];
			double t, lag;

			if (abs(kx) > c->hx || abs(ky) > c->hy) {
				open |= (step[k][0] ? c->hx : c->hy) > 0;
				continue;
			}
			if (*at(c, kx, ky) > level) {
				size_t next =
					grid_at(2 * c->hx + 1, kx + c->hx, ky + c->hy);

				if (!seen[next]) {
					seen[next] = 1;
					stack[top++] = next;
				}
				continue;
			}
			t = (c->r[i] - level) / (c->r[i] - *at(c, kx, ky));
			lag = hypot((jx + t * step[k][0]) * c->dx,
				(jy + t * step[k][1]) * c->dy);
			*shortest = fmin(*shortest, lag);
			*longest = fmax(*longest, lag);
		}
	}
	if (open || status)
		*longest = NAN;
	if (!isfinite(*shortest))
		*shortest = NAN;
	free(seen);
	free(stack);
	return status;
}

static enum num_status measure_correlation(int nx, int ny, double dx, double dy,
	const double *z, struct surface_parameters *p)
{
	struct correlation c = { nx / 2, ny / 2, dx, dy, NULL };
	double longest = NAN;
	enum num_status status;

	p->sal = p->str = p->corr_x = p->corr_y = NAN;
	if (!(p->sq > 0))
		return NUM_OK;
	c.r = fft_alloc((2 * (size_t)c.hx + 1) * (2 * (size_t)c.hy + 1));
	status = correlate(&c, nx, ny, z);
	if (!status)
		status = measure_lobe(&c, 0.2, &p->sal, &longest);
	if (!status) {
		p->str = nx > 1 && ny > 1 ? p->sal / longest : NAN;
		p->corr_x = first_fall(&c, 0, exp(-1));
		p->corr_y = first_fall(&c, 1, exp(-1));
	}
	fft_free(c.r);
	return status;
}

enum num_status surface_measure(int nx, int ny, double dx, double dy, const double *z,
	struct surface_parameters *par)
{
	static const double central[] = { 0.5 };
	static const double seven[] = { 45.0 / 60, -9.0 / 60, 1.0 / 60 };

	measure_heights(nx, ny, z, par);
	measure_neighbours(nx, ny, dx, dy, z, par);
	par->sdq_central = measure_formula(nx, ny, dx, dy, z, central, 1);
	par->sdq_iso7 = measure_formula(nx, ny, dx, dy, z, seven, 3);
	par->sdr = measure_area(nx, ny, dx, dy, z);
	return measure_correlation(nx, ny, dx, dy, z, par);
}
