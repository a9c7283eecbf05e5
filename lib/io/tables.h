/* tables.h - tab-separated tables with '#' comment lines and a bare header line
 *
 * Columns are found by name.  A table that follows another in one stream (cat a b)
 * continues it: its comments and header are read as those of the first.
 *
 *	struct table_in *t = table_open(path);
 *	int cd = table_need(t, "diameter"), cr = table_find(t, "realisation");
 *	while (table_next(t)) {
 *		double d = table_number(t, cd);
 *		...
 */
#ifndef IO_TABLES_H
#define IO_TABLES_H

#include "io/input.h"
#include <stddef.h>

struct table_in;
struct table_out;

struct table_in *table_open(const char *path); /* NULL or "-": standard input */
struct table_in *table_from(struct input *in); /* takes ownership of an open input */
/* The same; passes every comment "# key: value" to take, except end marks. */
typedef void table_comment_taker(void *context, const char *key, const char *value);
struct table_in *table_with_comments(
	struct input *in, table_comment_taker *take, void *context);
/* 1 if all rows read so far are between the first line and the end mark of a table of
 * wearpipe. */
int table_marked(const struct table_in *t);
const char *table_name(const struct table_in *t);
/* Value of the latest "# key: value" line read so far, NULL if none. */
const char *table_key(const struct table_in *t, const char *key);
/* The pipeline that rebuilds everything read so far, NULL if unknown; valid until the
 * next call.  Output made of a whole table records it. */
const char *table_upstream(struct table_in *t);
/* Number of the part of the stream: a "# cmd:" line and a further header begin a new one.
 */
long table_part(const struct table_in *t);
int table_columns(const struct table_in *t);
const char *table_column_name(const struct table_in *t, int column);
int table_find(const struct table_in *t, const char *column); /* -1 if absent */
int table_need(const struct table_in *t, const char *column); /* dies naming it */
/* Moves to the next row; 0 at the end.  A row with too few or too many cells, a last line
 * without its newline, or a table of wearpipe without its end mark ends the program with
 * a message that names file and line. */
int table_next(struct table_in *t);
long table_line(const struct table_in *t); /* of the present row, from 1 */
/* Cell as a number; nan, NaN, NA and an empty cell are NAN; anything else that is
 * not a number dies.  A column below 0 gives NAN. */
double table_number(const struct table_in *t, int column);
/* Whether that cell is nan, NaN, NA or empty. */
int table_missing(const struct table_in *t, int column);
/* From then on table_number() multiplies the cells of the column by scale, and dies at a
 * further "# units:" line with other units. */
void table_set_scale(struct table_in *t, int column, double scale);
/* The same for a program that passes the cells on as text, under one header. */
void table_same_units(struct table_in *t);
/* The same for numbers above 0, and for integers from least to most; others die. */
double table_positive(const struct table_in *t, int column);
long table_whole(const struct table_in *t, int column, double least, double most);
/* Cell as text, valid until the next row. */
const char *table_text(const struct table_in *t, int column);
/* Dies if the present row has another value than the first in the column unit, if there
 * is one. */
void table_one_unit(struct table_in *t);
/* At the end: why the table is doubtful, as its comments "# doubtful: why" say, all that
 * differ as one text; NULL if it is not.  Valid until the next call and table_close(). */
const char *table_doubt(struct table_in *t);
const char *table_doubted(struct table_in *t); /* the same with a warning */
void table_close(struct table_in *t);

/* columns: names separated by blanks, "t y state"; units: one for each column, "1" for
 * plain numbers and text.  cmd may be NULL, and units where they follow as a comment. */
struct table_out *table_create(
	const char *path, const char *cmd, const char *units, const char *columns);
/* The same for a file that keeps its contents until table_done() has written all of the
 * table, beside it. */
struct table_out *table_replace(
	const char *path, const char *cmd, const char *units, const char *columns);
/* One more "# key: value" line, unless the key has this value already; before the first
 * row it is written above the header. */
void table_comment(struct table_out *t, const char *key, const char *format, ...)
	__attribute__((format(printf, 3, 4)));
/* A further "# cmd:" line where the pipeline that made the rows changes; nothing is
 * written when cmd is the same as before. */
void table_cmd(struct table_out *t, const char *cmd);
void table_put(struct table_out *t, double value); /* shortest that reads back; nan */
void table_put_text(struct table_out *t, const char *text);
void table_end_row(struct table_out *t); /* checks the number of cells */
/* The last n cells of a row, and its end. */
void table_put_row(struct table_out *t, const double *value, int n);
void table_flush(struct table_out *t);
/* Writes the end and checks that all was written; frees. */
void table_done(struct table_out *t);

#endif
