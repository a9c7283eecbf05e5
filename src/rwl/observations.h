/* observations.h - the wear of a pair as it was observed: rows of a table turned into
 * gaps
 *
 * Anything that is not a state of growing time ends the program with one line that names
 * file and line.
 */
#ifndef OBSERVATIONS_H
#define OBSERVATIONS_H

#include "cli/opt.h"
#include "io/tables.h"
#include "life/grey/noise.h"
#include "life/pair/pair.h"
#include "life/trend/plateau.h"
#include "life/trend/rescaled.h"

/* Values of the options. */
extern struct state_options {
	enum pair_quantity quantity;
	const char *unit;
	double error; /* in that unit */
} state_options;

extern struct opt state_rows[]; /* for OPT_TABLE */

struct observations {
	struct table_in *table;
	const struct pair *pair;
	int time_column, value_column;
	int sources_column, verdict_column; /* of particles; -1 if absent */
	enum pair_quantity quantity;        /* found in the columns */
	int filtered;                       /* read from the column state */
	double scale, time_scale;           /* to SI */
	double debris;                      /* volume of the particles so far */
	long rows;
	long passed;           /* particles without a diameter */
	long beyond;           /* values that suggest another unit */
	struct rescaled seen;  /* values, to find out whether their unit changes */
	struct plateau course; /* of the gap, without particles */
	struct noise noise;    /* of volumes */
	double lowest;         /* volume, no more than 0, */
	long lowest_line;      /* and where it is */
	double first_t;        /* of the first row */
	double t, gap, value;  /* latest row, SI; gap and value NAN if missing */
	double gap_error;      /* standard error of the gap */
};

void state_open(struct observations *s, const char *file, const struct pair *pair);
/* The next row; 0 at the end.  Times must grow, but particles may come together.  A
 * particle that duet calls unresolved counts as its sources. */
int state_next(struct observations *s);

/* Dies if an option of particles was given and no table of them has been opened. */
void state_check(void);
/* Why the state is doubtful; NULL: it is not. */
const char *state_doubt(void);

/* Slope of the gap over the whole life of an earlier unit from the time skip on, m/s. */
double state_slope(const char *file, const struct pair *pair, double skip);

#endif
