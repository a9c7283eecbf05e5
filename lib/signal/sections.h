/* sections.h - stretches of a two-sensor record where pulses are
 *
 * One pass of a matched filter, on a grid of 1/24 of the pulse duration, over either
 * channel (noise of variance 1).  Wherever it exceeds the threshold a pulse may be, which
 * reaches as far as it can be told from the noise; stretches whose pulses could overlap
 * are one section.
 */
#ifndef SIGNAL_SECTIONS_H
#define SIGNAL_SECTIONS_H

#include "signal/shape.h"
#include <stddef.h>

struct section {
	long long begin, end; /* samples [begin, end) that hold all of its pulses */
	int open;             /* 1: it still goes on beyond end */
};

/* Samples that a pulse has to last. */
enum { SECTIONS_SHORTEST = 4 };

struct sections;

/* threshold in standard deviations of the matched filter; slack in samples is kept on
 * either side besides what the pulses need.  NULL: no memory, or duration too short. */
struct sections *sections_new(
	const struct shape *shape, double duration, double threshold, double slack);
void sections_free(struct sections *s);

/* Leaves out the samples before this one. */
void sections_skip(struct sections *s, long long upto);

/* Samples a scan needs on either side of a point, and may yet put into a section. */
long sections_reach(const struct sections *s);

/* Scans the record, held as y1, y2[0 .. n) from sample base on, up to sample limit (not
 * included); samples outside what is held count as zero.  Each point is scanned once.
 * Returns 0 when out of memory. */
int sections_scan(struct sections *s, const double *y1, const double *y2, long long base,
	size_t n, long long limit);

/* The first section: 1 and *section, or 0 where there is none.  It stays until taken. */
int sections_first(const struct sections *s, struct section *section);
/* Drops what lies before sample upto of the first section. */
void sections_take(struct sections *s, long long upto);
/* No trigger is to come: the last section is closed. */
void sections_end(struct sections *s);
long long sections_scanned(const struct sections *s); /* first sample not scanned yet */

#endif
