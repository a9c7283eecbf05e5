/* rwl - remaining wear life from fragments' wear and the state observed */
#include "life/leakage.h"
#include "life/metrics.h"
#include "life/observed.h"
#include "life/partition.h"
#include "life/paths.h"
#include "life/rate.h"
#include "life/remaining.h"
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum quantity { AUTO, LEAKAGE, GAP, VOLUME, DEBRIS };
static const char *const quantities[] = { "auto", "leakage", "gap", "volume", "debris",
	NULL };
static const char *const rules[] = { "mean", "last", "filter", NULL };
static const char *const size_sets[] = { "all", "step", NULL };
static const char *const time_units[] = { "s", "min", "h", "d", NULL };
static const double time_scale[] = { 1, 60, 3600, 86400 };

static struct opt_texts wear_files, calibrations;
static const char *state_file, *unit_text, *rates_file;
static double threshold_gap = NAN, threshold_volume = NAN, threshold_leakage = NAN;
static double critical_size = NAN, critical_probability = 0.05;
static double area = 2346.3e-6, fragment_area = 1e-8;
static struct leakage pump;
static struct opt_list radii = { .n = 4 };
static struct opt_list ports = { 2, { 0.15e6, 21e6 } };
static struct opt_list levels = { 3, { 0.05, 0.5, 0.95 } };
static double initial_gap = NAN, transition = 0.1, step_time = NAN;
static double state_error, skip, eol = NAN, cone = 0.2, horizon = NAN;
static double archard = NAN, hardness = 1.065e9, speed = 20.94;
static long seed = 1, first_path, count = 1000, first_step = 1, parts;
static int quantity = AUTO, rule = RATE_MEAN, size_set, time_unit, samples, grey, new;

