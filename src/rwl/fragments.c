#include "fragments.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/simulated.h"
#include "io/input.h"
#include "io/quantities.h"
#include "pump_options.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static double part_of(
	const char *option, const char **rest, enum unit unit, const char *what)
{
	const char *end, *wrong;
	double value;

	wrong = unit_parse(*rest, unit, ":", &value, &end);
	if (wrong)
		die(EXIT_USAGE, "--wear %s: %s %s", option, what, wrong);
	*rest = *end ? end + 1 : NULL;
	return value;
}

struct wear {
	struct table_in *table;
	const char *file;                        /* as given */
	int realisation, step, volume, diameter; /* columns */
	int class;
};

/* Dies if the rows of a table cannot be read as realisations. */
static void check_order(
	const struct partition *p, const char *file, enum partition_status status)
{
	if (status == PARTITION_MEMORY)
		die(EXIT_RUN, "out of memory");
	if (status == PARTITION_TWICE)
		die(EXIT_RUN,
			"%s: realisation %ld has a step twice: the numbers of joined ensembles must differ",
			file, partition_realisation(p));
	if (status == PARTITION_APART)
		die(EXIT_RUN,
			"%s: the rows of realisation %ld are not contiguous: sort the table by realisation",
			file, partition_realisation(p));
}

static void read_row(struct partition *p, const struct wear *w, long row)
{
	struct table_in *t = w->table;
	double r = w->realisation < 0 ? (double)row : table_number(t, w->realisation);
	double k = w->step < 0 ? 1 : table_number(t, w->step);
	double v = table_number(t, w->volume);

	if (!(r >= 0 && r <= 1e15 && r == floor(r)))
		die(EXIT_RUN,
			"%s: line %ld: realisation must be a whole number from 0 to 1e15",
			w->file, table_line(t));
	if (!(k >= 1 && k <= 1e6 && k == floor(k)))
		die(EXIT_RUN, "%s: line %ld: step must be a whole number from 1 to 1e6",
			w->file, table_line(t));
	if (!(v >= 0 && v <= 1e3))
		die(EXIT_RUN, "%s: line %ld: volume must be between 0 and 1000 m3",
			w->file, table_line(t));
	check_order(p, w->file,
		partition_fragment(p, w->class,
			&(struct realisation_cell){ (long)r, (long)k, table_part(t), v, 1,
				table_number(t, w->diameter) >= pump.critical_size }));
	stats_add("fragments_read", 1);
}

/* Properties of the fragments that a table states; NAN: not stated. */
struct physics {
	double area, pressure, distance;
};

static struct physics physics_of(const struct table_in *t)
{
	return (struct physics){ table_quantity(t, "nominal_area", UNIT_AREA),
		table_quantity(t, "nominal_pressure", UNIT_PRESSURE),
		table_quantity(t, "step_distance", UNIT_LENGTH) };
}

/* All parts of a table must be of the same fragments. */
static void check_part(const struct table_in *t, const struct physics *first)
{
	struct physics now = physics_of(t);

	if (quantity_differs(now.area, first->area))
		die(EXIT_RUN, "%s: line %ld: fragments of %g and of %g m2 in one table",
			table_name(t), table_line(t), first->area, now.area);
	if (quantity_differs(now.pressure, first->pressure))
		die(EXIT_RUN,
			"%s: line %ld: nominal pressures of %g and of %g Pa in one table: "
			"give each its own --wear",
			table_name(t), table_line(t), first->pressure, now.pressure);
	if (quantity_differs(now.distance, first->distance))
		die(EXIT_RUN, "%s: line %ld: steps of %g and of %g m in one table",
			table_name(t), table_line(t), first->distance, now.distance);
}

/* The options must not contradict the table. */
static void check_options(
	const char *option, const struct physics *told, double pressure, double *distance)
{
	if (quantity_differs(pressure, told->pressure))
		die(EXIT_USAGE,
			"--wear %s: the nominal pressure of the fragments is %g Pa",
			option, told->pressure);
	if (isnan(pump.fragment_area))
		pump.fragment_area = told->area;
	if (quantity_differs(pump.fragment_area, told->area))
		die(EXIT_USAGE, "--wear %s: fragments of %g m2, not of %g m2", option,
			told->area, pump.fragment_area);
	if (isnan(*distance))
		*distance = told->distance;
	if (quantity_differs(*distance, told->distance))
		die(EXIT_USAGE, "--wear %s: steps of %g m, not of %g m", option,
			told->distance, *distance);
}

