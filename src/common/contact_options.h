/* contact_options.h - how bodies are pressed together: options that bemcontact and
 * debrisgen share
 */
#ifndef CONTACT_OPTIONS_H
#define CONTACT_OPTIONS_H

#include "cli/opt.h"
#include "contact/solver.h"
#include "io/fields.h"

/* Values of the options; nan if not given.  estar follows from young and poisson
 * once press_check() was called. */
extern struct press {
	double load, pressure, approach, estar, hardness, tolerance;
	struct opt_list young, poisson;
	int boundary, solver, multiply;
	long max_iterations, threads;
} press;

extern struct opt press_rows[]; /* for OPT_TABLE */

/* Dies where options contradict one another. */
void press_check(void);

/* The problem on the grid of a record.  Material and boundary that were not given are
 * those of its keys estar, boundary and hardness; estar is nan if it is not known. */
struct contact_par press_par(const struct record *r, struct pool *pool);
/* Warns where a contact solved before is not what the options ask for; nan: unknown. */
void press_differs(const char *name, long number, const char *what, const char *unit,
	double asked, double solved);
/* Why what follows from a contact that did not converge is doubtful. */
extern const char press_not_converged[];
/* A contact solved before, of which the stress is wanted: dies if a body is coated; warns
 * if it is of another modulus or hardness; warns and returns why the stress is doubtful
 * if it is of another boundary or did not converge; NULL: it is not. */
const char *press_given(const struct record *r, const char *name, long number);
/* Writes the keys of material and boundary. */
void press_record(struct record *r, const struct contact_par *par);
/* Drops what an earlier contact found: it is not of other heights or another load. */
void press_forget(struct record *r);
/* 1 if both are the same grid, material and boundary, so that a solver serves again. */
int press_same(const struct contact_par *a, const struct contact_par *b);

enum contact_control press_control(void);
/* Requested mean pressure or approach; nan if neither of them nor a load was given. */
double press_target(const struct record *r);

#endif
