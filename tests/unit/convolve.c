/* The fused convolution against the plain double sum, at awkward sizes. */
#include "num/convolve.h"
#include "num/fft.h"
#include "num/pool.h"
#include "tap.h"
#include <string.h>

static double value(const void *context, size_t ix, size_t iy)
{
	(void)context;
	return 1 / (1 + sqrt((double)(ix * ix + 2 * iy * iy)));
}

static double noise(size_t i)
{
	return sin(12.9898 * (double)i) * 3 - cos(78.233 * (double)(i * i % 1009));
}

static size_t offset(size_t a, size_t b, size_t n, int periodic)
{
	size_t d = a > b ? a - b : b - a;

	return periodic && d > n - d ? n - d : d;
}

static double worst_error(
	size_t nx, size_t ny, enum convolve_kind kind, struct pool *pool)
{
	struct convolve *c = convolve_new(nx, ny, kind, pool);
	double *k = convolve_alloc(c), *x = fft_alloc(nx * ny), *y = fft_alloc(nx * ny);
	double worst = 0, size = 0;

	for (size_t i = 0; i < nx * ny; i++)
		x[i] = noise(i);
	convolve_kernel(c, k, value, NULL);
	convolve_apply(c, k, x, y);
	for (size_t iy = 0; iy < ny; iy++) {
		for (size_t ix = 0; ix < nx; ix++) {
			double sum = 0;

			for (size_t jy = 0; jy < ny; jy++)
				for (size_t jx = 0; jx < nx; jx++)
					sum += x[jy * nx + jx] *
					       value(NULL,
						       offset(ix, jx, nx,
							       kind == CONVOLVE_PERIODIC),
						       offset(iy, jy, ny,
							       kind == CONVOLVE_PERIODIC));
			size = tap_max(size, fabs(sum));
			worst = tap_max(worst, fabs(sum - y[iy * nx + ix]));
		}
	}
	fft_free(k);
	fft_free(x);
	fft_free(y);
	convolve_free(c);
	return worst / size;
}

/* The factor of a wave, at sizes that are transformed directly and at others. */
static double wave_factor(const void *context, size_t kx, size_t ky)
{
	(void)context;
	return 1 / (1. + (double)(kx + 3 * ky));
}

static double spectrum_error(size_t nx, size_t ny)
{
	struct convolve *c = convolve_new(nx, ny, CONVOLVE_PERIODIC, NULL);
	double *k = convolve_alloc(c), *x = fft_alloc(nx * ny), worst = 0;
	size_t kx = nx / 3, ky = ny / 4;

	for (size_t i = 0; i < nx * ny; i++)
		x[i] = cos(2 * M_PI * (double)(kx * (i % nx)) / (double)nx + 0.3) *
		       cos(2 * M_PI * (double)(ky * (i / nx)) / (double)ny - 1);
	convolve_spectrum(c, k, wave_factor, NULL);
	convolve_apply(c, k, x, x);
	for (size_t i = 0; i < nx * ny; i++)
		worst = tap_max(worst,
			fabs(x[i] / wave_factor(NULL, kx, ky) -
				cos(2 * M_PI * (double)(kx * (i % nx)) / (double)nx +
					0.3) *
					cos(2 * M_PI * (double)(ky * (i / nx)) /
							(double)ny -
						1)));
	fft_free(k);
	fft_free(x);
	convolve_free(c);
	return worst;
}

/* The framed convolution is that of the field and its frame. */
enum { FX = 10, FY = 37, MX = 15, MY = 40 };

static void load_noise(void *context, size_t y, double *row, int worker)
{
	(void)context;
	(void)worker;
	for (size_t x = 0; x < MX; x++)
		row[x] = noise(y * MX + x);
}

static void framed(struct pool *pool)
{
	struct convolve *c = convolve_frame(FX, FY, MX, MY, pool, NULL);
	struct convolve *whole = convolve_new(MX, MY, CONVOLVE_PERIODIC, NULL);
	double *k = convolve_alloc(c), *y = fft_alloc(FX * FY), *x = fft_alloc(MX * MY),
	       worst = 0;
	const struct convolve_passes passes = { .load = load_noise, .y = y };

	for (size_t i = 0; i < MY; i++)
		load_noise(NULL, i, x + i * MX, 0);
	convolve_spectrum(c, k, wave_factor, NULL);
	convolve_run(c, k, &passes);
	convolve_apply(whole, k, x, x);
	for (size_t i = 0; i < (size_t)FX * FY; i++)
		worst = tap_max(worst, fabs(y[i] - x[i / FX * MX + i % FX]));
	ok(worst < 1e-14, "10x37 points in a frame of 15x40: error %.1e", worst);
	fft_free(k);
	fft_free(x);
	fft_free(y);
	convolve_free(whole);
	convolve_free(c);
}

static void same_bytes(struct pool *two)
{
	enum { NX = 150, NY = 90 };
	double *x = fft_alloc(NX * NY), *y[2];

	for (size_t i = 0; i < (size_t)NX * NY; i++)
		x[i] = noise(i);
	for (int t = 0; t < 2; t++) {
		struct convolve *c =
			convolve_new(NX, NY, CONVOLVE_PADDED, t ? two : NULL);
		double *k = convolve_alloc(c);

		y[t] = fft_alloc(NX * NY);
		convolve_kernel(c, k, value, NULL);
		convolve_apply(c, k, x, y[t]);
		fft_free(k);
		convolve_free(c);
	}
	ok(memcmp(y[0], y[1], NX * NY * sizeof(double)) == 0,
		"one thread and two give the same bytes");
	fft_free(x);
	fft_free(y[0]);
	fft_free(y[1]);
}

int main(void)
{
	static const size_t sizes[][2] = { { 16, 16 }, { 17, 23 }, { 1, 1 }, { 1, 40 },
		{ 40, 1 }, { 2, 3 }, { 30, 11 }, { 13, 64 }, { 37, 41 }, { 74, 16 },
		{ 12, 47 } };
	struct pool *two = pool_new(2);

	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		size_t nx = sizes[i][0], ny = sizes[i][1];
		double e = worst_error(nx, ny, CONVOLVE_PERIODIC, i % 2 ? two : NULL);

		ok(e < 1e-14, "periodic %zux%zu equals the sum: error %.1e", nx, ny, e);
		e = worst_error(nx, ny, CONVOLVE_PADDED, i % 2 ? two : NULL);
		ok(e < 1e-14, "padded %zux%zu equals the sum: error %.1e", nx, ny, e);
		e = spectrum_error(nx, ny);
		ok(e < 5e-13,
			"periodic %zux%zu given by its spectrum equals the sum: error %.1e",
			nx, ny, e);
	}
	framed(two);
	same_bytes(two);
	pool_free(two);
	return tap_done();
}
