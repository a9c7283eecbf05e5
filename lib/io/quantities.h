/* quantities.h - numbers with units in the comment lines of tables */
#ifndef IO_QUANTITIES_H
#define IO_QUANTITIES_H

#include "cli/unit.h"
#include "io/tables.h"

/* Value of the latest "# key: 6.25e-10 m2" line, in SI; NAN if there is none.  Dies where
 * it is something else than a number of this unit. */
double table_quantity(const struct table_in *t, const char *key, enum unit unit);

/* 1 if two quantities differ by more than the digits that were lost where one of them was
 * rounded; 0 if one is nan. */
int quantity_differs(double a, double b);

/* The unit of a column as the "# units:" line writes it, at most 31 bytes; "1" where it
 * names none. */
enum { UNIT_WORD = 32 };
const char *table_unit_word(const struct table_in *t, int column, char word[UNIT_WORD]);

/* What one of the numbers of a column is in SI, by the "# units:" line; NAN if that line
 * has no unit for the column, or 1.  Dies where it is not a unit of this kind. */
double table_scale(const struct table_in *t, int column, enum unit unit);

/* Factor that converts the numbers of a column to a unit; 1 where the column has none or
 * the unit is "1".  Dies where the units are of different kinds. */
double table_ratio(const struct table_in *t, int column, const char *unit);

/* table_need() and table_find() for a column that is read in SI: its numbers are
 * converted where the "# units:" line gives another unit of this kind. */
int table_need_quantity(struct table_in *t, const char *column, enum unit unit);
int table_find_quantity(struct table_in *t, const char *column, enum unit unit);

/* Largest diameter of a particle, m: the bores of debris sensors are millimetres to a
 * few centimetres wide, and a larger particle is one in another unit. */
#define DIAMETER_MOST 0.1

/* Diameter of a particle in the present row, in SI.  Dies where it is not above 0, or
 * beyond DIAMETER_MOST. */
double table_diameter(const struct table_in *t, int column);

#endif
