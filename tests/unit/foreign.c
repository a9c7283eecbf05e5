/* Shocks, bubbles, impulses and transients are named; particles never are */
#include "signal/detect/foreign.h"
#include "num/philox.h"
#include "signal/pulse/shape.h"
#include "tap.h"
#include <math.h>
#include <string.h>

enum { N = 600, SHIFT = 196 };
static const double T = 100;

static double x[2][N];

static void add_noise(uint64_t seed)
{
	double z[2];

	for (uint64_t i = 0; i < N; i++) {
		philox_normal2(seed, 0, RNG_NOISE, i, z);
		x[0][i] = z[0];
		x[1][i] = z[1];
	}
}

static double uniform(uint64_t seed, uint64_t k)
{
	return philox_uniform(seed, 1, RNG_NOISE, k);
}

/* Decays with T / 2 from time t on, which is SHIFT samples earlier in the second channel.
 */
static void add_shock(double t, double level1, double level2, double period)
{
	for (int c = 0; c < 2; c++)
		for (int i = 0; i < N; i++) {
			double s = i - t + (c ? SHIFT : 0);

			if (s > 0)
				x[c][i] += (c ? level2 : level1) * exp(-2 * s / T) *
					   sin(2 * M_PI * s / period);
		}
}

static void add_lobe(double t, double delay, double level, double length)
{
	for (int c = 0; c < 2; c++)
		for (int i = 0; i < N; i++) {
			double s = (i - t - (c ? delay : 0)) / length;

			if (fabs(s) < 0.5)
				x[c][i] += level * (0.5 + 0.5 * cos(2 * M_PI * s));
		}
}

static void add_particle(const struct shape *p, double t, double delay, double level)
{
	static double value[N];

	for (int c = 0; c < 2; c++) {
		shape_sample(p, t + (c ? delay : 0), T, 0, N, value, NULL, NULL);
		for (int i = 0; i < N; i++)
			x[c][i] += level * value[i];
	}
}

static struct foreign find(void)
{
	const struct foreign_stretch s = {
		.y = { x[0], x[1] }, .n = N, .shift = SHIFT, .duration = T
	};
	struct foreign found = { .verdict = SEPARATE_ALONE };

	foreign_find(&s, -20, 20, &found);
	return found;
}

int main(void)
{
	struct shape *p = shape_new(PULSE_SINE);
	struct foreign f;
	int right = 0, named = 0, reversed = 0;
	double worst = 0, place = 0;

	for (uint64_t k = 0; k < 200; k++) {
		double level = 20 + 200 * uniform(k, 0),
		       other = level * (0.3 + uniform(k, 1));

		add_noise(k);
		add_shock(SHIFT + 5, level, uniform(k, 3) < 0.5 ? other : -other,
			30 + 100 * uniform(k, 2));
		f = find();
		right += f.verdict == SEPARATE_SHOCK && f.t[0] - SHIFT == f.t[1];
	}
	ok(right == 200, "200 of 200 shocks are named (%d)", right);

	right = 0;
	for (uint64_t k = 0; k < 200; k++) {
		double level = 20 + 200 * uniform(k, 0), delay = 30 * uniform(k, 1) - 15;
		double length = T * (1.5 + 1.5 * uniform(k, 2));

		if (k % 2)
			level = -level;
		add_noise(k);
		add_lobe(300, delay, level, length);
		f = find();
		right += f.verdict == SEPARATE_BUBBLE && f.amplitude * level > 0;
		worst = fmax(worst, fabs(f.t[1] - f.t[0] - delay) * fabs(level));
		place = fmax(place, fabs(f.t[0] - 300));
	}
	ok(right == 200, "200 of 200 bubbles are named, with their sign (%d)", right);
	/* The slope has the energy pi^2 A^2 / (4 L): the delay's standard deviation is at
	 * most sqrt(2 * 4 * 300 / pi^2) = 16 samples over the level, and an eighth of a
	 * sample is searched. */
	ok(worst < 4 * 16 + 220. / 16, "the delay of bubbles is right (%.3g)", worst);
	ok(place < 5, "the middle of bubbles is right (%.3g samples)", place);

	right = 0;
	for (uint64_t k = 0; k < 100; k++) {
		int c = k % 2;

		add_noise(k);
		for (int i = 250; i < N; i++)
			x[c][i] += 30 * exp((250 - i) / T);
		f = find();
		right += f.verdict == SEPARATE_TRANSIENT && isnan(f.t[!c]) &&
			 fabs(f.t[c] - 250) < 20;
	}
	ok(right == 100, "100 of 100 events at one sensor are named (%d)", right);

	right = 0;
	for (uint64_t k = 0; k < 100; k++) {
		add_noise(k);
		x[k % 2][300] += 100;
		f = find();
		right += f.verdict == SEPARATE_IMPULSE && f.t[k % 2] == 300 &&
			 isnan(f.t[!(k % 2)]);
	}
	ok(right == 100, "100 of 100 impulses at one sensor are named (%d)", right);

	for (uint64_t k = 0; k < 500; k++) {
		int many = 1 + (int)(4 * uniform(k, 90));
		double sign = k % 3 == 0 ? -1 : 1;

		add_noise(k);
		for (int i = 0; i < many; i++)
			add_particle(p, 120 + 360 * uniform(k, 10 + (uint64_t)i),
				k % 2 ? 0 : 30 * uniform(k, 20 + (uint64_t)i) - 15,
				sign * (5 + 300 * pow(uniform(k, 30 + (uint64_t)i), 3)));
		f = find();
		if (f.verdict != SEPARATE_MISFIT) {
			named++;
			reversed += sign < 0;
		}
	}
	ok(named == 0,
		"none of 500 groups of 1 to 4 particles is another event (%d, %d of them reversed)",
		named, reversed);

	named = 0;
	for (uint64_t k = 0; k < 200; k++) {
		add_noise(k);
		add_lobe(300, 0, 100, 2 * T);
		/* A pulse of 25 is as steep as the lobe; from 45 on it leaves more than
		 * noise. */
		add_particle(p, 200 + 200 * uniform(k, 1), 0, 45 + 50 * uniform(k, 2));
		named += find().verdict != SEPARATE_MISFIT;
	}
	ok(named == 0,
		"no particle that is steeper than a bubble is taken for a part of it (%d)",
		named);

	named = 0;
	for (uint64_t k = 0; k < 500; k++) {
		add_noise(1000 + k);
		named += find().verdict != SEPARATE_MISFIT;
	}
	ok(named == 0, "noise is no event (%d)", named);
	shape_free(p);
	return tap_done();
}
