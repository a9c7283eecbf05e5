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
			size = fmax(size, fabs(sum));
			worst = fmax(worst, fabs(sum - y[iy * nx + ix]));
		}
	}
	fft_free(k);
	fft_free(x);
	fft_free(y);
	convolve_free(c);
	return worst / size;
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
		"one and two threads: same bytes");
	fft_free(x);
	fft_free(y[0]);
	fft_free(y[1]);
}

int main(void)
{
	static const size_t sizes[][2] = { { 16, 16 }, { 17, 23 }, { 1, 1 }, { 1, 40 },
		{ 40, 1 }, { 2, 3 }, { 30, 11 }, { 13, 64 } };
	struct pool *two = pool_new(2);

	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		size_t nx = sizes[i][0], ny = sizes[i][1];
		double e = worst_error(nx, ny, CONVOLVE_PERIODIC, i % 2 ? two : NULL);

		ok(e < 1e-14, "periodic %zux%zu equals the sum: error %.1e", nx, ny, e);
		e = worst_error(nx, ny, CONVOLVE_PADDED, i % 2 ? two : NULL);
		ok(e < 1e-14, "padded %zux%zu equals the sum: error %.1e", nx, ny, e);
	}
	same_bytes(two);
	pool_free(two);
	return tap_done();
}
