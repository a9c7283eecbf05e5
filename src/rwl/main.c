/* rwl - remaining wear life from fragments' wear and the state observed */
#include "cli/msg.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "common/covariates.h"
#include "common/quantile_columns.h"
#include "fragments.h"
#include "life/trend/passage.h"
#include "life_table.h"
#include "observations.h"
#include "pump_options.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const rules[] = { "mean", "last", "filter", NULL };

static struct opt_texts wear_files, calibrations;
static const char *state_file, *rates_file;
static struct opt_list levels = { 3, { 0.05, 0.5, 0.95 } };
static double step_time = NAN, skip, eol = NAN, cone = 0.2, horizon = NAN, speed = NAN;
static long seed = 1, first_path, count = 1000, first_step = 1, parts;
static int rule = RATE_MEAN, samples, grey, new;

static const struct opt opts[] = { OPT_HEADING("Input"),
	{ 0, "wear", OPT_TEXTS, UNIT_NONE, &wear_files, 0, 0, "FILE[:PRESSURE[:AREA]]",
		"particles or worn volumes of fragments under a nominal pressure", 0, 0 },
	{ 0, "state", OPT_TEXT, UNIT_NONE, &state_file, 0, 0, "FILE",
		"observed leakage, gap, volume or debris, in place of the operand", 0,
		1 },
	{ 0, "new", OPT_FLAG, UNIT_NONE, &new, 0, 0, 0,
		"read no state; predict the life of a new pair", 0, 0 },
	OPT_TABLE(state_rows), OPT_TABLE(pump_threshold_rows), OPT_HEADING("Wear rate"),
	{ 0, "wear-rate", OPT_WORD, UNIT_NONE, &rule, 0, 0, "mean|last|filter",
		"wear rate by (4-29), by (4-28), or estimated by Kalman filters", rules,
		0 },
	OPT_TABLE(covariate_rows),
	{ 0, "step-time", OPT_NUM, UNIT_TIME, &step_time, 1e-15, 1e15, "T",
		"duration of one step of the fragments [from the state so far]", 0, 0 },
	{ 0, "speed", OPT_NUM, UNIT_SPEED, &speed, 1e-12, 1e6, "V",
		"sliding speed; step time is sliding distance over speed", 0, 0 },
	{ 0, "calibrate", OPT_TEXTS, UNIT_NONE, &calibrations, 0, 0, "FILE",
		"determine the step time from the whole life of an earlier unit", 0, 0 },
	{ 0, "first-step", OPT_INT, UNIT_COUNT, &first_step, 1, 1e6, "K",
		"earlier steps are running-in and do not count for the rate", 0, 0 },
	{ 0, "skip", OPT_NUM, UNIT_TIME, &skip, 0, 1e300, "T",
		"run-in that observed rates do not use, from the first row", 0, 0 },
	{ 0, "parts", OPT_INT, UNIT_COUNT, &parts, 0, 1e9, "N",
		"independently wearing parts of a class; 0: number of fragments", 0, 0 },
	OPT_TABLE(pump_face_rows), OPT_HEADING("Output"),
	{ 0, "grey", OPT_FLAG, UNIT_NONE, &grey, 0, 0, 0,
		"add a column: remaining life by the grey model", 0, 0 },
	{ 0, "levels", OPT_LIST, UNIT_FRACTION, &levels, 0, 1, "P,...",
		"quantiles to print", 0, 0 },
	{ 0, "samples", OPT_FLAG, UNIT_NONE, &samples, 0, 0, 0,
		"print every path instead of the summary", 0, 0 },
	{ 0, "rates", OPT_TEXT, UNIT_NONE, &rates_file, 0, 0, "FILE",
		"write the wear rate of each path", 0, 1 },
	{ 0, "horizon", OPT_NUM, UNIT_TIME, &horizon, 0, 1e18, "T",
		"longer lives count as no failure [none; 10 x age for filters without fragments]",
		0, 0 },
	{ 0, "eol", OPT_NUM, UNIT_TIME, &eol, 1e-18, 1e18, "T",
		"true end of life: add scores of the predictions", 0, 0 },
	{ 0, "cone", OPT_NUM, UNIT_FRACTION, &cone, 1e-6, 10, "ALPHA",
		"half-width of the alpha-lambda test", 0, 0 },
	OPT_HEADING("Monte Carlo"),
	{ 'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 1e7, "N", "Monte-Carlo paths", 0,
		0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first_path, 0, 4e9, "K",
		"number of the first path", 0, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "random seed", 0, 0 },
	OPT_END };

