/* The spectrum against its correlation functions, and its waves under refinement of the
 * grid. */
#include "surface/spectrum.h"
#include "num/fft.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

static struct spectrum *make(
	int nx, int ny, enum spectrum_kind kind, double cx, double cy)
{
	struct spectrum_par par = { .nx = nx,
		.ny = ny,
		.lx = 1,
		.ly = 1,
		.kind = kind,
		.corr_x = cx,
		.corr_y = cy,
		.hurst = 0.8 };
	struct spectrum *s;

	spectrum_make(&par, &s);
	return s;
}

/* Correlation at lag (jx, jy) as the sum over all waves of their power; what is missing
 * from 1 is the power of the mean. */
static double correlation(const struct spectrum *s, int nx, int ny, int jx, int jy)
{
	double sum = 0, all = 0;

	for (int iy = 0; iy < ny; iy++)
		for (int ix = 0; ix < nx; ix++) {
			int kx = 2 * ix <= nx ? ix : ix - nx,
			    ky = 2 * iy <= ny ? iy : iy - ny;

			all += spectrum_power(s, kx, ky);
			sum += spectrum_power(s, kx, ky) *
			       cos(2 * M_PI *
				       ((double)kx * jx / nx + (double)ky * jy / ny));
		}
	return sum + 1 - all;
}

/* The periodic sum of the wanted function. */
static double wanted(enum spectrum_kind kind, double x, double y, double cx, double cy)
{
	int reach = (int)(40 * (cx > cy ? cx : cy)) + 2;
	double sum = 0;

	for (int my = -reach; my <= reach; my++)
		for (int mx = -reach; mx <= reach; mx++) {
			double r = hypot((x + mx) / cx, (y + my) / cy);

			sum += exp(kind == SPECTRUM_GAUSS ? -r * r : -r);
		}
	return sum;
}

static void check_correlation(
	enum spectrum_kind kind, int nx, int ny, double cx, double cy)
{
	struct spectrum *s = make(nx, ny, kind, cx, cy);
	double worst = 0, zero = wanted(kind, 0, 0, cx, cy);

	for (int jy = 0; jy <= ny / 2; jy += 3)
		for (int jx = 0; jx <= nx / 2; jx += 2) {
			double got = correlation(s, nx, ny, jx, jy);
			double want =
				wanted(kind, (double)jx / nx, (double)jy / ny, cx, cy) /
				zero;

			worst = tap_max(worst, fabs(got - want));
		}
	ok(worst < 1e-12,
		"%s correlation, lengths %g and %g on %d x %d, holds: error %.1e",
		kind == SPECTRUM_GAUSS ? "Gaussian" : "exponential", cx, cy, nx, ny,
		worst);
	spectrum_free(s);
}

/* Mean square over realisations at one point: the power of all waves but the mean. */
static void check_variance(void)
{
	enum { N = 16, MANY = 4000 };
	struct spectrum *s = make(N, N, SPECTRUM_EXP, 0.1, 0.1);
	double z[N * N], sum = 0, want = 0;

	for (int ky = 1 - N / 2; ky <= N / 2; ky++)
		for (int kx = 1 - N / 2; kx <= N / 2; kx++)
			want += spectrum_power(s, kx, ky);

	for (uint32_t k = 0; k < MANY; k++) {
		spectrum_surface(s, NULL, 3, k, RNG_SURFACE, z, NULL);
		sum += z[5 * N + 2] * z[5 * N + 2];
	}
	/* Standard error of a variance: sqrt(2 / MANY) = 2.2 %; four of them. */
	near(sum / MANY, want, 0.09 * want,
		"the variance at a point over 4000 realisations is 1");
	spectrum_free(s);
}

/* The coefficient of wave (kx, ky) seen from the corner of the area. */
static double complex coefficient(const double *z, int n, int kx, int ky)
{
	double complex sum = 0;

	for (int iy = 0; iy < n; iy++)
		for (int ix = 0; ix < n; ix++) {
			double phase = 2 * M_PI * (kx * (ix + 0.5) + ky * (iy + 0.5)) / n;

			sum += z[iy * n + ix] * (cos(phase) - sin(phase) * I);
		}
	return sum / ((double)n * n);
}

