#include "io/tables.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/unit.h"
#include "cli/upstream.h"
#include "io/keys.h"
#include "io/kinds.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

struct table_in {
	FILE *f;
	const char *name;
	char *line; /* the present row, cut into cells */
	size_t room;
	long number; /* of that line, from 1 */
	int ncolumns;
	char **column; /* names */
	char **cell;
	const char *blanks; /* what parts the cells */
	int headed;         /* the names stand in the table */
	int pending;        /* the row read ahead by table_open() is still to come */
	struct keys keys;   /* of comment lines */
	struct upstream upstream;
	long part;
};

struct table_out {
	FILE *f;
	const char *name;
	char *head;    /* comment lines not yet written */
	char *columns; /* header line, NULL once written */
	char *cmd;
	int ncolumns, ncells;
};

/* Reader */

static char *trim(char *s)
{
	char *end = s + strlen(s);

	while (end > s && (end[-1] == ' ' || end[-1] == '\t'))
		*--end = '\0';
	return s + strspn(s, " \t");
}

static void keep_key(struct table_in *t, char *comment)
{
	char *colon = strchr(comment, ':');

	if (!colon)
		return;
	*colon = '\0';
	comment = trim(comment);
	keys_set(&t->keys, comment, trim(colon + 1));
	if (!strcmp(comment, "cmd")) {
		upstream_add(&t->upstream, table_key(t, "cmd"));
		t->part++;
	}
}

/* UTF-8 has none, but spreadsheets begin a file with it. */
static const char byte_order_mark[] = "\xef\xbb\xbf";

/* The next line that is neither empty nor a comment; 0 at the end. */
static int next_line(struct table_in *t)
{
	ssize_t n;

	while ((n = getline(&t->line, &t->room, t->f)) > 0) {
		if (t->number++ == 0)
			kind_refuse(t->name, t->line, (size_t)n, KIND_TABLE);
		if (t->line[n - 1] != '\n')
			die(EXIT_RUN,
				"%s: line %ld: no newline at the end: the table is cut off",
				t->name, t->number);
		t->line[--n] = '\0';
		if (n && t->line[n - 1] == '\r')
			t->line[--n] = '\0';
		if ((size_t)n != strlen(t->line))
			die(EXIT_RUN, "%s: line %ld: NUL byte in a table", t->name,
				t->number);
		if (t->number == 1 && strncmp(t->line, byte_order_mark, 3) == 0)
			memmove(t->line, t->line + 3, (size_t)(n -= 3) + 1);
		if (*t->line == '#')
			keep_key(t, t->line + 1);
		else if (n)
			return 1;
	}
	if (ferror(t->f))
		die(EXIT_RUN, "%s:", t->name);
	return 0;
}

/* Cuts the line into at most max cells; returns how many there are. */
static int cut(struct table_in *t, char *line, char **cells, int max)
{
	int n = 0;
	char *s = line;

	if (*t->blanks == ' ')
		s = trim(s);
	for (;;) {
		size_t length = strcspn(s, t->blanks);
		int last = !s[length];

		if (cells && n < max)
			cells[n] = s;
		n++;
		if (last)
			return n;
		s[length] = '\0';
		s += length + 1;
		if (*t->blanks == ' ')
			s += strspn(s, t->blanks);
	}
}

/* "1,5" */
static int is_comma_decimal(const char *s)
{
	size_t whole = strspn(s, "+-0123456789");

	return whole > 0 && s[whole] == ',' && s[whole + 1] &&
	       s[whole + 1 + strspn(s + whole + 1, "0123456789eE+-")] == '\0';
}

static int is_missing(const char *s)
{
	return !*s || !strcmp(s, "nan") || !strcmp(s, "NaN") || !strcmp(s, "NA") ||
	       !strcmp(s, "-nan");
}

static int to_number(const char *s, double *v)
{
	char *end;

	if (is_missing(s)) {
		*v = NAN;
		return 1;
	}
	*v = strtod(s, &end);
	return end != s && !*end && !isnan(*v);
}

/* A table whose first row is all numbers has no header: its names come from a
 * "# columns:" line, or are 1, 2, ... */
