/* wear_steps.h - the machinery of debrisgen: contact, stress below it, and what is lost
 */
#ifndef WEAR_STEPS_H
#define WEAR_STEPS_H

#include "outputs.h"

extern struct opt wearing_rows[]; /* for OPT_TABLE, beside press_rows */

/* Dies where options are missing or out of range. */
void wearing_check(void);

struct wearing;

/* For surfaces of in that are worn in this many steps each. */
struct wearing *wearing_open(const struct fields_in *in, long steps);
void wearing_close(struct wearing *w);

/* Serves grids like that of r from now on.  A doubtful counterface makes r doubtful. */
void wearing_prepare(struct wearing *w, struct record *r);
/* Load and contact under the pressure of c, for wearing_step() as well. */
void wearing_contact(
	struct wearing *w, const struct worn_surface *c, struct debris_step *s);
/* Presses c again, from its last pressure, to a mean pressure or approach; 0 if that did
 * not converge. */
int wearing_press(
	struct wearing *w, const struct worn_surface *c, double target, long step);
/* Whether a step (from 1 in this run) solves the contact, or uses the pressure of the
 * input. */
int wearing_solves(const struct wearing *w, long step);
/* Wears c over a distance under its pressure; the removed material is valid until the
 * next call. *solved is 0 if a contact did not converge. */
struct worn_step wearing_step(struct wearing *w, const struct worn_surface *c,
	double target, double distance, long step, int *solved);

/* Warns if slopes were too steep for the theory or surfaces outside the range of the
 * surrogate; 0 where an audit of the surrogate failed. */
int wearing_warn(const struct wearing *w);

double wearing_friction(void);
/* Whether steps take the heights of the input, or only its pressure. */
int wearing_takes_heights(const struct wearing *w);
int wearing_richardson(void); /* whether steps are repeated on coarser grids */
/* Distance the bodies slide in a step that is not amplified: that of a counterface, or
 * the length of the grid along the shear. */
double wearing_length(const struct record *r);

#endif
