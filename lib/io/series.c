#include "io/series.h"
#include "cli/msg.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct unit_seen {
	char *name;
	long rows;
	double last; /* time */
};

struct series {
	struct table_in *table;
	int t, y, u; /* columns, -1 if absent */
	int n, unit; /* number of units so far, and the present one */
	struct unit_seen *seen;
	double time, value;
};

struct series *series_open(const char *path, const char *unit)
{
	struct series *s = xcalloc(1, sizeof *s);

	s->table = table_open(path);
	s->t = table_find(s->table, "t");
	s->y = table_find(s->table, "y");
	if (s->t < 0 && s->y < 0 && table_columns(s->table) > 0 &&
		table_find(s->table, "1") == 0) {
		s->t = table_columns(s->table) > 1 ? 0 : -1;
		s->y = table_columns(s->table) > 1 ? 1 : 0;
	}
	if (s->y < 0)
		s->y = table_need(s->table, "y");
	/* If there are other columns, y without t may be a coordinate. */
	if (s->t < 0 && table_columns(s->table) > 1 + (unit != NULL))
		table_need(s->table, "t");
	s->u = unit ? table_need(s->table, unit) : -1;
	return s;
}

static int find_unit(struct series *s, const char *name)
{
	/* usually the unit of the row before, or the one after that */
	for (int i = s->n > 0 ? s->unit : 0, k = 0; k < s->n; k++, i = (i + 1) % s->n)
		if (strcmp(s->seen[i].name, name) == 0)
			return i;
	s->seen = xrealloc(s->seen, (size_t)s->n + 1, sizeof *s->seen);
	s->seen[s->n] = (struct unit_seen){ .name = xstrdup(name) };
	return s->n++;
}

static void check_row(const struct series *s, const struct unit_seen *u)
{
	const char *file = table_name(s->table), *colon = s->u < 0 ? "" : ": ";
	long line = table_line(s->table);

	if (!isfinite(s->time))
		die(EXIT_RUN, "%s: line %ld: %s%stime is missing or not finite", file,
			line, u->name, colon);
	if (isinf(s->value))
		die(EXIT_RUN, "%s: line %ld: %s%sy is infinite", file, line, u->name,
			colon);
	if (u->rows > 0 && s->time <= u->last)
		die(EXIT_RUN,
			"%s: line %ld: %s%stime %.17g %s %.17g: sort by time, once each",
			file, line, u->name, colon, s->time,
			s->time < u->last ? "comes after" : "comes twice, after",
			u->last);
}

int series_next(struct series *s)
{
	struct unit_seen *u;

	if (!table_next(s->table))
		return 0;
	if (s->u < 0)
		table_one_unit(s->table);
	s->unit = find_unit(s, s->u < 0 ? "" : table_text(s->table, s->u));
	u = &s->seen[s->unit];
	s->time = s->t < 0 ? (double)u->rows : table_number(s->table, s->t);
	s->value = table_number(s->table, s->y);
	check_row(s, u);
	u->last = s->time;
	u->rows++;
	return 1;
}

double series_time(const struct series *s)
{
	return s->time;
}

double series_value(const struct series *s)
{
	return s->value;
}

int series_unit(const struct series *s)
{
	return s->unit;
}

const char *series_unit_name(const struct series *s)
{
	return s->seen[s->unit].name;
}

int series_units(const struct series *s)
{
	return s->n;
}

int series_time_column(const struct series *s)
{
	return s->t;
}

int series_value_column(const struct series *s)
{
	return s->y;
}

void series_scale(struct series *s, double time, double value)
{
	if (s->t >= 0)
		table_set_scale(s->table, s->t, time);
	table_set_scale(s->table, s->y, value);
}

struct table_in *series_table(const struct series *s)
{
	return s->table;
}

void series_close(struct series *s)
{
	for (int i = 0; i < s->n; i++)
		free(s->seen[i].name);
	free(s->seen);
	table_close(s->table);
	free(s);
}
