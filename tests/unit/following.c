/* Noise that changes is followed; noise that does not is left alone */
#include "signal/noise/following.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

enum { BLOCK = 2048, BLOCKS = 2000 };

static double x[BLOCK];

/* Block k, with noise of this size, rounded to steps. */
static void draw(uint64_t seed, int k, double size, double step)
{
	double z[2];

	for (uint64_t i = 0; i < BLOCK; i++) {
		philox_normal2(seed, 0, RNG_NOISE, (uint64_t)k * BLOCK + i, z);
		x[i] = size * z[0];
		if (step > 0)
			x[i] = step * round(x[i] / step);
	}
}

static double size_of(double from, double to, int k)
{
	return from + (to - from) * k / BLOCKS;
}

int main(void)
{
	static struct following f;
	double sum = 0, square = 0, worst = 0;

	for (int k = 0; k < BLOCKS; k++) {
		double m;

		draw(1, k, 3, 0);
		m = following_measure(x, NULL, BLOCK) / 3;
		sum += m;
		square += m * m;
	}
	sum /= BLOCKS;
	square = sqrt(square / BLOCKS - sum * sum) * sqrt(BLOCK);
	/* 2000 blocks: 1.6 % of the standard error. */
	near(sum, 1, 4 * 1.46 / sqrt((double)BLOCK * BLOCKS),
		"noise is measured without bias");
	near(square, 1.46, 0.08,
		"the standard error of the noise is 1.46 over the root of the samples");

	for (int step = 0; step < 3; step++) {
		double first = 0, second = 0, reference = 0;
		int changes = 0;

		for (int k = 15; k >= 0; k--) {
			draw(2, k, 1, step);
			second = first;
			first = following_measure(x, NULL, BLOCK);
			reference += first / 16;
		}
		following_start(&f, 0, BLOCK, reference, first, second);
		for (int k = 0; k < BLOCKS; k++) {
			double before = following_at(&f, (double)k * BLOCK);

			draw(2, k, 1, step);
			following_take(&f, x, NULL);
			changes += following_at(&f, (double)(k + 1) * BLOCK) != before;
		}
		ok(changes <= 3,
			"constant noise in steps of %d changes at most 3 times in %d blocks (%d)",
			step, (int)BLOCKS, changes);
	}

	for (int way = 0; way < 2; way++) {
		double from = way ? 4 : 1, to = way ? 1 : 4, rms = 0;

		worst = 0;
		following_start(&f, 0, BLOCK, 1, from, from);
		for (int k = 0; k < BLOCKS; k++) {
			double now;

			draw(3, k, size_of(from, to, k), 0);
			following_take(&f, x, NULL);
			now = following_at(&f, (k + 0.5) * BLOCK) / size_of(from, to, k) -
			      1;
			worst = fmax(worst, fabs(now));
			rms += now * now / BLOCKS;
		}
		ok(worst < 0.2 && sqrt(rms) < 0.06,
			"noise that goes from %g to %g is followed (worst %.3f, rms %.3f)",
			from, to, worst, sqrt(rms));
	}
	return tap_done();
}