static const struct opt opts[] = {
	{ 'w', "wear", OPT_TEXTS, UNIT_NONE, &wear_files, 0, 0, "FILE[:PRESSURE[:AREA]]",
		"particles or volumes worn off fragments under a nominal pressure", 0,
		0 },
	{ 'x', "state", OPT_TEXT, UNIT_NONE, &state_file, 0, 0, "FILE",
		"observed leakage, gap, volume or debris; the operand says the same", 0,
		1 },
	{ 'N', "new", OPT_FLAG, UNIT_NONE, &new, 0, 0, 0,
		"read no state: the life of a new pair", 0, 0 },
	{ 'y', "quantity", OPT_WORD, UNIT_NONE, &quantity, 0, 0,
		"auto|leakage|gap|volume|debris", "what the state is", quantities, 0 },
	{ 'u', "state-unit", OPT_TEXT, UNIT_NONE, &unit_text, 0, 0, "UNIT",
		"unit of the state, where not SI: L/min", 0, 0 },
	{ 'X', "state-error", OPT_NUM, UNIT_NONE, &state_error, 0, 1e300, "SD",
		"standard error of the state, in its unit", 0, 0 },
	{ 't', "time-unit", OPT_WORD, UNIT_NONE, &time_unit, 0, 0, "s|min|h|d",
		"unit of the times read", time_units, 0 },
	{ 'g', "threshold-gap", OPT_NUM, UNIT_LENGTH, &threshold_gap, 1e-12, 1, "H",
		"failure at this gap", 0, 0 },
	{ 'Q', "threshold-leakage", OPT_NUM, UNIT_FLOW, &threshold_leakage, 1e-15, 1e3,
		"Q",
		"failure at this leakage of the pump [2.8 L/min if no threshold is given]",
		0, 0 },
	{ 'o', "threshold-volume", OPT_NUM, UNIT_VOLUME, &threshold_volume, 1e-30, 1e3,
		"V", "failure at this volume worn", 0, 0 },
	{ 'd', "critical-size", OPT_NUM, UNIT_LENGTH, &critical_size, 1e-12, 1, "D",
		"failure by particles of at least this diameter", 0, 0 },
	{ 'P', "critical-probability", OPT_NUM, UNIT_FRACTION, &critical_probability,
		1e-12, 1, "P", "their share, by number, at failure", 0, 0 },
	{ 'b', "sizes", OPT_WORD, UNIT_NONE, &size_set, 0, 0, "all|step",
		"share among all particles so far or those of a step", size_sets, 0 },
	{ 'R', "wear-rate", OPT_WORD, UNIT_NONE, &rule, 0, 0, "mean|last|filter",
		"rate by (4-29), by (4-28), or followed by filters", rules, 0 },
	{ 'p', "step-time", OPT_NUM, UNIT_TIME, &step_time, 1e-15, 1e15, "T",
		"time that one step of the fragments stands for [from the state so far]",
		0, 0 },
	{ 'C', "calibrate", OPT_TEXTS, UNIT_NONE, &calibrations, 0, 0, "FILE",
		"take the step time from the whole life of an earlier unit", 0, 0 },
	{ 'k', "first-step", OPT_INT, UNIT_COUNT, &first_step, 1, 1e6, "K",
		"steps before are running-in and count not for the rate", 0, 0 },
	{ 'T', "skip", OPT_NUM, UNIT_TIME, &skip, 0, 1e300, "T",
		"run-in left out of all rates observed, from the first row", 0, 0 },
	{ 'n', "parts", OPT_INT, UNIT_COUNT, &parts, 0, 1e9, "N",
		"parts of a class that wear independently; 0: as many as fit", 0, 0 },
	{ 'A', "area", OPT_NUM, UNIT_AREA, &area, 1e-18, 1e6, "A", "nominal contact area",
		0, 0 },
	{ 'B', "fragment-area", OPT_NUM, UNIT_AREA, &fragment_area, 1e-24, 1e6, "A",
		"area of a fragment", 0, 0 },
	{ 'Z', "transition", OPT_NUM, UNIT_FRACTION, &transition, 0, 1, "SHARE",
		"share of the area in the zone of linear pressure", 0, 0 },
	{ 'i', "initial-gap", OPT_NUM, UNIT_LENGTH, &initial_gap, 0, 1, "H",
		"gap when new [first one observed, else that of 1.5 L/min]", 0, 0 },
	{ 'a', "alpha0", OPT_NUM, UNIT_ANGLE, &pump.alpha0, 1e-9, 6.283185307179587, "A",
		"angle of the ports in (4-30)", 0, 0 },
	{ 'r', "leak-ratio", OPT_NUM, UNIT_FRACTION, &pump.ratio, 1e-9, 1, "R",
		"share of this pair in the pump's leakage", 0, 0 },
	{ 'L', "radii", OPT_LIST, UNIT_LENGTH, &radii, 1e-9, 1e3, "R1,R2,R3,R4",
		"radii of the sealing lands", 0, 0 },
	{ 'D', "ports", OPT_LIST, UNIT_PRESSURE, &ports, 0, 1e12, "PIN:POUT",
		"inlet and outlet pressure", 0, 0 },
	{ 'm', "viscosity", OPT_NUM, UNIT_VISCOSITY, &pump.viscosity, 1e-12, 1e6, "MU",
		"dynamic viscosity", 0, 0 },
	{ 'E', "archard", OPT_NUM, UNIT_NONE, &archard, 1e-30, 1, "K",
		"add a column: dry sliding with this wear coefficient", 0, 0 },
	{ 'K', "hardness", OPT_NUM, UNIT_PRESSURE, &hardness, 1, 1e15, "H",
		"hardness of --archard", 0, 0 },
	{ 'U', "speed", OPT_NUM, UNIT_SPEED, &speed, 1e-12, 1e6, "V",
		"sliding speed of --archard", 0, 0 },
	{ 'G', "grey", OPT_FLAG, UNIT_NONE, &grey, 0, 0, 0,
		"add a column: grey model of the state observed", 0, 0 },
	{ 'q', "levels", OPT_LIST, UNIT_FRACTION, &levels, 0, 1, "P,...",
		"quantiles to print", 0, 0 },
	{ 'O', "samples", OPT_FLAG, UNIT_NONE, &samples, 0, 0, 0,
		"print every path instead of the summary", 0, 0 },
	{ 'W', "rates", OPT_TEXT, UNIT_NONE, &rates_file, 0, 0, "FILE",
		"write the component's wear per step, one row per path", 0, 1 },
	{ 'H', "horizon", OPT_NUM, UNIT_TIME, &horizon, 0, 1e18, "T",
		"what lives longer counts as no failure [none; 10 x age for filters on their own]",
		0, 0 },
	{ 'e', "eol", OPT_NUM, UNIT_TIME, &eol, 1e-18, 1e18, "T",
		"true end of life: add scores of the predictions", 0, 0 },
	{ 'l', "cone", OPT_NUM, UNIT_FRACTION, &cone, 1e-6, 10, "ALPHA",
		"half-width of the alpha-lambda test", 0, 0 },
	{ 'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 1e7, "N", "Monte-Carlo paths", 0,
		0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first_path, 0, 4e9, "K",
		"number of the first one", 0, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "random seed", 0, 0 },
	OPT_END
};

