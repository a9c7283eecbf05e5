/* Eigenvectors of symmetric 3 x 3 matrices: A v = lambda v, orthonormal, in order. */
#include "num/sym3.h"
#include "num/philox.h"
#include "tap.h"

static double uniform(int trial, int k)
{
	return 2 * philox_uniform(11, (uint32_t)trial, RNG_NOISE, (uint64_t)k) - 1;
}

/* Largest errors of A v = lambda v and of v . w = 0 or 1, relative to the largest
 * eigenvalue. */
static void check(const double m[6], double *equation, double *normal, int *bad)
{
	const double a[3][3] = { { m[0], m[3], m[4] }, { m[3], m[1], m[5] },
		{ m[4], m[5], m[2] } };
	double value[3], v[3][3], scale;

	sym3_eigen(m, value, v);
	scale = fmax(fabs(value[0]), fabs(value[2]));
	*bad += !(value[0] >= value[1] && value[1] >= value[2]);
	for (int i = 0; i < 3; i++) {
		double most = 0;

		for (int r = 0; r < 3; r++) {
			double sum = -value[i] * v[i][r];

			for (int c = 0; c < 3; c++)
				sum += a[r][c] * v[i][c];
			*equation = tap_max(*equation, fabs(sum) / scale);
			most = fabs(v[i][r]) > fabs(most) ? v[i][r] : most;
		}
		*bad += !(most > 0);
		for (int j = 0; j < 3; j++) {
			double dot = -(i == j);

			for (int c = 0; c < 3; c++)
				dot += v[i][c] * v[j][c];
			*normal = tap_max(*normal, fabs(dot));
		}
	}
}

int main(void)
{
	/* Matrices of any kind, and ones whose eigenvalues lie close together. */
	for (int close = 0; close < 2; close++) {
		double equation = 0, normal = 0;
		int bad = 0;

		for (int trial = 0; trial < 20000; trial++) {
			double m[6];

			for (int k = 0; k < 6; k++)
				m[k] = (close ? 1e-9 : 1) * uniform(trial, k) +
				       (close && k < 3);
			check(m, &equation, &normal, &bad);
		}
		ok(equation < 2e-15, "%s: A v = lambda v holds to %.1e",
			close ? "close eigenvalues" : "20000 random matrices", equation);
		ok(normal < 2e-15, "the eigenvectors are orthonormal to %.1e", normal);
		ok(bad == 0,
			"the eigenvalues descend and the largest component of each vector is positive (%d are not)",
			bad);
	}
	return tap_done();
}
