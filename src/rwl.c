/* rwl - remaining wear life from fragments' wear and the state observed */
#include "life/grey.h"
#include "life/leakage.h"
#include "life/metrics.h"
#include "life/partition.h"
#include "life/rate.h"
#include "life/remaining.h"
#include "num/rng.h"
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/progress.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum quantity { AUTO, LEAKAGE, GAP, VOLUME, DEBRIS };
static const char *const quantities[] = { "auto", "leakage", "gap", "volume", "debris",
	NULL };
enum rule { MEAN, LAST, FILTER };
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
static double eol = NAN, cone = 0.2, horizon = NAN;
static double archard = NAN, hardness = 1.065e9, speed = 20.94;
static long seed = 1, first_path, count = 1000, first_step = 1, parts;
static int quantity = AUTO, rule = MEAN, size_set, time_unit, samples, grey;

static const struct opt opts[] = {
	{ 'w', "wear", OPT_TEXTS, UNIT_NONE, &wear_files, 0, 0, "FILE[:PRESSURE[:AREA]]",
		"particles or volumes worn off fragments under a nominal pressure", 0,
		0 },
	{ 'x', "state", OPT_TEXT, UNIT_NONE, &state_file, 0, 0, "FILE",
		"observed leakage, gap, volume or debris; the operand says the same", 0,
		1 },
	{ 'y', "quantity", OPT_WORD, UNIT_NONE, &quantity, 0, 0,
		"auto|leakage|gap|volume|debris", "what the state is", quantities, 0 },
	{ 'u', "unit", OPT_TEXT, UNIT_NONE, &unit_text, 0, 0, "UNIT",
		"unit of the state, where not SI: L/min", 0, 0 },
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
	{ 'T', "step-time", OPT_NUM, UNIT_TIME, &step_time, 1e-15, 1e15, "T",
		"time that one step of the fragments stands for [from the state so far]",
		0, 0 },
	{ 'C', "calibrate", OPT_TEXTS, UNIT_NONE, &calibrations, 0, 0, "FILE",
		"take the step time from the whole life of an earlier unit", 0, 0 },
	{ 'k', "first-step", OPT_INT, UNIT_COUNT, &first_step, 1, 1e6, "K",
		"steps before are running-in and count not for the rate", 0, 0 },
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
		"what lives longer counts as no failure [none; 10 x age with filters]", 0,
		0 },
	{ 'e', "eol", OPT_NUM, UNIT_TIME, &eol, 1e-18, 1e18, "T",
		"true end of life: add scores of the predictions", 0, 0 },
	{ 'l', "cone", OPT_NUM, UNIT_FRACTION, &cone, 1e-6, 10, "ALPHA",
		"half-width of the alpha-lambda test", 0, 0 },
	{ 'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 1e8, "N", "Monte-Carlo paths", 0,
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

/* What a path of the ensemble is worn by. */
struct path {
	struct partition_wear
		wear;     /* of the component per step; mean drawn for this unit */
	double step_time; /* NAN: from the state so far */
	long large_step;  /* 0: large particles never become too many */
};

/* The state as it is read: everything is turned into a gap. */
struct state {
	struct table_in *table;
	int time_column, value_column;
	int quantity;
	double scale;         /* of the value to SI */
	double debris;        /* volume of the particles so far */
	long rows, n;         /* rows, and those with a value */
	double t, gap, value; /* latest row; gap and value NAN where missing */
};

/* What predictions start from: the first, the last but one and the last gap known. */
struct observed {
	double first_t, first, before_t, before, t, gap;
	long n;
	double *value, *time; /* all of them, for --grey */
	size_t room;
};

static double gap_new = NAN; /* NAN: the first one observed */

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
static void read_wear(struct partition *p, const char *option)
{
	const char *colon = strchr(option, ':'), *rest = colon ? colon + 1 : NULL;
	char *file = xstrdup(option);
	double pressure = NAN, share = -1;
	struct table_in *t;
	int class, realisation, step, volume, diameter, sparse;

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
		if (partition_fragment(p, class, (long)r, (long)k, v, 1,
			    table_number(t, diameter) >= critical_size) != PARTITION_OK)
			die(EXIT_RUN, "%s: line %ld: realisation %g has step %g twice",
				file, table_line(t), r, k);
		stats_add("fragments_read", 1);
	}
	table_close(t);
	free(file);
}

static struct partition *read_partition(void)
{
	struct partition *p = partition_new(fragment_area, area);
	enum partition_status status;