static const struct prog prog = { "rwl",
	"Predict the remaining wear life of a sliding pair as a distribution.", "[state]",
	"tables: particles or volumes of fragments (--wear); state",
	"table: one row per observation time", opts };

/* Dies where options contradict one another. */
static void settle(void)
{
	static const char *const of_state[] = { "quantity", "state-unit", "state-error",
		"skip", "grey" };

	pump_check();
	covariates_check();
	if (covariates_count() > 0 && rule != RATE_FILTER)
		die(EXIT_USAGE, "--covariate requires --wear-rate filter");
	opt_require("wear",
		"critical-size calibrate rates speed step-time parts first-step "
		"fragment-area transition");
	opt_require("critical-size", "critical-probability sizes");
	if (state_file && new)
		die(EXIT_USAGE, "--new reads no state, not even %s", state_file);
	for (size_t i = 0; i < sizeof of_state / sizeof *of_state; i++)
		if (opt_given(of_state[i]) && calibrations.n == 0 && new)
			die(EXIT_USAGE, "--%s requires a state: --new reads none",
				of_state[i]);
	levels_check(&levels);
	for (int i = 0; i < wear_files.n; i++)
		if (!new && (!state_file || !strcmp(state_file, "-")) &&
			!strncmp(wear_files.v[i], "-", strcspn(wear_files.v[i], ":")))
			die(EXIT_USAGE, "standard input cannot be both --wear and state");
	if (new && (wear_files.n == 0 || rule == RATE_FILTER))
		die(EXIT_USAGE, "--new requires --wear and --wear-rate mean or last");
	if (new && !calibrations.n && isnan(step_time) && isnan(speed))
		die(EXIT_USAGE, "--new requires --step-time, --speed or --calibrate");
	if (samples && !isnan(eol))
		die(EXIT_USAGE, "--eol scores the summary, not --samples");
	if ((calibrations.n > 0) + !isnan(step_time) + !isnan(speed) > 1)
		die(EXIT_USAGE,
			"--step-time, --speed and --calibrate exclude one another");
}

static void tell(long done, long paths)
{
	progress("paths", (double)done, (double)paths);
}

static struct forecast *new_forecast(
	struct partition *p, enum pair_quantity quantity, int doubtful)
{
	int sizes = !isnan(pump.critical_size);
	double slope[OPT_TEXTS_MAX];
	struct forecast_par par = { .seed = (uint64_t)seed,
		.first = (uint32_t)first_path,
		.count = count,
		.rule = (enum rate_rule)rule,
		.pair = pump.pair,
		.quantity = quantity,
		.parts = (double)parts,
		.critical = sizes ? pump.critical_probability : NAN,
		.cumulative = !pump.per_step,
		.step_time = step_time,
		.slope = slope,
		.nslopes = calibrations.n,
		.progress = tell,
		.from_new = new || quantity >= PAIR_VOLUME,
		.doubtful = doubtful,
		.skip = skip,
		.horizon = horizon,
		.grey = grey,
		.load = covariates_future(),
		.n_loads = covariates_count() };
	struct forecast *f;

	for (int i = 0; i < calibrations.n; i++)
		slope[i] = state_slope(calibrations.v[i], &pump.pair, skip);
	f = forecast_new(&par, p);
	if (!f)
		die(EXIT_RUN, "out of memory");
	progress(NULL, 0, 0);
	if (p) {
		stats_add("replicates", (double)count);
		stats_add(sizes ? "sizes" : "sizes_skipped", (double)count);
	}
	return f;
}

static void write_rates(const struct path *path, const char *cmd)
{
	char *side = xprintf("%s --rates /dev/fd/3 3>&1 >/dev/null", cmd);
	struct table_out *out = table_create(rates_file, side, "1 m3 m3 s 1",
		"path mean step_sd step_time large_step");

	free(side);

	for (long i = 0; i < count; i++, path++)
		table_put_row(out,
			(double[]){ (double)(first_path + i), path->wear.mean,
				sqrt(path->wear.step_variance), path->step_time,
				(double)path->large_step },
			5);
	table_done(out);
}

