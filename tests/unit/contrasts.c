/* Contrasts of the delays of a group against a chi-square computed by elimination */
#include "signal/separate/contrasts.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

enum { MOST = 12 };

static double normal(uint64_t i)
{
	double z[2];

	philox_normal2(3, 0, RNG_NOISE, i, z);
	return z[0];
}

/* Solves a x = b, n by n, by elimination with pivots on the diagonal of a positive
 * definite matrix. */
static void solve(int n, double a[MOST][MOST], double *b)
{
	for (int k = 0; k < n; k++)
		for (int i = k + 1; i < n; i++) {
			double f = a[i][k] / a[k][k];

			for (int l = k; l < n; l++)
				a[i][l] -= f * a[k][l];
			b[i] -= f * b[k];
		}
	for (int k = n - 1; k >= 0; k--) {
		for (int l = k + 1; l < n; l++)
			b[k] -= a[k][l] * b[l];
		b[k] /= a[k][k];
	}
}

/* Least (d - tau)^T C^-1 (d - tau) over tau. */
static double chi_square(int m, const double *d, double cov[MOST][MOST])
{
	double a[MOST][MOST], u[MOST], v[MOST], dd = 0, d1 = 0, ones = 0;

	for (int k = 0; k < 2; k++) {
		for (int i = 0; i < m; i++) {
			(k ? v : u)[i] = k ? 1 : d[i];
			for (int l = 0; l < m; l++)
				a[i][l] = cov[i][l];
		}
		solve(m, a, k ? v : u);
	}
	for (int i = 0; i < m; i++) {
		dd += d[i] * u[i];
		d1 += d[i] * v[i];
		ones += v[i];
	}
	return dd - d1 * d1 / ones;
}

int main(void)
{
	double worst = 0, shifted = 0, trace = 0;

	for (int m = 2; m <= MOST; m++) {
		double root[MOST][MOST], cov[MOST][MOST], d[MOST], square[MOST],
			var[MOST];
		double sum = 0, direct;

		for (int i = 0; i < m; i++) {
			d[i] = normal((uint64_t)(1000 * m + i));
			for (int k = 0; k < m; k++)
				root[i][k] =
					normal((uint64_t)(100000 * m + 100 * i + k)) +
					(i == k ? 2 : 0);
		}
		for (int i = 0; i < m; i++)
			for (int k = 0; k < m; k++) {
				cov[i][k] = 0;
				for (int l = 0; l < m; l++)
					cov[i][k] += root[i][l] * root[k][l];
			}
		direct = chi_square(m, d, cov);
		ok(contrasts_of(m, d, cov[0], MOST, square, var) == NUM_OK,
			"%d delays have %d contrasts", m, m - 1);
		for (int k = 0; k < m - 1; k++)
			sum += square[k] / var[k];
		worst = tap_max(worst, fabs(sum / direct - 1));
		sum = 0;
		for (int k = 0; k < m - 1; k++)
			sum += var[k];
		direct = 0; /* trace of C less that along 1 */
		for (int i = 0; i < m; i++)
			for (int k = 0; k < m; k++)
				direct += cov[i][k] * ((i == k) - 1.0 / m);
		trace = tap_max(trace, fabs(sum / direct - 1));
		for (int i = 0; i < m; i++)
			d[i] = 5;
		contrasts_of(m, d, cov[0], MOST, square, var);
		for (int k = 0; k < m - 1; k++)
			shifted = tap_max(shifted, square[k]);
	}
	near(worst, 0, 1e-8, "their squares over their variances are chi-square");
	near(trace, 0, 1e-12, "their variances are those across the mean");
	near(shifted, 0, 1e-24, "equal delays have none");
	return tap_done();
}
