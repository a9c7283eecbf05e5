/* aopf - adaptive-order particle filter of a degradation series, and the time it has left
 */
#include "life/adaptive.h"
#include "life/predict.h"
#include "life/runin.h"
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/series.h"
#include "shell/stats.h"
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const directions[] = { "up", "down", "auto", NULL };
static const char *const orders[] = { "window", "insample", "all", NULL };
static const char *const schemes[] = { "systematic", "stratified", "residual",
	"multinomial", NULL };
static const char *const models[] = { "average", "linear", "exponential", "power", "rate",
	"grey", "literal", NULL };
static const char *const time_units[] = { "s", "min", "h", "d", NULL };
static const double seconds[] = { 1, 60, 3600, 86400 };

static double threshold = NAN, after = -INFINITY, zero, horizon, share = 0.5, freedom,
	      process = NAN, noise = NAN, hysteresis = 0.03;
static int direction = 2, scheme, model, time_unit;
static long persist = 3, particles = 300, largest = 60, window = 50, seed = 1;
static const char *const skips[] = { "auto", NULL };
static struct opt_choice order, skip = { -1, 0 };
static struct opt_list levels = { 3, { 0.05, 0.5, 0.95 } }, range;
static const char *unit_column, *fleet_file;

static const struct opt opts[] = {
	{ 'y', "threshold", OPT_NUM, UNIT_NONE, &threshold, -DBL_MAX, DBL_MAX, "Y",
		"value that ends the life, in units of y; none: no prediction of life",
		NULL, 0 },
	{ 'd', "direction", OPT_WORD, UNIT_NONE, &direction, 0, 0, "up|down|auto",
		"side the threshold is reached from; auto: from the first value",
		directions, 0 },
	{ 'k', "persist", OPT_INT, UNIT_COUNT, &persist, 1, 1e6, "K",
		"successive values beyond the threshold that end the life", NULL, 0 },
	{ 'z', "zero", OPT_NUM, UNIT_NONE, &zero, -DBL_MAX, DBL_MAX, "Y",
		"value of y without any degradation, the zero of the grey model", NULL,
		0 },
	{ 'T', "skip", OPT_CHOICE, UNIT_TIME, &skip, 0, DBL_MAX, "T|auto",
		"run-in left out of long-term models, from the first row", skips, 0 },
	{ 'n', "order", OPT_CHOICE, UNIT_COUNT, &order, 4, 1000, "N|window|insample|all",
		"order of the grey model, or how it is chosen", orders, 0 },
	{ 'P', "max-order", OPT_INT, UNIT_COUNT, &largest, 4, 1000, "N",
		"largest order that may be chosen", NULL, 0 },
	{ 'w', "order-window", OPT_INT, UNIT_COUNT, &window, 1, 10000, "N",
		"rows whose forecast errors choose the order", NULL, 0 },
	{ 'g', "hysteresis", OPT_NUM, UNIT_FRACTION, &hysteresis, 0, 1, "X",
		"relative fall of the error that changes the order", NULL, 0 },
	{ 'R', "order-range", OPT_LIST, UNIT_COUNT, &range, 0, 1000, "LO:HI",
		"orders searched while the trend goes on", NULL, 0 },
	{ 'N', "particles", OPT_INT, UNIT_COUNT, &particles, 1, 1e7, "N", "particles",
		NULL, 0 },
	{ 'r', "resampling", OPT_WORD, UNIT_NONE, &scheme, 0, 0,
		"systematic|stratified|residual|multinomial", "resampling scheme",
		schemes, 0 },
	{ 'e', "ess", OPT_NUM, UNIT_FRACTION, &share, 0, 1, "X",
		"resample below this effective share of the particles; 1: always", NULL,
		0 },
	{ 'l', "freedom", OPT_NUM, UNIT_NONE, &freedom, 0, 1e6, "NU",
		"degrees of freedom of Student-t observation noise; 0: Gaussian", NULL,
		0 },
	{ 'a', "sigma-u", OPT_NUM, UNIT_NONE, &process, 0, DBL_MAX, "SD",
		"process noise per row, in units of y (default from the innovations)",
		NULL, 0 },
	{ 'b', "sigma-v", OPT_NUM, UNIT_NONE, &noise, 0, DBL_MAX, "SD",
		"observation noise, in units of y (default from second differences)",
		NULL, 0 },
	{ 'm', "model", OPT_WORD, UNIT_NONE, &model, 0, 0,
		"average|linear|exponential|power|rate|grey|literal", "long-term model",
		models, 0 },
	{ 'H', "horizon", OPT_NUM, UNIT_TIME, &horizon, 0, DBL_MAX, "T",
		"longest life ahead; 0: ten times the time so far", NULL, 0 },
	{ 'A', "after", OPT_NUM, UNIT_TIME, &after, -DBL_MAX, DBL_MAX, "T",
		"time from which on life is predicted (default all the time)", NULL, 0 },
	{ 'q', "levels", OPT_LIST, UNIT_FRACTION, &levels, 0, 1, "Q,Q,...",
		"levels of the quantiles of remaining life", NULL, 0 },
	{ 'F', "fleet", OPT_TEXT, UNIT_NONE, &fleet_file, 0, 0, "FILE",
		"table of earlier units that reached the threshold: unit t y", NULL, 0 },
	{ 'u', "unit", OPT_TEXT, UNIT_NONE, &unit_column, 0, 0, "COLUMN",
		"column that tells units apart", NULL, 0 },
	{ 't', "time-unit", OPT_WORD, UNIT_NONE, &time_unit, 0, 0, "s|min|h|d",
		"unit of the time column", time_units, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e18, "N",
		"seed of the random numbers", NULL, 0 },
	OPT_END
};

