/* The noise that both channels have in common is measured beside pulses, and not removed
 * where it is not the same at all frequencies */
#include "signal/noise/common.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

enum { N = 32768, T = 100, SPACE = 700, LAG = 200 };

static double x[2][N], work[2 * N];

static const double *const both[] = { x[0], x[1] };

static double normal(uint64_t seed, uint64_t i)
{
	double z[2];

	philox_normal2(seed, 0, RNG_NOISE, i & ~(uint64_t)1, z);
	return z[i & 1];
}

/* Noise of variance 1 and correlation r; steep: 1: what they have in common is a
 * difference of successive values, -1: a mean of forty. */
static void make_noise(double r, int steep)
{
	double sum = 0;

	for (uint64_t i = 0; i < N; i++) {
		double common = normal(1, i + 40);

		sum += common - normal(1, i);
		if (steep > 0)
			common = (common - normal(1, i + 39)) / sqrt(2);
		else if (steep < 0)
			common = sum / sqrt(40);
		for (int c = 0; c < 2; c++)
			x[c][i] = sqrt(fabs(r)) * common * (c && r < 0 ? -1 : 1) +
				  sqrt(1 - fabs(r)) * normal(2 + (uint64_t)c, i);
	}
}

/* One period of a sine every SPACE samples, LAG later in the second channel. */
static void add_pulses(double amplitude)
{
	for (int at = SPACE; at + LAG + T < N; at += SPACE)
		for (int i = 0; i < T; i++) {
			x[0][at + i] += amplitude * sin(2 * M_PI * i / T);
			x[1][at + LAG + i] += amplitude * sin(2 * M_PI * i / T);
		}
}

/* The standard error of a correlation measured by fourth differences is at most 0.01
 * here, and 1 - r^2 is left. */
static void test_white(double r)
{
	double found[3], left = sqrt(1 - r * r);

	make_noise(r, 0);
	add_pulses(30);
	common_measure(both, N, T, work, found);
	ok(fabs(found[0] - r) < 0.03 && fabs(found[1] / left - 1) < 0.04 &&
			fabs(found[2] / left - 1) < 0.04,
		"correlation %g beside pulses of 30 deviations: %.3f, and %.3f and %.3f are left",
		r, found[0], found[1], found[2]);
}

static void test_unlike(void)
{
	double found[3];

	make_noise(0, 0);
	common_measure(both, N, T, work, found);
	ok(found[0] == 0, "independent noise is kept");
	make_noise(0.1, 0);
	common_measure(both, N, T, work, found);
	ok(found[0] == 0, "a correlation of 0.1 is kept");
	make_noise(0.8, 1);
	common_measure(both, N, T, work, found);
	ok(found[0] == 0, "noise that is common above the band of the pulses is kept");
	make_noise(0.8, -1);
	common_measure(both, N, T, work, found);
	ok(found[0] == 0, "noise that is common at low frequencies is kept");
	make_noise(0, 0);
	for (int i = 0; i < N; i++)
		x[1][i] = x[0][i];
	common_measure(both, N, T, work, found);
	ok(found[0] == 0, "channels that are the same leave no noise to fit by");
}

int main(void)
{
	test_white(0.9);
	test_white(0.5);
	test_white(-0.7);
	test_unlike();
	return tap_done();
}