/* Reads one --wear FILE[:PRESSURE[:AREA]] into a separate class. */
static void read_wear(struct partition *p, const char *option, char **cmd, char **doubt,
	double *distance)
{
	const char *colon = strchr(option, ':'), *rest = colon ? colon + 1 : NULL;
	char *file = xstrdup(option);
	double pressure = NAN, area = -1;
	int with_area;
	struct wear w = { .file = file };
	struct simulated simulated = { 0 };
	struct physics told;
	const char *why;
	long part;

	file[strcspn(file, ":")] = '\0';
	if (rest)
		pressure = part_of(option, &rest, UNIT_PRESSURE, "the pressure");
	with_area = rest != NULL;
	if (rest)
		area = part_of(option, &rest, UNIT_AREA, "the area");
	if (rest)
		die(EXIT_USAGE, "--wear %s: want FILE[:PRESSURE[:AREA]]", option);
	if (colon && !(pressure > 0 && isfinite(pressure)))
		die(EXIT_USAGE, "--wear %s: want a pressure above 0", option);
	if (with_area && !(area > 0 && isfinite(area)))
		die(EXIT_USAGE, "--wear %s: want an area above 0", option);
	w.table = table_with_comments(input_open(file), simulated_comment, &simulated);
	told = physics_of(w.table);
	check_options(option, &told, pressure, distance);
	if (isnan(pressure))
		pressure = told.pressure;
	w.realisation = table_find(w.table, "realisation");
	w.step = table_find(w.table, "step");
	w.volume = table_need_quantity(w.table, "volume", UNIT_VOLUME);
	w.diameter = isnan(pump.critical_size)
			     ? -1
			     : table_need_quantity(w.table, "diameter", UNIT_LENGTH);
	w.class =
		partition_class(p, table_find(w.table, "particle") >= 0, pressure, area);
	if (w.class < 0)
		die(EXIT_RUN, "out of memory");
	part = table_part(w.table);
	for (long row = 0; table_next(w.table); row++) {
		if (table_part(w.table) != part)
			check_part(w.table, &told);
		part = table_part(w.table);
		read_row(p, &w, row);
	}
	if (simulated.count > 0) {
		partition_simulated(p, w.class, simulated.lowest, simulated.last_step);
		partition_simulated(p, w.class, simulated.highest, simulated.last_step);
	}
	if (table_upstream(w.table))
		*cmd = xstrdup(table_upstream(w.table));
	why = table_doubt(w.table);
	if (why)
		*doubt = xstrdup(why);
	table_close(w.table);
	free(file);
}

/* The relative standard error of equal volumes, which sums round. */
static const double ROUNDING = 1e-14;

/* 1 if the ensemble of a class contains no information on the uncertainty of its mean. */
static int is_doubtful(const struct partition *p, int class, const char *file)
{
	double mean, error, n = partition_count(p, class, &mean, &error);

	if (n < 2)
		warn("%s: a single realisation: the uncertainty of its wear is unknown and not included",
			file);
	else if (!(mean > 0))
		warn("%s: none of %.0f realisations wore: its wear is assumed to be zero",
			file, n);
	else if (!(error > ROUNDING))
		warn("%s: %.0f realisations of equal volume: the uncertainty of the wear is unknown and not included",
			file, n);
	return n < 2 || !(error > ROUNDING);
}

struct partition *fragments_read(const struct opt_texts *files, long first_step,
	char **made_by, char **doubts, double *distance)
{
	struct partition *p =
		partition_new(pump.pair.area, first_step, !isnan(pump.critical_size));

	if (!p)
		die(EXIT_RUN, "out of memory");
	*distance = NAN;
	for (int i = 0; i < files->n; i++)
		read_wear(p, files->v[i], &made_by[i], &doubts[i], distance);
	return p;
}

int fragments_close(
	struct partition *p, const struct opt_texts *files, char *const *doubts)
{
	int doubtful = 0;
	enum partition_status status =
		partition_close(p, pump.fragment_area, pump.transition);
	const char *file = files->v[partition_culprit(p)];

	check_order(p, file, status);
	if (status == PARTITION_EMPTY)
		die(EXIT_RUN, "%s: no fragment in the steps from --first-step on", file);
	if (status == PARTITION_PRESSURE)
		die(EXIT_USAGE, "--wear %s: each of several tables requires a pressure",
			file);
	if (status == PARTITION_AREA)
		die(EXIT_USAGE, "--wear: the areas add up to more than --area %g m2",
			pump.pair.area);
	for (int i = 0; i < files->n; i++) {
		if (doubts[i])
			warn("%.*s: doubtful by its own account: %s",
				(int)strcspn(files->v[i], ":"), files->v[i], doubts[i]);
		doubtful |= is_doubtful(p, i, files->v[i]);
	}
	return doubtful;
}
