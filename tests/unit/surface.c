/* Preparing and measuring heights against surfaces whose parameters are known. */
#include "surface/surface.h"
#include "num/deviates.h"
#include "surface/areal.h"
#include "surface/heights.h"
#include "surface/spectrum.h"
#include "tap.h"
#include <stdlib.h>
#include <string.h>

/* rms of cos(q (i + 1/2)) over the inner samples. */
static double rms_cosine(int n, int margin, double q)
{
	double sum = 0;

	for (int i = margin; i < n - margin; i++)
		sum += pow(cos(q * (i + 0.5)), 2);
	return sqrt(sum / (n - 2 * margin));
}

/* z = A sin(2 pi x / L) over whole periods, 16 samples each. */
static void check_sine(void)
{
	enum { NX = 64, NY = 48 };
	const double a = 2e-6, d = 1e-6, q = 2 * M_PI / 16;
	struct surface_parameters p;
	double z[NX * NY], k;

	for (int iy = 0; iy < NY; iy++)
		for (int ix = 0; ix < NX; ix++)
			z[iy * NX + ix] = 5e-3 + a * sin(q * (ix + 0.5));
	ok(surface_measure(NX, NY, d, d, z, &p) == NUM_OK,
		"the parameters of a sine are computed");
	near(p.sq / a, sqrt(0.5), 1e-10, "Sq of a sine is A / sqrt 2");
	near(p.ssk, 0, 1e-9, "Ssk of a sine is 0");
	near(p.sku, 1.5, 1e-9, "Sku of a sine is 3 / 2");
	near(p.sp / a, sin(q * 3.5), 1e-9, "Sp of a sine is the highest sample");
	near(p.sz - p.sp - p.sv, 0, 1e-20, "Sz is Sp + Sv");
	/* Derivatives of a sine by a formula are exact ones times a factor: sin(q) for
	 * the central difference, (45 sin q - 9 sin 2q + sin 3q) / 30 for the seven
	 * points. */
	k = (45 * sin(q) - 9 * sin(2 * q) + sin(3 * q)) / 30;
	near(p.sdq_central / (a / d * rms_cosine(NX, 1, q)), sin(q), 1e-9,
		"Sdq of a sine by central differences is right");
	near(p.sdq_iso7 / (a / d * rms_cosine(NX, 3, q)), k, 1e-9,
		"Sdq of a sine by seven points is right");
	near(k / q, 1, pow(q, 6) / 100, "differences of seven points are of sixth order");
	/* Slopes along x only: Sdr is the excess length of the polygon. */
	{
		double sum = 0;

		for (int ix = 0; ix + 1 < NX; ix++) {
			double s = a * (sin(q * (ix + 1.5)) - sin(q * (ix + 0.5))) / d;

			sum += sqrt(1 + s * s) - 1;
		}
		near(p.sdr, sum / (NX - 1), 1e-9, "Sdr of a sine is that of the polygon");
	}
	ok(isnan(p.corr_y), "a sine along x has no correlation length along y");
}

/* A tilted plane: all slopes equal, area sqrt(1 + s^2), nothing left after levelling. */
static void check_plane(void)
{
	enum { NX = 13, NY = 7 };
	struct surface_parameters p;
	double z[NX * NY];

	for (int iy = 0; iy < NY; iy++)
		for (int ix = 0; ix < NX; ix++)
			z[iy * NX + ix] = 3 + 0.3 * (ix * 2e-6) - 0.4 * (iy * 1e-6);
	surface_measure(NX, NY, 2e-6, 1e-6, z, &p);
	near(p.sdq, 0.5, 1e-8, "Sdq of a plane is its slope");
	near(p.sdq_cell, 0.5, 1e-8, "Sdq of a plane by cells is its slope");
	near(p.sdq_2x2, 0.5, 1e-8, "Sdq of a plane of 2 x 2 points is its slope");
	near(p.sdq_central, 0.5, 1e-8,
		"Sdq of a plane by central differences is its slope");
	near(p.sdq_iso7, 0.5, 1e-8, "Sdq of a plane by seven points is its slope");
	near(p.sdr, sqrt(1.25) - 1, 1e-8, "Sdr of a plane is right");
	surface_level(NX, NY, z);
	near(surface_sq(NX, NY, z), 0, 1e-15, "levelling leaves nothing of a plane");
}

/* Small slopes, where Sdr = Sdq_cell^2 / 2 must survive rounding. */
static void check_small(void)
{
	enum { N = 32 };
	struct surface_parameters p;
	double z[N * N];

	for (int i = 0; i < N * N; i++)
		z[i] = 1e-9 * sin(1.3 * (i % N)) * cos(0.7 * (i / N));
	surface_measure(N, N, 1, 1, z, &p);
	ok(fabs(p.sdr / (0.5 * p.sdq_cell * p.sdq_cell) - 1) < 0.05,
		"for slopes of 1e-9 Sdr is half of Sdq squared and not lost");
}

