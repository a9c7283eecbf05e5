/* life_table.h - the table of lives left: quantiles or samples, with scores where the end
 * of life is known */
#ifndef LIFE_TABLE_H
#define LIFE_TABLE_H

#include "cli/opt.h"
#include "life/pair/forecast.h"

struct lifetable_par {
	const struct opt_list *levels; /* of the quantiles */
	int samples;                   /* print every path instead */
	int grey;                      /* add this column */
	long first;                    /* number of the first path */
	long least;                    /* samples to print if one represents all */
	double eol, cone, horizon;     /* eol not NAN: add scores */
};

struct lifetable;

/* par is copied.  Before the first row, comments may be put on lifetable_out(). */
struct lifetable *lifetable_open(const char *cmd, const struct lifetable_par *par);
struct table_out *lifetable_out(struct lifetable *t);
/* One observation time; sorts the samples of the row. */
void lifetable_put(struct lifetable *t, double time, struct forecast_row row);
/* Of the row written last; NAN before, and of samples. */
double lifetable_median(const struct lifetable *t);
/* Writes the scores and frees. */
void lifetable_close(struct lifetable *t);

#endif
