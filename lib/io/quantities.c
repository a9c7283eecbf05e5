#include "io/quantities.h"
#include "cli/msg.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double table_quantity(const struct table_in *t, const char *key, enum unit unit)
{
	const char *text = table_key(t, key), *end, *wrong;
	double value;
	char *joined;
	size_t n;

	if (!text)
		return NAN;
	n = strcspn(text, " ");
	joined = xprintf("%.*s%s", (int)n, text, text + n + strspn(text + n, " "));
	wrong = unit_parse(joined, unit, "", &value, &end);
	free(joined);
	if (wrong)
		die(EXIT_RUN, "%s: %s: '%.40s' %s%s%s", table_name(t), key, text, wrong,
			*unit_name(unit) ? ", want " : "", unit_name(unit));
	return value;
}

int quantity_differs(double a, double b)
{
	return fabs(a - b) > 1e-3 * fmax(fabs(a), fabs(b));
}

/* The word after that at text. */
static const char *next_word(const char *text)
{
	text += strcspn(text, " \t");
	return text + strspn(text, " \t");
}

const char *table_unit_word(const struct table_in *t, int column, char word[UNIT_WORD])
{
	const char *units = table_key(t, "units"), *rest = units;
	size_t n;

	/* Fewer are those of the first columns, to which others have been appended. */
	for (int i = 0; rest && i < table_columns(t); i++)
		rest = next_word(rest);
	if (rest && *rest)
		die(EXIT_RUN,
			"%s: '# units: %s' has more units than there are columns, %d",
			table_name(t), units, table_columns(t));
	for (int i = 0; units && i < column; i++)
		units = next_word(units);
	n = units && column >= 0 ? strcspn(units, " \t") : 0;
	snprintf(word, UNIT_WORD, "%.*s", n ? (int)n : 1, n ? units : "1");
	return word;
}

double table_scale(const struct table_in *t, int column, enum unit unit)
{
	char word[UNIT_WORD];
	double scale;

	if (!strcmp(table_unit_word(t, column, word), "1"))
		return NAN;
	scale = unit_scale(word, unit);
	if (scale <= 0)
		die(EXIT_RUN, "%s: column '%s' is in '%s', want %s", table_name(t),
			table_column_name(t, column), word, unit_name(unit));
	return scale;
}

double table_ratio(const struct table_in *t, int column, const char *to)
{
	char from[UNIT_WORD];

	table_unit_word(t, column, from);
	if (!strcmp(from, to) || !strcmp(from, "1") || !strcmp(to, "1"))
		return 1;
	for (int unit = UNIT_LENGTH; unit < UNIT_ANY; unit++) {
		double a = unit_scale(from, (enum unit)unit),
		       b = unit_scale(to, (enum unit)unit);

		if (a > 0 && b > 0)
			return a / b;
	}
	die(EXIT_RUN, "%s: column '%s' is in '%s', want '%s'", table_name(t),
		table_column_name(t, column), from, to);
}

double table_diameter(const struct table_in *t, int column)
{
	double d = table_positive(t, column);

	if (d > DIAMETER_MOST)
		die(EXIT_RUN,
			"%s: line %ld: diameter is %g m, want metres or a '# units:' "
			"line above the header that names the unit",
			table_name(t), table_line(t), d);
	return d;
}

int table_find_quantity(struct table_in *t, const char *column, enum unit unit)
{
	int found = table_find(t, column);
	double scale = table_scale(t, found, unit);

	/* Also where no unit is given: a unit given in a later part differs from it. */
	if (found >= 0)
		table_set_scale(t, found, isnan(scale) ? 1 : scale);
	return found;
}

int table_need_quantity(struct table_in *t, const char *column, enum unit unit)
{
	table_need(t, column);
	return table_find_quantity(t, column, unit);
}
