/* aopf - adaptive-order particle filter of a degradation series, and the time it has left
 */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "common/covariates.h"
#include "common/time_unit.h"
#include "filter_options.h"
#include "io/quantities.h"
#include "io/series.h"
#include "num/pool.h"
#include "units.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 4096 }; /* rows at a time with more than one thread */

static const char *unit_column, *clock_column, *save_file, *resume_file;
static int bare, json;
static long threads = 1;

static const struct opt opts[] = {
	OPT_TABLE(outlook_end_rows),
	OPT_TABLE(outlook_model_rows),
	OPT_HEADING("Monitoring"),
	OPT_TABLE(outlook_plant_rows),
	{ 0, "save", OPT_TEXT, UNIT_NONE, &save_file, 0, 0, "FILE",
		"write the state to FILE after each row", NULL, 1 },
	{ 0, "resume", OPT_TEXT, UNIT_NONE, &resume_file, 0, 0, "FILE",
		"continue from a state written by --save", NULL, 1 },
	OPT_HEADING("Input and output"),
	{ 0, "unit", OPT_TEXT, UNIT_NONE, &unit_column, 0, 0, "COLUMN",
		"column that identifies the unit", NULL, 0 },
	{ 0, "clock", OPT_TEXT, UNIT_NONE, &clock_column, 0, 0, "COLUMN",
		"column of the operating time", NULL, 0 },
	{ 0, "json", OPT_FLAG, UNIT_NONE, &json, 0, 0, NULL,
		"write a line of JSON for each row", NULL, 0 },
	{ 'j', "threads", OPT_INT, UNIT_COUNT, &threads, 1, 1024, "N",
		"threads for streams of many units; rows are then written in blocks",
		NULL, 1 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &filtering.seed, 0, 9e18, "N",
		"seed of the random numbers", NULL, 0 },
	{ 0, "lives-only", OPT_FLAG, UNIT_NONE, &bare, 0, 0, NULL,
		"leave out the particle filter and its columns", NULL, 0 },
	OPT_TABLE(filtering_rows),
	OPT_END,
};

static const struct prog prog = { "aopf",
	"Filter a degradation series and predict the remaining life.", "[file]",
	"table: t y (or y alone: t is the row, from 0)",
	"table: one row per row read, flushed at once", opts };

/* --- rows out ----------------------------------------------------------------------- */

struct sink {
	struct table_out *table; /* NULL: JSON */
	char **name;             /* of the columns, [n] */
	int n;
};

static void put_json(
	const struct sink *out, const struct outlook_row *in, const double *cell)
{
	int first = unit_column != NULL;
	char text[NUMBER_TEXT];

	putchar('{');
	if (first) {
		printf("\"%s\":\"", out->name[0]);
		for (const char *p = in->unit; *p; p++)
			if (*p == '"' || *p == '\\')
				printf("\\%c", *p);
			else if ((unsigned char)*p < ' ')
				printf("\\u%04x", (unsigned char)*p);
			else
				putchar(*p);
		printf("\",");
	}
	for (int i = first; i < out->n; i++) {
		double x = i == first       ? in->t
			   : i == first + 1 ? in->y
					    : cell[i - first - 2];

		printf("\"%s\":%s%s", out->name[i],
			isnan(x)   ? "null"
			: isinf(x) ? "\"inf\""
				   : number_text(x, text),
			i + 1 < out->n ? "," : "}\n");
	}
	fflush(stdout);
}

static void put_row(const struct sink *out, const struct outlook_row *in,
	const double *cell, int cells)
{
	if (!out->table) {
		put_json(out, in, cell);
		return;
	}
	if (unit_column)
		table_put_text(out->table, in->unit);
	table_put(out->table, in->t);
	table_put(out->table, in->y);
	table_put_row(out->table, cell, cells);
	table_flush(out->table);
}

static char *column_names(void)
{
	return outlook_columns(xprintf("%st y%s", unit_column ? "unit " : "",
		bare ? "" : " grey prediction state order ess"));
}

/* Units of the columns written. */
static char *column_units(const struct series *in)
{
	char y[UNIT_WORD], *units;

	table_unit_word(series_table(in), series_value_column(in), y);
	units = xprintf("%s%s %s", unit_column ? "1 " : "", timeunit_word(), y);
	if (!bare)
		units = xappend(units, " %s %s %s 1 1", y, y, y);
	return outlook_units(units);
}

static struct sink open_sink(const struct series *in)
{
	const char *start = table_key(series_table(in), "start");
	char *cmd = opt_cmd(table_key(series_table(in), "cmd"), NULL),
	     *units = column_units(in), *names = column_names();
	struct sink out = { 0 };

	if (json) {
		for (char *word = strtok(names, " "); word; word = strtok(NULL, " ")) {
			out.name =
				xrealloc(out.name, (size_t)out.n + 1, sizeof *out.name);
			out.name[out.n++] = xstrdup(word);
		}
	} else {
		out.table = table_create(NULL, cmd, units, names);
		table_comment(out.table, "seed", "%ld", filtering.seed);
		if (start)
			table_comment(out.table, "start", "%s", start);
	}
	free(cmd);
	free(units);
	free(names);
	return out;
}

static void close_sink(struct sink *out)
{
	if (out->table)
		table_done(out->table);
	for (int i = 0; i < out->n; i++)
		free(out->name[i]);
	free(out->name);
}

