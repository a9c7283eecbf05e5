#include "actions.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "cli/text.h"
#include "io/fields.h"
#include "io/tables.h"
#include <stdlib.h>
#include <string.h>

/* Comments of the header, as "key: value", in their order. */
struct head {
	int n;
	char **key, **value;
};

struct tables {
	struct table_out *out; /* NULL before the first header */
	char *columns, *units; /* of the first; units "" where it states none */
	struct head head;
};

static void take_comment(void *context, const char *key, const char *value)
{
	struct tables *t = context;
	struct head *h = &t->head;

	if (t->out) {
		table_comment(t->out, key, "%s", value);
		return;
	}
	h->key = xrealloc(h->key, (size_t)h->n + 1, sizeof *h->key);
	h->value = xrealloc(h->value, (size_t)h->n + 1, sizeof *h->value);
	h->key[h->n] = xstrdup(key);
	h->value[h->n++] = xstrdup(value);
}

static char *columns_of(const struct table_in *in)
{
	struct text names = { 0 };

	for (int i = 0; i < table_columns(in); i++)
		text_add(&names, "%s%s", i ? " " : "", table_column_name(in, i));
	return names.s;
}

static void join_table(struct tables *t, struct input *input)
{
	struct table_in *in = table_with_comments(input, take_comment, t);
	char *columns = columns_of(in);
	const char *units = table_key(in, "units");

	if (!columns)
		die(EXIT_RUN, "%s: empty, want a stream", table_name(in));
	table_same_units(in);
	if (!t->out) {
		t->columns = columns;
		t->units = xstrdup(units ? units : "");
		t->out = table_create(NULL, NULL, NULL, columns);
		for (int i = 0; i < t->head.n; i++)
			table_comment(t->out, t->head.key[i], "%s", t->head.value[i]);
	} else if (strcmp(columns, t->columns) != 0) {
		die(EXIT_RUN, "%s: columns '%s', want '%s' as in the table before",
			table_name(in), columns, t->columns);
	} else if (strcmp(units ? units : "", t->units) != 0) {
		die(EXIT_RUN, "%s: units '%s', want '%s' as in the table before",
			table_name(in), units ? units : "", t->units);
	} else {
		free(columns);
	}
	while (table_next(in)) {
		for (int i = 0; i < table_columns(in); i++)
			table_put_text(t->out, table_text(in, i));
		table_end_row(t->out);
		stats_add("rows", 1);
	}
	table_close(in);
}

static void end_tables(struct tables *t)
{
	table_done(t->out);
	for (int i = 0; i < t->head.n; i++) {
		free(t->head.key[i]);
		free(t->head.value[i]);
	}
	free(t->head.key);
	free(t->head.value);
	free(t->columns);
	free(t->units);
}

static void join_fields(struct fields_out *out, struct input *input, int more)
{
	struct fields_in *in = fields_from(input);
	struct record r = { 0 };

	while (fields_read(in, &r)) {
		fields_write(out, &r, fields_more(in) || more);
		stats_add("records", 1);
	}
	record_free(&r);
	fields_close(in);
}

void join_streams(int n, char **path)
{
	struct fields_out *out = NULL;
	struct tables tables = { 0 };

	for (int i = 0; i < n || i == 0; i++) {
		struct input *in = input_open(n ? path[i] : NULL);
		int fields = input_begins(in, "NRRD") || input_begins(in, "Gwyddion");

		if (input_begins(in, ".snd"))
			die(EXIT_RUN, "%s: a signal: signals cannot be joined",
				input_name(in));
		if (fields ? tables.out != NULL : out != NULL)
			die(EXIT_RUN, "%s: want %s as before, got %s", input_name(in),
				fields ? "a table" : "fields",
				fields ? "fields" : "a table");
		if (fields && !out)
			out = fields_create(NULL);
		if (fields)
			join_fields(out, in, i + 1 < n);
		else
			join_table(&tables, in);
	}
	if (out)
		fields_done(out);
	else
		end_tables(&tables);
}
