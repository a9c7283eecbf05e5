/* records - list, pick, count and convert the records of a field stream */
#include "actions.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "cli/unit.h"
#include "common/raw_layout.h"
#include "io/fields.h"
#include "io/gsf.h"
#include "io/reasons.h"
#include "io/tables.h"
#include "num/bytes.h"
#include "source.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum format { LIST, COUNT, NRRD, GSF, TEXT, TABLE, RAW };
static const char *const formats[] = { "list", "count", "nrrd", "gsf", "text", "table",
	"raw", NULL };

static int format = LIST;
static struct opt_list pick;
static const char *field, *raw_fields;
static int check, join, replay, pretty;

static const struct opt opts[] = {
	{ 'o', "output", OPT_WORD, UNIT_NONE, &format, 0, 0,
		"list|count|nrrd|gsf|text|table|raw", "output format", formats, 0 },
	{ 0, "pick", OPT_LIST, UNIT_COUNT, &pick, 1, 1e9, "K,...",
		"only these records, counted from 1", NULL, 1 },
	{ 0, "field", OPT_TEXT, UNIT_NONE, &field, 0, 0, "NAME", "only this field", NULL,
		0 },
	{ 0, "check", OPT_FLAG, UNIT_NONE, &check, 0, 0, NULL,
		"report whether a stream of any format is complete", NULL, 1 },
	{ 0, "replay", OPT_FLAG, UNIT_NONE, &replay, 0, 0, NULL,
		"run the pipeline recorded in a stream of any format", NULL, 1 },
	{ 0, "join", OPT_FLAG, UNIT_NONE, &join, 0, 0, NULL,
		"join streams of several processes into one", NULL, 1 },
	{ 0, "pretty", OPT_FLAG, UNIT_NONE, &pretty, 0, 0, NULL,
		"format a table for reading: units, four digits, aligned columns", NULL,
		1 },
	OPT_TABLE(raw_layer_rows),
	{ 0, "fields", OPT_TEXT, UNIT_NONE, &raw_fields, 0, 0, "NAME UNIT,...",
		"fields of a point of --raw (default one, height m)", NULL, 1 },
	OPT_END,
};

static const struct prog prog = { "records",
	"List, select, count, check and convert the records of a stream.", "[file ...]",
	"fields, or a table with --pretty", "table or fields", opts };

static int picked(long number)
{
	for (int i = 0; i < pick.n; i++)
		if ((long)pick.v[i] == number)
			return 1;
	return pick.n == 0;
}

static void keep_field(struct record *r, const struct source *in)
{
	char *cmd = opt_cmd(r->cmd, NULL);

	if (record_find(r, field) < 0)
		die(EXIT_RUN, "%s: record %ld: no field '%s'", source_name(in),
			source_count(in), field);
	for (int i = r->nfields - 1; i >= 0; i--)
		if (strcmp(r->name[i], field) != 0)
			record_drop(r, r->name[i]);
	free(r->cmd);
	r->cmd = cmd;
}

/* One row per field: its size and range. */
static void list_record(struct table_out *t, const struct record *r, long number)
{
	size_t n = (size_t)r->nx * (size_t)r->ny * (size_t)r->nz;

	for (int k = 0; k < r->nfields; k++) {
		double low = INFINITY, high = -INFINITY, sum = 0;

		for (size_t i = 0; i < n; i++) {
			low = fmin(low, r->data[k][i]);
			high = fmax(high, r->data[k][i]);
			sum += r->data[k][i];
		}
		table_put(t, (double)number);
		table_put(t, (double)r->realisation);
		table_put_text(t, r->name[k]);
		table_put_text(t, *r->unit[k] ? r->unit[k] : "1");
		table_put(t, r->nx);
		table_put(t, r->ny);
		table_put(t, r->nz);
		table_put(t, r->dx);
		table_put(t, r->dy);
		table_put(t, low);
		table_put(t, sum / (double)n);
		table_put(t, high);
		table_end_row(t);
	}
}

/* Adds why fields of a record may be wrong, by its keys.  Heights do not depend on the
 * contact. */
static void add_doubts(struct reasons *doubts, const struct record *r)
{
	const char *converged = record_get(r, "converged");

	reasons_add(doubts, record_get(r, "doubtful"));
	if (converged && strcmp(converged, "no") == 0 &&
		(r->nfields > 1 || record_find(r, "height") < 0))
		reasons_add(doubts, "a contact did not converge");
}

