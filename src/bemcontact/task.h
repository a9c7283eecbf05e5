/* task.h - one contact that bemcontact solves, and what may follow it */
#ifndef TASK_H
#define TASK_H

#include "cli/opt.h"
#include "contact/solver.h"
#include "io/fields.h"

/* What is solved for a record. */
struct task {
	struct record *r;
	const char *name;
	long number;
	struct contact_par par;
	struct contact *c;
	double *h, *p, *gap;
	double *other; /* a pressure to vary the load with */
};

/* Solves to a load or approach; dies where there is no such contact. */
enum contact_status press_to(const struct task *t, const double *height,
	enum contact_control control, double target, double *p, double *gap);
/* Counts the work of the last contact. */
void count_work(const struct contact_result *s, int warm);
/* Puts the row of a contact under pressure p into --table; fields and patches are put out
 * too where last. */
void put_row(const struct task *t, const double *height, const struct contact_result *s,
	double *p, int converged, int last);

/* slip.c: a tangential load below friction, on top of the contact that was found: its
 * shear, and what is to be known of it in the record.  1 if it converged. */
extern struct opt slip_rows[]; /* for OPT_TABLE */
void slip_check(void);
int slip_wanted(void);
int slip_solve(const struct task *t, const struct contact_result *normal, double *shear);

/* unload.c: what remains once the load is off.  full: the contact under all of the load,
 * with its gap.  The height that remains is written to residual, unless NULL, the rows of
 * unloading to --table.  1 if all converged. */
extern struct opt unload_rows[]; /* for OPT_TABLE */
int unload_wanted(void);
int unload_solve(
	const struct task *t, const struct contact_result *full, double *residual);

#endif
