/* fragments.h - the fragments of --wear, read into a partition of the contact face */
#ifndef FRAGMENTS_H
#define FRAGMENTS_H

#include "cli/opt.h"
#include "life/partition.h"

/* Every file is a class; see pump_options.h for the areas and for what counts as large.
 * Steps before first_step are running-in.  made_by[k] becomes the pipeline that made file
 * k, fresh memory, or stays as it is.  doubtful becomes 1, with a warning, where the
 * uncertainty of the wear is unknown.  Dies with one line naming the file. */
struct partition *fragments_read(
	const struct opt_texts *files, long first_step, char **made_by, int *doubtful);

#endif
