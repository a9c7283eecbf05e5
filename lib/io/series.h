/* series.h - time series of one or more units, row by row
 *
 * A table with the columns t and y.  If y is the only column except that of units, time
 * is the row number within the unit, from 0; columns of a table without a header are
 * identified by position.  With a unit column the rows of several units may alternate.
 * Times must be finite and ascending for each unit; y may be missing (nan) but not
 * infinite.  Anything else ends the program with one line that names file, line, unit and
 * the error.
 */
#ifndef IO_SERIES_H
#define IO_SERIES_H

#include "io/tables.h"

struct series;

/* unit: name of the column that identifies the unit, or NULL. */
struct series *series_open(const char *path, const char *unit);
/* Moves to the next row; 0 at the end. */
int series_next(struct series *s);
double series_time(const struct series *s);
double series_value(const struct series *s); /* NAN: missing */
int series_unit(const struct series *s);     /* 0, 1, ... in order of appearance */
const char *series_unit_name(const struct series *s); /* "" without a unit column */
int series_units(const struct series *s);             /* units so far */
/* The columns of times and values, -1 if times are row numbers. */
int series_time_column(const struct series *s);
int series_value_column(const struct series *s);
/* Multiplies all later times and values by these factors. */
void series_scale(struct series *s, double time, double value);
struct table_in *series_table(const struct series *s);
void series_close(struct series *s);

#endif
