/* whole_record.h - duet on a mixture: sources of the whole record, not of its sections */
#ifndef WHOLE_RECORD_H
#define WHOLE_RECORD_H

#include "outputs.h"

/* Separates up to the given number of sources (0: as many as there are).  window or hop
 * 0: the power of two of 45 to 90 ms, a quarter of the window.  1: doubtful, and a
 * warning says why. */
int whole_record(
	struct signal_in *in, struct found *out, size_t window, size_t hop, int sources);

#endif
