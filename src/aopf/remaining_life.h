/* remaining_life.h - the life that a unit has left: options of aopf, and its columns
 *
 * Different units may step at the same time.
 */
#ifndef REMAINING_LIFE_H
#define REMAINING_LIFE_H

#include "cli/opt.h"
#include "io/series.h"
#include "life/particle/adaptive.h"
#include "life/trend/bank.h"
#include "num/state.h"

/* The value of the option; nan: there is no life to predict, and no struct outlook.
 */
extern double outlook_threshold;

/* For OPT_TABLE: failure; prediction; maintenance decisions. */
extern struct opt outlook_end_rows[], outlook_model_rows[], outlook_plant_rows[];

/* Dies where options contradict one another; bare: there is no filter. */
void outlook_check(int bare);

/* Takes the unit of time of the series, and reads the fleet and the events, if there are
 * any, into its units; the first column identifies units, or "unit" if it is NULL, and
 * the second holds the operating time, unless it is NULL. */
void outlook_open(struct series *in, const char *unit_column, const char *clock_column);
/* At the end: why the fleet, the events or the future of a covariate make lives doubtful;
 * NULL: they do not. */
const char *outlook_doubt(void);
void outlook_close(void);

/* A row of the input. */
struct outlook_row {
	double t, clock, y; /* clock: the time that wears, t unless there is another */
	const char *unit;   /* its name, "" without one */
	double load[BANK_LOADS]; /* the covariates since the row before */
};

struct outlook;

/* unit: its name, the caller's.  filter: NULL if there is none. */
struct outlook *outlook_new(const char *unit, struct adaptive *filter);
void outlook_free(struct outlook *o);
void outlook_pass(struct outlook *o, struct state *s);
/* Learns from a row and fills its outlook_cells() cells; filtered: NULL without a filter.
 */
void outlook_step(struct outlook *o, const struct outlook_row *in,
	const struct adaptive_row *filtered, double *cell);
int outlook_cells(void); /* 0 without a threshold */
/* After the last row: tells which events the unit has used.  Warns and
 * returns 1 if there are events before the saved state that it did not know, or if its
 * values have changed their scale. */
int outlook_settle(const struct outlook *o);
int outlook_alarm(const struct outlook *o); /* the active alarm level, 0: none */
/* Counts the work it did. */
void outlook_count(struct outlook *o);

/* Append the names of the columns and their units, as xappend() does. */
char *outlook_columns(char *names);
char *outlook_units(char *units);

#endif