	for (int i = 0; i < wear_files.n; i++)
		read_wear(p, wear_files.v[i]);
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
	if (s->value_column < 0 || s->quantity == DEBRIS)
		s->value_column = table_find(t, columns[s->quantity]);
	if (s->value_column < 0)
		s->value_column = table_find(t, "y");
	if (s->value_column < 0)
		s->value_column = table_need(t, columns[s->quantity]);
	if (unit_text) {
		char *one = xprintf("1%s", unit_text);

		wrong = unit_parse(one, UNIT_ANY, "", &s->scale, &end);
		if (wrong)
			die(EXIT_USAGE, "--unit %s: %s", unit_text, wrong);
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
		return gap_new + value / area;
	default:
		return leakage_gap(&pump, value);
	}
}

static const double sphere = 0.52359877559829887; /* pi / 6 */

/* The next row; 0 at the end.  Times must grow, but particles may come together. */
static int next_state(struct state *s)
{
	struct table_in *t = s->table;
	double time, value;

	if (!table_next(t))
		return 0;
	time = table_number(t, s->time_column) * time_scale[time_unit];
	value = table_number(t, s->value_column) * s->scale;
	if (!isfinite(time))
		die(EXIT_RUN, "%s: line %ld: the time is missing", table_name(t),
			table_line(t));
	if (s->rows++ > 0 && (s->quantity == DEBRIS ? time < s->t : time <= s->t))
		die(EXIT_RUN, "%s: line %ld: time %g s does not grow", table_name(t),
			table_line(t), time);
	if (value < 0 || isinf(value))
		die(EXIT_RUN, "%s: line %ld: %g is not a %s", table_name(t),
			table_line(t), value, quantities[s->quantity]);
	s->t = time;
	if (s->quantity == DEBRIS && !isnan(value))
		value = s->debris += sphere * value * value * value;
	s->value = value;
	s->gap = to_gap(s, value);
	s->n += !isnan(value);
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

		if (isnan(s.gap))
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

/* One path after the other: replicate of the fragments, this unit, step time. */
static struct path *draw_paths(struct partition *p)
{
	struct path *paths = xcalloc((size_t)count, sizeof *paths);
	double slope[OPT_TEXTS_MAX];
	gsl_rng *rng = rng_new((uint64_t)seed, 0, RNG_BOOTSTRAP);
	struct partition_wear all;

	for (int i = 0; i < calibrations.n; i++)
		slope[i] = slope_of(calibrations.v[i]);
	partition_estimate(p, (double)parts, &all);
	for (long i = 0; i < count; i++) {
		struct path *path = &paths[i];

		rng_reset(rng, (uint64_t)seed, (uint32_t)(first_path + i), RNG_BOOTSTRAP);
		partition_replicate(p, (double)parts, rng, &path->wear);
		if (!isnan(critical_size))
			path->large_step =
				partition_large(p, critical_probability, !size_set);
		if (rule != LAST)
			path->wear.mean = remaining_draw_rate(
				path->wear.mean, path->wear.life_variance, rng);
		path->step_time = step_time;
		if (calibrations.n)
			path->step_time = all.mean / area /
					  slope[gsl_rng_uniform_int(
						  rng, (unsigned long)calibrations.n)];
		progress("replicates", (double)(i + 1), (double)count);
	}
	stats_add("replicates", (double)count);
	stats_add(isnan(critical_size) ? "sizes_skipped" : "sizes", (double)count);
	gsl_rng_free(rng);
	return paths;
}

static void write_rates(const struct path *paths, const char *cmd)
{
	struct table_out *out = table_create(
		rates_file, cmd, "1 m3 m3 s 1", "path mean step_sd step_time large_step");

	for (long i = 0; i < count; i++) {
		table_put(out, (double)(first_path + i));
		table_put(out, paths[i].wear.mean);
		table_put(out, sqrt(paths[i].wear.step_variance));
		table_put(out, paths[i].step_time);
		table_put(out, (double)paths[i].large_step);
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

static void take(struct observed *o, const struct state *s)
{
	if (o->n++ == 0) {
		if (isnan(gap_new))
			gap_new = s->gap;
		/* volume worn starts from none at time 0 */
		o->first_t = s->quantity >= VOLUME ? 0 : s->t;
		o->first = s->quantity >= VOLUME ? gap_new : s->gap;
		o->t = o->first_t;
		o->gap = o->first;
	}
	if (s->t > o->t) {
		o->before_t = o->t;
		o->before = o->gap;
	}
	o->t = s->t;
	o->gap = s->gap;
	if (!grey)
		return;
	if ((size_t)o->n > o->room) {
		o->room = 2 * o->room + 64;
		o->value = xrealloc(o->value, o->room, sizeof *o->value);
		o->time = xrealloc(o->time, o->room, sizeof *o->time);
	}
	o->value[o->n - 1] = s->value;
	o->time[o->n - 1] = s->t;
}

/* Rate of the gap told by the observations alone; NAN while there are too few. */
static double observed_rate(const struct observed *o)
{
	if (!(o->t > o->first_t))
		return NAN;
	if (rule == LAST)
		return (o->gap - o->before) / (o->t - o->before_t);
	return (o->gap - o->first) / (o->t - o->first_t);
}

/* Life left at the latest observation on every path; 0 where nothing can be said. */
static long predict(const struct observed *o, const struct path *paths,
	const struct partition_wear *all, const struct rate *filter, gsl_rng *rng,
	double *life)
{
	double limit = gap_limit(), left = area * (limit - o->gap),
	       rate = observed_rate(o);

	if (left <= 0) {
		life[0] = 0;
		return 1;
	}
	if (rule == FILTER ? !rate_ready(filter) : !paths && isnan(rate))
		return 0;
	if (rule != FILTER && !paths) {
		life[0] = remaining_constant(limit - o->gap, rate);
		return 1;
	}
	for (long i = 0; i < count; i++) {
		uint32_t k = (uint32_t)(first_path + i);
		double z[2], tau = paths ? paths[i].step_time : NAN;

		if (paths && isnan(tau)) {
			/* the mean of all fragments wears what was seen worn */
			if (isnan(rate) && rule != FILTER)
				return 0;
			tau = rate > 0 ? all->mean / (area * rate) : INFINITY;
		}
		if (rule == FILTER) {
			philox_normal2((uint64_t)seed, k, RNG_PREDICT, 0, z);
			life[i] = rate_passage(filter, limit,
				philox_uniform((uint64_t)seed, k, RNG_LIFE, 0), z[0]);
		} else if (rule == LAST) {
			rng_reset(rng, (uint64_t)seed, k, RNG_LIFE);
			life[i] = tau * remaining_gamma(left, paths[i].wear.mean,
						paths[i].wear.step_variance, rng);
		} else {
			life[i] = tau * remaining_constant(left, paths[i].wear.mean);
		}
		if (paths && !isnan(critical_size))
			life[i] = fmin(
				life[i], remaining_large(paths[i].large_step, tau, o->t));
	}
	return count;
}

/* Life left by the grey model of all values observed; NAN with fewer than four. */
static double grey_life(const struct state *s, const struct observed *o)
{
	struct grey g = { 0 };
	double spacing = (o->t - o->first_t) / (double)(o->n - 1), limit = gap_limit();
	double threshold = limit, now, rate;

	if (o->n < GREY_ORDER_MIN)
		return NAN;
	if (s->quantity == LEAKAGE)
		threshold = leakage_flow(&pump, limit);
	else if (s->quantity != GAP)
		threshold = (limit - gap_new) * area;
	for (long i = o->n; i-- > 0;)
		grey_add(&g, o->value[i],
			i + 1 < o->n ? (o->time[i + 1] - o->time[i]) / spacing : 1);
	stats_add("grey_points", (double)o->n);
	now = grey_forecast(&g, 0, 1);
	rate = -grey_rate(&g);
	if (now >= threshold)
		return 0;
	return now > 0 && rate > 0 ? log(threshold / now) / rate * spacing : INFINITY;
}

static struct rate *new_filter(const struct path *paths)
{
	double mean = 0, square = 0;

	if (!paths || isnan(paths[0].step_time))
		return rate_new(0, INFINITY);
	for (long i = 0; i < count; i++) {
		double r = paths[i].wear.mean / (area * paths[i].step_time), d = r - mean;

		mean += d / (double)(i + 1);
		square += d * (r - mean);
	}
	return rate_new(mean, sqrt(square / (double)count));
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
	long n, double dry, double by_grey)
{
	struct remaining_summary sum = { NAN, NAN };
	double limit = isnan(horizon) ? INFINITY : horizon;

	if (samples) {
		for (long i = 0; i < n; i++) {
			table_put(out, t);
			table_put(out, (double)(first_path + i));
			table_put(out, life[i] <= limit ? life[i] : INFINITY);
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

/* Every observation time, with the life that is left at the latest known state less
 * the time gone since. */
static void follow(struct state *s, struct table_out *out, struct metrics *m,
	const struct path *paths, const struct partition_wear *all, double dry_rate)
{
	struct observed o = { 0 };
	struct rate *filter = rule == FILTER ? new_filter(paths) : NULL;
	gsl_rng *rng = rng_new((uint64_t)seed, 0, RNG_LIFE);
	double *life = xcalloc((size_t)count, sizeof *life);
	double *later = xcalloc((size_t)count, sizeof *later);
	long n = 0;
	double by_grey = NAN;

	while (next_state(s)) {
		if (filter)
			rate_add(filter, s->t, s->gap);
		if (!isnan(s->gap)) {
			take(&o, s);
			n = predict(&o, paths, all, filter, rng, life);
			if (grey)
				by_grey = grey_life(s, &o);
			stats_add("paths", n > 1 ? (double)n : 0);
			stats_add("paths_skipped", n > 1 ? 0 : (double)count);
		}
		for (long i = 0; i < n; i++)
			later[i] = later_life(life[i], s->t - o.t);
		if (rule == FILTER && !opt_given('H'))
			horizon = 10 * (s->t - o.first_t);
		write_row(out, m, s->t, later, n,
			remaining_constant(
				area * (gap_limit() - o.gap) - dry_rate * (s->t - o.t),
				dry_rate),
			later_life(by_grey, s->t - o.t));
		stats_add("rows", 1);
	}
	rate_free(filter);
	gsl_rng_free(rng);
	free(o.value);
	free(o.time);
	free(life);
	free(later);
}

/* A new unit: nothing observed yet. */
static void foresee(struct table_out *out, struct metrics *m, const struct path *paths,
	const struct partition_wear *all, double dry_rate)
{
	struct observed o = { .n = 1, .gap = gap_new };
	gsl_rng *rng = rng_new((uint64_t)seed, 0, RNG_LIFE);
	double *life = xcalloc((size_t)count, sizeof *life);
	long n;

	if (rule == FILTER || isnan(paths[0].step_time))
		die(EXIT_USAGE,
			rule == FILTER
				? "--wear-rate filter needs a state"
				: "without a state, --step-time or --calibrate must be given");
	n = predict(&o, paths, all, NULL, rng, life);

	write_row(out, m, 0, life, n,
		remaining_constant(area * (gap_limit() - gap_new), dry_rate), NAN);
	gsl_rng_free(rng);
	free(life);
}

/* The command line that rebuilds the output: the state comes through a pipe where it
 * tells how it was made, else from its file. */
static char *record_cmd(const struct state *s, int operand)
{
	const char *upstream = s->table ? table_key(s->table, "cmd") : NULL;
	char *extra = NULL, *cmd;

	if (upstream)
		extra = xstrdup("--state -");
	else if (s->table && !operand)
		extra = xprintf("--state '%s'", state_file ? state_file : "-");
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
	if (calibrations.n && !isnan(step_time))
		die(EXIT_USAGE, "--calibrate and --step-time exclude each other");
	if (isnan(threshold_gap) && isnan(threshold_leakage) && isnan(threshold_volume) &&
		isnan(critical_size))
		threshold_leakage = 2.8e-3 / 60;
}

int main(int argc, char **argv)
{
	int i;
	struct partition *p = NULL;
	struct path *paths = NULL;
	struct partition_wear all = { 0 };
	struct metrics *m = NULL;
	struct table_out *out;
	struct state s = { 0 };
	double dry_rate = NAN;
	char *cmd, *names;

	pump = leakage_thesis();
	memcpy(radii.v, pump.radius, sizeof pump.radius);
	i = opt_parse(&prog, argc, argv);
	settle();
	if (argv[i])
		state_file = argv[i];
	gap_new = initial_gap;
	if (wear_files.n)
		p = read_partition();
	if (state_file || !p)
		open_state(&s, state_file);
	if (isnan(gap_new) && (!s.table || s.quantity >= VOLUME))
		gap_new = leakage_gap(&pump, 1.5e-3 / 60);
	if (p) {
		paths = draw_paths(p);
		partition_estimate(p, (double)parts, &all);
		dry_rate = remaining_archard(archard, partition_load(p), speed, hardness);
		if (!isnan(archard) && isnan(dry_rate))
			die(EXIT_USAGE, "--archard needs the pressures of --wear");
	}
	cmd = record_cmd(&s, argv[i] != NULL);
	if (rates_file)
		write_rates(paths, cmd);
	if (!isnan(eol)) {
		struct metrics_par par = { .eol = eol,
			.alpha = cone,
			.beta = 0.5,
			.limit = isnan(horizon) ? 10 * eol : horizon };

		m = metrics_new(&par);
	}
	names = columns();
	out = table_create(NULL, cmd, samples ? "s 1 s" : NULL, names);
	if (s.table)
		follow(&s, out, m, paths, &all, dry_rate);
	else
		foresee(out, m, paths, &all, dry_rate);
	if (m)
		write_scores(out, m);
	table_done(out);
	metrics_free(m);
	partition_free(p);
	free(paths);
	free(names);
	free(cmd);
	return shell_done(0);
}
