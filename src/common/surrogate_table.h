/* surrogate_table.h - a surrogate of the debris model as a table: debrisfit, debrisgen
 *
 * Columns kind, name and value: least and most of a property of the contacts of the fit;
 * the scores of particles and totals, ascending.
 */
#ifndef SURROGATE_TABLE_H
#define SURROGATE_TABLE_H

#include "debris/surrogate.h"

/* Writes to standard output; doubt: why it is doubtful, or NULL. */
void surrogate_write(const struct surrogate *s, const struct surrogate_report *report,
	const char *cmd, const char *doubt);
/* Dies where the file is not what it should be.  1 if it is doubtful, with a warning. */
int surrogate_read(const char *path, struct surrogate *s);

#endif