static const struct prog prog = { "rwl",
	"Predict the remaining wear life of a sliding pair as a distribution.", "[state]",
	"tables: particles or volumes of fragments (--wear); state",
	"table: one row per observation time", opts };

/* The state as it is read: everything is turned into a gap. */
struct state {
	struct table_in *table;
	int time_column, value_column;
	int quantity;
	int filtered;  /* read from the column state */
	double scale;  /* of the value to SI */
	double debris; /* volume of the particles so far */
	long rows;
	double first_t;       /* of the first row */
	double t, gap, value; /* latest row; gap and value NAN where missing */
	double gap_error;     /* standard error of the gap */
};

static char *made_by[OPT_TEXTS_MAX]; /* what each --wear says of how it was made */
static double gap_new = NAN;         /* NAN: the first one observed */
static double dry_rate = NAN;        /* of --archard, m3/s */

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

/* Reads one --wear FILE[:PRESSURE[:AREA]] into a class of its own. */
static void read_wear(struct partition *p, const char *option, char **cmd)
{
	const char *colon = strchr(option, ':'), *rest = colon ? colon + 1 : NULL;
	char *file = xstrdup(option);
	double pressure = NAN, share = -1;
	struct table_in *t;
	int class, realisation, step, volume, diameter, sparse;
	enum partition_status status;

	if (rest)
		file[colon - option] = '\0';
	if (rest)
		pressure = part_of(option, &rest, UNIT_PRESSURE, "the pressure");
	if (rest)
		share = part_of(option, &rest, UNIT_AREA, "the area");
	t = table_open(file);
	realisation = table_find(t, "realisation");
	step = table_find(t, "step");
	volume = table_need(t, "volume");
	sparse = table_find(t, "particle") >= 0;
	diameter = isnan(critical_size) ? -1 : table_need(t, "diameter");
	class = partition_class(p, sparse, pressure, share);
	for (long row = 0; table_next(t); row++) {
		double r = realisation < 0 ? (double)row : table_number(t, realisation);
		double k = step < 0 ? 1 : table_number(t, step),
		       v = table_number(t, volume);

		if (!(r >= 0 && r <= 4294967295. && r == floor(r)))
			die(EXIT_RUN, "%s: line %ld: realisation must be a whole number",
				file, table_line(t));
		if (!(k >= 1 && k <= 1e6 && k == floor(k)))
			die(EXIT_RUN,
				"%s: line %ld: step must be a whole number from 1 to 1e6",
				file, table_line(t));
		if (!(v >= 0 && v <= 1e3))
			die(EXIT_RUN,
				"%s: line %ld: volume must lie within 0 and 1000 m3",
				file, table_line(t));
		status = partition_fragment(p, class, (long)r, (long)k, v, 1,
			table_number(t, diameter) >= critical_size);
		if (status == PARTITION_MEMORY)
			die(EXIT_RUN, "out of memory");
		if (status == PARTITION_TWICE)
			die(EXIT_RUN, "%s: line %ld: realisation %g has step %g twice",
				file, table_line(t), r, k);
		stats_add("fragments_read", 1);
	}
	if (table_key(t, "cmd"))
		*cmd = xstrdup(table_key(t, "cmd"));
	table_close(t);
	free(file);
}