/* Steps cannot resolve a life below one step. */
static void check_life(const struct lifetable *out, double time)
{
	static int said;
	double life = time + lifetable_median(out);

	if (isnan(step_time) || said || !(life < step_time))
		return;
	said = 1;
	warn("a life of %.3g s is below one simulated step of %.3g s: wear within a step "
	     "is not known",
		life, step_time);
}

static void follow(struct observations *s, struct lifetable *out, struct forecast *f)
{
	while (state_next(s)) {
		struct forecast_row row;
		double load[BANK_LOADS] = { 0 };

		covariates_read(s->table, load);
		if (forecast_add(f, s->t, s->value, s->gap, s->gap_error, load) != NUM_OK)
			die(EXIT_RUN, "out of memory");
		row = forecast_at(f, s->t);
		if (!isnan(s->gap)) {
			long n = row.n;

			stats_add("paths", n > 1 ? (double)n : 0);
			stats_add("paths_skipped", n > 1 ? 0 : (double)count);
		}
		lifetable_put(out, s->t, row);
		check_life(out, s->t);
		stats_add("rows", 1);
	}
	if (s->rows == 0)
		warn("%s: no rows", table_name(s->table));
}

/* The command line that reproduces the output: the state comes through a pipe if it
 * records its pipeline, else from its file. */
static char *record_cmd(const struct observations *s, int operand)
{
	const char *upstream = s->table ? table_key(s->table, "cmd") : NULL;
	char *extra = NULL, *cmd;

	if (!upstream && state_file && !operand)
		extra = xprintf("--state '%s'", state_file);
	cmd = opt_cmd(upstream, extra);
	free(extra);
	return cmd;
}

static struct lifetable *open_table(const struct observations *s, const char *cmd,
	char **made_by, const char *assumed)
{
	const char *start = s->table ? table_key(s->table, "start") : NULL;
	struct lifetable_par par = { .levels = &levels,
		.samples = samples,
		.grey = grey,
		.first = first_path,
		.least = wear_files.n ? count : 1,
		.eol = eol,
		.cone = cone,
		.horizon = horizon };
	struct lifetable *t = lifetable_open(cmd, &par);

	if (start)
		table_comment(lifetable_out(t), "start", "%s", start);
	if (assumed)
		table_comment(lifetable_out(t), "assumed", "%s", assumed);
	for (int k = 0; k < wear_files.n; k++)
		if (made_by[k])
			table_comment(lifetable_out(t), "wear", "%s made by %s",
				wear_files.v[k], made_by[k]);
	return t;
}

/* The fragments of --wear, and the step time that their sliding distance makes. */
static struct partition *read_fragments(char **made_by, char **doubts)
{
	double distance;
	struct partition *p =
		fragments_read(&wear_files, first_step, made_by, doubts, &distance);

	if (isnan(speed))
		return p;
	if (isnan(distance))
		die(EXIT_USAGE,
			"--speed: the tables of --wear do not state '# step_distance:'; specify "
			"--step-time");
	step_time = distance / speed;
	return p;
}

/* By chance in one series of a thousand. */
static const double TREND = 3.3;

static int doubt(struct lifetable *out, const char *why, const char *more)
{
	table_comment(lifetable_out(out), "doubtful", "%s", why);
	warn("%s%s", why, more);
	return EXIT_NOCONV;
}

/* Says so if the rate that is taken as constant is not, or if the values are not those of
 * one pair; its status. */
