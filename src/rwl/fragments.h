/* fragments.h - the fragments of --wear, read into a partition of the contact face */
#ifndef FRAGMENTS_H
#define FRAGMENTS_H

#include "cli/opt.h"
#include "life/prior/partition.h"

/* Every file is a class; see pump_options.h for the areas and for what counts as large.
 * Nominal pressure, area and sliding distance of a step are read from the tables if these
 * state them, and must not contradict the options; distance is NAN if they do not. Steps
 * before first_step are running-in.  made_by[k] becomes the pipeline that made file k,
 * fresh memory, or stays as it is.  Dies with one line naming the file. */
struct partition *fragments_read(
	const struct opt_texts *files, long first_step, char **made_by, double *distance);
/* After the last of them, once the area of a fragment is known.  1, with a warning, where
 * the uncertainty of the wear is unknown. */
int fragments_close(struct partition *p, const struct opt_texts *files);
/* Why the fragments are doubtful, by a table's own account; NULL: they are not. */
const char *fragments_doubt(void);

#endif