static struct partition *read_partition(void)
{
	struct partition *p = partition_new(fragment_area, area);
	enum partition_status status;

	if (!p)
		die(EXIT_RUN, "out of memory");
	for (int i = 0; i < wear_files.n; i++)
		read_wear(p, wear_files.v[i], &made_by[i]);
	status = partition_close(p, transition, first_step);
	switch (status) {
	case PARTITION_OK:
		break;
	case PARTITION_EMPTY:
		die(EXIT_RUN, "%s: no fragment from step %ld on",
			wear_files.v[partition_culprit(p)], first_step);
	case PARTITION_TWICE:
		die(EXIT_RUN, "%s: a realisation has the same step twice",
			wear_files.v[partition_culprit(p)]);
	case PARTITION_PRESSURE:
		die(EXIT_USAGE,
			"--wear %s: each of several tables needs a pressure of its own",
			wear_files.v[partition_culprit(p)]);
	case PARTITION_AREA:
		die(EXIT_USAGE, "--wear: the areas add up to more than --area %g m2",
			area);
	case PARTITION_MEMORY:
		die(EXIT_RUN, "out of memory");
	}
	return p;
}

static void open_state(struct state *s, const char *file)
{
	static const char *const columns[] = { "", "leakage", "gap", "volume",
		"diameter" };
	struct table_in *t = table_open(file);
	const char *wrong, *end;

	*s = (struct state){ .table = t, .quantity = quantity, .scale = 1 };
	s->time_column = table_find(t, "t");
	if (s->time_column < 0)
		s->time_column = table_find(t, "time1");
	if (s->time_column < 0)
		s->time_column = table_need(t, "t");
	s->value_column = table_find(t, "state");
	for (int q = LEAKAGE; q <= DEBRIS && s->quantity == AUTO && s->value_column < 0;
		q++)
		if (table_find(t, columns[q]) >= 0)
			s->quantity = q;
	if (s->quantity == AUTO)
		s->quantity = LEAKAGE;
	s->filtered = s->value_column >= 0 && s->quantity != DEBRIS;
	if (!s->filtered)
		s->value_column = table_find(t, columns[s->quantity]);
	if (s->value_column < 0)
		s->value_column = table_find(t, "y");
	if (s->value_column < 0)
		s->value_column = table_need(t, columns[s->quantity]);
	if (unit_text) {
		char *one = xprintf("1%s", unit_text);

		wrong = unit_parse(one, UNIT_ANY, "", &s->scale, &end);
		if (wrong)
			die(EXIT_USAGE, "--state-unit %s: %s", unit_text, wrong);
		free(one);
	}
}

/* Gap that a value of the state tells. */
static double to_gap(const struct state *s, double value)
{
	switch (s->quantity) {
	case GAP:
		return value;
	case VOLUME:
	case DEBRIS:
		return (isnan(gap_new) ? 0 : gap_new) + value / area;
	default:
		return leakage_gap(&pump, value);
	}
}

static const double sphere = 0.52359877559829887; /* pi / 6 */

