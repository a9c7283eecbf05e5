/* verdicts.h - which rows of duet's table are to be counted: an option of abrade,
 * ballcal, debriscount, rwl, sensorsim and wear-volume */
#ifndef VERDICTS_H
#define VERDICTS_H

#include "cli/opt.h"
#include "io/tables.h"

extern struct opt verdict_rows[]; /* for OPT_TABLE */

enum verdict {
	VERDICT_SURE,       /* alone, overlap, or a table without verdicts */
	VERDICT_DOUBTFUL,   /* any other word: left out, unless --doubtful is given */
	VERDICT_UNRESOLVED, /* a row that represents many */
	VERDICT_FOREIGN /* shock, bubble, impulse, transient, also by the column kind of
			   sensorsim: no particle, left out; it may lack a time */
};

/* The column of verdicts, or -1; finds that of classes, too. */
int verdict_column(struct table_in *t);
/* The same without classes, where diameters are wanted as they are. */
int verdict_column_alone(struct table_in *t);
/* Of the present row; counts what is doubtful.  column may be -1. */
enum verdict verdict_of(const struct table_in *t, int column);
/* Says how many rows have been left out since the last report, and adds them to the
 * counters. */
void verdict_report(void);
/* Diameter of the particle of the present row, of which this is in the table: that of a
 * sphere of the material of --non-ferrous, if it is of that class. */
double verdict_diameter(const struct table_in *t, double diameter);
/* Warns of rows whose diameter is not that of the particle, or may not be: of class
 * non-ferrous if their material is not named, of class unclear, of either sign.  1 if
 * there have been any since the last call. */
int verdict_equivalent(void);

#endif
