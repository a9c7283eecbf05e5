/* channels.h - what the samples of each channel look like, as a table
 *
 * low, high, mean of the samples that are numbers; level, the lower decile over stretches
 * of 256 frames of their standard deviation, which is nearly that of the noise (6 % less
 * where it is white) as long as a few of them are free of pulses; rails, the samples in
 * runs of at least four that equal low or high, as a converter leaves them that is driven
 * beyond its range; missing, the samples that are not finite.
 */
#ifndef CHANNELS_H
#define CHANNELS_H

#include "io/signals.h"
#include <stddef.h>

struct channels;

struct channels *channels_new(const struct signal_format *format);
void channels_add(struct channels *c, const double *x, size_t frames);
/* Writes the table to standard output; frees.  doubt: of the samples, or NULL. */
void channels_done(struct channels *c, const char *doubt);

#endif
