#include "io/quantities.h"
#include "cli/msg.h"
#include <math.h>
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

double table_scale(const struct table_in *t, int column, enum unit unit)
{
	const char *units = table_key(t, "units"), *end, *wrong;
	char *one;
	double scale;
	size_t n;

	for (int i = 0; units && i < column; i++) {
		units += strcspn(units, " \t");
		units += strspn(units, " \t");
	}
	n = units && column >= 0 ? strcspn(units, " \t") : 0;
	if (n == 0 || (n == 1 && *units == '1'))
		return NAN;
	one = xprintf("1%.*s", (int)n, units);
	wrong = unit_parse(one, unit, "", &scale, &end);
	free(one);
	if (wrong)
		die(EXIT_RUN, "%s: column '%s' is in '%.*s', want %s", table_name(t),
			table_column_name(t, column), (int)n, units, unit_name(unit));
	return scale;
}

int table_find_quantity(struct table_in *t, const char *column, enum unit unit)
{
	int found = table_find(t, column);
	double scale = table_scale(t, found, unit);

	/* Also where no unit is named: units that a later part names differ from it. */
	if (found >= 0)
		table_set_scale(t, found, isnan(scale) ? 1 : scale);
	return found;
}

int table_need_quantity(struct table_in *t, const char *column, enum unit unit)
{
	table_need(t, column);
	return table_find_quantity(t, column, unit);
}