/* Gaussian power does not alias, so the waves of the coarse grid reappear. */
static void check_refinement(void)
{
	enum { N = 512 };
	struct spectrum *coarse = make(N, N, SPECTRUM_GAUSS, 0.05, 0.05);
	struct spectrum *fine = make(2 * N, 2 * N, SPECTRUM_GAUSS, 0.05, 0.05);
	double *a = malloc(N * N * sizeof *a), *b = malloc(4 * N * N * sizeof *b);
	double worst = 0, power = 0, mean = 0, rms = 0;

	spectrum_surface(coarse, NULL, 7, 11, RNG_SURFACE, a, NULL);
	spectrum_surface(fine, NULL, 7, 11, RNG_SURFACE, b, NULL);
	for (int ky = -3; ky <= 3; ky++)
		for (int kx = 0; kx <= 3; kx++) {
			double complex ca = coefficient(a, N, kx, ky);
			double complex cb = coefficient(b, 2 * N, kx, ky);

			worst = tap_max(worst, cabs(ca - cb));
			power = tap_max(power, cabs(ca));
		}
	ok(worst < 1e-13 * power * N,
		"512 and 1024 points have the same long waves, to %.1e of the largest",
		worst / power);
	/* Means of 2 x 2 fine cells against coarse samples: they differ by the curvature
	 * within a cell, (q dx)^2 / 16 with q about 2 / 0.05: 4e-4. */
	for (int iy = 0; iy < N; iy++)
		for (int ix = 0; ix < N; ix++) {
			const double *c = b + 4 * N * iy + 2 * ix;
			double d = (c[0] + c[1] + c[2 * N] + c[2 * N + 1]) / 4 -
				   a[iy * N + ix];

			mean += d * d;
			rms += a[iy * N + ix] * a[iy * N + ix];
		}
	ok(sqrt(mean / rms) < 2e-3,
		"heights of 512 and 1024 points agree cell by cell, rms %.1e",
		sqrt(mean / rms));
	free(a);
	free(b);
	spectrum_free(coarse);
	spectrum_free(fine);
}

/* Three times finer: every third cell centre is a coarse one.  With a cut-off the waves
 * are the same set, whatever the spectrum. */
static void check_threefold(void)
{
	enum { N = 50 };
	struct spectrum_par par = { .nx = N,
		.ny = N,
		.lx = 1,
		.ly = 1,
		.kind = SPECTRUM_AFFINE,
		.hurst = 0.7,
		.rolloff = 0.3,
		.cutoff = 0.1 };
	struct spectrum *coarse, *fine;
	double a[N * N], *b = malloc(9 * N * N * sizeof *b), worst = 0, slope, again,
			 measured;

	spectrum_make(&par, &coarse);
	par.nx = par.ny = 3 * N;
	spectrum_make(&par, &fine);
	spectrum_surface(coarse, NULL, 1, 2, RNG_SURFACE_2, a, &slope);
	spectrum_surface(fine, NULL, 1, 2, RNG_SURFACE_2, b, &again);
	for (int iy = 0; iy < N; iy++)
		for (int ix = 0; ix < N; ix++)
			worst = tap_max(worst, fabs(b[(3 * iy + 1) * 3 * N + 3 * ix + 1] -
						       a[iy * N + ix]));
	near(worst, 0, 1e-13,
		"a threefold refinement keeps the heights at common centres");
	near(again / slope, 1, 1e-13, "a threefold refinement keeps the rms slope");
	ok(spectrum_slope(fine, b, &measured) == NUM_OK,
		"the rms slope of heights is computed");
	near(measured / slope, 1, 1e-12, "the rms slope of heights is that of the waves");
	ok(spectrum_waves(coarse) == spectrum_waves(fine),
		"the cut-off leaves the same waves");
	free(b);
	spectrum_free(coarse);
	spectrum_free(fine);
}

