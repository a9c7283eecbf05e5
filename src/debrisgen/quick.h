/* quick.h - volumes by a surrogate of the debris model instead of the model */
#ifndef QUICK_H
#define QUICK_H

#include "cli/opt.h"
#include "debris/debris.h"
#include "debris/surrogate.h"

extern struct opt quick_rows[]; /* for OPT_TABLE */

int quick_asked(void); /* whether there is to be a surrogate */

struct quick;

/* What is known of the volumes of a step. */
struct quick_volumes {
	int exact; /* by the full model */
	const struct surrogate_guess *particle;
	struct surrogate_guess total;
};

/* Dies where the file is no surrogate. */
struct quick *quick_open(void);
void quick_close(struct quick *q);

/* Steps are of grids like this from now on. */
void quick_prepare(struct quick *q, const struct stress_par *par);
/* Finds the particles under a pressure from the stress at the surface alone, which it
 * has been loaded with.  Fills step and returns 1, or 0 where the full model is wanted:
 * outside the range of the fit, where the interval is too wide, or to audit. */
int quick_step(struct quick *q, struct stress *stress, const double *pressure,
	double yield, double hardness, long realisation, struct debris_step *step);
/* What the full model found instead. */
void quick_take(struct quick *q, const struct debris_step *step);
const struct quick_volumes *quick_volumes(const struct quick *q);

/* Reports what was done; returns 1, or 0 if intervals contained too few of the audited
 * volumes. */
int quick_report(const struct quick *q, const char *name);

#endif
