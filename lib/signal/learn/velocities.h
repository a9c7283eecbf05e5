/* velocities.h - the instrument where particles differ much in velocity
 *
 * The pulses of one particle share its velocity: the time from sensor to sensor is a
 * constant multiple of their duration, whatever the velocity.  That multiple, unlike the
 * time itself, shows even where velocities differ by several times, as in laminar flow.
 */
#ifndef SIGNAL_VELOCITIES_H
#define SIGNAL_VELOCITIES_H

#include "num/status.h"
#include "signal/learn/marks.h"

struct velocities {
	int opposite; /* 1: sensor 2 seems to reverse the pulses; all else is then 0 */
	double ratio; /* of transit time and duration; 0: not found */
	/* Durations of the pulses, as sine pulses, samples: of the fastest and of the
	 * slowest particle, and those between which four fifths are. */
	double fastest, slowest, fast, slow;
};

/* From the clearest pulses of both channels of n samples.  NUM_MEMORY. */
enum num_status velocities_find(const struct marks m[2], size_t n, struct velocities *v);

#endif