static void name_columns(struct table_in *t)
{
	const char *declared = table_key(t, "columns");
	int all = 1;
	double v;

	for (int i = 0; i < t->ncolumns; i++)
		all &= to_number(t->cell[i], &v) && *t->cell[i];
	t->pending = all;
	t->headed = !all;
	for (int i = 0; i < t->ncolumns; i++)
		t->column[i] = all ? xprintf("%d", i + 1) : xstrdup(t->cell[i]);
	if (all && declared) {
		char *copy = xstrdup(declared), **names;

		names = xcalloc((size_t)t->ncolumns, sizeof *names);
		if (cut(t, copy, names, t->ncolumns) == t->ncolumns)
			for (int i = 0; i < t->ncolumns; i++) {
				free(t->column[i]);
				t->column[i] = xstrdup(names[i]);
			}
		free(names);
		free(copy);
	}
}

struct table_in *table_open(const char *path)
{
	struct table_in *t = xcalloc(1, sizeof *t);
	char *copy;

	t->f = file_open(path, &t->name);
	if (!next_line(t))
		return t;
	t->blanks = strchr(t->line, '\t') ? "\t" : " \t";
	copy = xstrdup(t->line);
	t->ncolumns = cut(t, copy, NULL, 0);
	free(copy);
	t->column = xcalloc((size_t)t->ncolumns, sizeof *t->column);
	t->cell = xcalloc((size_t)t->ncolumns, sizeof *t->cell);
	cut(t, t->line, t->cell, t->ncolumns);
	name_columns(t);
	return t;
}

const char *table_name(const struct table_in *t)
{
	return t->name;
}

const char *table_key(const struct table_in *t, const char *key)
{
	return keys_get(&t->keys, key);
}

const char *table_upstream(struct table_in *t)
{
	return upstream_cmd(&t->upstream);
}

long table_part(const struct table_in *t)
{
	return t->part;
}

int table_columns(const struct table_in *t)
{
	return t->ncolumns;
}

const char *table_column_name(const struct table_in *t, int column)
{
	return t->column[column];
}

int table_find(const struct table_in *t, const char *column)
{
	int found = -1;

	for (int i = 0; i < t->ncolumns; i++) {
		if (strcmp(t->column[i], column) != 0)
			continue;
		if (found >= 0)
			die(EXIT_RUN, "%s: two columns '%s'", t->name, column);
		found = i;
	}
	return found;
}

/* What is wrong with a header whose columns are separated by other characters. */
static const char *wrong_separator(const struct table_in *t)
{
	for (int i = 0; i < t->ncolumns; i++) {
		if (strchr(t->column[i], ';'))
			return ": a TAB parts columns, not a semicolon";
		if (*t->blanks == ' ' && strchr(t->column[i], ','))
			return ": a TAB parts columns, not a comma";
	}
	return "";
}

/* The names of the first columns, for a message before the end. */
static char *list_columns(const struct table_in *t)
{
	char *list = xstrdup("");

	for (int i = 0; i < t->ncolumns && i < 8; i++) {
		char *longer = xprintf("%s%s'%.40s'", list, i ? " " : "", t->column[i]);

		free(list);
		list = longer;
	}
	return list;
}

int table_need(const struct table_in *t, const char *column)
{
	int i = table_find(t, column);

	if (i < 0 && t->ncolumns == 0)
		die(EXIT_RUN, "%s: empty, want %s", t->name, opt_reads());
	if (i < 0)
		die(EXIT_RUN, "%s: no column '%s' among %s%s", t->name, column,
			list_columns(t), wrong_separator(t));
	return i;
}

/* The header of a table appended by cat. */
static int is_header(const struct table_in *t)
{
	if (!t->headed)
		return 0;
	for (int i = 0; i < t->ncolumns; i++)
		if (strcmp(t->cell[i], t->column[i]) != 0)
			return 0;
	return 1;
}

int table_next(struct table_in *t)
{
	if (t->pending) {
		t->pending = 0;
		return 1;
	}
	for (;;) {
		int n;

		if (!next_line(t))
			return 0;
		n = cut(t, t->line, t->cell, t->ncolumns);
		if (n != t->ncolumns)
			die(EXIT_RUN, "%s: line %ld: want %d cells, got %d", t->name,
				t->number, t->ncolumns, n);
		if (!is_header(t))
			return 1;
		t->part++;
	}
}

long table_line(const struct table_in *t)
{
	return t->number;
}

double table_number(const struct table_in *t, int column)
{
	double v;

	if (column < 0)
		return NAN;
	if (!to_number(t->cell[column], &v))
		die(EXIT_RUN, "%s: line %ld: %s: '%.40s' is not a number%s", t->name,
			t->number, t->column[column], t->cell[column],
			is_comma_decimal(t->cell[column])
				? ": decimals are behind a point"
				: "");
	return v;
}