/* Rows of samples and an empty line after each field: gnuplot's matrix layout. */
static void print_text(const struct record *r)
{
	struct reasons doubts = { 0 };
	char text[NUMBER_TEXT];

	add_doubts(&doubts, r);
	if (reasons_text(&doubts))
		printf("# doubtful: %s\n", reasons_text(&doubts));
	reasons_free(&doubts);
	for (int k = 0; k < r->nfields; k++) {
		const double *x = r->data[k];

		printf("# %s %s\n", r->name[k], r->unit[k]);
		for (long iy = 0; iy < (long)r->ny * r->nz; iy++)
			for (int ix = 0; ix < r->nx; ix++)
				printf("%s%c", number_text(*x++, text),
					ix + 1 < r->nx ? '\t' : '\n');
		putchar('\n');
	}
}

static struct table_out *create_table(const struct record *r)
{
	struct table_out *t;
	char *columns = xstrdup(SOURCE_COLUMNS), *units = xstrdup("1 m m m");

	for (int k = 0; k < r->nfields; k++) {
		size_t before = strlen(units);

		columns = xappend(columns, " %s", r->name[k]);
		units = xappend(units, " %s", *r->unit[k] ? r->unit[k] : "1");
		for (char *s = units + before + 1; *s; s++)
			*s = *s == ' ' || *s == '\t' ? '_' : *s;
	}
	t = table_create(NULL, NULL, units, columns);
	free(columns);
	free(units);
	return t;
}

/* The records of one table have the same fields. */
static void check_fields(char **first, const struct record *r, const struct source *in)
{
	char *names = xstrdup("");

	for (int k = 0; k < r->nfields; k++)
		names = xappend(names, "%s%s", k ? ", " : "", r->name[k]);
	if (*first && strcmp(*first, names) != 0)
		die(EXIT_RUN,
			"%s: record %ld has fields %s, the first one %s: use "
			"--field or --pick",
			source_name(in), source_count(in), names, *first);
	free(*first);
	*first = names;
}

/* The output, and the keys written to it so far. */
struct output {
	struct fields_out *fields;
	struct table_out *table;
	char *names;           /* of the fields of a table */
	struct keys written;   /* of records in it */
	struct reasons doubts; /* of those written, by their own account */
	long records;
};

/* The keys of a record precede its rows; a key that only the record before had is written
 * without a value. */
static void put_keys(struct output *o, const struct record *r)
{
	char *cmd =
		r->cmd && !field ? opt_cmd(r->cmd, NULL) : xstrdup(r->cmd ? r->cmd : "");

	if (*cmd || keys_get(&o->written, "cmd"))
		table_comment(o->table, "cmd", "%s", cmd);
	if (*cmd)
		keys_set(&o->written, "cmd", cmd);
	free(cmd);
	for (int i = 0; i < o->written.n; i++)
		if (strcmp(o->written.key[i], "cmd") != 0 &&
			!record_get(r, o->written.key[i]))
			table_comment(o->table, o->written.key[i], "%s", "");
	for (int i = 0; i < r->keys.n; i++) {
		table_comment(o->table, r->keys.key[i], "%s", r->keys.value[i]);
		keys_set(&o->written, r->keys.key[i], r->keys.value[i]);
	}
}

/* Little-endian 64-bit floats: the fields of a point side by side, x fastest. */
static void put_raw(const struct record *r)
{
	size_t n = record_points(r);
	unsigned char bytes[8];

	for (size_t i = 0; i < n; i++)
		for (int k = 0; k < r->nfields; k++) {
			bytes_put_double_little(bytes, r->data[k][i]);
			if (fwrite(bytes, 1, sizeof bytes, stdout) != sizeof bytes)
				die(EXIT_RUN, "standard output:");
		}
}

/* One row per point, at the centre of its cell; layers lie at the depth z = iz dz. */
static void print_table(struct table_out *t, const struct record *r)
{
	size_t i = 0;

	for (int iz = 0; iz < r->nz; iz++) {
		for (int iy = 0; iy < r->ny; iy++) {
			for (int ix = 0; ix < r->nx; ix++, i++) {
				table_put(t, (double)r->realisation);
				table_put(t, (ix + 0.5) * r->dx);
				table_put(t, (iy + 0.5) * r->dy);
				table_put(t, iz * r->dz);
				for (int k = 0; k < r->nfields; k++)
					table_put(t, r->data[k][i]);
				table_end_row(t);
			}
		}
	}
}