/* Second differences of a polynomial of second order are exact in cells of any sides. */
static double harmonic(int ix, int iy, double dx, double dy)
{
	double x = ix * dx, y = iy * dy;

	return 1 + x * x - y * y + 0.5 * x * y;
}

static void check_fill(double dx, double dy)
{
	enum { NX = 21, NY = 17 };
	double z[NX * NY], worst = 0, residual;
	int steps;

	for (int iy = 0; iy < NY; iy++)
		for (int ix = 0; ix < NX; ix++)
			z[iy * NX + ix] = harmonic(ix, iy, dx, dy);
	for (int iy = 4; iy < 12; iy++)
		for (int ix = 3; ix < 17; ix++)
			z[iy * NX + ix] = NAN;
	z[14 * NX + 5] = NAN;
	ok(surface_missing(NX, NY, z) == 8 * 14 + 1, "missing samples are counted");
	ok(surface_fill(NX, NY, dx, dy, z, &steps, &residual) == NUM_OK && steps > 0,
		"a hole is filled");
	for (int iy = 0; iy < NY; iy++)
		for (int ix = 0; ix < NX; ix++)
			worst = tap_max(
				worst, fabs(z[iy * NX + ix] - harmonic(ix, iy, dx, dy)));
	near(worst, 0, 1e-9, "filling restores a discrete harmonic function");
	/* A hole at the rim has no slope across it: one known column spreads. */
	for (int i = 0; i < NX * NY; i++)
		z[i] = i % NX ? NAN : 4;
	surface_fill(NX, NY, dx, dy, z, &steps, &residual);
	near(z[NX * NY - 1], 4, 1e-9,
		"filling continues the last known column as a constant");
	ok(residual <= SURFACE_FILLED, "filling returns the residual (%.1e)", residual);
	/* The numbers leave the range of doubles: no result, and the residual says so. */
	for (int i = 0; i < NX * NY; i++)
		z[i] = i % NX ? NAN : i % 2 ? 1e300 : -1e300;
	surface_fill(NX, NY, dx, dy, z, &steps, &residual);
	ok(!(residual <= SURFACE_FILLED), "filling reports an iteration that fails");
}

static double cubic_error(int n)
{
	enum { TIMES = 3 };
	double *z = malloc((size_t)n * sizeof *z),
	       *f = malloc(TIMES * (size_t)n * sizeof *f);
	double worst = 0;

	for (int i = 0; i < n; i++)
		z[i] = sin(2 * (i + 0.5) / n);
	surface_resample(n, 1, z, TIMES * n, 1, f);
	for (int i = 0; i < TIMES * n; i++)
		worst = tap_max(worst, fabs(f[i] - sin(2 * (i + 0.5) / (TIMES * n))));
	free(z);
	free(f);
	return worst;
}

static void check_resample(void)
{
	enum { NX = 12, NY = 10 };
	double z[NX * NY], coarse[4 * 5], fine[NX * 3 * NY * 2], worst = 0, order;

	for (int iy = 0; iy < NY; iy++)
		for (int ix = 0; ix < NX; ix++)
			z[iy * NX + ix] = 2 + 0.25 * (ix + 0.5) - 0.5 * (iy + 0.5);
	surface_resample(NX, NY, z, 3 * NX, 2 * NY, fine);
	for (int iy = 0; iy < 2 * NY; iy++)
		for (int ix = 0; ix < 3 * NX; ix++)
			worst = tap_max(worst, fabs(fine[iy * 3 * NX + ix] -
						       (2 + 0.25 * (ix + 0.5) / 3 -
							       0.5 * (iy + 0.5) / 2)));
	near(worst, 0, 1e-14, "refining keeps a plane up to the rim");
	surface_resample(NX, NY, z, 4, 5, coarse);
	near(coarse[4 * 2 + 1], 2 + 0.25 * 4.5 - 0.5 * 5, 1e-14,
		"coarsening averages over the new cell");
	near(surface_mean(4, 5, coarse), surface_mean(NX, NY, z), 1e-14,
		"coarsening keeps the mean");
	surface_resample(NX, NY, z, 5, 7, fine);
	near(surface_mean(5, 7, fine), surface_mean(NX, NY, z), 1e-14,
		"coarsening by a fractional ratio keeps the mean");
	order = log2(cubic_error(40) / cubic_error(80));
	ok(order > 2.8, "refining converges with order %.2f, want 3", order);
}