double table_positive(const struct table_in *t, int column)
{
	double v = table_number(t, column);

	if (!(v > 0) || !isfinite(v))
		die(EXIT_RUN, "%s: line %ld: %s is %g, want a positive number",
			table_name(t), table_line(t), table_column_name(t, column), v);
	return v;
}

long table_whole(const struct table_in *t, int column, double least, double most)
{
	double v = table_number(t, column);

	if (!(v >= least) || v > most || v != floor(v))
		die(EXIT_RUN, "%s: line %ld: %s is %.17g, want a whole number, %g to %g",
			table_name(t), table_line(t), table_column_name(t, column), v,
			least, most);
	return (long)v;
}

const char *table_text(const struct table_in *t, int column)
{
	return t->cell[column];
}

void table_close(struct table_in *t)
{
	if (t->f != stdin)
		fclose(t->f);
	for (int i = 0; i < t->ncolumns; i++)
		free(t->column[i]);
	free(t->column);
	free(t->cell);
	keys_free(&t->keys);
	upstream_free(&t->upstream);
	free(t->line);
	free(t);
}

/* Writer */

struct table_out *table_create(
	const char *path, const char *cmd, const char *units, const char *columns)
{
	struct table_out *t = xcalloc(1, sizeof *t);

	t->f = file_create(path, &t->name);
	t->head = xstrdup("");
	if (cmd)
		table_cmd(t, cmd);
	if (units)
		table_comment(t, "units", "%s", units);
	t->columns = xstrdup(columns);
	t->ncolumns = 1;
	for (char *s = t->columns; *s; s++) {
		if (*s == ' ') {
			*s = '\t';
			t->ncolumns++;
		}
	}
	return t;
}

static void check(const struct table_out *t)
{
	if (ferror(t->f))
		die(EXIT_RUN, "%s:", t->name);
}

static void write_head(struct table_out *t)
{
	if (!t->columns)
		return;
	fprintf(t->f, "%s%s\n", t->head, t->columns);
	free(t->columns);
	t->columns = NULL;
}

void table_comment(struct table_out *t, const char *key, const char *format, ...)
{
	char *value, *longer;
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(NULL, 0, format, ap);
	va_end(ap);
	value = xcalloc((size_t)n + 1, 1);
	va_start(ap, format);
	vsnprintf(value, (size_t)n + 1, format, ap);
	va_end(ap);
	if (t->columns || !t->ncolumns) {
		longer = xprintf("%s# %s: %s\n", t->head, key, value);
		free(t->head);
		t->head = longer;
	} else {
		fprintf(t->f, "# %s: %s\n", key, value);
	}
	free(value);
}

void table_cmd(struct table_out *t, const char *cmd)
{
	if (!cmd || (t->cmd && strcmp(t->cmd, cmd) == 0))
		return;
	free(t->cmd);
	t->cmd = xstrdup(cmd);
	table_comment(t, "cmd", "%s", cmd);
}

static void begin_cell(struct table_out *t)
{
	write_head(t);
	if (t->ncells++)
		putc('\t', t->f);
}

void table_put(struct table_out *t, double value)
{
	char text[NUMBER_TEXT];

	begin_cell(t);
	fputs(number_text(value, text), t->f);
}

void table_put_text(struct table_out *t, const char *text)
{
	begin_cell(t);
	fputs(text, t->f);
}

void table_end_row(struct table_out *t)
{
	if (t->ncells != t->ncolumns)
		die(EXIT_RUN, "%s: wrote %d cells to a row of %d", t->name, t->ncells,
			t->ncolumns);
	t->ncells = 0;
	putc('\n', t->f);
	check(t);
}

void table_put_row(struct table_out *t, const double *value, int n)
{
	for (int k = 0; k < n; k++)
		table_put(t, value[k]);
	table_end_row(t);
}

void table_flush(struct table_out *t)
{
	write_head(t);
	if (fflush(t->f))
		die(EXIT_RUN, "%s:", t->name);
}

void table_done(struct table_out *t)
{
	table_flush(t);
	check(t);
	if (t->f != stdout && fclose(t->f))
		die(EXIT_RUN, "%s:", t->name);
	free(t->head);
	free(t->cmd);
	free(t);
}
