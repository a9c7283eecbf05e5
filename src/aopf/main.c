/* aopf - adaptive-order particle filter of a degradation series, and the time it has left
 */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "filter_options.h"
#include "io/series.h"
#include "remaining_life.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *unit_column;

static const struct opt opts[] = {
	OPT_TABLE(outlook_end_rows),
	OPT_TABLE(filtering_rows),
	OPT_TABLE(outlook_model_rows),
	{ 0, "unit", OPT_TEXT, UNIT_NONE, &unit_column, 0, 0, "COLUMN",
		"column that tells units apart", NULL, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &filtering.seed, 0, 9e18, "N",
		"seed of the random numbers", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "aopf",
	"Filter a degradation series and predict the life it has left.", "[file]",
	"table: t y (or y alone: t is the row, from 0)",
	"table: one row per row read, flushed at once", opts };

/* What is kept of one unit between its rows. */
struct unit_state {
	struct adaptive *filter;
	struct outlook *outlook; /* NULL without a threshold */
	long rows;
};

struct units {
	struct unit_state *unit;
	int n;
};

static struct unit_state *find_unit(struct units *units, int number)
{
	struct unit_state *u;

	if (number < units->n)
		return &units->unit[number];
	units->unit = xrealloc(units->unit, (size_t)number + 1, sizeof *units->unit);
	u = &units->unit[units->n++];
	*u = (struct unit_state){ .filter = filtering_new(number) };
	if (!isnan(outlook_options.threshold))
		u->outlook = outlook_new(number, u->filter);
	return u;
}

static void step(struct unit_state *u, const struct series *in, struct table_out *out)
{
	double t = series_time(in), y = series_value(in), zero = outlook_options.zero;
	struct adaptive_row row;

	u->rows++;
	adaptive_step(u->filter, t, y - zero, &row);
	if (unit_column)
		table_put_text(out, series_unit_name(in));
	table_put(out, t);
	table_put(out, y);
	table_put(out, row.grey + zero);
	table_put(out, row.prediction + zero);
	table_put(out, row.state + zero);
	table_put(out, row.order);
	table_put(out, row.ess);
	if (u->outlook)
		outlook_put(u->outlook, t, y, &row, out);
	table_end_row(out);
	table_flush(out);
}

static char *column_names(void)
{
	char *names = xprintf(
		"%st y grey prediction state order ess", unit_column ? "unit " : "");
	char *all;

	if (isnan(outlook_options.threshold))
		return names;
	all = outlook_columns(names);
	free(names);
	return all;
}

/* Units of the columns written, when the input says "T Y"; NULL otherwise. */
static char *column_units(const char *read)
{
	char t[32], y[32], more, *units, *all;

	if (!read || strchr(read, ':') || sscanf(read, "%31s %31s %c", t, y, &more) != 2)
		return NULL;
	units = xprintf("%s%s %s %s %s %s 1 1", unit_column ? "1 " : "", t, y, y, y, y);
	if (isnan(outlook_options.threshold))
		return units;
	all = outlook_units(units, t);
	free(units);
	return all;
}

static void finish(struct units *units)
{
	for (int i = 0; i < units->n; i++) {
		struct unit_state *u = &units->unit[i];

		stats_add("rows", (double)u->rows);
		filtering_count(u->filter);
		outlook_free(u->outlook);
		adaptive_free(u->filter);
	}
	free(units->unit);
}

int main(int argc, char **argv)
{
	int operand = opt_parse(&prog, argc, argv);
	struct series *in;
	struct table_out *out;
	struct units units = { 0 };
	char *cmd, *names, *units_line;

	filtering_check();
	outlook_check();
	outlook_open(unit_column);
	in = series_open(argv[operand], unit_column);
	cmd = opt_cmd(table_key(series_table(in), "cmd"), NULL);
	names = column_names();
	units_line = column_units(table_key(series_table(in), "units"));
	out = table_create(NULL, cmd, units_line, names);
	table_comment(out, "seed", "%ld", filtering.seed);
	while (series_next(in))
		step(find_unit(&units, series_unit(in)), in, out);
	finish(&units);
	outlook_close();
	table_done(out);
	series_close(in);
	free(cmd);
	free(names);
	free(units_line);
	return shell_done(0);
}
