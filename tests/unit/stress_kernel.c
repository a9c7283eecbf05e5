/* Stress under a loaded rectangle against reference values, equilibrium and symmetry. */
#include "stress/stress_kernel.h"
#include "tap.h"

#include <stdlib.h>
#include <string.h>

enum { N = STRESS_COMPONENTS };

static double worst(const double *a, const double *b)
{
	double e = 0;

	for (int c = 0; c < N; c++)
		e = tap_max(e, fabs(a[c] - b[c]));
	return e;
}

/* Rows a b nu x y z, six components and von Mises, evaluated with 50 digits. */
static void check_table(const char *path, int sheared)
{
	FILE *f = fopen(path, "r");
	char line[512];
	int rows = 0;
	double error = 0, mises = 0;

	if (!f) {
		ok(0, "the reference table %s can be read", path);
		return;
	}
	while (fgets(line, sizeof(line), f)) {
		double v[13], n[N], s[N];
		char *at = line;

		if (line[0] == '#' || line[0] == 'a')
			continue;
		for (int k = 0; k < 13; k++)
			v[k] = strtod(at, &at);
		stress_patch(v[0], v[1], v[2], v[3], v[4], v[5], n, s);
		error = tap_max(error, worst(sheared ? s : n, v + 6));
		mises = tap_max(mises, fabs(stress_von_mises(sheared ? s : n) - v[12]));
		rows++;
	}
	fclose(f);
	ok(rows == 20, "%s has 20 points", path);
	near(error, 0, 3e-15, "the six components have the values of the reference");
	near(mises, 0, 3e-15, "the von Mises stress has the value of the reference");
}

/* Divergence of the stress by central differences of order four. */
static double divergence(int row, double x, double y, double z, int sheared)
{
	static const int pick[3][3] = { { STRESS_XX, STRESS_XY, STRESS_XZ },
		{ STRESS_XY, STRESS_YY, STRESS_YZ },
		{ STRESS_XZ, STRESS_YZ, STRESS_ZZ } };
	double h = 1e-3, sum = 0, n[N], s[N];

	for (int axis = 0; axis < 3; axis++)
		for (int k = -2; k <= 2; k++) {
			static const double w[5] = { 1, -8, 0, 8, -1 };

			stress_patch(0.7, 0.4, 0.3, x + (axis == 0) * k * h,
				y + (axis == 1) * k * h, z + (axis == 2) * k * h, n, s);
			sum += w[k + 2] * (sheared ? s : n)[pick[row][axis]] / (12 * h);
		}
	return sum;
}

static void check_equilibrium(void)
{
	double most = 0;

	for (int row = 0; row < 3; row++)
		for (int sheared = 0; sheared < 2; sheared++)
			for (int k = 0; k < 20; k++)
				most = tap_max(most, fabs(divergence(row, 1.1 * cos(k),
							     0.9 * sin(3 * k),
							     0.2 + 0.05 * k, sheared)));
	near(most, 0, 1e-8, "the stress is in equilibrium (divergence by differences)");
}

static void check_principal(void)
{
	double s[N] = { 3, -1, 0.5, 0.25, -2, 1 }, p[3], i1, i2, i3;
	double sphere[N] = { 2, 2, 2, 0, 0, 0 }, shear[N] = { 0, 0, 0, 1, 0, 0 };

	stress_principal(s, p);
	i1 = s[0] + s[1] + s[2];
	i2 = s[0] * s[1] + s[1] * s[2] + s[2] * s[0] - s[3] * s[3] - s[4] * s[4] -
	     s[5] * s[5];
	i3 = s[0] * s[1] * s[2] + 2 * s[3] * s[4] * s[5] - s[0] * s[5] * s[5] -
	     s[1] * s[4] * s[4] - s[2] * s[3] * s[3];
	near(p[0] + p[1] + p[2], i1, 1e-14,
		"the principal stresses have the first invariant");
	near(p[0] * p[1] + p[1] * p[2] + p[2] * p[0], i2, 1e-13,
		"the principal stresses have the second invariant");
	near(p[0] * p[1] * p[2], i3, 1e-13,
		"the principal stresses have the third invariant");
	ok(p[0] >= p[1] && p[1] >= p[2], "the principal stresses descend");
	stress_principal(sphere, p);
	ok(p[0] == 2 && p[1] == 2 && p[2] == 2, "equal principal stresses are found");
	stress_principal(shear, p);
	near(p[0], 1, 1e-15, "pure shear has a principal tension");
	near(p[2], -1, 1e-15, "pure shear has a principal compression");
	near(stress_von_mises(shear), sqrt(3), 1e-15,
		"the von Mises stress of pure shear is right");
}

/* A patch seen from far away is a point load; both loads at once. */
static void check_point(void)
{
	double n[N], s[N], p[N], sum[N], r = 1000, x = 0.6, y = -0.48, z = 0.64;

	stress_patch(0.5, 0.5, 0.3, r * x, r * y, r * z, n, s);
	stress_point(0.3, 0.25, x, y, z, p);
	for (int c = 0; c < N; c++)
		sum[c] = r * r * (n[c] + 0.25 * s[c]);
	/* The patch differs from a point by (size / distance)^2 ~ 1e-6 and rounding 1e-9.
	 */
	near(worst(sum, p), 0, 1e-6, "a point load is the limit of a patch");
}

int main(void)
{
	check_table("tests/data/patch_normal.tsv", 0);
	check_table("tests/data/patch_shear_x.tsv", 1);
	check_equilibrium();
	/* Corners lose (distance / cell)^2 ulps against their own size. */
	check_principal();
	check_point();
	return tap_done();
}
