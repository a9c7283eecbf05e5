/* common.c - see common.h */
#include "signal/noise/common.h"
#include "signal/noise/robust.h"
#include "signal/pulse/shape.h"
#include <math.h>
#include <string.h>

/* Least correlation that is removed: standard errors fall by 2 %. */
static const double LEAST = 0.2;

/* Standard deviation of x less share times y, summed over blocks, by its fourth
 * differences; work holds 2 n. */
static double noise_of(const double *x, const double *y, double share, size_t n,
	size_t block, double *work)
{
	size_t blocks = n / block;

	memset(work, 0, blocks * sizeof *work);
	for (size_t i = 0; i < blocks * block; i++)
		work[i / block] += x[i] - share * y[i];
	return robust_noise(work, NULL, blocks, work + blocks);
}

/* What is left of the noise of x less share times y. */
static double share_left(const double *x, const double *y, double share, size_t n,
	size_t block, double *work)
{
	double left = noise_of(x, y, share, n, block, work);

	return left / noise_of(x, y, 0, n, block, work);
}

void common_measure(const double *const x[2], size_t n, double duration, double *work,
	double found[3])
{
	/* Samples of a block.  Its fourth differences extend down to the highest
	 * frequencies of a pulse, and a pulse of 30 deviations disappears in them. */
	size_t block = (size_t)fmax(duration / (2 * SHAPE_BAND), 1);
	/* By how much the shares left in the two bands may differ.  Their ratio is 1.0 to
	 * 1.1 for white noise, 1.8 for a difference of successive values and where 200
	 * pulses a second hide the noise. */
	static const double same = 1.5;
	double sum = noise_of(x[0], x[1], -1, n, 1, work);
	double difference = noise_of(x[0], x[1], 1, n, 1, work);
	double r = (sum * sum - difference * difference) /
		   (sum * sum + difference * difference);

	for (int k = 0; k < 2 && fabs(r) >= LEAST; k++) {
		const double *one = x[k], *other = x[1 - k];

		found[1 + k] = share_left(one, other, r, n, 1, work);
		if (!(found[1 + k] > 0 && found[1 + k] < 1) ||
			share_left(one, other, r, n, block, work) > same * found[1 + k])
			r = 0;
	}
	found[0] = fabs(r) >= LEAST ? r : 0;
}
