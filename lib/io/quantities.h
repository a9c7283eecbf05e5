/* quantities.h - numbers with units in the comment lines of tables */
#ifndef IO_QUANTITIES_H
#define IO_QUANTITIES_H

#include "cli/unit.h"
#include "io/tables.h"

/* Value of the latest "# key: 6.25e-10 m2" line, in SI; NAN if there is none.  Dies where
 * it is something else than a number of this unit. */
double table_quantity(const struct table_in *t, const char *key, enum unit unit);

/* What one of the numbers of a column is in SI, by the "# units:" line; NAN if that line
 * has no unit for the column, or 1.  Dies where it is not a unit of this kind. */
double table_scale(const struct table_in *t, int column, enum unit unit);

/* table_need() and table_find() for a column that is read in SI: its numbers are
 * converted where the "# units:" line gives another unit of this kind. */
int table_need_quantity(struct table_in *t, const char *column, enum unit unit);
int table_find_quantity(struct table_in *t, const char *column, enum unit unit);

#endif
