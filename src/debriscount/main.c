/* debriscount - how many particles of which sizes, by period: classes, codes, trend,
 * alarm */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "common/non_ferrous.h"
#include "common/periods.h"
#include "common/verdicts.h"
#include "groups.h"
#include "io/quantities.h"
#include "io/tables.h"
#include "num/sigmas.h"
#include "reports.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const outputs[] = { "classes", "codes", "trend", NULL };
static const char *const standards[] = { "own", "iso4406", "as4059", NULL };

static struct opt_list edges;
static double period = NAN, duration = NAN, density = NAN, d50 = NAN, threshold = NAN;
static double detection_exponent = 3, confidence = 0.95;
static int output, standard;
static const char *by;

static struct opt_list alarm_level;
static int alarm_mass;

static const struct opt opts[] = {
	{ 'o', "output", OPT_WORD, UNIT_NONE, &output, 0, 0, "classes|codes|trend",
		"what to print", outputs, 0 },
	{ 0, "classes", OPT_LIST, UNIT_LENGTH, &edges, 0, 1, "D,D,...",
		"lower limits of the size classes; the last class is open", NULL, 0 },
	{ 0, "standard", OPT_WORD, UNIT_NONE, &standard, 0, 0, "own|iso4406|as4059",
		"classes of a standard", standards, 0 },
	{ 0, "period", OPT_NUM, UNIT_TIME, &period, 1e-9, 1e12, "T",
		"one set of rows per period (default the whole record)", NULL, 0 },
	{ 0, "duration", OPT_NUM, UNIT_TIME, &duration, 1e-9, 1e12, "T",
		"duration of the record (default until its last particle)", NULL, 0 },
	{ 0, "by", OPT_TEXT, UNIT_NONE, &by, 0, 0, "COLUMN",
		"count separately for each value of this column: material, ...", NULL,
		0 },
	OPT_TABLE(non_ferrous_rows),
	OPT_TABLE(oil_rows),
	{ 0, "density", OPT_NUM, UNIT_DENSITY, &density, 1, 1e5, "RHO",
		"density of the particles, for masses", NULL, 0 },
	{ 0, "d50", OPT_NUM, UNIT_LENGTH, &d50, 1e-9, 1, "D",
		"size at which the sensor detects half of the particles (default detects all)",
		NULL, 0 },
	{ 0, "detection-threshold", OPT_NUM, UNIT_NONE, &threshold, 0.1, 1e6, "T",
		"detection threshold in standard deviations of the noise, with --d50",
		NULL, 0 },
	{ 0, "detection-exponent", OPT_NUM, UNIT_NONE, &detection_exponent, 0.1, 20, "N",
		"exponent of the diameter in the amplitude", NULL, 0 },
	OPT_TABLE(verdict_rows),
	{ 0, "confidence", OPT_NUM, UNIT_FRACTION, &confidence, 0.01, 0.9999, "C",
		"confidence level of the intervals", NULL, 0 },
	OPT_TABLE(report_rows),
	{ 0, "alarm", OPT_LIST, UNIT_NONE, &alarm_level, 0, 1e300, "LEVEL[:CLEAR]",
		"raise an alarm at LEVEL particles per hour, clear it below CLEAR", NULL,
		0 },
	{ 0, "alarm-mass", OPT_FLAG, UNIT_NONE, &alarm_mass, 0, 0, NULL,
		"levels of --alarm are in kg per hour", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "debriscount",
	"Count particles by size and time: classes, cleanliness codes, trends, alarms.",
	"[file]", "table: diameter [time1] [verdict] [sources]",
	"table: one row per period and class", opts };

static void check_options(void)
{
	if (standard && edges.n)
		die(EXIT_USAGE, "--classes and --standard exclude one another");
	if (output == REPORT_CODES && edges.n)
		die(EXIT_USAGE, "--output codes uses the sizes of the standards");
	if (isnan(d50) != isnan(threshold))
		die(EXIT_USAGE,
			"specify both --d50 and --detection-threshold, or neither");
	for (int k = 1; k < edges.n; k++)
		if (edges.v[k] <= edges.v[k - 1])
			die(EXIT_USAGE, "--classes: %g m is not above %g m", edges.v[k],
				edges.v[k - 1]);
	if (alarm_level.n == 2 && alarm_level.v[1] > alarm_level.v[0])
		die(EXIT_USAGE,
			"--alarm requires LEVEL:CLEAR with CLEAR not above LEVEL");
	opt_require("d50", "detection-exponent");
	if (density > 1 && density < 100 && opt_given_bare("density"))
		warn("--density %g kg/m3 is lighter than any particle: is %gg/cm3 meant?",
			density, density);
	if (alarm_mass && (!alarm_level.n || isnan(density)))
		die(EXIT_USAGE, "--alarm-mass requires --alarm and --density");
	if (non_ferrous_known() && (!by || strcmp(by, "class") != 0))
		die(EXIT_USAGE, "--non-ferrous requires --by class");
	report_check((enum report_kind)output, !isnan(period));
}

static struct report_par parameters(void)
{
	struct report_par par = { .output = (enum report_kind)output,
		.period = period,
		.duration = duration,
		.density = density,
		.alarm = alarm_level.n ? alarm_level.v[0] : INFINITY,
		.clear = alarm_level.n ? alarm_level.v[alarm_level.n - 1] : INFINITY,
		.alarm_mass = alarm_mass,
		.by = by,
		.equivalent = non_ferrous_known() ? non_ferrous_equivalent : NULL,
		.size = non_ferrous_known() ? non_ferrous_size : NULL };
	const double *from = edges.v;
	int n = edges.n;

	if (output == REPORT_CODES || standard) {
		int as4059 = standard == 2 || output == REPORT_CODES;

		from = as4059 ? as4059_size : iso4406_size;
		n = as4059 ? AS4059_SIZES : ISO4406_SIZES;
	}
	par.classes.detection = (struct detection){ isnan(d50) ? 0 : d50,
		isnan(threshold) ? 1 : threshold, detection_exponent };
	par.classes.confidence = confidence;
	par.edges = n > 0 ? n : 1;
	par.edge[0] = 0;
	memcpy(par.edge, from, (size_t)n * sizeof *from);
	return par;
}

/* The column of times; -1 if there is none. */
static int time_column(struct table_in *t)
{
	static const char *const names[] = { "time1", "time", "t" };
	int found = -1;

	for (int i = 0; i < 3 && found < 0; i++)
		found = table_find_quantity(t, names[i], UNIT_TIME);
	return found;
}

/* A particle that was at the first sensor before the record began, but is at the second
 * one in it, counts from the beginning. */
static double time_of(const struct table_in *t, int column, int second)
{
	double v = table_number(t, column);

	if (v < 0 && isfinite(v) && second >= 0 && table_number(t, second) >= 0)
		return 0;
	if (!isfinite(v) || v < 0)
		die(EXIT_RUN, "%s: line %ld: %s is %g, want a time of 0 or later",
			table_name(t), table_line(t), table_column_name(t, column), v);
	return v;
}

/* What is unknown of an unresolved section is nan. */
static double or_nan(const struct table_in *t, int column,
	double (*valid)(const struct table_in *, int))
{
	return isnan(table_number(t, column)) ? NAN : valid(t, column);
}

struct stretch_columns {
	int sources, diameter, diameter_se, most;
};

/* The unresolved section of the present row: its limits are three standard errors wide,
 * as those of duet.  Without them the sums are taken to be exact. */
static struct stretch stretch_of(
	const struct table_in *t, const struct stretch_columns *c)
{
	double d = or_nan(t, c->diameter, table_diameter);
	double number = or_nan(t, c->sources, table_positive);
	double se = table_number(t, c->diameter_se);

	if (c->most < 0)
		return (struct stretch){ number, d, d * pow(number, 1. / 6), d };
	/* the amplitude goes with the cube of the diameter */
	return (struct stretch){ number, d, or_nan(t, c->most, table_diameter),
		d * cbrt(1 + 3 * SIGMAS_SELDOM * se / d) };
}

/* Probability of detection below which a particle counts as more than a hundred. */
static const double HARDLY = 0.01;

/* A record without a stated duration whose particles begin so late by so small a chance
 * has begun later than 0. */
static const double UNLIKELY = 1e-6;

/* Reads all rows; returns the end of the record. */
static double count_rows(
	struct table_in *t, const struct detection *detection, struct groups *groups)
{
	int cd = table_need_quantity(t, "diameter", UNIT_LENGTH), ct = time_column(t);
	int cv = verdict_column(t), c2 = table_find_quantity(t, "time2", UNIT_TIME);
	const struct stretch_columns columns = { table_find(t, "sources"), cd,
		table_find_quantity(t, "diameter_se", UNIT_LENGTH),
		table_find_quantity(t, "diameter_most", UNIT_LENGTH) };
	/* The standard error of its middle gives the length of an unresolved section. */
	int ce = table_find_quantity(t, "time1_se", UNIT_TIME),
	    cb = by ? table_need(t, by) : -1;
	double first = INFINITY, last = 0, late = 0, number = 0, across = 0, begin = 0,
	       end = groups_next(groups), hardly = 0, diameter;
	long part = table_part(t), records = 1;

	if (ct < 0 && !isnan(period))
		die(EXIT_RUN, "%s: no column of times: --period needs time1, time or t",
			table_name(t));
	do {
		enum verdict v = verdict_of(t, cv);
		const char *name;
		double time;

		if (v == VERDICT_FOREIGN)
			continue;
		time = ct >= 0 ? time_of(t, ct, c2) : NAN;
		if (table_part(t) != part && ct >= 0 &&
			(isnan(duration) || !isnan(period)))
			die(EXIT_RUN,
				"%s: line %ld: another record begins: count each record separately",
				table_name(t), table_line(t));
		records += table_part(t) != part;
		part = table_part(t);
		if (time > duration)
			die(EXIT_RUN,
				"%s: line %ld: a particle at %g s, after --duration "
				"%g s",
				table_name(t), table_line(t), time, duration);
		if ((time - end) / period > PERIODS_MOST)
			die(EXIT_RUN,
				"%s: line %ld: %s is %g s, more than %d periods after the "
				"particle before: --period or the unit of time is wrong",
				table_name(t), table_line(t), table_column_name(t, ct),
				time, PERIODS_MOST);
		while (time >= end && !(end >= duration)) {
			groups_report(groups, begin, end, 1);
			begin = end;
			end = groups_next(groups);
		}
		late += time < begin;
		first = fmin(first, time);
		last = fmax(last, time);
		number++;
		name = cb < 0 ? "" : table_missing(t, cb) ? "nan" : table_text(t, cb);
		if (v == VERDICT_UNRESOLVED) {
			double half = ce >= 0 ? sqrt(3) * table_number(t, ce) : 0;
			const struct stretch stretch = stretch_of(t, &columns);

			across += !isnan(period) &&
				  (time - half < begin || time + half > end);
			groups_add_stretch(groups, name, &stretch);
			continue;
		}
		diameter = table_diameter(t, cd);
		hardly += detection_probability(detection, diameter) < HARDLY;
		groups_add(groups, name, diameter, v == VERDICT_SURE);
		stats_add("particles", 1);
	} while (table_next(t));
	if (late > 0) {
		warn("%.0f particles arrived after the end of their period and are counted in a later one",
			late);
		stats_set("particles_late", late);
		groups_doubtful(groups, "particles are counted after their period");
	}
	if (across > 0) {
		warn("%.0f sections that are not resolved reach beyond their period and are "
		     "counted in that of their middle: choose a longer --period",
			across);
		groups_doubtful(groups, "unresolved sections reach beyond their period");
	}
	/* Of particles at random times as many begin so late with this chance. */
	if (number > 0 && ct >= 0 && isnan(duration) &&
		pow(1 - first / last, number - 1) < UNLIKELY) {
		warn("no particle in the first %g s of %g s: times that do not begin at 0 make "
		     "%s; subtract their beginning, or specify --duration",
			first, last,
			isnan(period) ? "rates too low" : "empty periods and a trend");
		groups_doubtful(groups, "times do not begin at 0");
	}
	if (records > 1 && !isnan(duration))
		warn("%ld records are counted as one: --duration %g s is taken for all together",
			records, duration);
	if (hardly > 0) {
		warn("%.0f particles are of a size that the sensor detects in less than 1 %% "
		     "of cases: each counts as more than a hundred, or is none, or --d50 is "
		     "wrong",
			hardly);
		groups_doubtful(
			groups, "particles of a size that the sensor hardly detects");
	}
	return last;
}

int main(int argc, char **argv)
{
	int operand = opt_parse(&prog, argc, argv), more, status;
	struct report_par par;
	struct groups *groups;
	struct table_in *t;
	const char *why;
	double last = 0;

	check_options();
	t = table_open(argv[operand]);
	table_need(t, "diameter");
	more = table_next(t);
	par = parameters();
	par.cmd = opt_cmd(table_upstream(t), NULL);
	groups = groups_new(&par);
	if (more)
		last = count_rows(t, &par.classes.detection, groups);
	else if (isnan(duration))
		die(EXIT_RUN,
			"%s: no particle: specify the length of the record with --duration",
			table_name(t));
	if (isnan(duration) && isnan(period) && time_column(t) >= 0 && !(last > 0))
		die(EXIT_RUN,
			"%s: no particle after 0 s: specify the length of the record with --duration",
			table_name(t));
	if (isnan(duration) && isnan(period) && time_column(t) >= 0)
		warn("the record is taken to end with its last particle, at %g s; "
		     "specify --duration",
			last);
	if ((duration - last) / period > PERIODS_MOST)
		die(EXIT_USAGE,
			"--duration %g s is more than %d periods after the last particle: "
			"--period or the unit of time is wrong",
			duration, PERIODS_MOST);
	groups_finish(groups, time_column(t) >= 0 ? last : NAN);
	verdict_report();
	if (!non_ferrous_known() &&
		(edges.n || standard || output == REPORT_CODES || !isnan(density)) &&
		verdict_equivalent())
		groups_doubtful(
			groups, "the diameters of particles that are not ferrous");
	why = table_doubted(t);
	if (why)
		groups_doubtful(groups, why);
	table_close(t);
	status = groups_alarm(groups) ? EXIT_ALARM : groups_status(groups);
	groups_free(groups);
	free(par.cmd);
	return shell_done(status);
}
