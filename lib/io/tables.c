#include "io/tables.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/text.h"
#include "cli/unit.h"
#include "cli/upstream.h"
#include "io/ends.h"
#include "io/input.h"
#include "io/keys.h"
#include "io/reasons.h"
#include "num/crc32.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_MOST = 1 << 24 }; /* bytes of a line */
static const char promise[] = "# stream: " ENDS_PROMISE "\n";
static const char end_line[] = "# end: ";

/* What a cell is multiplied by: by shifting its text where that is 10^ten, ten not 0. */
struct scale {
	double factor;
	int ten;
};

struct table_in {
	struct input *in;
	const char *name;
	char *line; /* the present row, cut into cells */
	size_t room, most, most_keys;
	long number; /* of that line, from 1 */
	int ncolumns;
	char **column;       /* names */
	struct scale *scale; /* of table_number(), or NULL */
	char **cell;
	const char *blanks; /* separator of the cells */
	int headed;         /* the table has a line of names */
	int pending;    /* the row read ahead by table_open() has not been returned yet */
	int stated;     /* units stand between the row before and this line */
	int unstated;   /* a further header came without units */
	int same_units; /* of all rows, see table_same_units() */
	struct keys keys;       /* of comment lines */
	struct reasons reasons; /* of the lines "# doubtful:" */
	table_comment_taker *take;
	void *context; /* of take */
	struct upstream upstream;
	long part;
	int promised;      /* an end must come */
	int unmarked;      /* a header or row came where no end was announced */
	long rows;         /* since the announcement */
	uint32_t checksum; /* of the lines since then */
	char *unit;        /* of the rows, see table_one_unit() */
};

struct table_out {
	FILE *f;
	const char *name;
	const char *path; /* of the file that fresh replaces; NULL: none */
	char *fresh;
	char *head;          /* comment lines not yet written */
	char *columns;       /* header line, NULL once written */
	struct keys written; /* comments so far */
	int ncolumns, ncells;
	char *row; /* the cells of the present row */
	size_t length, room;
	long rows;
	uint32_t checksum; /* of all lines so far */
};

/* Reader */

static char *trim(char *s)
{
	char *end = s + strlen(s);

	while (end > s && (end[-1] == ' ' || end[-1] == '\t'))
		*--end = '\0';
	return s + strspn(s, " \t");
}

/* Comments are free text; one that begins with a single word and a colon is a key. */
static void keep_key(struct table_in *t, char *comment)
{
	char *colon = strchr(comment, ':'), *value;

	if (!colon)
		return;
	*colon = '\0';
	comment = trim(comment);
	if (!*comment || comment[strcspn(comment, " \t")] || !strcmp(comment, "stream"))
		return;
	if (t->take)
		t->take(t->context, comment, trim(colon + 1));
	/* Names and units may be separated by TABs. */
	value = strcmp(comment, "cmd") ? xstrdup(trim(colon + 1))
				       : text_escape(trim(colon + 1));
	if ((t->scale || t->same_units) && !strcmp(comment, "units") &&
		(!table_key(t, "units") || strcmp(table_key(t, "units"), value) != 0))
		die(EXIT_RUN, "%s: line %ld: the units change within the table", t->name,
			t->number);
	if (!strcmp(comment, "units")) {
		t->stated = 1;
		t->unstated = 0;
	}
	keys_set(&t->keys, comment, value);
	/* records(1) ends a key of one record by one without a value. */
	if (!strcmp(comment, "doubtful") && *value)
		reasons_add(&t->reasons, value);
	free(value);
	if ((size_t)t->keys.n > t->most_keys)
		die(EXIT_RUN, "%s: line %ld: more than %zu keys", t->name, t->number,
			t->most_keys);
	if (!strcmp(comment, "cmd")) {
		upstream_add(&t->upstream, table_key(t, "cmd"));
		t->part++;
	}
}

/* A byte order mark, which spreadsheets write at the beginning of UTF-8 files. */
static const char byte_order_mark[] = "\xef\xbb\xbf";

