#include "source.h"
#include "cli/msg.h"
#include "cli/text.h"
#include "io/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct source {
	struct fields_in *fields; /* or: */
	struct table_in *table;
	int row; /* one of the next record was read */
	long count;
	struct keys keys; /* comments so far, including those of the next record */
	int nfields;
	double *value; /* of the record: x, y, z and fields, row by row */
	size_t rows, room;
};

/* A comment without a value removes the key of the record before. */
static void take_comment(void *context, const char *key, const char *value)
{
	struct source *s = context;

	keys_set(&s->keys, key, value);
}

static void table_begin(struct source *s, struct input *in)
{
	static const char *const before[SOURCE_BEFORE] = { "realisation", "x", "y", "z" };

	s->table = table_with_comments(in, take_comment, s);
	s->nfields = table_columns(s->table) - SOURCE_BEFORE;
	for (int i = 0; i < SOURCE_BEFORE; i++)
		if (table_columns(s->table) && table_find(s->table, before[i]) != i)
			die(EXIT_RUN,
				"%s: a table, but not of the points of fields: want "
				"columns " SOURCE_COLUMNS,
				table_name(s->table));
	if (s->nfields > RECORD_FIELDS_MAX)
		die(EXIT_RUN, "%s: %d fields, want at most %d", table_name(s->table),
			s->nfields, RECORD_FIELDS_MAX);
	s->row = table_columns(s->table) && table_next(s->table);
	if (s->nfields < 1 || !s->row)
		die(EXIT_RUN, "%s: no record", table_name(s->table));
}

struct source *source_open(const char *path, const struct raw_layout *raw)
{
	struct source *s = xcalloc(1, sizeof *s);
	struct input *in;

	if (raw) {
		s->fields = fields_open(path, raw);
		return s;
	}
	in = input_open(path);
	if (input_begins(in, "# stream: "))
		table_begin(s, in);
	else
		s->fields = fields_from(in);
	return s;
}

static void keep_row(struct source *s)
{
	size_t width = (size_t)s->nfields + 3;

	if ((s->rows + 1) * width > s->room) {
		s->room = 2 * (s->rows + 1) * width;
		s->value = xrealloc(s->value, s->room, sizeof *s->value);
	}
	for (size_t i = 0; i < width; i++)
		s->value[s->rows * width + i] = table_number(s->table, (int)i + 1);
	s->rows++;
}

/* Coordinate 0 to 2 of a row. */
static double position(const struct source *s, size_t row, int axis)
{
	return s->value[row * ((size_t)s->nfields + 3) + (size_t)axis];
}

/* Rows from the first on that differ from it in none of the axes from this one. */
static size_t run(const struct source *s, int axis)
{
	size_t n = 1;

	for (; n < s->rows; n++)
		for (int a = axis; a < 3; a++)
			if (position(s, n, a) != position(s, 0, a))
				return n;
	return n;
}

/* Positions may be rounded to a millionth of a step. */
static int near(double a, double b, double step)
{
	return fabs(a - b) <= 1e-6 * step;
}

/* Determines sizes and spacings, and checks that every point lies on the grid. */
static void settle_grid(const struct source *s, struct record *r, long line)
{
	size_t nx = run(s, 1), plane = run(s, 2), i = 0;
	double x = position(s, 0, 0), y = position(s, 0, 1);
	int wrong = plane % nx != 0 || s->rows % plane != 0 || s->rows > 1 << 30;

	r->dx = 2 * x;
	r->dy = 2 * y;
	r->nx = (int)nx;
	r->ny = (int)(plane / nx);
	r->nz = wrong ? 1 : (int)(s->rows / plane);
	r->dz = r->nz > 1 ? position(s, plane, 2) : 0;
	wrong |= !(r->dx > 0 && r->dy > 0 && r->dz >= 0 && position(s, 0, 2) == 0);
	for (int iz = 0; iz < r->nz && !wrong; iz++)
		for (int iy = 0; iy < r->ny && !wrong; iy++)
			for (int ix = 0; ix < r->nx && !wrong; ix++, i++)
				wrong = !near(position(s, i, 0), (ix + 0.5) * r->dx,
						r->dx) ||
					!near(position(s, i, 1), (iy + 0.5) * r->dy,
						r->dy) ||
					!near(position(s, i, 2), iz * r->dz, r->dz);
	if (wrong)
		die(EXIT_RUN,
			"%s: line %ld: the record that ends here is not a regular grid, x "
			"fastest, from half a spacing on",
			table_name(s->table), line);
}

/* The unit of column k of the "# units:" line, fresh memory. */
static char *unit_of(const char *units, int k)
{
	size_t n;

	for (; units && k > 0; k--) {
		units += strcspn(units, " ");
		units += strspn(units, " ");
	}
	n = units ? strcspn(units, " ") : 0;
	return n == 1 && *units == '1' ? xstrdup("")
				       : xprintf("%.*s", (int)n, units ? units : "");
}

static void fill(const struct source *s, struct record *r, const char *units)
{
	size_t width = (size_t)s->nfields + 3;

	for (int k = 0; k < s->nfields; k++) {
		char *unit = unit_of(units, SOURCE_BEFORE + k);

		record_new_field(r, table_column_name(s->table, SOURCE_BEFORE + k), unit);
		free(unit);
		for (size_t i = 0; i < s->rows; i++)
			r->data[k][i] = s->value[i * width + 3 + (size_t)k];
	}
}

/* The pipeline of the record without its conversion into a table, which is reverted. */
static char *without_table(const char *cmd)
{
	static const char turn[] = " | records --output table";
	size_t n = strlen(cmd), m = sizeof turn - 1;

	return xprintf(
		"%.*s", (int)(n > m && !strcmp(cmd + n - m, turn) ? n - m : n), cmd);
}

static void take_keys(const struct source *s, struct record *r)
{
	for (int i = 0; i < s->keys.n; i++) {
		const char *key = s->keys.key[i], *value = s->keys.value[i];

		if (!strcmp(key, "units") || !*value)
			continue;
		if (!strcmp(key, "cmd"))
			r->cmd = without_table(value);
		else
			record_set(r, key, "%s", value);
	}
}

/* Reads the rows up to the next one at the position of the first. */
static int read_table(struct source *s, struct record *r)
{
	const char *units;
	long line;

	if (!s->row)
		return 0;
	s->rows = 0;
	s->count++;
	r->realisation = table_whole(s->table, 0, 0, 1e15);
	take_keys(s, r);
	units = table_key(s->table, "units");
	do {
		keep_row(s);
		line = table_line(s->table);
		s->row = table_next(s->table);
	} while (s->row && (table_number(s->table, 1) != position(s, 0, 0) ||
				   table_number(s->table, 2) != position(s, 0, 1) ||
				   table_number(s->table, 3) != position(s, 0, 2)));
	settle_grid(s, r, line);
	fill(s, r, units);
	return 1;
}

int source_read(struct source *s, struct record *r)
{
	if (s->fields)
		return fields_read(s->fields, r);
	record_free(r);
	return read_table(s, r);
}

int source_more(struct source *s)
{
	return s->fields ? fields_more(s->fields) : s->row;
}

const char *source_name(const struct source *s)
{
	return s->fields ? fields_name(s->fields) : table_name(s->table);
}

long source_count(const struct source *s)
{
	return s->fields ? fields_count(s->fields) : s->count;
}

void source_close(struct source *s)
{
	if (s->fields)
		fields_close(s->fields);
	if (s->table)
		table_close(s->table);
	keys_free(&s->keys);
	free(s->value);
	free(s);
}