static void check_picked(const struct source *in)
{
	for (int i = 0; i < pick.n; i++)
		if ((long)pick.v[i] > source_count(in))
			die(EXIT_RUN, "%s: no record %ld: there are %ld", source_name(in),
				(long)pick.v[i], source_count(in));
}

static void open_output(struct output *o)
{
	if (format == NRRD)
		o->fields = fields_create(NULL);
	if (format == RAW && isatty(STDOUT_FILENO))
		die(EXIT_USAGE, "not writing binary data to a terminal");
	if (format == LIST)
		o->table = table_create(NULL, NULL, "1 1 1 1 1 1 1 m m unit unit unit",
			"record realisation field unit nx ny nz dx dy min mean max");
}

/* Checked before anything is written: half an output would look complete. */
static void check_plane(const struct record *r, struct source *in)
{
	if (r->nfields != 1 || r->nz > 1 || pick.n > 1 ||
		(pick.n == 0 && source_more(in)))
		die(EXIT_USAGE, "GSF holds one plane field: use --pick and --field");
}

/* 1 if another record is to be written. */
static int picks_left(struct source *in)
{
	for (int i = 0; i < pick.n; i++)
		if ((long)pick.v[i] > source_count(in))
			return 1;
	return pick.n == 0 && source_more(in);
}

static void put_record(struct output *o, struct record *r, struct source *in)
{
	o->records++;
	add_doubts(&o->doubts, r);
	switch (format) {
	case LIST:
		list_record(o->table, r, source_count(in));
		break;
	case NRRD:
		fields_write(o->fields, r, picks_left(in));
		break;
	case GSF:
		check_plane(r, in);
		gsf_write(stdout, r, 0);
		break;
	case TEXT:
		print_text(r);
		break;
	case TABLE:
		check_fields(&o->names, r, in);
		if (!o->table)
			o->table = create_table(r);
		put_keys(o, r);
		print_table(o->table, r);
		break;
	case RAW:
		put_raw(r);
		break;
	default:
		break;
	}
}

/* Returns the exit status: 3 if the records are doubtful, and the output shows or holds
 * samples without the keys of their records. */
static int close_output(struct output *o, const char *name)
{
	const char *why = NULL;

	if (format == LIST || format == GSF || format == RAW)
		why = reasons_warn(&o->doubts, name);
	if (format == COUNT)
		printf("%ld\n", o->records);
	if (format == LIST && why)
		table_comment(o->table, "doubtful", "%s", why);
	if (o->fields)
		fields_done(o->fields);
	if (o->table)
		table_done(o->table);
	free(o->names);
	keys_free(&o->written);
	reasons_free(&o->doubts);
	return why ? EXIT_NOCONV : EXIT_SUCCESS;
}

/* There may be nothing to list or count, but not to convert. */
static int next_record(struct source *in, struct record *r)
{
	int may_be_empty = format == LIST || format == COUNT;

	return (!may_be_empty || source_more(in)) && source_read(in, r);
}

/* The values of --raw and --fields. */
static const struct raw_layout *layout(void)
{
	static struct raw_layout raw;
	const struct raw_layout *given = raw_given();

	if (!given)
		return NULL;
	raw = *given;
	raw.fields = raw_fields;
	return &raw;
}

static int convert(const char *path)
{
	struct source *in = source_open(path, layout());
	struct output out = { 0 };
	struct record r = { 0 };
	int status;

	open_output(&out);
	while (next_record(in, &r)) {
		if (!picked(source_count(in)))
			continue;
		if (field)
			keep_field(&r, in);
		put_record(&out, &r, in);
	}
	check_picked(in);
	status = close_output(&out, source_name(in));
	record_free(&r);
	source_close(in);
	stats_set("records", (double)out.records);
	return status;
}

int main(int argc, char **argv)
{
	int first = opt_parse(&prog, argc, argv), status = EXIT_SUCCESS;

	opt_require("raw", "fields");
	if (!join && argc - first > 1)
		die(EXIT_USAGE, "%s: one file at most, unless --join", argv[first + 1]);
	if (join)
		join_streams(argc - first, argv + first);
	else if (replay)
		status = replay_stream(argv[first]);
	else if (check)
		status = check_stream(argv[first]);
	else if (pretty)
		show_pretty(argv[first]);
	else
		status = convert(argv[first]);
	return shell_done(status);
}
