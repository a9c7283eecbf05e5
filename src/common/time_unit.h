/* time_unit.h - the unit that a table counts time in: an option of aopf and rwl */
#ifndef TIME_UNIT_H
#define TIME_UNIT_H

#include "cli/opt.h"
#include "io/tables.h"

extern struct opt timeunit_rows[]; /* for OPT_TABLE */

/* Takes the unit of the column from the "# units:" line, if that names one.  Dies where
 * the option contradicts it, or, if times are needed, where it is not a unit of time. */
void timeunit_settle(const struct table_in *t, int column, int needed);

/* The unit in seconds; 1 if neither table nor option states it. */
double timeunit(void);
const char *timeunit_word(void); /* "1" then */
/* Factor that converts the times of a column of another table, or of another column, to
 * that unit.  Dies where they name a unit but the times read do not. */
double timeunit_ratio(const struct table_in *t, int column);

#endif
