/* time_unit.h - the unit that a table counts time in: an option of aopf and rwl */
#ifndef TIMEUNIT_H
#define TIMEUNIT_H

#include "cli/opt.h"

extern struct opt timeunit_rows[]; /* for OPT_TABLE */

/* In seconds; 1 if it was not given. */
double timeunit(void);

#endif
