/* Statistics after the matched filter: of noise, of what both channels share, of pulses
 * of any duration */
#include "signal/learn/matched.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

enum { N = 40000 };

static double x1[N], x2[N], work[N];

/* Two channels of noise of unit variance, of which this part is common. */
static void make_noise(double common)
{
	for (uint64_t i = 0; i < N; i++) {
		double z[2], both[2];

		philox_normal2(1, 0, RNG_NOISE, i, z);
		philox_normal2(1, 1, RNG_NOISE, i, both);
		x1[i] = sqrt(1 - common) * z[0] + sqrt(common) * both[0];
		x2[i] = sqrt(1 - common) * z[1] + sqrt(common) * both[0];
	}
}

/* A median of N / T independent deviates has a relative error of some 0.8 sqrt(T / N).
 * The quietest tenth of the record is some N / (20 T) blocks of two durations: its level
 * is low, since it was chosen, as is a correlation there, which has an error of some
 * sqrt(5 T / N).
 */
static void test_duration(double duration)
{
	struct calibration c = { .shape = shape_new(PULSE_SINE), .duration = duration };
	double noise, coherence, level, error = sqrt(5 * duration / N);
	enum num_status status;

	make_noise(0);
	status = matched_noise(&c, x1, N, work, &noise);
	ok(status == NUM_OK && fabs(noise - 1) < 4 * 0.8 * sqrt(duration / N),
		"white noise of 1 after pulses of %g samples is %.3f", duration, noise);
	status = matched_coherence(&c, x1, x2, N, work, &coherence, &level);
	ok(status == NUM_OK && fabs(coherence) < 4 * error && level > 0.2 && level < 1,
		"the channels are not coherent (%.3f, level %.2f)", coherence, level);
	make_noise(0.8);
	status = matched_coherence(&c, x1, x2, N, work, &coherence, &level);
	ok(status == NUM_OK && coherence > 0.5 * 0.8 - error && coherence < 0.8,
		"the part that is common to them is found (%.3f)", coherence);
	shape_free(c.shape);
}

int main(void)
{
	static const double duration[] = { 3, 7.5, 8, 15.9, 40, 300 };

	for (int i = 0; i < 6; i++)
		test_duration(duration[i]);
	return tap_done();
}
