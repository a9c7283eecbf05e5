/* demix - separation of two overlapping pulses, in decibels
 *
 * Scale-invariant ratio of signal to distortion (SI-SDR: Le Roux et al., ICASSP 2019) of
 * each of two pulses, 0.5 to 1.5 V at 30 dB, on sensor 1: of the record as it is, of the
 * masks of the thesis, and of the joint fit, by the time between the pulses in samples
 * (they last 100).  Median over the scenes.  BSS-eval would allow any filter of 512 taps
 * as no distortion, longer than the pulses themselves. */
#include "num/philox.h"
#include "num/robust.h"
#include "signal/fit/joint.h"
#include "signal/mixture/masks.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 512, SCENES = 60 };

static double sum(const double *x, const double *y)
{
	double s = 0;

	for (int i = 0; i < N; i++)
		s += x[i] * y[i];
	return s;
}

/* Silence counts as -60 dB, a perfect copy as 100. */
static double si_sdr(const double *truth, const double *estimate)
{
	double a = sum(truth, estimate) / sum(truth, truth),
	       target = a * a * sum(truth, truth);
	double rest = sum(estimate, estimate) - target;

	if (target <= 0)
		return -60;
	return rest <= 0 ? 100 : fmin(fmax(10 * log10(target / rest), -60), 100);
}

/* Mean of the two sources over the better way to pair them with the estimates. */
static double best_pair(double truth[2][N], double estimate[2][N])
{
	double straight = si_sdr(truth[0], estimate[0]) + si_sdr(truth[1], estimate[1]);
	double crossed = si_sdr(truth[0], estimate[1]) + si_sdr(truth[1], estimate[0]);

	return fmax(straight, crossed) / 2;
}

static void bench(const struct joint_scene *s, struct joint *joint, struct masks *masks,
	double apart)
{
	static double truth[2][N], part[2][N], y[2][N];
	double mixed[SCENES], masked[SCENES], fitted[SCENES];

	for (unsigned k = 0; k < SCENES; k++) {
		struct masks_source source[MASKS_SOURCES_MAX];
		struct joint_pulse found[8];
		struct joint_result result;
		double z[2];
		int m = 0, n;

		memset(truth, 0, sizeof truth);
		memset(y, 0, sizeof y);
		for (unsigned i = 0; i < 2; i++) {
			struct joint_pulse p = {
				.t = 180 + apart * i +
				     philox_uniform(1, k, RNG_PARTICLE, 3 * i),
				.delta = 2 + 3 * philox_uniform(
							 1, k, RNG_PARTICLE, 3 * i + 1),
				.a = 31.62 *
				     (0.5 + philox_uniform(1, k, RNG_PARTICLE, 3 * i + 2))
			};

			joint_add(s, &p, 1, truth[i], NULL, N);
			joint_add(s, &p, 1, y[0], y[1], N);
		}
		for (unsigned i = 0; i < N; i++) {
			philox_normal2(1, k, RNG_NOISE, i, z);
			y[0][i] += z[0];
			y[1][i] += z[1];
		}
		memcpy(part[0], y[0], sizeof part[0]);
		memcpy(part[1], y[0], sizeof part[1]);
		mixed[k] = best_pair(truth, part);
		if (masks_find(masks, y[0], y[1], N, source, &n) != NUM_OK)
			n = 0;
		for (int i = 0; i < 2; i++)
			if (i < n)
				masks_separate(masks, i, part[i]);
			else
				memcpy(part[i], y[0], sizeof part[i]);
		masked[k] = best_pair(truth, part);
		joint_fit(joint, s, y[0], y[1], N, found, &m, &result);
		memset(part, 0, sizeof part);
		for (int i = 0; i < 2 && i < m; i++)
			joint_add(s, &found[i], 1, part[i], NULL, N);
		fitted[k] = best_pair(truth, part);
	}
	printf("%g\t%.1f\t%.1f\t%.1f\n", apart, robust_median(mixed, SCENES),
		robust_median(masked, SCENES), robust_median(fitted, SCENES));
}

int main(void)
{
	struct shape *shape = shape_new(PULSE_SINE);
	struct joint *joint = joint_new();
	struct joint_scene s = { .shape = shape,
		.duration = 100,
		.transit = 196.35,
		.gain = 0.909,
		.width = 1,
		.delta_min = 0,
		.delta_max = 7,
		.threshold = 33,
		.threshold_near = 23,
		.max_pulses = 8,
		.tone_variance = INFINITY };
	struct masks_par par = { .window = 64,
		.hop = 32,
		.duration = 100,
		.delta_min = -2,
		.delta_max = 10,
		.gain_max = 2,
		.peak_share = 0.3,
		.shape = shape };
	struct masks *masks = masks_new(&par);

	puts("apart\trecord\tmasks\tfit");
	for (double apart = 10; apart < 250; apart *= 1.5)
		bench(&s, joint, masks, apart);
	masks_free(masks);
	joint_free(joint);
	shape_free(shape);
	return 0;
}
