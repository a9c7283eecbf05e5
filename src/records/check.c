#include "actions.h"
#include "cli/msg.h"
#include "io/fields.h"
#include "io/signals.h"
#include "io/tables.h"
#include <stdio.h>
#include <stdlib.h>

static long count_records(struct input *input, int *marked)
{
	struct fields_in *in = fields_from(input);
	struct record r = { 0 };
	long n;

	while (fields_read(in, &r))
		;
	record_free(&r);
	n = fields_count(in);
	*marked = fields_marked(in);
	fields_close(in);
	return n;
}

static long count_frames(struct input *input, int *marked)
{
	enum { FRAMES = 1024 };
	struct signal_in *in = signal_from(input);
	double *x = xcalloc((size_t)signal_format(in)->channels, FRAMES * sizeof *x);
	size_t n;
	long frames = 0;

	while ((n = signal_read(in, x, FRAMES)) > 0)
		frames += (long)n;
	*marked = signal_marked(in);
	signal_close(in);
	free(x);
	return frames;
}

static long count_rows(struct input *input, int *marked)
{
	struct table_in *in = table_from(input);
	long rows = 0;

	if (table_columns(in) == 0)
		die(EXIT_RUN, "%s: empty, want a stream", input_name(input));
	while (table_next(in))
		rows++;
	*marked = table_marked(in);
	table_close(in);
	return rows;
}

int check_stream(const char *path)
{
	struct input *in = input_open(path);
	const char *name = input_name(in), *what;
	int marked;
	long n;

	if (input_begins(in, "NRRD") || input_begins(in, "Gwyddion")) {
		what = "fields: records";
		n = count_records(in, &marked);
	} else if (input_begins(in, ".snd")) {
		what = "signal: frames";
		n = count_frames(in, &marked);
	} else {
		what = "table: rows";
		n = count_rows(in, &marked);
	}
	printf("%s: %s %ld, %s\n", name, what, n,
		marked ? "whole"
		       : "no mark of an end: nobody can tell whether it is whole");
	return marked ? EXIT_SUCCESS : EXIT_NOCONV;
}
