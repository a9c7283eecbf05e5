/* bubbles.h - pulses of one sign among those of particles
 *
 * They follow each other in the channels as particles do.  Many of them spoil what is
 * learned first, the transit time and the duration of the pulses.  Particles that overlap
 * look like them, too, but are described by a few pulses of the shape that those of the
 * record have, in both channels; a bubble is not, as these have two lobes.
 */
#ifndef SIGNAL_BUBBLES_H
#define SIGNAL_BUBBLES_H

#include "signal/learn/marks.h"
#include "signal/learn/velocities.h"

/* Subtracts from seen the bubbles of y, both two channels of n samples one behind the
 * other.  Particles, with pulses m, have velocities v; bubbles last longer than most of
 * them by this factor at least.  work holds 2 n values.  NUM_MEMORY. */
enum num_status bubbles_remove(const struct velocities *v, double factor,
	const struct marks m[2], const double *y, size_t n, double *work, double *seen);

#endif