static int check_state(
	const struct observations *s, const struct forecast *f, struct lifetable *out)
{
	const struct bank *bank = forecast_bank(f);
	const struct observed *observed = forecast_observed(f);
	double trend = observed_rate_trend(observed);
	int status = 0;
	char *more;

	if (rescaled_alternates(&s->seen))
		status = doubt(out, "the values alternate between two courses",
			", as those of two machines do");
	if (bank && bank_stuck(bank))
		status = doubt(out, "the last values are equal",
			": the sensor sticks or is at the end of its range");
	else if (s->course.n > 0 &&
		 ((bank && bank_ceased(bank)) ||
			 plateau_reached(&s->course, pair_limit(s->pair), -INFINITY, 0)))
		status = doubt(out, "the gap has ceased to grow",
			": the wear rests, or the sensor is at the end of its range");
	if (bank && bank_recedes(bank))
		status = doubt(out, "the gap closes", ": no life ends");
	if (rule != RATE_FILTER && forecast_contradicts(f))
		status = doubt(out, "the gap does not grow at the rate of the fragments",
			": their step time, pressure or wear is not that of this pair");
	if (rule == RATE_MEAN &&
		(observed_falls(observed) || (bank && bank_repaired(bank))))
		return doubt(out, "the gap falls behind its rate",
			", as after a repair or a halt, and --wear-rate mean takes this for wear: "
			"--wear-rate filter does not");
	if (rule == RATE_FILTER || !(fabs(trend) > TREND))
		return status;
	more = xprintf(
		" in the course of the series (%.1f standard deviations of chance), and "
		"--wear-rate %s takes it as constant: --wear-rate filter follows it",
		fabs(trend), rules[rule]);
	status = doubt(out,
		trend > 0 ? "the rate of the gap grows" : "the rate of the gap falls",
		more);
	free(more);
	return status;
}

/* Says so if the state or the fragments are doubtful by their own account; the status. */
static int pass_doubt(struct lifetable *out, char *const *doubts)
{
	const char *far = covariates_doubt();
	int status = far ? EXIT_NOCONV : 0;

	if (far)
		table_comment(lifetable_out(out), "doubtful", "%s", far);
	for (int k = -1; k < wear_files.n; k++) {
		const char *why = k < 0 ? state_doubt() : doubts[k];

		if (!why)
			continue;
		table_comment(lifetable_out(out), "doubtful", "%s", why);
		status = EXIT_NOCONV;
	}
	return status;
}

int main(int argc, char **argv)
{
	char *made_by[OPT_TEXTS_MAX] = { NULL }, *doubts[OPT_TEXTS_MAX] = { NULL }, *cmd,
	     *assumed;
	struct partition *p = NULL;
	struct lifetable *out;
	struct forecast *f;
	struct observations s = { 0 };
	int i, status = 0;

	pump_init();
	i = opt_parse(&prog, argc, argv);
	if (argv[i] && state_file)
		die(EXIT_USAGE, "--state %s: the state is also the operand %s",
			state_file, argv[i]);
	if (argv[i])
		state_file = argv[i];
	settle();
	if (wear_files.n)
		p = read_fragments(made_by, doubts);
	if (!new)
		state_open(&s, state_file, &pump.pair);
	if (!new)
		covariates_open(s.table);
	assumed = pump_assumed(p != NULL, s.quantity == PAIR_LEAKAGE);
	if (p && fragments_close(p, &wear_files, doubts))
		status = EXIT_NOCONV;
	if (isnan(pump.pair.gap_new) && (new || s.quantity >= PAIR_VOLUME))
		pump.pair.gap_new = leakage_gap(&pump.pair.leakage, 1.5e-3 / 60);
	f = new_forecast(p, s.quantity, status != 0 || calibrations.n == 1);
	if (calibrations.n == 1) {
		warn("--calibrate %s: a single earlier unit: how units differ is unknown and not included",
			calibrations.v[0]);
		status = EXIT_NOCONV;
	}
	state_check();
	cmd = record_cmd(&s, argv[i] != NULL);
	if (rates_file)
		write_rates(forecast_paths(f), cmd);
	out = open_table(&s, cmd, made_by, assumed);
	if (new) {
		forecast_foresee(f);
		lifetable_put(out, 0, forecast_at(f, 0));
		check_life(out, 0);
	} else {
		follow(&s, out, f);
	}
	status |= check_state(&s, f, out) | pass_doubt(out, doubts);
	lifetable_close(out);
	covariates_close();
	if (assumed)
		warn("assumed: %s", assumed);
	if (!p && rule != RATE_FILTER && !(state_options.error > 0))
		warn("the rate is taken as exact, and all quantiles are equal: "
		     "--wear-rate filter gives an interval");
	forecast_free(f);
	partition_free(p);
	if (s.table)
		table_close(s.table);
	for (int k = 0; k < wear_files.n; k++) {
		free(made_by[k]);
		free(doubts[k]);
	}
	free(cmd);
	free(assumed);
	return shell_done(status);
}