static void check_crown(void)
{
	enum { N = 101 };
	double *z = calloc(N * 51, sizeof *z);

	surface_crown(N, 51, 1e-3, 2e-3, 7, z);
	near(z[25 * N + 50], 0, 1e-15, "a crown is 0 in the middle");
	near(z[0],
		-7 * (pow(50e-3, 2) + pow(50e-3, 2)) / (pow(50.5e-3, 2) + pow(51e-3, 2)),
		1e-12, "a crown has its drop at the corner of the area");
	near((z[25 * N + 60] + z[25 * N + 40]) / pow(10e-3, 2),
		(z[30 * N + 50] + z[20 * N + 50]) / pow(10e-3, 2), 1e-9,
		"a crown has equal curvature in both directions");
	free(z);
}

static void check_correlation(void)
{
	enum { N = 512 };
	struct spectrum_par par = { .nx = N,
		.ny = N,
		.lx = 1,
		.ly = 1,
		.kind = SPECTRUM_GAUSS,
		.corr_x = 0.02,
		.corr_y = 0.01 };
	struct spectrum *s;
	double *z = malloc(N * N * sizeof *z);
	struct surface_parameters p;

	spectrum_make(&par, &s);
	spectrum_surface(s, NULL, 1, 0, RNG_SURFACE, z, NULL);
	surface_measure(N, N, 1.0 / N, 1.0 / N, z, &p);
	/* About 1600 independent patches: 2.5 %; twice that. */
	near(p.corr_x / 0.02, 1, 0.05,
		"the measured correlation length along x is right");
	near(p.corr_y / 0.01, 1, 0.05,
		"the measured correlation length along y is right");
	near(p.sal / (0.01 * sqrt(log(5))), 1, 0.06,
		"Sal of a Gaussian correlation is right");
	near(p.str, 0.5, 0.05, "Str of lengths 1 : 2 is 1/2");
	near(p.sdq_iso7 / p.sq, sqrt(2 * (1 / pow(0.02, 2) + 1 / pow(0.01, 2))), 6,
		"Sdq of a Gaussian correlation is right");
	free(z);
	spectrum_free(s);
}

static void check_moments(size_t n, double skewness, double kurtosis)
{
	double *z = malloc(n * sizeof *z), m1 = 0, m2 = 0, m3 = 0, m4 = 0;
	enum heights_status status = heights_sorted(n, skewness, kurtosis, z);
	int ascending = 1;

	for (size_t i = 0; status == HEIGHTS_OK && i < n; i++) {
		m1 += z[i] / (double)n;
		m2 += z[i] * z[i] / (double)n;
		m3 += pow(z[i], 3) / (double)n;
		m4 += pow(z[i], 4) / (double)n;
		ascending &= i == 0 || z[i] >= z[i - 1];
	}
	ok(status == HEIGHTS_OK && ascending && fabs(m1) < 1e-9 && fabs(m2 - 1) < 1e-9 &&
			fabs(m3 - skewness) < 2e-6 && fabs(m4 - kurtosis) < 2e-6,
		"%zu heights have skewness %g and kurtosis %g; errors %.1e, %.1e", n,
		skewness, kurtosis, m3 - skewness, m4 - kurtosis);
	free(z);
}

static void check_heights(void)
{
	static const double pairs[][2] = { { 0, 3 }, { 0, 1.8 }, { 0, 1.2 }, { 0, 10 },
		{ 0.5, 3.2 }, { -0.5, 3.2 }, { -1.22, 4.27 }, { 2, 9 }, { 1, 5 },
		{ -2, 5.2 }, { 1, 2.2 }, { 3, 30 }, { -0.37, 4.56 }, { 0.001, 3.0001 },
		{ -5, 60 } };
	double z[16];

	near(normal_quantile(0.975), 1.959963984540054, 1e-14,
		"the quantile at 97.5 % is right");
	near(normal_quantile(1e-10), -6.361340902404056, 1e-12,
		"the quantile at 1e-10 is right");
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
		check_moments(65536, pairs[i][0], pairs[i][1]);
	check_moments(100, 0.5, 3.2);
	check_moments(6, 0, 1.7);
	ok(heights_sorted(16, 1, 1.9, z) == HEIGHTS_IMPOSSIBLE,
		"a kurtosis below skewness^2 + 1 is refused");
	ok(heights_sorted(16, 0, 50, z) == HEIGHTS_TOO_FEW,
		"a kurtosis of 50 is refused for 16 points");
}

static void check_ranking(void)
{
	double z[] = { 3, -1, -0.0, 1e300, -1e-300, 3, INFINITY };
	double sorted[] = { 10, 11, 12, 13, 14, 15, 16 };
	double want[] = { 13, 10, 12, 15, 11, 14, 16 };
	struct ranking *r = ranking_new(7);

	ranking_impose(r, sorted, z);
	ok(memcmp(z, want, sizeof want) == 0,
		"ranking orders signs, tiny, huge and equal values");
	ranking_free(r);
}

int main(void)
{
	check_sine();
	check_plane();
	check_small();
	check_fill(1, 1);
	check_fill(2.6, 0.7);
	check_resample();
	check_crown();
	check_correlation();
	check_heights();
	check_ranking();
	return tap_done();
}
