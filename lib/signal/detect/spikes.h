/* spikes.h - impulses: samples that differ from their neighbours by more than pulses
 * and noise do
 */
#ifndef SIGNAL_SPIKES_H
#define SIGNAL_SPIKES_H

#include <stddef.h>

/* Sets flags[0 .. n) of y, noise of variance 1 and pulses of this duration, in samples:
 * 1 for an impulse.  Returns how many there are. */
size_t spikes_find(const double *y, size_t n, double duration, unsigned char *flags);

#endif
