#include "remaining_life.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/quantile_columns.h"
#include "common/time_unit.h"
#include "filter_options.h"
#include "io/series.h"
#include "life/fleet.h"
#include "life/metrics.h"
#include "life/predict.h"
#include "life/runin.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { UP, DOWN, AUTO };
static const char *const directions[] = { "up", "down", "auto", NULL };
static const char *const models[] = { "average", "linear", "exponential", "power", "rate",
	"grey", "literal", NULL };
static const char *const skips[] = { "auto", NULL };

struct outlook_options outlook_options = { .threshold = NAN };

static double after = -INFINITY, horizon;
static int direction = AUTO, model;
static long persist = 3;
static struct opt_choice skip = { -1, 0 };
static struct opt_list levels = { 3, { 0.05, 0.5, 0.95 } };
static const char *fleet_file;

struct opt outlook_end_rows[] = {
	{ 'y', "threshold", OPT_NUM, UNIT_NONE, &outlook_options.threshold, -DBL_MAX,
		DBL_MAX, "Y",
		"value that ends the life, in units of y; none: no prediction of life",
		NULL, 0 },
	{ 0, "direction", OPT_WORD, UNIT_NONE, &direction, 0, 0, "up|down|auto",
		"side the threshold is reached from; auto: from the first value",
		directions, 0 },
	{ 0, "persist", OPT_INT, UNIT_COUNT, &persist, 1, 1e6, "K",
		"successive values beyond the threshold that end the life", NULL, 0 },
	{ 0, "zero", OPT_NUM, UNIT_NONE, &outlook_options.zero, -DBL_MAX, DBL_MAX, "Y",
		"value of y without any degradation, the zero of the grey model", NULL,
		0 },
	{ 0, "skip", OPT_CHOICE, UNIT_TIME, &skip, 0, DBL_MAX, "T|auto",
		"run-in left out of long-term models, from the first row", skips, 0 },
	OPT_END
};

struct opt outlook_model_rows[] = {
	{ 0, "model", OPT_WORD, UNIT_NONE, &model, 0, 0,
		"average|linear|exponential|power|rate|grey|literal", "long-term model",
		models, 0 },
	{ 0, "horizon", OPT_NUM, UNIT_TIME, &horizon, 0, DBL_MAX, "T",
		"longest life ahead; 0: ten times the time so far", NULL, 0 },
	{ 0, "after", OPT_NUM, UNIT_TIME, &after, -DBL_MAX, DBL_MAX, "T",
		"time from which on life is predicted (default all the time)", NULL, 0 },
	{ 0, "levels", OPT_LIST, UNIT_FRACTION, &levels, 0, 1, "Q,Q,...",
		"levels of the quantiles of remaining life", NULL, 0 },
	{ 0, "fleet", OPT_TEXT, UNIT_NONE, &fleet_file, 0, 0, "FILE",
		"table of earlier units, failed or not: unit t y", NULL, 0 },
	OPT_TABLE(timeunit_rows), OPT_END
};

enum { DRAWS = 500 };

static struct fleet *fleet; /* NULL without --fleet */
static struct bank_chances *chances;
static double *life; /* draws of one prediction */

struct outlook {
	int unit;
	struct adaptive *filter;
	struct predict *predict; /* NULL before the first value */
	struct runin runin;
	double first; /* time */
	long rows;
	long beyond; /* successive values past the threshold */
	int failed;
};

void outlook_check(void)
{
	for (int k = 1; k < levels.n; k++)
		if (levels.v[k] <= levels.v[k - 1])
			die(EXIT_USAGE, "--levels: want rising levels");
	if (fleet_file && (isnan(outlook_options.threshold) || direction == AUTO))
		die(EXIT_USAGE, "--fleet wants --threshold and --direction up or down");
}

static void read_fleet(const char *unit_column)
{
	struct series *in = series_open(fleet_file, unit_column);
	int good, failed, carried_on, n;

	fleet = fleet_new(outlook_options.threshold, direction == UP ? 1 : -1);
	good = fleet != NULL;
	while (good && series_next(in))
		if (!isnan(series_value(in)))
			good = fleet_add(fleet, series_unit(in), series_time(in),
				series_value(in));
	n = good ? fleet_build(fleet, &failed, &carried_on) : -1;
	if (n < 0)
		die(EXIT_RUN, "no memory for the fleet");
	if (n == 0)
		die(EXIT_RUN, "%s: none of %d units shows any wear to compare with",
			fleet_file, series_units(in));
	stats_set("fleet_units", failed);
	stats_set("fleet_units_carried_on", carried_on);
	stats_set("fleet_units_left_out", series_units(in) - n);
	series_close(in);
}

