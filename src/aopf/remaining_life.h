/* remaining_life.h - the life that a unit has left: options of aopf, and its columns
 *
 *	outlook_open(unit_column);
 *	struct outlook *o = outlook_new(0, filter);
 *	for each row
 *		outlook_put(o, t, y, &row, out);
 *	outlook_free(o);
 *	outlook_close();
 */
#ifndef OUTLOOK_H
#define OUTLOOK_H

#include "life/adaptive.h"
#include "cli/opt.h"
#include "io/tables.h"

/* Values of the options. */
extern struct outlook_options {
	double threshold; /* nan: there is no life to predict, nor a call of what follows
			   */
	double zero;      /* value of y without any degradation */
} outlook_options;

/* For OPT_TABLE: what ends a life; how it is foreseen. */
extern struct opt outlook_end_rows[], outlook_model_rows[];

/* Dies where options contradict one another. */
void outlook_check(void);

/* Reads the fleet, if there is one; its units are told apart by this column, or by unit
 * where it is NULL. */
void outlook_open(const char *unit_column);
void outlook_close(void);

struct outlook;

struct outlook *outlook_new(int unit, struct adaptive *filter);
void outlook_free(struct outlook *o);
/* Learns from a row and puts its cells. */
void outlook_put(struct outlook *o, double t, double y, const struct adaptive_row *row,
	struct table_out *out);

/* Names of the columns and their units, behind those given; fresh memory. */
char *outlook_columns(const char *before);
char *outlook_units(const char *before, const char *time);

#endif
