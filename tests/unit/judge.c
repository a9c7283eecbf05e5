/* The velocities of a group: what tells particles from the parts of one object */
#include "signal/judge.h"
#include "num/philox.h"
#include "tap.h"
#include <math.h>

/* Pulses whose delays scatter by spread beside their standard error of 0.2 samples. */
static void draw(struct joint_pulse *p, int m, double spread, uint64_t trial)
{
	for (int i = 0; i < m; i++) {
		double z[2];

		philox_normal2(7, 0, RNG_NOISE, 4 * trial + (uint64_t)i, z);
		p[i] = (struct joint_pulse){ .t = 50.0 * i,
			.delta = spread * z[0] + 0.2 * z[1],
			.a = 1,
			.cov = { 0.02, 0, 0.02, 0, 0, 1e-4 } };
	}
}

int main(void)
{
	enum { TRIALS = 4000 };
	static const double spread[] = { 0, 0.5, 2 };

	for (int m = 2; m <= 4; m++)
		for (int k = 0; k < 3; k++) {
			struct joint_pulse p[4];
			double untold = 0, expected = 0, deviation;
			int told;

			for (int i = 0; i < TRIALS; i++) {
				draw(p, m, spread[k], (uint64_t)i);
				expected += judge_velocities(
					p, m, spread[k] * spread[k], &told);
				untold += !told;
			}
			deviation = sqrt(expected * (1 - expected / TRIALS)) + 1;
			ok(fabs(untold - expected) < 4 * deviation,
				"%d pulses, delays scatter by %g: %g of %d groups are accepted, %g expected",
				m, spread[k], untold, TRIALS, expected);
		}
	return tap_done();
}
