/* wear-volume - volume worn off against time, from the particles that passed a sensor */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "cli/unit.h"
#include "common/non_ferrous.h"
#include "common/periods.h"
#include "common/verdicts.h"
#include "io/quantities.h"
#include "io/tables.h"
#include <math.h>
#include <stdlib.h>

static const double sphere = 0.52359877559829887; /* pi / 6 */
static double period = 1, time_scale = 1;

static const struct opt opts[] = {
	{ 0, "period", OPT_NUM, UNIT_TIME, &period, 1e-9, 1e12, "T",
		"time of the record between rows", NULL, 0 },
	{ 0, "time-scale", OPT_NUM, UNIT_NONE, &time_scale, 1e-12, 1e12, "K",
		"ratio of operating time to recorded time", NULL, 0 },
	OPT_TABLE(verdict_rows),
	OPT_TABLE(non_ferrous_rows),
	OPT_END,
};

static const struct prog prog = { "wear-volume", "Sum the volume of particles over time.",
	"[file]", "table: diameter, time1 [verdict] [sources] [class]",
	"table: t, y (volume)", opts };

struct columns {
	int time, diameter, verdict, sources;
};

static struct columns find_columns(struct table_in *t)
{
	struct columns c = { table_find_quantity(t, "time1", UNIT_TIME),
		table_need_quantity(t, "diameter", UNIT_LENGTH), verdict_column(t),
		table_find(t, "sources") };

	if (c.time < 0)
		c.time = table_find_quantity(t, "t", UNIT_TIME);
	if (c.time < 0)
		c.time = table_need(t, "time1");
	return c;
}

/* Time of the present row, which must not precede that of the row above. */
static double time_of(const struct table_in *t, int column, double before)
{
	double time = table_number(t, column);

	if (!isfinite(time))
		die(EXIT_RUN, "%s: line %ld: %s is %g, want a number", table_name(t),
			table_line(t), table_column_name(t, column), time);
	if (time < before)
		die(EXIT_RUN, "%s: line %ld: %s %.17g comes after %.17g: sort by time",
			table_name(t), table_line(t), table_column_name(t, column), time,
			before);
	return time;
}

/* Volume of the particles of the present row. */
static double volume_of(
	const struct table_in *t, const struct columns *c, enum verdict v, long *without)
{
	double d, many = 1;

	if (v == VERDICT_DOUBTFUL)
		return 0;
	if (isnan(table_number(t, c->diameter))) {
		++*without;
		return 0;
	}
	d = table_diameter(t, c->diameter);
	if (v == VERDICT_UNRESOLVED && c->sources >= 0)
		many = (double)table_whole(t, c->sources, 0, 1e15);
	stats_add("particles", many);
	d = verdict_diameter(t, d);
	return many * sphere * d * d * d;
}

/* The periods that are complete at this time, from the one that ends at *end on. */
static void put_until(
	struct table_out *out, double time, double volume, long long *rows, double *end)
{
	long long before = *rows;

	for (; time >= *end; *end = decimal_multiple((double)*rows + 1, period)) {
		const double row[2] = { *end * time_scale, volume };

		table_put_row(out, row, 2);
		++*rows;
	}
	if (*rows > before)
		table_flush(out);
}

/* Returns how many rows have no diameter. */
static long sum_rows(struct table_in *t, struct table_out *out)
{
	struct columns c = find_columns(t);
	double before = -INFINITY, volume = 0, end = decimal_multiple(1, period);
	long part = -1, without = 0;
	long long rows = 0;

	while (table_next(t)) {
		enum verdict v = verdict_of(t, c.verdict);
		double time;

		if (v == VERDICT_FOREIGN)
			continue;
		table_one_unit(t);
		time = time_of(t, c.time, before);
		if (part < 0)
			part = table_part(t);
		if (table_part(t) != part)
			die(EXIT_RUN,
				"%s: line %ld: another record begins: sum each record separately",
				table_name(t), table_line(t));
		if (time / period - (double)rows > PERIODS_MOST)
			die(EXIT_RUN,
				"%s: line %ld: %s %g is more than %d periods after the "
				"particle before: --period or the unit of time is wrong",
				table_name(t), table_line(t),
				table_column_name(t, c.time), time, PERIODS_MOST);
		before = time;
		put_until(out, time, volume, &rows, &end);
		volume += volume_of(t, &c, v, &without);
	}
	if (rows == 0 && part >= 0)
		warn("%s: no period of %g s is complete: the last particle is at %g s",
			table_name(t), period, before);
	stats_set("rows", (double)rows);
	stats_set("particles_without_diameter", (double)without);
	if (without > 0)
		warn("%s: rows ignored because they have no diameter: %ld", table_name(t),
			without);
	return without;
}

static int doubt(struct table_out *out, const char *why)
{
	table_comment(out, "doubtful", "%s", why);
	return 1;
}

int main(int argc, char **argv)
{
	int operand = opt_parse(&prog, argc, argv);
	struct table_in *t = table_open(argv[operand]);
	const char *start = table_key(t, "start");
	struct table_out *out;
	char *cmd;
	const char *own;
	int doubtful = 0;

	find_columns(t);
	cmd = opt_cmd(table_upstream(t), NULL);
	out = table_create(NULL, cmd, "s m3", "t y");
	if (start)
		table_comment(out, "start", "%s", start);
	if (sum_rows(t, out) > 0)
		doubtful = doubt(out, "rows without a diameter");
	verdict_report();
	if (verdict_equivalent())
		doubtful = doubt(out, "the diameters of particles that are not ferrous");
	own = table_doubted(t);
	if (own)
		doubtful = doubt(out, own);
	table_close(t);
	table_done(out);
	free(cmd);
	return shell_done(doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