/* The next row; 0 at the end.  Times must grow, but particles may come together. */
static int next_state(struct state *s)
{
	struct table_in *t = s->table;
	double time, value, error = state_error * s->scale;

	if (!table_next(t))
		return 0;
	time = table_number(t, s->time_column) * time_scale[time_unit];
	value = table_number(t, s->value_column) * s->scale;
	if (!isfinite(time))
		die(EXIT_RUN, "%s: line %ld: the time is missing", table_name(t),
			table_line(t));
	if (time < 0 && s->quantity >= VOLUME)
		die(EXIT_RUN, "%s: line %ld: time %g s is before the pair was new",
			table_name(t), table_line(t), time);
	if (s->rows++ > 0 && (s->quantity == DEBRIS ? time < s->t : time <= s->t))
		die(EXIT_RUN, "%s: line %ld: time %g s does not grow", table_name(t),
			table_line(t), time);
	if (value < 0 && s->filtered)
		value = 0; /* a filter's idea of nothing worn */
	if (value < 0 || isinf(value))
		die(EXIT_RUN, "%s: line %ld: %g is not a %s", table_name(t),
			table_line(t), value, quantities[s->quantity]);
	if (s->rows == 1)
		s->first_t = time;
	s->t = time;
	if (s->quantity == DEBRIS && !isnan(value))
		value = s->debris += sphere * value * value * value;
	s->value = value;
	s->gap = to_gap(s, value);
	s->gap_error = (to_gap(s, value + error) - to_gap(s, value - error)) / 2;
	return 1;
}

/* Slope of the gap over the whole life of an earlier unit, by least squares, m/s. */
static double slope_of(const char *file)
{
	struct state s;
	double mean_t = 0, mean_h = 0, tt = 0, th = 0, slope;
	long n = 0;

	open_state(&s, file);
	while (next_state(&s)) {
		double dt = s.t - mean_t, dh = s.gap - mean_h;

		if (isnan(s.gap) || s.t - s.first_t < skip)
			continue;
		n++;
		mean_t += dt / (double)n;
		mean_h += dh / (double)n;
		tt += dt * (s.t - mean_t);
		th += dt * (s.gap - mean_h);
	}
	slope = th / tt;
	if (!(slope > 0) || !isfinite(slope))
		die(EXIT_RUN, "%s: the unit to calibrate with does not wear", file);
	table_close(s.table);
	return slope;
}

static struct paths *draw_paths(struct partition *p)
{
	double slope[OPT_TEXTS_MAX];
	struct paths_par par = { .seed = (uint64_t)seed,
		.first = (uint32_t)first_path,
		.count = count,
		.rule = rule,
		.area = area,
		.parts = (double)parts,
		.critical = isnan(critical_size) ? NAN : critical_probability,
		.cumulative = !size_set,
		.step_time = step_time,
		.slope = slope,
		.nslopes = calibrations.n };
	struct paths *e;

	for (int i = 0; i < calibrations.n; i++)
		slope[i] = slope_of(calibrations.v[i]);
	e = paths_new(&par, p);
	if (!e)
		die(EXIT_RUN, "out of memory");
	if (p) {
		stats_add("replicates", (double)count);
		stats_add(
			isnan(critical_size) ? "sizes_skipped" : "sizes", (double)count);
	}
	return e;
}

static void write_rates(const struct paths *e, const char *cmd)
{
	struct table_out *out = table_create(
		rates_file, cmd, "1 m3 m3 s 1", "path mean step_sd step_time large_step");

	for (long i = 0; i < count; i++) {
		const struct path *path = paths_get(e, i);

		table_put(out, (double)(first_path + i));
		table_put(out, path->wear.mean);
		table_put(out, sqrt(path->wear.step_variance));
		table_put(out, path->step_time);
		table_put(out, (double)path->large_step);
		table_end_row(out);
	}
	table_done(out);
}

/* The one gap at which total volume or gap fail. */
static double gap_limit(void)
{
	double limit = INFINITY;

	if (!isnan(threshold_gap))
		limit = threshold_gap;
	if (!isnan(threshold_leakage))
		limit = fmin(limit, leakage_gap(&pump, threshold_leakage));
	if (!isnan(threshold_volume))
		limit = fmin(limit, gap_new + threshold_volume / area);
	return limit;
}