static void check_affine(void)
{
	struct spectrum_par par = { .nx = 128,
		.ny = 128,
		.lx = 1,
		.ly = 1,
		.kind = SPECTRUM_AFFINE,
		.hurst = 0.8,
		.rolloff = 1.0 / 8,
		.longest = 1.0 / 4,
		.cutoff = 1.0 / 32 };
	struct spectrum *s;

	spectrum_make(&par, &s);
	near(spectrum_power(s, 32, 0) / spectrum_power(s, 16, 0), pow(2, -3.6), 1e-14,
		"self-affine: the power falls as q^-2(1+H)");
	near(spectrum_power(s, 4, 0) / spectrum_power(s, 8, 0), 1, 1e-14,
		"self-affine: the power is constant above the roll-off wavelength");
	ok(spectrum_power(s, 3, 0) == 0 && spectrum_power(s, 33, 0) == 0,
		"self-affine: no wave is longer than the longest or shorter than the cut-off");
	ok(spectrum_waves(s) + spectrum_waves_skipped(s) == 128 * 128 - 1,
		"drawn and excluded waves make up the grid");
	spectrum_free(s);
}

static void check_pool(void)
{
	enum { NX = 45, NY = 31 };
	struct spectrum *s = make(NX, NY, SPECTRUM_EXP, 0.2, 0.1);
	struct pool *pool = pool_new(3);
	double a[NX * NY], b[NX * NY];

	spectrum_surface(s, NULL, 9, 1, RNG_SURFACE, a, NULL);
	spectrum_surface(s, pool, 9, 1, RNG_SURFACE, b, NULL);
	ok(memcmp(a, b, sizeof a) == 0, "three threads draw the same bytes");
	pool_free(pool);
	spectrum_free(s);
}

static void check_profiles(void)
{
	struct spectrum *along_x = make(64, 1, SPECTRUM_EXP, 0.1, 0.1);
	struct spectrum *along_y = make(1, 64, SPECTRUM_EXP, 0.1, 0.1);
	double a[64], b[64], zero = 0, want = 0, sum = 0;

	for (int m = -6; m <= 6; m++) {
		zero += exp(-abs(m) / 0.1);
		want += exp(-fabs(m + 0.125) / 0.1);
	}
	near(correlation(along_x, 64, 1, 8, 0), want / zero, 1e-12,
		"the correlation of a profile is right");
	spectrum_surface(along_x, NULL, 1, 0, RNG_SURFACE, a, NULL);
	spectrum_surface(along_y, NULL, 1, 0, RNG_SURFACE, b, NULL);
	for (int i = 0; i < 64; i++)
		sum += a[i] * a[i] + b[i] * b[i];
	ok(isfinite(sum) && sum > 0, "profiles along x and y are drawn");
	spectrum_free(along_x);
	spectrum_free(along_y);
}

static void check_refusals(void)
{
	struct spectrum_par good = { .nx = 8,
		.ny = 8,
		.lx = 1,
		.ly = 1,
		.corr_x = 0.1,
		.corr_y = 0.1 },
			    par;
	struct spectrum *s;

	par = good;
	par.corr_x = NAN;
	ok(spectrum_make(&par, &s) == SPECTRUM_DOMAIN && !s,
		"a length of nan is refused");
	par = good;
	par.corr_y = 1.5;
	ok(spectrum_make(&par, &s) == SPECTRUM_TOO_LONG && !s,
		"a correlation length above the side is refused");
	par = good;
	par.cutoff = 2;
	ok(spectrum_make(&par, &s) == SPECTRUM_EMPTY && !s,
		"a cut-off above the side leaves no waves");
	par = good;
	par.nx = par.ny = 1;
	ok(spectrum_make(&par, &s) == SPECTRUM_EMPTY && !s, "one point has no waves");
}

int main(void)
{
	check_correlation(SPECTRUM_GAUSS, 24, 24, 0.1, 0.1);
	check_correlation(SPECTRUM_GAUSS, 25, 31, 0.7, 0.02);
	check_correlation(SPECTRUM_GAUSS, 24, 27, 0.01, 0.01);
	check_correlation(SPECTRUM_EXP, 24, 24, 0.1, 0.1);
	check_correlation(SPECTRUM_EXP, 25, 30, 0.3, 0.05);
	check_correlation(SPECTRUM_EXP, 24, 31, 0.001, 0.001);
	check_correlation(SPECTRUM_EXP, 16, 16, 0.9, 0.9);
	check_variance();
	check_refinement();
	check_threefold();
	check_affine();
	check_pool();
	check_profiles();
	check_refusals();
	return tap_done();
}
