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

const char *table_unit_word(const struct table_in *t, int column, char word[UNIT_WORD])
{
	const char *units = table_key(t, "units");
	size_t n;

	for (int i = 0; units && i < column; i++) {
		units += strcspn(units, " \t");
		units += strspn(units, " \t");
	}
	n = units && column >= 0 ? strcspn(units, " \t") : 0;
	snprintf(word, UNIT_WORD, "%.*s", n ? (int)n : 1, n ? units : "1");
	return word;
}

double table_scale(const struct table_in *t, int column, enum unit unit)
{
	char word[UNIT_WORD], one[UNIT_WORD + 1];
	const char *end, *wrong;
	double scale;

	if (!strcmp(table_unit_word(t, column, word), "1"))
		return NAN;
	snprintf(one, sizeof one, "1%s", word);
	wrong = unit_parse(one, unit, "", &scale, &end);
	if (wrong)
		die(EXIT_RUN, "%s: column '%s' is in '%s', want %s", table_name(t),
			table_column_name(t, column), word, unit_name(unit));
	return scale;
}

double table_ratio(const struct table_in *t, int column, const char *to)
{
	char from[UNIT_WORD], one[2][UNIT_WORD + 1];
	double scale[2];
	const char *end;

	table_unit_word(t, column, from);
	if (!strcmp(from, to) || !strcmp(from, "1") || !strcmp(to, "1"))
		return 1;
	snprintf(one[0], sizeof one[0], "1%s", from);
	snprintf(one[1], sizeof one[1], "1%s", to);
	for (int unit = UNIT_LENGTH; unit < UNIT_ANY; unit++)
		if (!unit_parse(one[0], (enum unit)unit, "", &scale[0], &end) &&
			!unit_parse(one[1], (enum unit)unit, "", &scale[1], &end))
			return scale[0] / scale[1];
	die(EXIT_RUN, "%s: column '%s' is in '%s', want '%s'", table_name(t),
		table_column_name(t, column), from, to);
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
