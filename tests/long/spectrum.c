/* Statistics of many realisations: correlation, distribution, independence. */
#include "../unit/tap.h"
#include "surface/rough.h"
#include <stdlib.h>
#include <string.h>

enum { N = 64, MANY = 3000, LAGS = 4 };
static const int lag[LAGS][2] = { { 0, 0 }, { 3, 0 }, { 0, 6 }, { 9, 5 } };

static struct spectrum_par shape(enum spectrum_kind kind)
{
	return (struct spectrum_par){ .nx = N,
		.ny = N,
		.lx = 1,
		.ly = 1,
		.kind = kind,
		.corr_x = 0.1,
		.corr_y = 0.1,
		.hurst = 0.8 };
}

static struct spectrum *make(enum spectrum_kind kind)
{
	struct spectrum_par par = shape(kind);
	struct spectrum *s;

	spectrum_make(&par, &s);
	return s;
}

/* Mean over the surface of z times z shifted round by (jx, jy). */
static double product(const double *a, const double *b, int jx, int jy)
{
	double sum = 0;

	for (int iy = 0; iy < N; iy++)
		for (int ix = 0; ix < N; ix++)
			sum += a[iy * N + ix] * b[(iy + jy) % N * N + (ix + jx) % N];
	return sum / (N * N);
}

/* Covariances over the ensemble before scaling, against the spectrum's own sum, which
 * tests/unit/spectrum.c holds against the formula. */
static void check_correlation(enum spectrum_kind kind, const char *name)
{
	struct spectrum *s = make(kind);
	double z[N * N], sum[LAGS] = { 0 }, square[LAGS] = { 0 };

	for (uint32_t k = 0; k < MANY; k++) {
		spectrum_surface(s, NULL, 5, k, RNG_SURFACE, z, NULL);
		for (int l = 0; l < LAGS; l++) {
			double p = product(z, z, lag[l][0], lag[l][1]);

			sum[l] += p / MANY;
			square[l] += p * p / MANY;
		}
	}
	for (int l = 0; l < LAGS; l++) {
		double want = 0, se = sqrt((square[l] - sum[l] * sum[l]) / MANY);

		for (int ky = 1 - N / 2; ky <= N / 2; ky++)
			for (int kx = 1 - N / 2; kx <= N / 2; kx++)
				want += spectrum_power(s, kx, ky) *
					cos(2 * M_PI * (kx * lag[l][0] + ky * lag[l][1]) /
						N);
		ok(fabs(sum[l] - want) < 4.5 * se,
			"%s: covariance at lag (%d, %d): %.5f, want %.5f, %.1f standard errors",
			name, lag[l][0], lag[l][1], sum[l], want, (sum[l] - want) / se);
	}
	spectrum_free(s);
}

/* Heights at one point over the ensemble: normal, and not those of its neighbours in
 * the ensemble or of the second surface. */
static void check_heights(void)
{
	struct spectrum *s = make(SPECTRUM_EXP);
	double z[N * N], other[N * N], m2 = 0, m3 = 0, m4 = 0, next = 0, pair = 0,
				       last = 0;

	for (uint32_t k = 0; k < MANY; k++) {
		double h;

		spectrum_surface(s, NULL, 5, k, RNG_SURFACE, z, NULL);
		spectrum_surface(s, NULL, 5, k, RNG_SURFACE_2, other, NULL);
		h = z[17 * N + 40];
		m2 += h * h / MANY;
		m3 += h * h * h / MANY;
		m4 += h * h * h * h / MANY;
		next += h * last / MANY;
		pair += h * other[17 * N + 40] / MANY;
		last = h;
	}
	/* Standard errors: sqrt(6 / n), sqrt(24 / n), 1 / sqrt(n). */
	near(m3 / pow(m2, 1.5), 0, 4.5 * sqrt(6.0 / MANY),
		"the skewness at a point is 0");
	near(m4 / (m2 * m2), 3, 4.5 * sqrt(24.0 / MANY), "the kurtosis at a point is 3");
	near(next / m2, 0, 4.5 / sqrt(MANY), "consecutive realisations are independent");
	near(pair / m2, 0, 4.5 / sqrt(MANY),
		"the two surfaces of a pair are independent");
	spectrum_free(s);
}

/* Imposed heights keep the correlation of the ensemble. */
static void check_imposed(void)
{
	struct rough_par par = { .spectrum = shape(SPECTRUM_GAUSS),
		.kind = ROUGH_SQ,
		.target = { 1, 1 },
		.kurtosis = 3,
		.seed = 5 };
	struct rough *normal, *r;
	double z[N * N], g[N * N], sum = 0, want = 0;

	rough_make(&par, &normal);
	par.skewness = -1.2;
	par.kurtosis = 4.3;
	rough_make(&par, &r);
	for (uint32_t k = 0; k < 300; k++) {
		rough_surface(r, k, z, NULL);
		rough_surface(normal, k, g, NULL);
		sum += product(z, z, 4, 3) / 300;
		want += product(g, g, 4, 3) / 300;
	}
	near(sum, want, 0.002, "imposed heights leave the correlation as it was");
	rough_free(r);
	rough_free(normal);
}

static void check_range(void)
{
	struct rough_range range = { 78e-6, 82e-6 };
	double mean = 0, square = 0;

	for (uint32_t k = 0; k < 10000; k++) {
		double u = (rough_draw(&range, 1, k, 0) - 78e-6) / 4e-6;

		mean += u / 10000;
		square += u * u / 10000;
	}
	near(mean, 0.5, 4.5 / sqrt(12 * 10000),
		"drawn roughness has the mean of a uniform distribution");
	near(square - mean * mean, 1 / 12.0, 4.5 * sqrt(1.0 / 180 / 10000),
		"drawn roughness has the variance of a uniform distribution");
}

int main(void)
{
	check_correlation(SPECTRUM_GAUSS, "Gaussian");
	check_correlation(SPECTRUM_EXP, "exponential");
	check_correlation(SPECTRUM_AFFINE, "self-affine");
	check_heights();
	check_imposed();
	check_range();
	return tap_done();
}
