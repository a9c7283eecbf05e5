#include "common/covariates.h"
#include "cli/msg.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct opt_texts covariates;
static struct bank_covariate future[BANK_LOADS];
static char *name[BANK_LOADS];
static int column[BANK_LOADS];
static double least[BANK_LOADS], most[BANK_LOADS]; /* in the table */

struct opt covariate_rows[] = {
	{ 0, "covariate", OPT_TEXTS, UNIT_NONE, &covariates, 0, 0,
		"COLUMN[:mean|:last|:X]",
		"column that scales the wear rate, and its value in the future", NULL,
		0 },
	OPT_END
};

/* Takes COLUMN[:FUTURE] apart. */
static void read_covariate(int k)
{
	const char *text = covariates.v[k], *colon = strrchr(text, ':');
	char *end;

	name[k] = xstrdup(text);
	if (colon) {
		name[k][colon - text] = '\0';
		if (strcmp(colon, ":last") == 0) {
			future[k].future = BANK_LAST;
		} else if (strcmp(colon, ":mean") == 0) {
			future[k].future = BANK_MEAN;
		} else {
			future[k].future = BANK_VALUE;
			future[k].value = strtod(colon + 1, &end);
			if (end == colon + 1 || *end || !isfinite(future[k].value))
				die(EXIT_USAGE,
					"--covariate %s: want mean, last or a number "
					"after the colon",
					text);
		}
	}
	for (int j = 0; j < k; j++)
		if (strcmp(name[j], name[k]) == 0)
			die(EXIT_USAGE, "--covariate %s: given twice", name[k]);
}

void covariates_check(void)
{
	if (covariates.n > BANK_LOADS)
		die(EXIT_USAGE, "--covariate: %d columns, want at most %d", covariates.n,
			(int)BANK_LOADS);
	for (int k = 0; k < covariates.n; k++)
		read_covariate(k);
}

int covariates_count(void)
{
	return covariates.n;
}

const char *covariate_name(int k)
{
	return name[k];
}

const struct bank_covariate *covariates_future(void)
{
	return future;
}

void covariates_open(struct table_in *t)
{
	for (int k = 0; k < covariates.n; k++) {
		column[k] = table_need(t, name[k]);
		table_set_scale(t, column[k], 1); /* its unit must not change */
		least[k] = INFINITY;
		most[k] = -INFINITY;
	}
}

void covariates_read(struct table_in *t, double load[BANK_LOADS])
{
	for (int k = 0; k < covariates.n; k++) {
		load[k] = table_number(t, column[k]);
		if (!isfinite(load[k]))
			die(EXIT_RUN, "%s: line %ld: %s is missing or not finite",
				table_name(t), table_line(t), name[k]);
		least[k] = fmin(least[k], load[k]);
		most[k] = fmax(most[k], load[k]);
	}
}

const char *covariates_doubt(void)
{
	const char *why = NULL;

	for (int k = 0; k < covariates.n; k++) {
		if (future[k].future != BANK_VALUE || !(least[k] <= most[k]) ||
			!(fabs(2 * future[k].value - least[k] - most[k]) >
				3 * (most[k] - least[k])))
			continue;
		why = "the future value of a covariate is far from those of the series";
		warn("--covariate %s: %g is far from the values in the series, %g "
		     "to %g",
			name[k], future[k].value, least[k], most[k]);
	}
	return why;
}

void covariates_close(void)
{
	for (int k = 0; k < covariates.n; k++)
		free(name[k]);
}
