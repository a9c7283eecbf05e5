/* traffic.h - probabilities that pulses of particles in a pipe overlap or are confused
 *
 * Particles arrive as a Poisson process, spread over the section of the pipe in
 * proportion to the flow.  None comes nearer to the wall than 1 % of the radius.
 *
 * A pulse is isolated if no other overlaps it at its coil. Durations of pulses differ
 * with the velocity, so the probability is the mean of exp(-arrivals (T + mean T));
 * exp(-2 arrivals T) if all are equal.
 *
 * A pulse is matched correctly if no other arrives at the second coil within its search
 * window: exp(-arrivals times the width of the window).
 */
#ifndef LAYOUT_TRAFFIC_H
#define LAYOUT_TRAFFIC_H

#include "signal/pulse/sensor.h"

struct traffic {
	struct pipe pipe;
	double arrivals; /* particles per second */
	double spread;   /* transit times differ by up to this share of those of the oil,
			  * [0, 1) */
};

/* Mean over the particles of exp(-arrivals (T + mean T)), T = zone / v. */
double traffic_alone(const struct traffic *t, double zone);

/* Slowness, s/m, of particles inside whose radius this share of the flow passes, and
 * which differ from the oil by this share of the spread, -1 to 1. */
double traffic_slowness(const struct traffic *t, double share, double along);

/* Probability that no other particle arrives within a window of this width, s. */
double traffic_unique(const struct traffic *t, double width);

#endif
