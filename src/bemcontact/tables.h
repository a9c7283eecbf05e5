/* tables.h - tables of contacts and of their patches */
#ifndef BEMCONTACT_TABLES_H
#define BEMCONTACT_TABLES_H

#include "cli/opt.h"
#include "contact/solver.h"
#include "io/fields.h"

extern struct opt table_opts[]; /* for OPT_TABLE */

/* 1 if --table was given. */
int table_wanted(void);
void tables_open(const char *upstream);
/* A row for a contact, and rows for its patches if it is the record's last.  stiffness is
 * dF / d approach, nan if unknown. */
void tables_put(const struct record *r, const struct contact_par *par,
	const struct contact_result *found, const double *pressure, double stiffness,
	int converged, int last);
/* The tables say that they are doubtful. */
void tables_doubt(const char *why);
void tables_done(void);

#endif