/* The next line with its newline; returns its length, 0 at the end. */
static size_t read_line(struct table_in *t)
{
	size_t n = input_text_line(t->in, &t->line, &t->room, t->most, &t->number);

	if (n == 0)
		return 0;
	if (t->line[n - 1] == '\n')
		return n;
	if (file_followed())
		return 0;
	die(EXIT_RUN, "%s: line %ld: no newline at the end: the table is truncated",
		t->name, t->number);
}

/* A table that announces an end begins. */
static void begin_promised(struct table_in *t)
{
	if (t->promised)
		die(EXIT_RUN, "%s: line %ld: the preceding table has no '# end' line",
			t->name, t->number);
	input_whole(t->in, 0);
	t->promised = 1;
	t->rows = 0;
	t->checksum = 0;
}

static void check_end(struct table_in *t)
{
	long rows = -1;
	unsigned checksum = 0;
	int n = 0;

	sscanf(t->line + sizeof end_line - 1, "%ld rows, crc32 %8x\n%n", &rows, &checksum,
		&n);
	if (!t->promised && n > 0)
		die(EXIT_RUN,
			"%s: line %ld: the end of a table whose first line is missing",
			t->name, t->number);
	if (!t->promised)
		return;
	if (rows != t->rows || checksum != t->checksum)
		die(EXIT_RUN,
			"%s: line %ld: want %ld rows and crc32 %08x, got %ld and %08lx: "
			"damaged or edited; grep -v '^#' makes a plain table of it",
			t->name, t->number, rows, checksum, t->rows,
			(unsigned long)t->checksum);
	t->promised = 0;
	input_whole(t->in, 1);
}

/* Processes announcement, checksum and end; 1 if the line is for the caller. */
static int mind_end(struct table_in *t, size_t n)
{
	if (strcmp(t->line, promise) == 0)
		begin_promised(t);
	if (strncmp(t->line, end_line, sizeof end_line - 1) == 0) {
		check_end(t);
		return 0;
	}
	if (t->promised)
		t->checksum = crc32_add(t->checksum, t->line, n);
	return 1;
}

