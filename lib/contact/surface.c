/* surface.c - heights on a grid: preparing measured ones, shape, areal parameters */
#include "contact/surface.h"
#include "num/fft.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- missing samples ---- */

size_t surface_missing(int nx, int ny, const double *z)
{
	size_t missing = 0;

	for (size_t i = 0; i < (size_t)nx * ny; i++)
		missing += isnan(z[i]) != 0;
	return missing;
}

/* The unknown samples and their neighbours: sample place[k], unknown or known. */
struct holes {
	int nx, ny;
	size_t n;
	size_t *place;
	size_t *index; /* of a sample: its unknown, or n where it is known */
	double *x, *r, *p, *q;
};

/* Neighbours of a sample; returns how many. */
static int neighbours(const struct holes *h, size_t place, size_t next[4])
{
	int ix = (int)(place % h->nx), iy = (int)(place / h->nx), n = 0;

	if (ix > 0)
		next[n++] = place - 1;
	if (ix + 1 < h->nx)
		next[n++] = place + 1;
	if (iy > 0)
		next[n++] = place - h->nx;
	if (iy + 1 < h->ny)
		next[n++] = place + h->nx;
	return n;
}

/* y = graph Laplacian of the unknowns times v; with z, known neighbours count too. */
static void laplacian(const struct holes *h, const double *v, const double *z, double *y)
{
	size_t next[4];

	for (size_t k = 0; k < h->n; k++) {
		int n = neighbours(h, h->place[k], next);
		double sum = n * v[k];

		for (int j = 0; j < n; j++) {
			size_t m = h->index[next[j]];

			if (m < h->n)
				sum -= v[m];
			else if (z)
				sum -= z[next[j]];
		}
		y[k] = sum;
	}
}

