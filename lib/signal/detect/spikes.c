/* spikes.c - see spikes.h */
#include "signal/detect/spikes.h"
#include "num/robust.h"
#include "num/sigmas.h"
#include "signal/pulse/shape.h"
#include <math.h>
#include <string.h>

/* The median of SHAPE_FINEST on either side of a sample is compared with it: an impulse
 * is shorter.  The curvature of a sine changes that median by (2 pi / 20)^2 / 8 of its
 * height; four times this is allowed, for other pulses. */
static const double CURVED = 0.05;

/* Largest of some values within a quarter of a duration of sample i, except those next to
 * it: the height of pulses there. */
static double height_near(const double *y, size_t n, size_t i, size_t side)
{
	enum { STEPS = 5 };
	double height = 0;

	for (size_t k = side + 1; k <= STEPS * side; k += side) {
		if (i >= k)
			height = fmax(height, fabs(y[i - k]));
		if (i + k < n)
			height = fmax(height, fabs(y[i + k]));
	}
	return height;
}

/* 1 if y[i] differs by more than far from the median of as many samples on either side,
 * so that a slope has no effect. */
static int stands_out(const double *y, size_t n, size_t i, size_t side, double far)
{
	size_t room = i < n - 1 - i ? i : n - 1 - i;
	size_t reach = room < side ? room : side;
	const double *near = y + i - reach;

	return robust_median_at_most(near, 2 * reach + 1, y[i] - far) ||
	       !robust_median_at_most(near, 2 * reach + 1, y[i] + far);
}

size_t spikes_find(const double *y, size_t n, double duration, unsigned char *flags)
{
	enum { MOST = 64 };
	size_t side = (size_t)fmin(SHAPE_FINEST * duration, MOST), found = 0;

	memset(flags, 0, n);
	if (side == 0)
		return 0; /* impulses are not shorter than such pulses */

	for (size_t i = 0; i < n; i++) {
		flags[i] = stands_out(y, n, i, side, SIGMAS_NEVER) &&
			   stands_out(y, n, i, side,
				   SIGMAS_NEVER + CURVED * height_near(y, n, i, side));
		found += flags[i];
	}
	return found;
}