/* The next line that is neither empty nor a comment; 0 at the end. */
static int next_line(struct table_in *t)
{
	size_t n;

	while ((n = read_line(t)) > 0) {
		/* A stream is whole with a mark, or with converted line ends, too. */
		if (t->number == 1 && strncmp(t->line, byte_order_mark, 3) == 0)
			memmove(t->line, t->line + 3, (n -= 3) + 1);
		if (n > 1 && t->line[n - 2] == '\r')
			memcpy(t->line + --n - 1, "\n", 2);
		if (!mind_end(t, n))
			continue;
		t->line[--n] = '\0';
		if (n != strlen(t->line))
			die(EXIT_RUN, "%s: line %ld: NUL byte in a table", t->name,
				t->number);
		if (*t->line == '#')
			keep_key(t, t->line + 1);
		else if (n) {
			t->unmarked |= !t->promised;
			return 1;
		}
	}
	if (t->promised && !file_followed())
		die(EXIT_RUN,
			"%s: the table ends after %ld rows without its '# end' line: its writer did not finish",
			t->name, t->rows);
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

/* "2026-11-29" and more */
static int is_date(const char *s)
{
	return strspn(s, "0123456789") == 4 && s[4] == '-' &&
	       strspn(s + 5, "0123456789") == 2 && s[7] == '-';
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
	*v = decimal_parse(s, &end);
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
	return table_from(input_open(path));
}

struct table_in *table_from(struct input *in)
{
	return table_with_comments(in, NULL, NULL);
}

struct table_in *table_with_comments(
	struct input *in, table_comment_taker *take, void *context)
{
	struct table_in *t = xcalloc(1, sizeof *t);
	char *copy;

	t->in = in;
	t->take = take;
	t->context = context;
	t->name = input_name(t->in);
	t->most = input_limit("line", LINE_MOST);
	t->most_keys = input_limit("keys", KEYS_MOST);
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

int table_marked(const struct table_in *t)
{
	return !t->unmarked;
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

/* Advice for a header of another program, such as "Flow [L/min]" or "t;y". */
static const char *converter(const struct table_in *t)
{
	for (int i = 0; i < t->ncolumns; i++)
		if (strpbrk(t->column[i], ";[(") ||
			(*t->blanks == ' ' && strchr(t->column[i], ',')))
			return ": 'sigconvert --output table' makes a table of it";
	return "";
}

/* The names of the first columns, for a message before the end. */
static char *list_columns(const struct table_in *t)
{
	char *list = xstrdup("");

	for (int i = 0; i < t->ncolumns && i < 8; i++)
		list = xappend(list, "%s'%.40s'", i ? " " : "", t->column[i]);
	return list;
}

int table_need(const struct table_in *t, const char *column)
{
	int i = table_find(t, column);

	if (i < 0 && t->ncolumns == 0 && !strncmp(opt_reads(), "table", 5))
		die(EXIT_RUN, "%s: empty, want %s", t->name, opt_reads());
	if (i < 0 && t->ncolumns == 0)
		die(EXIT_RUN, "%s: empty, want a table with the column '%s'", t->name,
			column);
	if (i < 0)
		die(EXIT_RUN, "%s: no column '%s' among %s%s", t->name, column,
			list_columns(t), converter(t));
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

/* A table with units that is followed by one without: numbers of SI, or the same again?
 */
static void check_units(struct table_in *t)
{
	if (t->unstated) {
		int doubted = t->same_units && table_key(t, "units");

		for (int i = 0; t->scale && i < t->ncolumns; i++)
			doubted |= t->scale[i].factor != 1;
		if (doubted)
			die(EXIT_RUN,
				"%s: line %ld: the header before has no '# units', that of the table before has",
				t->name, t->number);
	}
	t->stated = t->unstated = 0;
}

int table_next(struct table_in *t)
{
	if (t->pending) {
		t->pending = 0;
		t->rows++;
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
		if (!is_header(t)) {
			check_units(t);
			t->rows++;
			return 1;
		}
		t->unstated = !t->stated;
		t->part++;
	}
}

long table_line(const struct table_in *t)
{
	return t->number;
}

int table_missing(const struct table_in *t, int column)
{
	return is_missing(table_text(t, column));
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
				? ": 'sigconvert --output table' reads decimal commas"
			: is_date(t->cell[column])
				? ": 'sigconvert --output table' reads dates"
				: "");
	if (!t->scale)
		return v;
	if (t->scale[column].ten != 0 && isfinite(v))
		return decimal_shift(
			t->cell[column], strlen(t->cell[column]), t->scale[column].ten);
	return v * t->scale[column].factor;
}

void table_set_scale(struct table_in *t, int column, double scale)
{
	int ten = scale > 0 ? (int)lround(log10(scale)) : 0;

	if (!t->scale) {
		t->scale = xcalloc((size_t)t->ncolumns, sizeof *t->scale);
		for (int i = 0; i < t->ncolumns; i++)
			t->scale[i].factor = 1;
	}
	t->scale[column] =
		(struct scale){ scale, decimal_shift("1", 1, ten) == scale ? ten : 0 };
}

void table_same_units(struct table_in *t)
{
	t->same_units = 1;
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

void table_one_unit(struct table_in *t)
{
	int column = table_find(t, "unit");

	if (column < 0)
		return;
	if (!t->unit)
		t->unit = xstrdup(t->cell[column]);
	if (strcmp(t->unit, t->cell[column]) != 0)
		die(EXIT_RUN, "%s: line %ld: unit '%s' after '%s': want rows of one unit",
			t->name, t->number, t->cell[column], t->unit);
}

const char *table_doubt(struct table_in *t)
{
	return reasons_text(&t->reasons);
}

const char *table_doubted(struct table_in *t)
{
	return reasons_warn(&t->reasons, table_name(t));
}

void table_close(struct table_in *t)
{
	input_close(t->in);
	for (int i = 0; i < t->ncolumns; i++)
		free(t->column[i]);
	free(t->column);
	free(t->scale);
	free(t->cell);
	keys_free(&t->keys);
	reasons_free(&t->reasons);
	upstream_free(&t->upstream);
	free(t->unit);
	free(t->line);
	free(t);
}

/* Writer */

static int words(const char *s)
{
	int n = 0;

	for (; *(s += strspn(s, " \t")); s += strcspn(s, " \t"))
		n++;
	return n;
}

static void begin(
	struct table_out *t, const char *cmd, const char *units, const char *columns)
{
	if (units && words(units) != words(columns))
		die(EXIT_RUN, "%d units for %d columns: %s", words(units), words(columns),
			columns);
	t->head = xstrdup(promise);
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
}

struct table_out *table_create(
	const char *path, const char *cmd, const char *units, const char *columns)
{
	struct table_out *t = xcalloc(1, sizeof *t);

	t->f = file_create(path, &t->name);
	begin(t, cmd, units, columns);
	return t;
}

struct table_out *table_replace(
	const char *path, const char *cmd, const char *units, const char *columns)
{
	struct table_out *t = xcalloc(1, sizeof *t);

	t->f = file_create_beside(path, &t->fresh);
	t->name = t->path = path;
	begin(t, cmd, units, columns);
	return t;
}

static void put_line(struct table_out *t, const char *line, size_t n)
{
	t->checksum = crc32_add(t->checksum, line, n);
	if (fwrite(line, 1, n, t->f) != n)
		die(EXIT_RUN, "%s:", t->name);
}

static void write_head(struct table_out *t)
{
	char *text;

	if (!t->columns)
		return;
	text = xprintf("%s%s\n", t->head, t->columns);
	put_line(t, text, strlen(text));
	free(text);
	free(t->columns);
	t->columns = NULL;
}

void table_comment(struct table_out *t, const char *key, const char *format, ...)
{
	char *value, *escaped, *line;
	const char *before;
	va_list ap;
	int n;

	va_start(ap, format);
	n = vsnprintf(NULL, 0, format, ap);
	va_end(ap);
	value = xcalloc((size_t)n + 1, 1);
	va_start(ap, format);
	vsnprintf(value, (size_t)n + 1, format, ap);
	va_end(ap);
	escaped = text_escape(value);
	free(value);
	before = keys_get(&t->written, key);
	if (before && strcmp(before, escaped) == 0) {
		free(escaped);
		return;
	}
	if (before && strcmp(key, "cmd") == 0)
		write_head(t); /* with the first pipeline, even if it wrote no row */
	keys_set(&t->written, key, escaped);
	line = xprintf("# %s: %s\n", key, escaped);
	if (t->columns || !t->ncolumns)
		t->head = xappend(t->head, "%s", line);
	else
		put_line(t, line, strlen(line));
	free(line);
	free(escaped);
}

void table_cmd(struct table_out *t, const char *cmd)
{
	if (cmd)
		table_comment(t, "cmd", "%s", cmd);
}

static void need_room(struct table_out *t, size_t n)
{
	if (t->length + n > t->room) {
		t->room = 2 * (t->length + n);
		t->row = xrealloc(t->row, t->room, 1);
	}
}

static void append(struct table_out *t, const char *text)
{
	size_t n = strlen(text);

	need_room(t, n + 1);
	memcpy(t->row + t->length, text, n + 1);
	t->length += n;
}

static void put_cell(struct table_out *t, const char *text)
{
	if (t->ncells++)
		append(t, "\t");
	append(t, text);
}

void table_put_text(struct table_out *t, const char *text)
{
	char *escaped = text_escape(text);

	put_cell(t, escaped);
	free(escaped);
}

void table_put(struct table_out *t, double value)
{
	need_room(t, 1 + NUMBER_TEXT);
	if (t->ncells++)
		t->row[t->length++] = '\t';
	t->length += number_write(value, t->row + t->length);
}

void table_end_row(struct table_out *t)
{
	if (t->ncells != t->ncolumns)
		die(EXIT_RUN, "%s: wrote %d cells to a row of %d", t->name, t->ncells,
			t->ncolumns);
	write_head(t);
	append(t, "\n");
	put_line(t, t->row, t->length);
	t->rows++;
	t->ncells = 0;
	t->length = 0;
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
	ends_check();
	write_head(t);
	fprintf(t->f, "%s%ld rows, crc32 %08lx\n", end_line, t->rows,
		(unsigned long)t->checksum);
	table_flush(t);
	if (ferror(t->f) || (t->f != stdout && fclose(t->f)))
		die(EXIT_RUN, "%s:", t->name);
	if (t->path)
		file_replace(t->fresh, t->path);
	free(t->head);
	keys_free(&t->written);
	free(t->row);
	free(t);
}
