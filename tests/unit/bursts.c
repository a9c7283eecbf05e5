/* A pulse, an impulse or a bubble stands out of noise; noise, lines and drift do not */
#include "signal/detect/bursts.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

enum { N = 40000, SEEDS = 20 };

static double x[N], work[N];

/* Standard normal noise, passed through a one-pole low-pass with this time constant in
 * samples, 0: white, and brought back to unit variance. */
static void make_noise(uint64_t seed, double constant)
{
	double keep = constant > 0 ? exp(-1 / constant) : 0, last = 0;

	for (uint64_t i = 0; i < N; i += 2) {
		double z[2];

		philox_normal2(seed, 0, RNG_NOISE, i, z);
		for (uint64_t k = 0; k < 2; k++)
			x[i + k] = last = keep * last + sqrt(1 - keep * keep) * z[k];
	}
}

static void add_pulse(double at, double duration, double amplitude)
{
	for (int i = 0; i < N; i++)
		if (fabs(i - at) < duration / 2)
			x[i] += amplitude * sin(2 * M_PI * (i - at) / duration);
}

static int found(void)
{
	return bursts_found(x, N, N, work);
}

static void test_noise(void)
{
	int white = 0, coloured = 0, slow = 0, stepped = 0;

	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		make_noise(seed, 0);
		white += found();
		for (int i = 0; i < N; i++)
			x[i] = rint(2 * x[i]); /* a coarse converter */
		stepped += found();
		make_noise(seed, 10);
		coloured += found();
		make_noise(seed, 1000);
		slow += found();
	}
	ok(white == 0, "white noise has no bursts (%d of %d records)", white, SEEDS);
	ok(stepped == 0, "noise of a coarse converter has no bursts (%d)", stepped);
	ok(coloured == 0, "coloured noise has no bursts (%d)", coloured);
	ok(slow == 0, "noise that wanders has no bursts (%d)", slow);
}

static void test_slow_changes(void)
{
	make_noise(1, 0);
	for (int i = 0; i < N; i++)
		x[i] = x[i] * (1 + i / (double)N) + 30 * sin(2 * M_PI * i / N) +
		       5 * sin(2 * M_PI * 0.005 * i);
	ok(!found(), "a line, a drift and a rise of the noise are no bursts");
}

static void test_pulses(void)
{
	static const double duration[] = { 20, 100, 500 };
	int small = 0;

	for (int k = 0; k < 3; k++) {
		/* Amplitude for the same energy, 20^2 in units of the noise */
		double amplitude = 20 / sqrt(duration[k] / 2);

		make_noise(1, 0);
		add_pulse(12345, duration[k], amplitude);
		ok(found(),
			"one pulse of %g samples, 20 standard deviations of its matched filter",
			duration[k]);
		make_noise(1, 0);
		add_pulse(12345, duration[k], 0.2 * amplitude);
		small += found();
	}
	ok(small == 0, "pulses of four standard deviations are not bursts (%d)", small);
	make_noise(1, 0);
	x[N / 2] += 40;
	ok(found(), "an impulse of one sample is a burst");
	ok(bursts_found(x, N, 4, work),
		"an impulse of one sample is a burst in means of four samples");
	make_noise(1, 0);
	add_pulse(N / 2, 500, 40);
	ok(found(), "a pulse of 500 samples is a burst");
	ok(!bursts_found(x, N, 8, work),
		"a pulse of 500 samples is no burst in means of eight samples");
	make_noise(1, 0);
	x[3] += 45;
	x[N - 3] += 45;
	ok(found(), "impulses at the ends are bursts");
}

static void test_silence(void)
{
	for (int i = 0; i < N; i++)
		x[i] = 1;
	ok(!found(), "a constant has no bursts");
	ok(!bursts_found(x, 8, 8, work), "a record that is too short has no bursts");
}

static struct bursts_power power_of(uint64_t seed, double constant, double scale)
{
	struct bursts_power power;

	make_noise(seed, constant);
	for (int i = 0; i < N; i++)
		x[i] *= scale;
	bursts_measure(x, N, work, &power);
	return power;
}

/* Ten thousand differences of the finest octave tell a level to 1.4 %. */
static void test_alike(void)
{
	int white = 0, coloured = 0, louder = 0, other = 0, crowd = 0, slow = 0;

	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		struct bursts_power a = power_of(seed, 0, 1), b = power_of(seed, 10, 1),
				    c;

		c = power_of(seed + SEEDS, 0, 1);
		white += bursts_alike(&a, &c);
		c = power_of(seed + SEEDS, 0, 1.1);
		louder += bursts_alike(&a, &c);
		other += bursts_alike(&a, &b);
		c = power_of(seed + SEEDS, 10, 1);
		coloured += bursts_alike(&b, &c);
		/* pulses of four standard deviations, of which none is a burst */
		make_noise(seed + SEEDS, 0);
		for (int i = 0; i < 200; i++)
			add_pulse(100 + 199.3 * i, 100, 4 / sqrt(50.));
		bursts_measure(x, N, work, &c);
		crowd += bursts_alike(&a, &c);
		make_noise(seed + SEEDS, 0);
		add_pulse(0.5 * N, 6000, 4);
		bursts_measure(x, N, work, &c);
		slow += bursts_alike(&a, &c);
	}
	ok(white == SEEDS, "white noise is like white noise (%d of %d)", white, SEEDS);
	ok(coloured == SEEDS, "coloured noise is like that of its colour (%d)", coloured);
	ok(louder == 0, "noise a tenth louder is not like that of its colour (%d)",
		louder);
	ok(other == 0, "noise of another colour is not like it (%d)", other);
	ok(crowd == 0, "many weak pulses are not like noise (%d)", crowd);
	ok(slow == 0, "a pulse that is too long for a burst is not like noise (%d)",
		slow);
}

int main(void)
{
	test_noise();
	test_slow_changes();
	test_pulses();
	test_silence();
	test_alike();
	return tap_done();
}
