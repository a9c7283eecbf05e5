/* quantities.h - numbers with units in the comment lines of tables */
#ifndef IO_QUANTITIES_H
#define IO_QUANTITIES_H

#include "cli/unit.h"
#include "io/tables.h"

/* Value of the latest "# key: 6.25e-10 m2" line, in SI; NAN if there is none.  Dies where
 * it is something else than a number of this unit. */
double table_quantity(const struct table_in *t, const char *key, enum unit unit);

/* What one of the numbers of a column is in SI, by the "# units:" line; NAN where that
 * tells no unit of the column, or 1.  Dies where it is not a unit of this kind. */
double table_scale(const struct table_in *t, int column, enum unit unit);

#endif