/* 1 where there is a reason.  The table says it too, since the exit status is lost in a
 * pipe. */
static int doubt(const struct sink *out, const char *why)
{
	if (why && out->table)
		table_comment(out->table, "doubtful", "%s", why);
	return why != NULL;
}

/* --- rows in ------------------------------------------------------------------------ */

/* Rows of several units; those of one unit follow each other by next. */
struct block {
	struct item {
		struct outlook_row in;
		struct machine *unit;
		int next; /* -1: the last */
	} * item;
	double *cell; /* [n][cells] */
	int n, room, cells;
	int *first, chains; /* first item of each unit in the block */
	int *last, lasts;   /* last item so far, by number of the unit; -1: none */
	struct units *units;
	struct pool *pool;
	const struct sink *out;
};

static struct block *pending; /* its rows are written if a later one is refused */

static void step_chain(void *context, size_t i, int worker)
{
	struct block *b = context;

	(void)worker;
	for (int k = b->first[i]; k >= 0; k = b->item[k].next)
		unit_step(b->item[k].unit, &b->item[k].in,
			b->cell + (size_t)k * (size_t)b->cells);
}

/* Links the last row of the block to those of its unit before. */
static void link_row(struct block *b)
{
	int k = b->n - 1, number = unit_number(b->item[k].unit);

	while (b->lasts <= number) {
		b->last = xrealloc(b->last, (size_t)b->lasts + 1, sizeof *b->last);
		b->last[b->lasts++] = -1;
	}
	b->item[k].next = -1;
	if (b->last[number] < 0)
		b->first[b->chains++] = k;
	else
		b->item[b->last[number]].next = k;
	b->last[number] = k;
}

static void finish_block(struct block *b)
{
	pending = NULL;
	pool_run(b->pool, (size_t)b->chains, step_chain, b);
	for (int k = 0; k < b->n; k++) {
		put_row(b->out, &b->item[k].in, b->cell + (size_t)k * (size_t)b->cells,
			b->cells);
		if (b->item[k].next < 0)
			unit_save(b->units, b->item[k].unit);
		b->last[unit_number(b->item[k].unit)] = -1;
	}
	b->n = b->chains = 0;
	pending = b;
}

static void finish_pending(void)
{
	if (pending)
		finish_block(pending);
}

static void read_rows(
	struct series *in, struct units *units, struct pool *pool, const struct sink *out)
{
	struct block b = { .room = pool ? BLOCK : 1,
		.cells = unit_cells(bare),
		.units = units,
		.pool = pool,
		.out = out };
	size_t room = (size_t)b.room;
	int clock = clock_column ? table_need(series_table(in), clock_column) : -1;
	long before = 0;

	if (clock >= 0)
		table_set_scale(
			series_table(in), clock, timeunit_ratio(series_table(in), clock));
	b.item = xcalloc(room, sizeof *b.item);
	b.cell = xcalloc(room, (size_t)(b.cells ? b.cells : 1) * sizeof *b.cell);
	b.first = xcalloc(room, sizeof *b.first);
	atexit(finish_pending);
	pending = &b;
	while (series_next(in)) {
		struct item *item = &b.item[b.n];
		double t = series_time(in);

		item->unit = units_find(units, series_unit(in), series_unit_name(in));
		item->in = (struct outlook_row){ t,
			clock < 0 ? t : table_number(series_table(in), clock),
			series_value(in), series_unit_name(in), { 0 } };
		covariates_read(series_table(in), item->in.load);
		if (!isfinite(item->in.clock))
			die(EXIT_RUN, "%s: line %ld: %s is missing or not finite",
				table_name(series_table(in)),
				table_line(series_table(in)), clock_column);
		if (!unit_takes(item->unit, &item->in, series_table(in))) {
			before++;
			continue;
		}
		b.n++;
		link_row(&b);
		if (b.n == b.room)
			finish_block(&b);
	}
	finish_block(&b);
	pending = NULL;
	if (series_units(in) == 0)
		warn("%s: no rows", table_name(series_table(in)));
	if (resume_file)
		stats_set("rows_before", (double)before);
	free(b.item);
	free(b.cell);
	free(b.first);
	free(b.last);
}

int main(int argc, char **argv)
{
	int operand = opt_parse(&prog, argc, argv), alarm, doubtful;
	struct units *units;
	struct pool *pool = NULL;
	struct series *in;
	struct sink out;
	char *options, *in_units;

	outlook_check(bare);
	if (threads > 1 && !(pool = pool_new((int)threads)))
		die(EXIT_RUN, "no %ld threads", threads);
	in = series_open(argv[operand], unit_column);
	outlook_open(in, unit_column, clock_column);
	units = units_new(bare);
	in_units = column_units(in);
	options = opt_cmd("", in_units);
	free(in_units);
	if (resume_file)
		units_resume(units, resume_file, options);
	if (save_file)
		units_keep(units, save_file, options);
	free(options);
	out = open_sink(in);
	read_rows(in, units, pool, &out);
	alarm = units_alarm(units);
	doubtful = doubt(
		&out, units_report(units) ? "lives or events, as a warning says" : NULL);
	doubtful |= doubt(&out, table_doubted(series_table(in)));
	doubtful |= doubt(&out, outlook_doubt());
	units_free(units);
	pool_free(pool);
	outlook_close();
	close_sink(&out);
	series_close(in);
	return shell_done(alarm ? EXIT_ALARM : doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
