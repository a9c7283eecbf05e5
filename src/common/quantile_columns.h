/* quantile_columns.h - columns of quantiles, named by per cent: q05, q50, q97.5, q100 */
#ifndef QUANTILE_COLUMNS_H
#define QUANTILE_COLUMNS_H

#include "cli/opt.h"

/* Dies where the levels of --levels do not ascend. */
void levels_check(const struct opt_list *levels);

/* Appends a name for each level, as xappend() does. */
char *levels_columns(char *names, const char *prefix, const struct opt_list *levels);

#endif
