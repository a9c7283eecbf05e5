/* alignment.h - the delay between the channels of a record that its sections show
 *
 * Pulses pass sensor 2 after sensor 1 by the delay at which the product of both channels,
 * summed over the sections of sensor 1, is largest.  Products are of sums over as many
 * samples as the coarsest sampling that the network takes has between two, and a parabola
 * through the three largest finds the delay between two of them.
 *
 *	struct alignment *a = alignment_new(duration, 2 * align);
 *	alignment_add(a, y1, n, y2, available);
 *	delay = alignment_delay(a);
 *	alignment_free(a);
 */
#ifndef DELAYNET_ALIGNMENT_H
#define DELAYNET_ALIGNMENT_H

#include <stddef.h>

struct alignment;

/* Duration of a pulse and the longest delay that is sought, samples. */
struct alignment *alignment_new(double duration, double longest);
void alignment_free(struct alignment *a);

/* Samples of channel 2 that alignment_add() takes for a section of n, if there are as
 * many. */
size_t alignment_reach(const struct alignment *a, size_t n);

/* A section of channel 1, and channel 2 from its first sample on. */
void alignment_add(struct alignment *a, const double *y1, size_t n, const double *y2,
	size_t available);

/* Samples; nan if there were no sections, or no pulse in both channels. */
double alignment_delay(const struct alignment *a);

#endif
