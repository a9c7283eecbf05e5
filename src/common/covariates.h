/* covariates.h - columns that scale the wear rate: --covariate of aopf and rwl
 *
 *	covariates_check();                (after the options)
 *	covariates_open(table);
 *	par.load = covariates_future();
 *	par.n_loads = covariates_count();
 *	for each row
 *		covariates_read(table, load);
 *	covariates_close();
 */
#ifndef COVARIATES_H
#define COVARIATES_H

#include "cli/opt.h"
#include "io/tables.h"
#include "life/trend/bank.h"

extern struct opt covariate_rows[]; /* for OPT_TABLE */

void covariates_check(void);
int covariates_count(void);
const char *covariate_name(int k);
const struct bank_covariate *covariates_future(void);
void covariates_open(struct table_in *t);
/* The covariates of the present row; dies where one is not finite. */
void covariates_read(struct table_in *t, double load[BANK_LOADS]);
/* At the end: warns of future values far from those of the table, and says why lives are
 * doubtful then; NULL: they are not. */
const char *covariates_doubt(void);
void covariates_close(void);

#endif
