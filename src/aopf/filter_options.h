/* filter_options.h - how a series is filtered: options of aopf */
#ifndef FILTER_OPTIONS_H
#define FILTER_OPTIONS_H

#include "cli/opt.h"
#include "life/particle/adaptive.h"

/* Values of the options. */
extern struct filtering {
	long particles, seed;
} filtering;

extern struct opt filtering_rows[]; /* for OPT_TABLE; not that of the seed */

/* The filter of a unit. */
struct adaptive *filtering_new(int unit);
/* Counts the work it did. */
void filtering_count(const struct adaptive *a);

#endif
