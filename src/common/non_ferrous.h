/* non_ferrous.h - options --non-ferrous and --excitation of debriscount, rwl and
 * wear-volume: the size of particles that duet calls non-ferrous */
#ifndef NON_FERROUS_H
#define NON_FERROUS_H

#include "cli/opt.h"

extern struct opt non_ferrous_rows[]; /* for OPT_TABLE */

/* 1 if the material is named; dies where there is none of this name. */
int non_ferrous_known(void);
/* 1 if it is a ferrous one: none of the particles is non-ferrous then. */
int non_ferrous_none(void);
/* Diameter of the sphere with the same pulse as a ferrous one, and its inverse, m. */
double non_ferrous_size(double equivalent);
double non_ferrous_equivalent(double size);

#endif
