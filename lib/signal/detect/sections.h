/* sections.h - sections of a two-sensor record that contain pulses
 *
 * One pass of a matched filter, on a grid of 1/24 of the pulse duration, over either
 * channel (noise of variance 1).  Wherever it exceeds the threshold there may be a pulse,
 * which reaches as far as it stands out of the noise; stretches whose pulses could
 * overlap form one section.
 */
#ifndef SIGNAL_SECTIONS_H
#define SIGNAL_SECTIONS_H

#include "num/status.h"
#include "signal/pulse/shape.h"
#include <stddef.h>

struct section {
	long long begin, end; /* samples [begin, end) that hold all of its pulses */
	int open;             /* 1: it may continue beyond end */
};

/* Shortest pulse, samples. */
enum { SECTIONS_SHORTEST = 4 };

struct sections;

/* duration: at least SECTIONS_SHORTEST; threshold: standard deviations of the matched
 * filter; slack: samples added at either side of the pulses.  NULL: no memory. */
struct sections *sections_new(
	const struct shape *shape, double duration, double threshold, double slack);
void sections_free(struct sections *s);

/* Skips the samples before upto. */
void sections_skip(struct sections *s, long long upto);

/* Samples that a scan needs at either side of a point and may add to a section. */
long sections_reach(const struct sections *s);

/* Samples on either side of a weak pulse, at least, that a section contains. */
long sections_margin(const struct sections *s);

/* Scans the channels of a record, held as y[channel][0 .. n) from sample base on, up to
 * sample limit (not included); samples outside what is held count as zero.  Each point is
 * scanned once.  Beyond the first two channels a section is where the filter exceeds the
 * threshold with either sign. */
enum num_status sections_scan(struct sections *s, const double *const y[], int channels,
	long long base, size_t n, long long limit);

/* The first section: 1 and *section, or 0 where there is none.  It stays until taken. */
int sections_first(const struct sections *s, struct section *section);
/* Samples before (side 0) and behind (1) the first section that are in no section, at
 * most as many as a pulse reaches. */
long sections_aside(const struct sections *s, int side);
/* Drops what lies before sample upto of the first section. */
void sections_take(struct sections *s, long long upto);
/* Closes the last section at the end of the record. */
void sections_end(struct sections *s);
long long sections_scanned(const struct sections *s); /* first sample not scanned yet */

#endif
