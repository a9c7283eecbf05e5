/* sizing.c - see sizing.h */
#include "signal/separate/sizing.h"
#include "signal/pulse/sensor.h"
#include <math.h>

void sizing_of(const struct transit *p, double rate, double spacing, double kappa,
	struct sizing *out)
{
	double delay = (p->t2 - p->t1) / rate, delay_se = p->delay_se / rate;
	double velocity = delay > 0 ? spacing / delay : NAN;
	double ra = p->amplitude_se / fabs(p->amplitude), rt = delay_se / delay;
	double d = sensor_diameter(kappa, velocity, fabs(p->amplitude));

	if (verdict_is_foreign(p->verdict))
		d = NAN;

	*out = (struct sizing){ .time = { p->t1 / rate, p->t2 / rate },
		.diameter = d,
		.most = sensor_diameter(kappa, velocity, p->most),
		.amplitude = p->amplitude,
		.delay = delay,
		.velocity = velocity,
		.time_se = { p->t1_se / rate, p->t2_se / rate },
		.diameter_se = sensor_diameter_error(d, ra, rt, p->correlation),
		.amplitude_se = p->amplitude_se,
		.delay_se = delay_se,
		.velocity_se = velocity * rt };
}
