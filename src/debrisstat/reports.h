/* reports.h - the tables of debrisstat that need an ensemble: fits, steps, comparison */
#ifndef REPORTS_H
#define REPORTS_H

#include "io/tables.h"
#include "study.h"
#include <stdint.h>

struct report_par {
	const char *cmd;   /* that makes the table */
	const char *doubt; /* why the input is doubtful; NULL: it is not */
	double confidence; /* of the intervals */
	long bootstrap;    /* samples; 0: none */
	uint64_t seed;     /* of these */
	double depth;      /* of report_comparison(): mean depth that ends the life, m */
};

void report_fits(const struct report_par *par, const struct ensemble *e);
void report_steps(const struct report_par *par, const struct ensemble *e);
/* Differences and ratios of two studies. */
void report_comparison(const struct report_par *par, const struct study study[2]);
/* Ends a table, which is as doubtful as the input. */
void report_end(struct table_out *t, const struct report_par *par);

#endif