/* The same in what is observed. */
static double value_limit(const struct state *s)
{
	double limit = gap_limit();

	if (s->quantity == LEAKAGE)
		return leakage_flow(&pump, limit);
	return s->quantity == GAP ? limit : (limit - gap_new) * area;
}

static char *columns(void)
{
	char *names = xstrdup(samples ? "t path rwl" : "t mean"), *more;

	for (int i = 0; i < levels.n && !samples; i++, names = more) {
		more = xprintf("%s q%s%g", names, levels.v[i] < 0.0999999 ? "0" : "",
			100 * levels.v[i]);
		free(names);
	}
	if (samples)
		return names;
	more = xprintf("%s p_no_failure%s%s%s", names, isnan(archard) ? "" : " archard",
		grey ? " grey" : "",
		isnan(eol) ? "" : " truth error accuracy mass inside covered crps");
	free(names);
	return more;
}

static void put_scores(
	struct table_out *out, struct metrics *m, double t, long n, const double *life)
{
	struct metrics_row r = {
		.truth = eol - t, .error = NAN, .accuracy = NAN, .mass = NAN, .crps = NAN
	};
	int counted = 0;

	if (n > 0)
		counted = metrics_add(m, t, metric_quantile(life, (size_t)n, 0.5),
			metric_quantile(life, (size_t)n, levels.v[0]),
			metric_quantile(life, (size_t)n, levels.v[levels.n - 1]), life,
			NULL, (size_t)n, &r);
	if (counted < 0)
		die(EXIT_RUN, "out of memory");
	table_put(out, r.truth);
	table_put(out, r.error);
	table_put(out, r.accuracy);
	table_put(out, r.mass);
	table_put(out, counted ? r.inside : NAN);
	table_put(out, counted ? r.covered : NAN);
	table_put(out, r.crps);
}

/* One observation time: life holds n samples of the life left, 0 for no prediction. */
static void write_row(struct table_out *out, struct metrics *m, double t, double *life,
	long n, double limit, double dry, double by_grey)
{
	struct remaining_summary sum = { NAN, NAN };

	if (samples) {
		/* one sample may stand for all */
		for (long i = 0; i < (n == 1 && wear_files.n ? count : n); i++) {
			double left = life[n == 1 ? 0 : i];

			table_put(out, t);
			table_put(out, (double)(first_path + i));
			table_put(out, left <= limit ? left : INFINITY);
			table_end_row(out);
		}
		table_flush(out);
		return;
	}
	if (n > 0)
		sum = remaining_sum_up(life, (size_t)n, limit);
	table_put(out, t);
	table_put(out, sum.mean);
	for (int i = 0; i < levels.n; i++)
		table_put(out, n ? metric_quantile(life, (size_t)n, levels.v[i]) : NAN);
	table_put(out, sum.p_no_failure);
	if (!isnan(archard))
		table_put(out, dry);
	if (grey)
		table_put(out, by_grey);
	if (m)
		put_scores(out, m, t, n, life);
	table_end_row(out);
	table_flush(out);
}

static void write_scores(struct table_out *out, const struct metrics *m)
{
	struct metrics_sum s = metrics_get(m);

	table_comment(out, "predictions", "%zu", s.n);
	table_comment(out, "bias", "%.6g s", s.bias);
	table_comment(out, "mean_absolute_error", "%.6g s", s.mae);
	table_comment(out, "root_mean_square_error", "%.6g s", s.rmse);
	table_comment(out, "relative_accuracy", "%.6g", s.accuracy);
	table_comment(out, "alpha_lambda", "%.6g", s.alpha_lambda);
	table_comment(out, "prognostic_horizon", "%.6g s", s.horizon);
	table_comment(out, "coverage", "%.6g", s.coverage);
	table_comment(out, "crps", "%.6g s", s.crps);
}

static double later_life(double life, double gone)
{
	return life < gone ? 0 : life - gone;
}