static double dot(size_t n, const double *a, const double *b)
{
	double sum = 0;

	for (size_t i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

static int solve_holes(struct holes *h, const double *z)
{
	const double tolerance = 1e-13;
	double rr, first;
	int step;

	laplacian(h, h->x, z, h->r);
	for (size_t k = 0; k < h->n; k++)
		h->p[k] = h->r[k] = -h->r[k];
	first = rr = dot(h->n, h->r, h->r);
	for (step = 0; rr > tolerance * tolerance * first && step < 100000; step++) {
		double alpha, beta;

		laplacian(h, h->p, NULL, h->q);
		alpha = rr / dot(h->n, h->p, h->q);
		for (size_t k = 0; k < h->n; k++) {
			h->x[k] += alpha * h->p[k];
			h->r[k] -= alpha * h->q[k];
		}
		beta = rr;
		rr = dot(h->n, h->r, h->r);
		beta = rr / beta;
		for (size_t k = 0; k < h->n; k++)
			h->p[k] = h->r[k] + beta * h->p[k];
	}
	return step;
}

int surface_fill(int nx, int ny, double *z, int *iterations)
{
	size_t n = (size_t)nx * ny, missing = surface_missing(nx, ny, z), k = 0;
	struct holes h = { nx, ny, missing, NULL, NULL, NULL, NULL, NULL, NULL };
	double mean = 0;
	int done = 0;

	*iterations = 0;
	if (missing == 0)
		return 1;
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
		*iterations = solve_holes(&h, z);
		for (k = 0; k < missing; k++)
			z[h.place[k]] = h.x[k];
		done = 1;
	}
	free(h.place);
	free(h.index);
	free(h.x);
	return done;
}

/* ---- plane, crop, crown ---- */

/* Coordinates from the middle make the normal equations diagonal. */
void surface_level(int nx, int ny, double *z)
{
	double mean = surface_mean(nx, ny, z), sx = 0, sy = 0, xx, yy;

	for (int iy = 0; iy < ny; iy++) {
		double row = 0, moment = 0;

		for (int ix = 0; ix < nx; ix++) {
			double d = z[(size_t)iy * nx + ix] - mean;

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
			z[(size_t)iy * nx + ix] -= mean + sx * (ix - 0.5 * (nx - 1)) +
						   sy * (iy - 0.5 * (ny - 1));
}

void surface_crop(int nx, const double *z, int x0, int y0, int mx, int my, double *out)
{
	for (int iy = 0; iy < my; iy++)
		memcpy(out + (size_t)iy * mx, z + (size_t)(y0 + iy) * nx + x0,
			(size_t)mx * sizeof *out);
}

void surface_crown(int nx, int ny, double dx, double dy, double drop, double *z)
{
	double corner = 0.25 * (nx * dx * nx * dx + ny * dy * ny * dy);

	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++) {
			double x = (ix + 0.5 - 0.5 * nx) * dx,
			       y = (iy + 0.5 - 0.5 * ny) * dy;

			z[(size_t)iy * nx + ix] -= drop * ((x * x + y * y) / corner);
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

/* Cubic convolution at position x (in samples, 0 at the first); beyond the first and
 * last sample the end pieces go on. */
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

int surface_resample(int nx, int ny, const double *z, int mx, int my, double *out)
{
	double *half = malloc((size_t)mx * ny * sizeof *half);

	if (!half)
		return 0;
	for (int iy = 0; iy < ny; iy++)
		resample_line(z + (size_t)iy * nx, nx, 1, half + (size_t)iy * mx, mx, 1);
	for (int ix = 0; ix < mx; ix++)
		resample_line(half + ix, ny, (size_t)mx, out + ix, my, (size_t)mx);
	free(half);
	return 1;
}

/* ---- height parameters ---- */

/* Sum over the surface, row by row so that rounding grows with the side only. */
static double sum_rows(int nx, int ny, const double *z,
	double (*term)(double z, double mean), double mean)
{
	double sum = 0;

	for (int iy = 0; iy < ny; iy++) {
		double row = 0;

		for (int ix = 0; ix < nx; ix++)
			row += term(z[(size_t)iy * nx + ix], mean);
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

	/* The rounding of a mean far from 0 is taken out by a second sum. */
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
			double d = z[(size_t)iy * nx + ix] - mean, t = d / p->sq;

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
			const double *a = z + (size_t)iy * nx + ix;
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
			const double *a = z + (size_t)iy * nx + ix;
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
		size_t n = (size_t)nx * ny - 1;

		for (size_t i = 0; i < n; i++)
			sum += excess((z[i + 1] - z[i]) / (ny == 1 ? dx : dy), 0);
		return n ? sum / (double)n : NAN;
	}
	for (int iy = 0; iy + 1 < ny; iy++) {
		double row = 0;

		for (int ix = 0; ix + 1 < nx; ix++) {
			const double *a = z + (size_t)iy * nx + ix;
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
	return c->r + (size_t)(jy + c->hy) * (2 * c->hx + 1) + jx + c->hx;
}

/* Transform of z - mean with zeros behind, squared, transformed back; each lag is
 * divided by the number of products in it. */
static int correlate(struct correlation *c, int nx, int ny, const double *z)
{
	size_t px = fft_good_size((size_t)nx + c->hx),
	       py = fft_good_size((size_t)ny + c->hy);
	size_t columns = px / 2 + 1;
	double mean = surface_mean(nx, ny, z), zero, *pad = fft_alloc(px * py);
	double complex *spectrum = fft_alloc_complex(columns * py);
	struct fft *fft = fft_new(px, py);
	int done = pad && spectrum && fft && c->r;

	if (done) {
		for (int iy = 0; iy < ny; iy++)
			for (int ix = 0; ix < nx; ix++)
				pad[(size_t)iy * px + ix] =
					z[(size_t)iy * nx + ix] - mean;
		fft_forward(fft, pad, spectrum);
		for (size_t i = 0; i < columns * py; i++) {
			double re = creal(spectrum[i]), im = cimag(spectrum[i]);

			spectrum[i] = re * re + im * im;
		}
		fft_inverse(fft, spectrum, pad);
		zero = pad[0] / ((double)nx * ny);
		for (int jy = -c->hy; jy <= c->hy; jy++)
			for (int jx = -c->hx; jx <= c->hx; jx++) {
				size_t x = jx < 0 ? px + jx : (size_t)jx;
				size_t y = jy < 0 ? py + jy : (size_t)jy;
				double many = (double)(nx - abs(jx)) * (ny - abs(jy));

				*at(c, jx, jy) = pad[y * px + x] / many / zero;
			}
	}
	fft_free(pad);
	fft_free(spectrum);
	fft_done(fft);
	return done;
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
static int measure_lobe(
	const struct correlation *c, double level, double *shortest, double *longest)
{
	static const int step[4][2] = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
	size_t width = 2 * (size_t)c->hx + 1, n = width * (2 * (size_t)c->hy + 1),
	       top = 0;
	unsigned char *seen = calloc(n, 1);
	size_t *stack = malloc(n * sizeof *stack);
	int open = 0;

	*shortest = INFINITY;
	*longest = 0;
	if (seen && stack) {
		stack[top++] = (size_t)c->hy * width + c->hx;
		seen[stack[0]] = 1;
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
				size_t next = (size_t)(ky + c->hy) * width + kx + c->hx;

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
	open |= !seen || !stack;
	if (open)
		*longest = NAN;
	if (!isfinite(*shortest))
		*shortest = NAN;
	open = seen && stack;
	free(seen);
	free(stack);
	return open;
}

static int measure_correlation(int nx, int ny, double dx, double dy, const double *z,
	struct surface_parameters *p)
{
	struct correlation c = { nx / 2, ny / 2, dx, dy, NULL };
	double longest = NAN;
	int done;

	p->sal = p->str = p->corr_x = p->corr_y = NAN;
	if (!(p->sq > 0))
		return 1;
	c.r = fft_alloc((2 * (size_t)c.hx + 1) * (2 * (size_t)c.hy + 1));
	done = correlate(&c, nx, ny, z) && measure_lobe(&c, 0.2, &p->sal, &longest);
	if (done) {
		p->str = nx > 1 && ny > 1 ? p->sal / longest : NAN;
		p->corr_x = first_fall(&c, 0, exp(-1));
		p->corr_y = first_fall(&c, 1, exp(-1));
	}
	fft_free(c.r);
	return done;
}

int surface_measure(int nx, int ny, double dx, double dy, const double *z,
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
