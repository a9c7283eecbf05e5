/* counterface.h - the rough body that slides over the one that is worn */
#ifndef COUNTERFACE_H
#define COUNTERFACE_H

#include "cli/opt.h"
#include "io/fields.h"

extern struct opt counterface_rows[]; /* for OPT_TABLE */

/* Whether there is one; dies where options are missing or contradict one another. */
int counterface_check(void);

struct counterface;

/* axis: along which it slides, x (0) or y (1). */
struct counterface *counterface_open(int axis);
void counterface_close(struct counterface *c);

/* Takes the next record, or the only one again, for the surface r. */
void counterface_next(struct counterface *c, const struct record *r);
/* The part above the grid in a step (from 1): height[iy * nx + ix]. */
void counterface_window(const struct counterface *c, long step, double *height);
/* Puts that back, worn. */
void counterface_return(struct counterface *c, long step, const double *height);

/* Its distance per step, m; nan: the length of the grid. */
double counterface_slide(void);
/* The whole of it, to be written. */
const struct record *counterface_record(const struct counterface *c);

#endif
