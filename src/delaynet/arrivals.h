/* arrivals.h - a network applied to the sections of a record of two sensors */
#ifndef ARRIVALS_H
#define ARRIVALS_H

#include "cli/opt.h"

extern struct opt arrivals_rows[]; /* for OPT_TABLE: the sections and the instrument */

/* Dies where an option that the record needs is missing. */
void arrivals_check(void);
/* Writes a table of the pulses that the network finds in the sections of this record.  1
 * if a section did not suit the network, or the record or the sections are doubtful. */
int arrivals_apply(const char *network, const char *record);

#endif