void outlook_open(const char *unit_column)
{
	size_t draws = model == PREDICT_LITERAL ? (size_t)filtering.particles : DRAWS;

	if (isnan(outlook_options.threshold))
		return;
	chances = bank_chances_new(DRAWS, (uint64_t)filtering.seed);
	if (!chances)
		die(EXIT_RUN, "no memory");
	life = xcalloc(draws, sizeof *life);
	if (fleet_file)
		read_fleet(unit_column ? unit_column : "unit");
}

void outlook_close(void)
{
	fleet_free(fleet);
	bank_chances_free(chances);
	free(life);
}

struct outlook *outlook_new(int unit, struct adaptive *filter)
{
	struct outlook *o = xcalloc(1, sizeof *o);

	o->unit = unit;
	o->filter = filter;
	return o;
}

void outlook_free(struct outlook *o)
{
	if (o)
		predict_free(o->predict);
	free(o);
}

/* Prediction begins with the first value, which may tell the direction. */
static void start(struct outlook *o, double y)
{
	int up = direction == AUTO ? y <= outlook_options.threshold : direction == UP;
	struct predict_par par = {
		.model = (enum predict_model)model,
		.threshold = outlook_options.threshold,
		.direction = up ? 1 : -1,
		.zero = outlook_options.zero,
		.horizon = horizon / timeunit(),
		.adaptive = o->filter,
		.draws = (int)filtering.particles,
		.chances = chances,
	};

	if (fleet)
		par.paths = fleet_shapes(fleet, &par.n_paths);
	o->predict = predict_new(&par);
	if (!o->predict)
		die(EXIT_RUN, "no memory for the prediction");
	o->runin.direction = par.direction;
}

/* What the long-term model is told of a row. */
static void learn(struct outlook *o, double t, double y, const struct adaptive_row *row)
{
	if (skip.word == 0 && !isnan(y) && runin_add(&o->runin, y, row->noise)) {
		predict_restart(o->predict);
		stats_add("run_ins", 1);
	}
	if (skip.word == 0 || t - o->first >= skip.value / timeunit())
		predict_add(o->predict, t, y, row->state + outlook_options.zero);
	else
		stats_add("rows_skipped", 1);
}

/* Quantiles of the lives, and the share of them that has no end; 0 where there are none
 * yet. */
static int foresee(struct outlook *o, double *quantile, double *never)
{
	int n = predict_draws(o->predict), drawn = predict_life(o->predict, life),
	    ends = n;

	if (drawn < 0)
		die(EXIT_RUN, "no memory for %d paths", n);
	if (!drawn)
		return 0;
	for (int i = 0; i < levels.n; i++)
		quantile[i] = metric_quantile(life, (size_t)n, levels.v[i]);
	while (ends > 0 && isinf(life[ends - 1]))
		ends--;
	*never = (double)(n - ends) / n;
	return 1;
}

static void put_life(struct outlook *o, struct table_out *out, double t, double y)
{
	double q[OPT_LIST_MAX], never = NAN;
	int wanted = t >= after / timeunit();

	if (!isnan(y))
		o->beyond = o->runin.direction * (y - outlook_options.threshold) >= 0
				    ? o->beyond + 1
				    : 0;
	o->failed |= o->predict && o->beyond >= persist;
	for (int i = 0; i < levels.n; i++)
		q[i] = o->failed ? 0 : NAN;
	if (o->failed)
		never = 0;
	else if (o->predict && wanted)
		foresee(o, q, &never);
	stats_add("lives", o->predict && !o->failed && wanted);
	stats_add("lives_left_out", o->failed || !wanted);
	for (int i = 0; i < levels.n; i++)
		table_put(out, q[i]);
	table_put(out, never);
}

void outlook_put(struct outlook *o, double t, double y, const struct adaptive_row *row,
	struct table_out *out)
{
	if (o->rows++ == 0)
		o->first = t;
	if (!o->predict && !isnan(y))
		start(o, y);
	if (o->predict)
		learn(o, t, y, row);
	put_life(o, out, t, y);
}

char *outlook_columns(const char *before)
{
	char *names = levels_columns(before, "rul_q", &levels);
	char *longer = xprintf("%s p_no_crossing", names);

	free(names);
	return longer;
}

char *outlook_units(const char *before, const char *time)
{
	char *units = xstrdup(before), *longer;

	for (int i = 0; i <= levels.n; i++) {
		longer = xprintf("%s %s", units, i < levels.n ? time : "1");
		free(units);
		units = longer;
	}
	return units;
}
