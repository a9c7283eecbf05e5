#include "actions.h"
#include "cli/msg.h"
#include "cli/text.h"
#include "io/input.h"
#include "io/tables.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "-1.235e-10" */
enum { NUMBER_WIDTH = 10, UNIT_WIDTH = 32 };

/* Comments that are shown; other keys are omitted.
 */
static void show_comment(void *context, const char *key, const char *value)
{
	char *shown;

	(void)context;
	if (!strcmp(key, "cmd") || !strcmp(key, "units") || !strcmp(key, "columns"))
		return;
	shown = text_escape(value);
	printf("%s: %s\n", key, shown);
	free(shown);
}

/* The unit of column k of the "# units:" line; "" where it has none. */
static void unit_of(const char *units, int k, char unit[UNIT_WIDTH])
{
	size_t length;

	for (; units && k > 0; k--) {
		units += strcspn(units, " \t");
		units += strspn(units, " \t");
	}
	length = units ? strcspn(units, " \t") : 0;
	if (length >= UNIT_WIDTH)
		length = UNIT_WIDTH - 1;
	snprintf(unit, UNIT_WIDTH, "%.*s", (int)length, units ? units : "");
	if (!strcmp(unit, "1") || !strcmp(unit, "unit"))
		*unit = '\0';
}

/* Prints a heading of its least width; returns how wide it is. */
static int show_heading(const struct table_in *t, int k)
{
	char unit[UNIT_WIDTH], *name;
	int width;

	unit_of(table_key(t, "units"), k, unit);
	name = xprintf(*unit ? "%s [%s]" : "%s", table_column_name(t, k), unit);
	width = printf("%s%*s", k ? "  " : "", NUMBER_WIDTH, name) - 2 * (k > 0);
	free(name);
	return width;
}

static void show_cell(const struct table_in *t, int k, int width)
{
	const char *text = table_text(t, k);
	char *end, *shown;
	double value = strtod(text, &end);

	shown = end > text && !*end ? xprintf("%.4g", value) : text_escape(text);
	printf("%s%*s", k ? "  " : "", width, shown);
	free(shown);
}

void show_pretty(const char *path)
{
	struct table_in *t = table_with_comments(input_open(path), show_comment, NULL);
	int more = table_next(t), n = table_columns(t);
	int *width = xcalloc((size_t)n, sizeof *width);

	if (n == 0)
		die(EXIT_RUN, "%s: empty, want a table", table_name(t));
	table_same_units(t);
	for (int k = 0; k < n; k++)
		width[k] = show_heading(t, k);
	putchar('\n');
	for (; more; more = table_next(t)) {
		for (int k = 0; k < n; k++)
			show_cell(t, k, width[k]);
		putchar('\n');
		fflush(stdout);
	}
	table_close(t);
	free(width);
}