static const struct prog prog = { "aopf",
	"Filter a degradation series and predict the life it has left.", "[file]",
	"table: t y (or y alone: t is the row, from 0)",
	"table: one row per row read, flushed at once", opts };

static struct fleet *fleet; /* NULL without --fleet */

/* What is kept of one unit between its rows. */
struct unit_state {
	struct adaptive *adaptive;
	struct predict
		*predict; /* NULL without a threshold, and before the first value */
	struct runin runin;
	double first; /* time */
	long rows;
	long beyond; /* successive values past the threshold */
	int failed;
};

struct units {
	struct unit_state *unit;
	int n;
};

static struct unit_state *find_unit(struct units *units, int number)
{
	struct adaptive_par par = {
		.filter = { (size_t)particles, 0, (enum resampling)scheme, share,
			freedom },
		.order = { order.word < 0 ? ORDER_FIXED : (enum order_rule)order.word,
			order.word < 0 ? (int)order.value : (int)largest, (int)window,
			hysteresis, (int)range.v[0], (int)range.v[1] },
		.process = process,
		.noise = noise,
		.seed = (uint64_t)seed,
		.realisation = (uint32_t)number,
	};
	struct unit_state *u;

	if (number < units->n)
		return &units->unit[number];
	units->unit = xrealloc(units->unit, (size_t)number + 1, sizeof *units->unit);
	u = &units->unit[units->n++];
	*u = (struct unit_state){ .adaptive = adaptive_new(&par) };
	if (!u->adaptive)
		die(EXIT_RUN, "no memory for %ld particles", particles);
	return u;
}

static struct fleet *read_fleet(void)
{
	struct series *in = series_open(fleet_file, unit_column ? unit_column : "unit");
	struct fleet *f = fleet_new(threshold, 1 - 2 * direction);
	int failed = f != NULL, n;

	while (failed && series_next(in))
		if (!isnan(series_value(in)))
			failed = fleet_add(
				f, series_unit(in), series_time(in), series_value(in));
	n = series_units(in);
	failed = failed ? fleet_build(f) : -1;
	if (failed < 0)
		die(EXIT_RUN, "no memory for the fleet");
	if (failed < FLEET_MIN)
		die(EXIT_RUN, "%s: %d of %d units reach the threshold; want %d or more",
			fleet_file, failed, n, (int)FLEET_MIN);
	stats_set("fleet_units", failed);
	stats_set("fleet_units_left_out", n - failed);
	series_close(in);
	return f;
}

/* Long-term prediction begins with the first value, which may tell the direction. */
static void start_predict(struct unit_state *u, double y, int number)
{
	struct predict_par par = {
		.model = (enum predict_model)model,
		.threshold = threshold,
		.direction =
			direction == 2 ? (y <= threshold ? 1 : -1) : 1 - 2 * direction,
		.zero = zero,
		.horizon = horizon / seconds[time_unit],
		.fleet = fleet,
		.adaptive = u->adaptive,
		.draws = model == PREDICT_LITERAL ? (int)particles : 500,
		.seed = (uint64_t)seed,
		.realisation = (uint32_t)number,
	};

	u->predict = predict_new(&par);
	if (!u->predict)
		die(EXIT_RUN, "no memory for the prediction");
	u->runin.direction = par.direction;
}

/* What the long-term model is told of a row. */
static void learn(
	struct unit_state *u, double t, double y, const struct adaptive_row *row)
{
	if (skip.word == 0 && !isnan(y) && runin_add(&u->runin, y, row->noise)) {
		predict_restart(u->predict);
		stats_add("run_ins", 1);
	}
	if (skip.word == 0 || t - u->first >= skip.value / seconds[time_unit])
		predict_add(u->predict, t, y, row->state + zero);
	else
		stats_add("rows_skipped", 1);
}

