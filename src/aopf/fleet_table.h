/* fleet_table.h - earlier units of the kind that aopf predicts: the table of --fleet */
#ifndef FLEET_TABLE_H
#define FLEET_TABLE_H

#include "io/reasons.h"
#include "io/series.h"
#include "life/trend/bank.h"
#include <stdint.h>

/* Reads the file into the units of the series that is predicted; ages are operating times
 * if there is a column of the clock, not NULL, and the file has it.  direction: 1 or -1.
 * Reasons for which it is doubtful are added. */
void fleet_table_read(const char *file, const char *unit_column, const char *clock_column,
	double threshold, int direction, const struct series *like,
	struct reasons *doubts);
/* The paths of the units; NULL: no table has been read. */
const struct bank_shape *fleet_table_shapes(int *n);
/* Which of them, from 1, is that of the unit of this name; 0: none. */
int fleet_table_shape_of(const char *unit);
uint64_t fleet_table_checksum(void); /* of the paths */
void fleet_table_free(void);

#endif
