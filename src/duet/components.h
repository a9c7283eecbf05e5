/* components.h - records of four channels, I1 Q1 I2 Q2: the components that duet works
 * on, and the class of a particle by the phase of its pulse; options of duet
 *
 * The phase of ferrous particles is given; those of conductors that are not are a quarter
 * of a turn behind it or more.  The component halfway between sees both with a positive
 * sign and at least 0.7 of their height, down to 135 degrees behind ferrous ones.
 */
#ifndef COMPONENTS_H
#define COMPONENTS_H

#include "cli/opt.h"
#include <stddef.h>

extern struct opt component_rows[]; /* for OPT_TABLE */

/* Dies where options of four channels are given for another number of them. */
void components_check(int channels);
/* Phase of the first component: what an instrument has been learned with. */
double components_angle(void);
/* Height of the pulse of a particle halfway over that in the first component. */
double components_share(void);

struct component_class {
	double phase;     /* from that of ferrous particles, rad */
	double ferrous;   /* probability; NAN: the phase is of no material */
	const char *name; /* "ferrous", "non-ferrous", "unclear" */
};

/* size: diameter of a ferrous particle with this pulse, m; phase and phase_se of its
 * components. */
struct component_class components_classify(double size, double phase, double phase_se);

#endif