static void put_life(struct unit_state *u, struct table_out *out, double t, double y)
{
	double q[OPT_LIST_MAX], never = NAN;
	int wanted = t >= after / seconds[time_unit];

	if (!isnan(y))
		u->beyond = u->runin.direction * (y - threshold) >= 0 ? u->beyond + 1 : 0;
	u->failed |= u->predict && u->beyond >= persist;
	for (int i = 0; i < levels.n; i++)
		q[i] = u->failed ? 0 : NAN;
	if (u->failed)
		never = 0;
	else if (u->predict && wanted)
		predict_life(u->predict, levels.v, q, levels.n, &never);
	stats_add("lives", u->predict && !u->failed && wanted);
	stats_add("lives_left_out", u->failed || !wanted);
	for (int i = 0; i < levels.n; i++)
		table_put(out, q[i]);
	table_put(out, never);
}

static void step(struct unit_state *u, const struct series *in, struct table_out *out)
{
	double t = series_time(in), y = series_value(in);
	struct adaptive_row row;

	if (u->rows++ == 0)
		u->first = t;
	adaptive_step(u->adaptive, t, y - zero, &row);
	if (unit_column)
		table_put_text(out, series_unit_name(in));
	table_put(out, t);
	table_put(out, y);
	table_put(out, row.grey + zero);
	table_put(out, row.prediction + zero);
	table_put(out, row.state + zero);
	table_put(out, row.order);
	table_put(out, row.ess);
	if (!isnan(threshold)) {
		if (!u->predict && !isnan(y))
			start_predict(u, y, series_unit(in));
		if (u->predict)
			learn(u, t, y, &row);
		put_life(u, out, t, y);
	}
	table_end_row(out);
	table_flush(out);
}

static char *column_names(void)
{
	char *longer;
	char *names = xprintf(
		"%st y grey prediction state order ess", unit_column ? "unit " : "");

	if (isnan(threshold))
		return names;
	for (int i = 0; i < levels.n; i++) {
		char digits[32];
		const char *decimals;

		/* 0.05, 0.5 and 0.975 are called 05, 50 and 975. */
		snprintf(digits, sizeof digits, "%g", levels.v[i]);
		decimals = strncmp(digits, "0.", 2) ? digits : digits + 2;
		longer = xprintf("%s rul_q%s%s", names, decimals, decimals[1] ? "" : "0");
		free(names);
		names = longer;
	}
	longer = xprintf("%s p_no_crossing", names);
	free(names);
	return longer;
}

/* Units of the columns written, when the input says "T Y"; NULL otherwise. */
static char *column_units(const char *read)
{
	char t[32], y[32], more, *units, *longer;

	if (!read || strchr(read, ':') || sscanf(read, "%31s %31s %c", t, y, &more) != 2)
		return NULL;
	units = xprintf("%s%s %s %s %s %s 1 1", unit_column ? "1 " : "", t, y, y, y, y);
	for (int i = 0; i <= levels.n && !isnan(threshold); i++) {
		longer = xprintf("%s %s", units, i < levels.n ? t : "1");
		free(units);
		units = longer;
	}
	return units;
}

static void finish(struct units *units)
{
	for (int i = 0; i < units->n; i++) {
		struct unit_state *u = &units->unit[i];
		const struct order *o = adaptive_order(u->adaptive);

		stats_add("rows", (double)u->rows);
		stats_add("resamplings",
			(double)filter_resamplings(adaptive_filter(u->adaptive)));
		stats_add("outliers", (double)adaptive_outliers(u->adaptive));
		stats_add("restarts", (double)adaptive_restarts(u->adaptive));
		stats_add("orders", (double)order_tried(o));
		stats_add("orders_skipped", (double)order_skipped(o));
		stats_add("order_changes", (double)order_changes(o));
		adaptive_free(u->adaptive);
		predict_free(u->predict);
	}
	free(units->unit);
}

static void check_options(void)
{
	if (range.n == 1 || (range.n == 2 && range.v[0] > range.v[1]))
		die(EXIT_USAGE, "--order-range: want LO:HI");
	for (int k = 1; k < levels.n; k++)
		if (levels.v[k] <= levels.v[k - 1])
			die(EXIT_USAGE, "--levels: want rising levels");
	if (fleet_file && (isnan(threshold) || direction == 2))
		die(EXIT_USAGE, "--fleet wants --threshold and --direction up or down");
}

int main(int argc, char **argv)
{
	struct series *in;
	struct table_out *out;
	struct units units = { 0 };
	char *cmd, *names, *units_line;
	int i;

	order.word = ORDER_WINDOW;
	i = opt_parse(&prog, argc, argv);
	check_options();
	if (fleet_file)
		fleet = read_fleet();
	in = series_open(argv[i], unit_column);
	cmd = opt_cmd(table_key(series_table(in), "cmd"), NULL);
	names = column_names();
	units_line = column_units(table_key(series_table(in), "units"));
	out = table_create(NULL, cmd, units_line, names);
	table_comment(out, "seed", "%ld", seed);
	while (series_next(in))
		step(find_unit(&units, series_unit(in)), in, out);
	finish(&units);
	fleet_free(fleet);
	table_done(out);
	series_close(in);
	free(cmd);
	free(names);
	free(units_line);
	return shell_done(0);
}
