/* Multi-level multi-summation against the plain sum. */
#include "contact/mlms.h"
#include "contact/kernel.h"
#include "num/fft.h"
#include "tap.h"
#include <string.h>

static double love(const void *context, size_t ix, size_t iy)
{
	const double *aspect = context;

	return kernel_patch(1, *aspect, (double)ix, *aspect * (double)iy);
}

static size_t apart(size_t a, size_t b)
{
	return a > b ? a - b : b - a;
}

/* Largest difference to the direct sum over its largest value; sources on a part of the
 * grid, of both signs. */
static double worst_error(
	size_t nx, size_t ny, int order, int reach, double aspect, struct pool *pool)
{
	struct mlms *m = mlms_new(nx, ny, aspect, order, reach, love, &aspect, pool);
	double *x = fft_alloc(nx * ny), *y = fft_alloc(nx * ny), *k = fft_alloc(nx * ny);
	double worst = 0, size = 0;

	for (size_t i = 0; i < nx * ny; i++) {
		x[i] = i % nx * 3 >= nx / 2 && i / nx * 5 < 4 * ny
			       ? 1 + sin(7.1 * (double)i)
			       : 0;
		k[i] = love(&aspect, i % nx, i / nx);
	}
	mlms_apply(m, x, y);
	for (size_t i = 0; i < nx * ny; i++) {
		double sum = 0;

		for (size_t j = 0; j < nx * ny; j++)
			sum += x[j] *
			       k[apart(i / nx, j / nx) * nx + apart(i % nx, j % nx)];
		worst = tap_max(worst, fabs(sum - y[i]));
		size = tap_max(size, fabs(sum));
	}
	mlms_free(m);
	fft_free(x);
	fft_free(y);
	fft_free(k);
	return worst / size;
}

static void same_bytes(struct pool *two)
{
	enum { N = 90 };
	double aspect = 1, *x = fft_alloc(N * N), *y = fft_alloc(N * N),
	       *z = fft_alloc(N * N);
	struct mlms *m = mlms_new(N, N, aspect, 6, 6, love, &aspect, NULL);
	struct mlms *t = mlms_new(N, N, aspect, 6, 6, love, &aspect, two);

	for (int i = 0; i < N * N; i++)
		x[i] = cos(i);
	mlms_apply(m, x, y);
	mlms_apply(t, x, z);
	ok(memcmp(y, z, N * N * sizeof *y) == 0,
		"one thread and two give the same bytes");
	mlms_free(m);
	mlms_free(t);
	fft_free(x);
	fft_free(y);
	fft_free(z);
}

int main(void)
{
	static const size_t sizes[][2] = { { 64, 64 }, { 61, 47 }, { 1, 200 }, { 200, 1 },
		{ 120, 10 }, { 10, 120 }, { 20, 20 }, { 1, 1 } };
	/* Long cells, grids that are halved in one direction only, and both. */
	static const double shapes[][3] = { { 64, 64, 2 }, { 64, 64, 0.3 },
		{ 64, 64, 20 }, { 200, 40, 1 }, { 40, 200, 1 }, { 200, 40, 0.3 },
		{ 40, 200, 3 }, { 300, 9, 0.78 }, { 100, 40, 7 } };
	struct pool *two = pool_new(2);
	double last = 1;

	for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
		double e = worst_error(
			sizes[i][0], sizes[i][1], 8, 18, 1, i % 2 ? two : NULL);

		ok(e < 1e-7, "%zux%zu: the error is %.1e", sizes[i][0], sizes[i][1], e);
	}
	for (size_t i = 0; i < sizeof(shapes) / sizeof(shapes[0]); i++) {
		double e = worst_error((size_t)shapes[i][0], (size_t)shapes[i][1], 8, 18,
			shapes[i][2], NULL);

		ok(e < 1e-7, "%gx%g cells of aspect %g: the error is %.1e", shapes[i][0],
			shapes[i][1], shapes[i][2], e);
	}
	for (int order = 4; order <= 10; order += 2) {
		double e = worst_error(64, 64, order, 2 * order + 2, 1, NULL);

		ok(e < last / 5,
			"order %d and reach %d: the error %.1e is far below the last",
			order, 2 * order + 2, e);
		last = e;
	}
	same_bytes(two);
	pool_free(two);
	return tap_done();
}
