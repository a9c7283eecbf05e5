#include "stress/stress_kernel.h"
#include "num/sym3.h"

#include <math.h>
#include <stddef.h>

enum { N = STRESS_COMPONENTS };

/* Terms of the closed forms at a corner (x, y), for the roles of x and y as given,
 * without cancellation where y < 0 and R + y is small. */
struct half {
	double q;   /* x z / (R (R + y)) */
	double w;   /* z^2 / (R (R + y)) */
	double t;   /* 2 atan(x / (R + y + z)) */
	double log; /* ln(R + y) */
};

static struct half half_terms(double x, double y, double z, double r, int logs)
{
	double rho2 = x * x + z * z;
	double sum = y < 0 ? rho2 / (r - y) : r + y; /* R + y */
	double below = y < 0 ? (x * x + 2 * z * (r + z)) / (r + z - y) : r + y + z;
	struct half h = { 0, 0, 0, 0 };

	if (z != 0) {
		h.w = z * z / (r * sum);
		h.q = x * z / (r * sum);
	}
	h.t = 2 * atan2(x, below);
	if (logs)
		h.log = log(sum);
	return h;
}

/* The potentials T of (2-8) and (2-9) at one corner. */
static void corner(double x, double y, double z, double nu, double *normal, double *shear)
{
	double r = sqrt(x * x + y * y + z * z), k = 1 - 2 * nu;
	struct half h = half_terms(x, y, z, r, shear != NULL);
	struct half v = half_terms(y, x, z, r, shear != NULL);
	double a = atan2(x * y, r * z);

	normal[STRESS_XX] = -2 * nu * a + k * h.t - h.q;
	normal[STRESS_YY] = -2 * nu * a + k * v.t - v.q;
	normal[STRESS_ZZ] = -a + h.q + v.q;
	normal[STRESS_XY] = -k * log(r + z) - z / r;
	normal[STRESS_XZ] = -h.w;
	normal[STRESS_YZ] = -v.w;
	if (shear) {
		double g = z / (r * (r + z));

		shear[STRESS_XX] = 2 * h.log + k * y * g + h.w + 2 * nu * y / r;
		shear[STRESS_YY] = 2 * nu * h.log - k * y * g - 2 * nu * y / r;
		shear[STRESS_ZZ] = -h.w;
		shear[STRESS_XY] = v.log - k * x * g - 2 * nu * x / r;
		shear[STRESS_XZ] = -h.q - a;
		shear[STRESS_YZ] = -z / r;
	}
}

/* (2-7), differences in y first. */
static void difference(const double *pp, const double *pm, const double *mp,
	const double *mm, double *out)
{
	for (int c = 0; c < N; c++)
		out[c] = ((pp[c] - pm[c]) - (mp[c] - mm[c])) * (1 / (2 * M_PI));
}

void stress_patch(double a, double b, double nu, double x, double y, double z,
	double normal[STRESS_COMPONENTS], double shear[STRESS_COMPONENTS])
{
	double n[4][N], s[4][N] = { { 0 } };

	/* Logarithms of dimensionless lengths. */
	x /= a, y /= a, z /= a, b /= a;
	for (int i = 0; i < 4; i++)
		corner(x + (i < 2 ? 1 : -1), y + (i % 2 ? -b : b), z, nu, n[i],
			shear ? s[i] : NULL);
	difference(n[0], n[1], n[2], n[3], normal);
	if (shear)
		difference(s[0], s[1], s[2], s[3], shear);
}

/* Boussinesq and Cerruti (along x), per unit load and times 2 pi, in the form without 0/0
 * on the axis.  shear may be NULL. */
static void point_load(
	double x, double y, double z, double nu, double *normal, double *shear)
{
	double r = sqrt(x * x + y * y + z * z), k = 1 - 2 * nu, d = r + z;
	double ir = 1 / r, id = 1 / d, ir3 = ir * ir * ir, f = 3 * z * ir3 * ir * ir;
	double m = k * (2 * r + z) * ir3 * id * id - f; /* of x^2, y^2 and x y */
	double l = k * (z * ir3 - ir * id);

	normal[STRESS_XX] = m * x * x + l;
	normal[STRESS_YY] = m * y * y + l;
	normal[STRESS_ZZ] = -f * z * z;
	normal[STRESS_XY] = m * x * y;
	normal[STRESS_XZ] = -f * x * z;
	normal[STRESS_YZ] = -f * y * z;
	if (shear) {
		double h = k * ir * id * id;

		f = 3 * ir3 * ir * ir;
		m = k * (3 * r + z) * ir3 * id * id * id - f;
		shear[STRESS_XX] = x * (m * x * x + k * ir3 - 3 * h);
		shear[STRESS_YY] = x * (m * y * y + k * ir3 - h);
		shear[STRESS_ZZ] = -f * x * z * z;
		shear[STRESS_XY] = y * (m * x * x - h);
		shear[STRESS_XZ] = -f * x * x * z;
		shear[STRESS_YZ] = -f * x * y * z;
	}
}

void stress_point_load(double nu, double x, double y, double z,
	double normal[STRESS_COMPONENTS], double shear[STRESS_COMPONENTS])
{
	point_load(x, y, z, nu, normal, shear);
	for (int c = 0; c < N; c++) {
		normal[c] *= 1 / (2 * M_PI);
		if (shear)
			shear[c] *= 1 / (2 * M_PI);
	}
}

void stress_point(double nu, double mu, double x, double y, double z,
	double stress[STRESS_COMPONENTS])
{
	double shear[N];

	point_load(x, y, z, nu, stress, shear);
	for (int c = 0; c < N; c++)
		stress[c] = (stress[c] + mu * shear[c]) / (2 * M_PI);
}

int stress_odd(enum stress_component component, int axis)
{
	switch (component) {
	case STRESS_XY:
		return 1;
	case STRESS_XZ:
		return axis == 0;
	case STRESS_YZ:
		return axis == 1;
	default:
		return 0;
	}
}

double stress_von_mises(const double s[STRESS_COMPONENTS])
{
	double a = s[STRESS_XX] - s[STRESS_YY], b = s[STRESS_YY] - s[STRESS_ZZ];
	double c = s[STRESS_ZZ] - s[STRESS_XX];
	double t = s[STRESS_XY] * s[STRESS_XY] + s[STRESS_XZ] * s[STRESS_XZ] +
		   s[STRESS_YZ] * s[STRESS_YZ];

	return sqrt(0.5 * (a * a + b * b + c * c) + 3 * t);
}

void stress_principal(const double stress[STRESS_COMPONENTS], double principal[3])
{
	sym3_eigen(stress, principal, NULL);
}
