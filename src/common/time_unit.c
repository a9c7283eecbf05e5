#include "time_unit.h"
#include "cli/msg.h"
#include "io/quantities.h"
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char *const words[] = { "s", "min", "h", "d", NULL };
static const double seconds[] = { 1, 60, 3600, 86400 };

static int unit;
static double told = NAN;
static char told_word[UNIT_WORD] = "1";

struct opt timeunit_rows[] = {
	{ 0, "time-unit", OPT_WORD, UNIT_NONE, &unit, 0, 0, "s|min|h|d",
		"unit of the times read, if they do not name it", words, 0 },
	OPT_END,
};

void timeunit_settle(const struct table_in *t, int column, int needed)
{
	double scale;

	if (!strcmp(table_unit_word(t, column, told_word), "1"))
		return;
	scale = unit_scale(told_word, UNIT_TIME);
	told = scale > 0 ? scale : NAN;
	if (isnan(told)) {
		if (needed)
			die(EXIT_RUN, "%s: column '%s' is in '%s', want s, min, h or d",
				table_name(t), table_column_name(t, column), told_word);
	} else if (opt_given("time-unit") && fabs(seconds[unit] / told - 1) > 1e-9) {
		die(EXIT_USAGE, "--time-unit %s contradicts '# units:' of %s, %s",
			words[unit], table_name(t), told_word);
	}
}

double timeunit(void)
{
	return isnan(told) ? seconds[unit] : told;
}

double timeunit_ratio(const struct table_in *t, int column)
{
	char word[UNIT_WORD];

	if (column >= 0 && strcmp(table_unit_word(t, column, word), "1") != 0 &&
		strcmp(timeunit_word(), "1") == 0)
		die(EXIT_RUN,
			"%s: column '%s' is in '%s', but the series names no unit of its "
			"times: specify --time-unit",
			table_name(t), table_column_name(t, column), word);
	return table_ratio(t, column, timeunit_word());
}

const char *timeunit_word(void)
{
	return strcmp(told_word, "1") != 0 ? told_word
	       : opt_given("time-unit")    ? words[unit]
					   : "1";
}
