/* pump_options.h - options of the sliding pair of rwl: surfaces, leakage and thresholds
 */
#ifndef PUMP_OPTIONS_H
#define PUMP_OPTIONS_H

#include "cli/opt.h"
#include "life/pair/pair.h"

/* Values of the options; nan if not given. */
extern struct pump {
	struct pair pair;
	double fragment_area, transition; /* see life/prior/partition.h; NAN: not known */
	double critical_size, critical_probability; /* failure by large particles */
	int per_step;                               /* their share in one step */
	struct opt_list radii, ports;
} pump;

extern struct opt pump_threshold_rows[], pump_face_rows[]; /* for OPT_TABLE */

/* Sets the defaults; before the options are parsed. */
void pump_init(void);
/* Parameters that are assumed because neither options nor tables state them, for a
 * message; fresh memory, NULL: none.  fragments: they are read; leaks: a leakage is
 * observed.  Sets the area of a fragment if it is not known. */
char *pump_assumed(int fragments, int leaks);
/* Dies where options make no pump; sets what follows from several of them. */
void pump_check(void);

#endif