/* The row at t: what was said at the latest known state, n samples in life, less the
 * time gone since. */
static void put_row(struct table_out *out, struct metrics *m, const struct observed *o,
	double t, double *life, long n, double by_grey)
{
	double gone = t - observed_time(o), limit = horizon, dry = NAN;
	double left = area * (gap_limit() - observed_gap(o));
	int scaled = wear_files.n && (calibrations.n || !isnan(step_time));

	for (long i = 0; i < n; i++)
		life[i] = later_life(life[i], gone);
	if (isnan(limit))
		limit = rule == RATE_FILTER && !scaled
				? 10 * (t - observed_first(o) + skip)
				: INFINITY;
	if (!isnan(dry_rate) && !isnan(left))
		dry = later_life(remaining_constant(left, dry_rate), gone);
	write_row(out, m, t, life, n, limit, dry, later_life(by_grey, gone));
}

static void follow(
	struct state *s, struct table_out *out, struct metrics *m, struct paths *e)
{
	struct observed *o = observed_new(rule);
	struct rate *filter = rule == RATE_FILTER ? paths_filter(e) : NULL;
	double *life = xcalloc((size_t)count, sizeof *life), by_grey = NAN;
	double *later = xcalloc((size_t)count, sizeof *later);
	long n = 0;

	if (!o || (rule == RATE_FILTER && !filter))
		die(EXIT_RUN, "out of memory");
	/* volume worn is counted from the new pair at time 0 */
	if (s->quantity >= VOLUME)
		observed_begin(o, 0, gap_new);
	while (next_state(s)) {
		int run_in = s->t - s->first_t < skip;

		if (filter && !run_in && (s->rows == 1 || s->t > observed_time(o)))
			rate_add(filter, s->t, s->gap);
		if (!isnan(s->gap)) {
			if (isnan(gap_new))
				gap_new = s->gap;
			if (run_in || (skip > 0 && observed_count(o) == 0))
				observed_begin(o, s->t, s->gap);
			if (!run_in)
				observed_add(o, s->t, s->value, s->gap);
			n = paths_predict(e, o, filter, gap_limit(), s->gap_error, life);
			if (grey)
				by_grey = observed_grey(o, value_limit(s));
			stats_add("paths", n > 1 ? (double)n : 0);
			stats_add("paths_skipped", n > 1 ? 0 : (double)count);
		}
		memcpy(later, life, (size_t)n * sizeof *later);
		put_row(out, m, o, s->t, later, n, by_grey);
		stats_add("rows", 1);
	}
	rate_free(filter);
	observed_free(o);
	free(life);
	free(later);
}

/* A new pair: nothing is observed yet. */
static void foresee(struct table_out *out, struct metrics *m, struct paths *e)
{
	struct observed *o = observed_new(rule);
	double *life = xcalloc((size_t)count, sizeof *life);

	if (!o)
		die(EXIT_RUN, "out of memory");
	observed_begin(o, 0, gap_new);
	put_row(out, m, o, 0, life, paths_predict(e, o, NULL, gap_limit(), 0, life), NAN);
	observed_free(o);
	free(life);
}

/* The command line that rebuilds the output: the state comes through a pipe where it
 * tells how it was made, else from its file. */
static char *record_cmd(const struct state *s, int operand)
{
	const char *upstream = s->table ? table_key(s->table, "cmd") : NULL;
	char *extra = NULL, *cmd;

	if (!upstream && state_file && !operand)
		extra = xprintf("--state '%s'", state_file);
	cmd = opt_cmd(upstream, extra);
	free(extra);
	return cmd;
}

