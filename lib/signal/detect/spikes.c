/* spikes.c - see spikes.h */
#include "signal/detect/spikes.h"
#include "signal/noise/robust.h"
#include "signal/noise/sigmas.h"
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

size_t spikes_find(const double *y, size_t n, double duration, unsigned char *flags)
{
	enum { MOST = 64 };
	size_t side = (size_t)fmin(SHAPE_FINEST * duration, MOST), found = 0;
	double near[2 * MOST + 1];

	memset(flags, 0, n);
	if (side == 0)
		return 0; /* impulses are not shorter than such pulses */

	for (size_t i = 0; i < n; i++) {
		/* The same number on either side, so that a slope has no effect. */
		size_t room = i < n - 1 - i ? i : n - 1 - i;
		size_t reach = room < side ? room : side;
		double middle;

		memcpy(near, y + i - reach, (2 * reach + 1) * sizeof *near);
		middle = robust_median(near, 2 * reach + 1);
		flags[i] = fabs(y[i] - middle) > SIGMAS_NEVER &&
			   fabs(y[i] - middle) >
				   SIGMAS_NEVER + CURVED * height_near(y, n, i, side);
		found += flags[i];
	}
	return found;
}
