#include "stress/criterion.h"
#include "num/sym3.h"
#include <math.h>
#include <stddef.h>

static double von_mises(const double v[STRESS_DEVIATOR])
{
	double t = v[DEV_XY] * v[DEV_XY] + v[DEV_XZ] * v[DEV_XZ] + v[DEV_YZ] * v[DEV_YZ];
	double d = v[DEV_X] * v[DEV_X] + v[DEV_Y] * v[DEV_Y] - v[DEV_X] * v[DEV_Y];

	return sqrt(d + 3 * t);
}

static double tresca(const double v[STRESS_DEVIATOR])
{
	const double m[6] = { v[DEV_X], v[DEV_Y], 0, v[DEV_XY], v[DEV_XZ], v[DEV_YZ] };
	double principal[3];

	sym3_eigen(m, principal, NULL);
	return principal[0] - principal[2];
}

/* sqrt(3/2) |deviator|, and the deviator is no longer than the tensor. */
const struct stress_criterion stress_von_mises_criterion = { "von-mises", von_mises,
	1.2247448713915890491 };
/* a - b <= sqrt(2) sqrt(a^2 + b^2). */
const struct stress_criterion stress_tresca_criterion = { "tresca", tresca,
	1.4142135623730950488 };
