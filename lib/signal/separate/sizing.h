/* sizing.h - time, velocity and size of a particle in SI units, from its transit
 *
 * The velocity is spacing / delay; the diameter that of sensor.h for a peak voltage
 * kappa v d^3.  NAN where a number is not known.
 */
#ifndef SIGNAL_SIZING_H
#define SIGNAL_SIZING_H

#include "signal/separate/separate.h"

struct sizing {
	double time[2];   /* arrival at either sensor, s */
	double diameter;  /* m */
	double most;      /* diameter of transit.most, m */
	double amplitude; /* at sensor 1, V */
	double delay;     /* s */
	double velocity;  /* m/s */
	/* standard errors */
	double time_se[2], diameter_se, amplitude_se, delay_se, velocity_se;
};

/* rate in Hz, spacing of the sensors in m, kappa in V s/m4. */
void sizing_of(const struct transit *p, double rate, double spacing, double kappa,
	struct sizing *out);

#endif