/* Checks options against each other and sets what follows from several of them. */
static void settle(void)
{
	const char *wrong;

	if (radii.n != 4)
		die(EXIT_USAGE, "--radii: want R1,R2,R3,R4");
	memcpy(pump.radius, radii.v, sizeof pump.radius);
	if (ports.n != 2)
		die(EXIT_USAGE, "--ports: want PIN:POUT");
	pump.drop = ports.v[1] - ports.v[0];
	wrong = leakage_check(&pump);
	if (wrong)
		die(EXIT_USAGE, "%s", wrong);
	for (int i = 1; i < levels.n; i++)
		if (!(levels.v[i] > levels.v[i - 1]))
			die(EXIT_USAGE, "--levels must grow");
	if (!isnan(critical_size) && wear_files.n == 0)
		die(EXIT_USAGE, "--critical-size needs --wear");
	if ((calibrations.n || rates_file || !isnan(archard)) && wear_files.n == 0)
		die(EXIT_USAGE, "--calibrate, --rates and --archard need --wear");
	for (int i = 0; i < wear_files.n; i++)
		if (!new && (!state_file || !strcmp(state_file, "-")) &&
			!strncmp(wear_files.v[i], "-", strcspn(wear_files.v[i], ":")))
			die(EXIT_USAGE, "standard input cannot be both --wear and state");
	if (new && (wear_files.n == 0 || rule == RATE_FILTER))
		die(EXIT_USAGE, "--new needs --wear and the rates of its fragments");
	if (new && !calibrations.n && isnan(step_time))
		die(EXIT_USAGE, "--new needs --step-time or --calibrate");
	if (samples && !isnan(eol))
		die(EXIT_USAGE, "--eol scores the summary, not --samples");
	if (calibrations.n && !isnan(step_time))
		die(EXIT_USAGE, "--calibrate and --step-time exclude each other");
	if (isnan(threshold_gap) && isnan(threshold_leakage) && isnan(threshold_volume) &&
		isnan(critical_size))
		threshold_leakage = 2.8e-3 / 60;
}

static struct metrics *new_metrics(void)
{
	struct metrics_par par = {
		.eol = eol, .alpha = cone, .beta = 0.5, .limit = horizon
	};
	struct metrics *m;

	if (isnan(eol))
		return NULL;
	if (isnan(horizon))
		par.limit = 10 * eol;
	m = metrics_new(&par);
	if (!m)
		die(EXIT_RUN, "out of memory");
	return m;
}

int main(int argc, char **argv)
{
	int i;
	struct partition *p;
	struct paths *e;
	struct metrics *m;
	struct table_out *out;
	struct state s = { 0 };
	char *cmd, *names;

	pump = leakage_thesis();
	memcpy(radii.v, pump.radius, sizeof pump.radius);
	i = opt_parse(&prog, argc, argv);
	if (argv[i])
		state_file = argv[i];
	settle();
	p = wear_files.n ? read_partition() : NULL;
	gap_new = initial_gap;
	if (!new)
		open_state(&s, state_file);
	if (isnan(gap_new) && (new || s.quantity >= VOLUME))
		gap_new = leakage_gap(&pump, 1.5e-3 / 60);
	e = draw_paths(p);
	if (!isnan(archard))
		dry_rate = remaining_archard(archard, partition_load(p), speed, hardness);
	if (!isnan(archard) && isnan(dry_rate))
		die(EXIT_USAGE, "--archard needs the pressures of --wear");
	cmd = record_cmd(&s, argv[i] != NULL);
	if (rates_file)
		write_rates(e, cmd);
	m = new_metrics();
	names = columns();
	out = table_create(NULL, cmd, samples ? "s 1 s" : NULL, names);
	for (int k = 0; k < wear_files.n; k++)
		if (made_by[k])
			table_comment(out, "wear", "%s made by %s", wear_files.v[k],
				made_by[k]);
	if (new)
		foresee(out, m, e);
	else
		follow(&s, out, m, e);
	if (m)
		write_scores(out, m);
	table_done(out);
	metrics_free(m);
	partition_free(p);
	paths_free(e);
	for (int k = 0; k < wear_files.n; k++)
		free(made_by[k]);
	free(names);
	free(cmd);
	return shell_done(0);
}
