#include "stress/criterion.h"
#include "num/lanes.h"
#include "num/sym3.h"
#include <math.h>
#include <stddef.h>

static double von_mises(const double v[STRESS_DEVIATOR])
{
	double t = v[DEV_XY] * v[DEV_XY] + v[DEV_XZ] * v[DEV_XZ] + v[DEV_YZ] * v[DEV_YZ];
	double d = v[DEV_X] * v[DEV_X] + v[DEV_Y] * v[DEV_Y] - v[DEV_X] * v[DEV_Y];

	return sqrt(d + 3 * t);
}

/* The same in the same order, two at a time. */
static void von_mises_row(
	const double *const number[STRESS_DEVIATOR], int count, double *value)
{
	for (int i = 0; i < count; i += 2) {
		int n = i + 1 < count ? 2 : 1;
		lanes x = lanes_load(number[DEV_X] + i, n),
		      y = lanes_load(number[DEV_Y] + i, n),
		      xy = lanes_load(number[DEV_XY] + i, n),
		      xz = lanes_load(number[DEV_XZ] + i, n),
		      yz = lanes_load(number[DEV_YZ] + i, n);
		lanes t = xy * xy + xz * xz + yz * yz, d = x * x + y * y - x * y;
		lanes square = d + 3 * t;

		lanes_store(value + i, (lanes){ sqrt(square[0]), sqrt(square[1]) }, n);
	}
}

static double tresca(const double v[STRESS_DEVIATOR])
{
	const double m[6] = { v[DEV_X], v[DEV_Y], 0, v[DEV_XY], v[DEV_XZ], v[DEV_YZ] };
	double principal[3];

	sym3_eigen(m, principal, NULL);
	return principal[0] - principal[2];
}

static void tresca_row(
	const double *const number[STRESS_DEVIATOR], int count, double *value)
{
	for (int i = 0; i < count; i++) {
		double v[STRESS_DEVIATOR];

		for (int c = 0; c < STRESS_DEVIATOR; c++)
			v[c] = number[c][i];
		value[i] = tresca(v);
	}
}

/* sqrt(3/2) |deviator|, and the deviator is no longer than the tensor. */
const struct stress_criterion stress_von_mises_criterion = { "von-mises", von_mises,
	von_mises_row, 1.2247448713915890491 };
/* a - b <= sqrt(2) sqrt(a^2 + b^2). */
const struct stress_criterion stress_tresca_criterion = { "tresca", tresca, tresca_row,
	1.4142135623730950488 };
