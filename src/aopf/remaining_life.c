#include "remaining_life.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/covariates.h"
#include "common/quantile_columns.h"
#include "common/time_unit.h"
#include "event_list.h"
#include "filter_options.h"
#include "fleet_table.h"
#include "io/quantities.h"
#include "io/reasons.h"
#include "io/series.h"
#include "life/grey/grey.h"
#include "life/score/metrics.h"
#include "life/trend/passage.h"
#include "life/trend/plateau.h"
#include "life/trend/rescaled.h"
#include "num/select.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { UP, DOWN, AUTO };
/* Long-term models: the bank with all coordinates or those of one family, GM(1,1) through
 * the filtered states, and particles that continue step by step. */
enum { AVERAGE, GREY = 6, LITERAL };
static const char *const directions[] = { "up", "down", "auto", NULL };
static const char *const models[] = { "average", "linear", "exponential", "power", "rate",
	"saturating", "grey", "literal", NULL };
static const unsigned families[] = { BANK_ALL, BANK_LINEAR, BANK_EXPONENTIAL, BANK_POWER,
	BANK_RATE, BANK_SATURATING };

/* The share of the lives below a quantile of 5 % is then known to
 * sqrt(0.05 * 0.95 / 500) = 1 %.  Where a failure costs more than this number of
 * replacements, the time of the lowest cost is before the first draw. */
enum { DRAWS = 500 };

double outlook_threshold = NAN;

static double after = -INFINITY, horizon, skip;
static int direction = AUTO, model;
static long persist = 3;
static struct opt_list levels = { 3, { 0.05, 0.5, 0.95 } };
static const char *fleet_file, *events_file;
static int weights;
static double mission = NAN, cost_ratio = NAN;
static struct opt_list alarms;

struct opt outlook_end_rows[] = { OPT_HEADING("End of life"),
	{ 'y', "threshold", OPT_NUM, UNIT_NONE, &outlook_threshold, -DBL_MAX, DBL_MAX,
		"Y", "value of y at failure; without it no life is predicted", NULL, 0 },
	{ 0, "direction", OPT_WORD, UNIT_NONE, &direction, 0, 0, "up|down|auto",
		"direction towards the threshold; auto: from the first value", directions,
		0 },
	{ 0, "persist", OPT_INT, UNIT_COUNT, &persist, 1, 1e6, "K",
		"successive values beyond the threshold that constitute failure", NULL,
		0 },
	{ 0, "skip", OPT_NUM, UNIT_TIME, &skip, 0, DBL_MAX, "T",
		"run-in that the long-term model does not use, from the first row", NULL,
		0 },
	OPT_END };

struct opt outlook_model_rows[] = { OPT_HEADING("Prediction"),
	{ 0, "model", OPT_WORD, UNIT_NONE, &model, 0, 0,
		"average|linear|exponential|power|rate|saturating|grey|literal",
		"long-term model", models, 0 },
	{ 0, "horizon", OPT_NUM, UNIT_TIME, &horizon, 0, DBL_MAX, "T",
		"longest remaining life; 0: ten times the time so far", NULL, 0 },
	{ 0, "after", OPT_NUM, UNIT_TIME, &after, -DBL_MAX, DBL_MAX, "T",
		"predict the remaining life only from this time on (default always)",
		NULL, 0 },
	{ 0, "levels", OPT_LIST, UNIT_FRACTION, &levels, 0, 1, "Q,Q,...",
		"levels of the quantiles of remaining life", NULL, 0 },
	{ 0, "fleet", OPT_TEXT, UNIT_NONE, &fleet_file, 0, 0, "FILE",
		"table of earlier units, failed or not: unit t y", NULL, 0 },
	OPT_TABLE(covariate_rows),
	{ 0, "weights", OPT_FLAG, UNIT_NONE, &weights, 0, 0, NULL,
		"add columns with the weight of each family of models", NULL, 0 },
	OPT_TABLE(timeunit_rows), OPT_END };

struct opt outlook_plant_rows[] = {
	{ 0, "events", OPT_TEXT, UNIT_NONE, &events_file, 0, 0, "FILE",
		"table of repairs and changes of load: t event [unit]", NULL, 0 },
	{ 0, "mission", OPT_NUM, UNIT_TIME, &mission, 0, DBL_MAX, "T",
		"add the probability of failure within this time", NULL, 0 },
	{ 0, "cost-ratio", OPT_NUM, UNIT_NONE, &cost_ratio, 1, DRAWS, "R",
		"add the optimal replacement time if a failure costs R replacements",
		NULL, 0 },
	{ 0, "alarm", OPT_LIST, UNIT_TIME, &alarms, 0, DBL_MAX, "T,T,...",
		"add the alarm level: number of these descending times reached", NULL,
		0 },
	OPT_END
};

/* An alarm is cleared once the quantile exceeds its level by this factor.  In 20 noisy
 * series of 150 rows with exponential growth and levels of 9 and 3 % of the life, 1, 1.1,
 * 1.25, 1.5 and 2 raise it 185, 123, 83, 31 and 8 times and leave 1753, 1903, 2130, 2753
 * and 3000 rows in alarm. */
static const double CLEARED = 1.25;

static const struct {
	const char *name;
	enum bank_family family;
} weighed[] = { { "linear", BANK_LINEAR }, { "exponential", BANK_EXPONENTIAL },
	{ "power", BANK_POWER }, { "rate", BANK_RATE }, { "saturating", BANK_SATURATING },
	{ "fleet", BANK_OTHER }, { "changed", BANK_ALL } };

enum { WEIGHED = sizeof weighed / sizeof *weighed };

static struct bank_chances *chances;

struct outlook {
	const char *unit; /* its name */
	char *prefix;     /* of messages, tells the name if there is one */
	struct adaptive *filter;
	struct bank *bank; /* NULL before the first value, for GREY and for LITERAL */
	struct outlook_state {
		int direction; /* 0 before the first value */
		struct rescaled scale;
		struct plateau course;
		struct grey_series grey;        /* of the filtered states, for GREY */
		double factor, range, rescaled; /* of the values, or of the counter, from
						 * about this time on; 0: none */
		double first, clock;            /* times of the first and the last row */
		double from;                    /* of the first in use; NAN: none yet */
		double heeded;                  /* events up to this time are done */
		double early;                   /* the last of those without an effect */
		long rows;
		long beyond;  /* successive values past the threshold */
		long healthy; /* values short of it */
		int failed, alarm;
		int leapt; /* 1: failed by values that no trend had foreseen */
		unsigned long lives, left_out, skipped, events, standing;
	} now;
};

void outlook_check(int bare)
{
	static const char *const of_bank[] = { "weights", "events", "covariate",
		"fleet" };

	levels_check(&levels);
	for (int k = 1; k < alarms.n; k++)
		if (alarms.v[k] >= alarms.v[k - 1])
			die(EXIT_USAGE, "--alarm: times must be descending");
	if (fleet_file && (isnan(outlook_threshold) || direction == AUTO))
		die(EXIT_USAGE,
			"--fleet requires --threshold and --direction up or down");
	if (isnan(outlook_threshold) && (bare || opt_any_given(outlook_plant_rows)))
		die(EXIT_USAGE, "--%s requires --threshold",
			bare ? "lives-only" : opt_any_given(outlook_plant_rows));
	opt_require("threshold",
		"direction persist skip model horizon after levels weights covariate "
		"clock");
	for (size_t i = 0; i < sizeof of_bank / sizeof *of_bank; i++)
		if (model >= GREY && opt_given(of_bank[i]))
			die(EXIT_USAGE, "--%s is not for --model %s", of_bank[i],
				models[model]);
	covariates_check();
	if (bare && model >= GREY)
		die(EXIT_USAGE,
			"--lives-only excludes --model grey and literal, which require the "
			"filter");
	if (bare && opt_any_given(filtering_rows))
		die(EXIT_USAGE, "--lives-only excludes --%s, an option of the filter",
			opt_any_given(filtering_rows));
}

/* Of the tables of the fleet and of events, by their own account, and of covariates. */
static struct reasons doubts;

const char *outlook_doubt(void)
{
	reasons_add(&doubts, covariates_doubt());
	return reasons_text(&doubts);
}

void outlook_open(struct series *in, const char *unit_column, const char *clock_column)
{
	static const char *const timed[] = { "skip", "horizon", "after", "mission",
		"alarm" };
	const char *unit = unit_column ? unit_column : "unit";
	int needed = 0;

	for (size_t i = 0; i < sizeof timed / sizeof *timed; i++)
		needed |= opt_given(timed[i]);
	timeunit_settle(series_table(in), series_time_column(in), needed);
	for (size_t i = 0; i < sizeof timed / sizeof *timed; i++)
		if (opt_given(timed[i]) && !opt_given_bare(timed[i]) &&
			!strcmp(timeunit_word(), "1"))
			die(EXIT_USAGE,
				"--%s has a unit, but the series names none of its times: specify "
				"--time-unit",
				timed[i]);
	series_scale(in, 1, 1); /* a unit that changes within the table is an error */
	if (isnan(outlook_threshold))
		return;
	covariates_open(series_table(in));
	chances = bank_chances_new(DRAWS, (uint64_t)filtering.seed);
	if (!chances)
		die(EXIT_RUN, "no memory");
	if (fleet_file)
		fleet_table_read(fleet_file, unit, clock_column, outlook_threshold,
			direction == UP ? 1 : -1, in, &doubts);
	if (events_file)
		event_list_read(events_file, unit, &doubts);
}

void outlook_close(void)
{
	covariates_close();
	fleet_table_free();
	event_list_free();
	bank_chances_free(chances);
	reasons_free(&doubts);
}

struct outlook *outlook_new(const char *unit, struct adaptive *filter)
{
	struct outlook *o = xcalloc(1, sizeof *o);

	o->unit = unit;
	o->prefix = xprintf("%s%s", unit, *unit ? ": " : "");
	o->filter = filter;
	o->now.heeded = o->now.early = -INFINITY;
	o->now.from = NAN;
	return o;
}

void outlook_free(struct outlook *o)
{
	if (!o)
		return;
	bank_free(o->bank);
	free(o->prefix);
	free(o);
}

/* Prediction begins with the first value, which may determine the direction. */
static void start(struct outlook *o)
{
	struct bank_par par = { .threshold = outlook_threshold,
		.direction = o->now.direction,
		.steady = model != AVERAGE,
		.load = covariates_future(),
		.n_loads = covariates_count() };

	if (model >= GREY)
		return;
	par.more = fleet_table_shapes(&par.n_more);
	par.families = families[model] | (par.more ? BANK_OTHER : 0);
	par.own = fleet_table_shape_of(o->unit);
	o->bank = bank_new(&par);
	if (!o->bank)
		die(EXIT_RUN, "no memory for the prediction");
}

/* A state saved before the first value has its full size. */
void outlook_pass(struct outlook *o, struct state *s)
{
	state_move(s, &o->now, sizeof o->now);
	if (!o->bank)
		start(o);
	if (o->bank)
		bank_pass(o->bank, s);
	if (o->now.direction != 0)
		return;
	bank_free(o->bank);
	o->bank = NULL;
}

/* Events since the last row in which the clock advanced.  Those of a kind are one, as the
 * rows know nothing of what was between them. */
static void heed_events(struct outlook *o, const struct outlook_row *in)
{
	double last[BANK_LOAD + 1];
	unsigned long n = event_list_between(o->unit, o->now.heeded, in->t, last);

	if (n > 0) { /* they explain it */
		o->now.scale = (struct rescaled){ 0 };
		o->now.course = (struct plateau){ 0 };
		o->now.events += n;
	}
	for (enum bank_event e = BANK_REPAIR; e <= BANK_LOAD; e++)
		if (last[e] > -INFINITY && !bank_event(o->bank, e))
			o->now.early = fmax(o->now.early, last[e]);
	o->now.heeded = in->t;
}

/* Passes a row to the long-term model. */
static void learn(struct outlook *o, const struct outlook_row *in,
	const struct adaptive_row *filtered)
{
	struct outlook_state *now = &o->now;
	double gap = in->clock - now->clock;

	if (now->rows > 0 && gap <= 0) {
		now->standing++; /* no time of wear has passed */
		return;
	}
	now->clock = in->clock;
	heed_events(o, in);
	if (!isnan(in->y))
		plateau_add(&now->course, in->clock, in->y);
	if (in->clock - now->first < skip / timeunit()) {
		now->skipped++;
		return;
	}
	if (isnan(now->from))
		now->from = in->clock;
	if (model == GREY)
		grey_append(&now->grey, filtered->state, gap);
	if (!o->bank)
		return;
	bank_load(o->bank, in->clock, in->load);
	bank_add(o->bank, in->clock, in->y);
}

static int raise_alarm(int standing, double quantile)
{
	int level = 0;

	for (int k = 0; k < alarms.n; k++) {
		double limit = alarms.v[k] / timeunit();

		if (quantile <= limit * (k < standing ? CLEARED : 1))
			level = k + 1;
	}
	return level;
}

/* The time at which a unit of this age is best replaced in advance, where a failure costs
 * ratio times as much (age replacement: Barlow, Hunter, Operations Research 8 (1960) 90),
 * from n ascending lives; INFINITY: never. */
static double replacement(const double *life, int n, double age, double ratio)
{
	double best = INFINITY, area = 0, before = 0;
	int at = -1, last = -1;

	/* cost per time of a replacement just before the i-th failure */
	for (int i = 0; i < n && isfinite(life[i]); i++) {
		double failed = (double)i / n, cost;

		area += (1 - failed) * (life[i] - before);
		before = life[i];
		cost = (1 + (ratio - 1) * failed) / (age + area);
		if (cost < best) {
			best = cost;
			at = i;
		}
		last = i;
	}
	/* If the cost still falls after the first failure and until the last one, no
	 * replacement is advised. */
	return at == last && at != 0 ? INFINITY : life[at];
}

/* Fills the cells of a life, ascending draws.  Those beyond the horizon count as infinite
 * only in its quantiles: what is decided must not depend on it. */
static void put_draws(
	struct outlook *o, const double *life, int n, double longest, double *cell)
{
	int ends = n, failures = 0;

	for (int i = 0; i < levels.n; i++) {
		double q = sorted_quantile(life, (size_t)n, levels.v[i]);

		*cell++ = q <= longest ? q : INFINITY;
	}
	while (ends > 0 && !(life[ends - 1] <= longest))
		ends--;
	*cell++ = (double)(n - ends) / n;
	while (failures < n && life[failures] <= mission / timeunit())
		failures++;
	if (!isnan(mission))
		*cell++ = (double)failures / n;
	if (!isnan(cost_ratio))
		*cell++ = replacement(life, n, o->now.clock - o->now.first, cost_ratio);
	if (alarms.n > 0)
		*cell = o->now.alarm = raise_alarm(
			o->now.alarm, sorted_quantile(life, (size_t)n, levels.v[0]));
}

/* Draws n remaining lives at the last row, with the same random numbers at every row, so
 * that successive rows differ only by their data; NUM_DOMAIN while there are too few. */
static enum num_status draw_lives(const struct outlook *o, int n, double *life)
{
	const struct outlook_state *now = &o->now;
	double threshold = outlook_threshold;

	if (model == LITERAL)
		return adaptive_lives(o->filter, threshold, now->direction, life);
	if (bank_ready(o->bank))
		return bank_draw(o->bank, chances, now->clock, threshold, life);
	if (o->bank || now->grey.forward.n < GREY_ORDER_MIN)
		return NUM_DOMAIN;
	for (int i = 0; i < n; i++)
		life[i] = grey_life(&now->grey, threshold, now->direction,
			bank_chance_normal(chances, i, 0),
			bank_chance_normal(chances, i, 1));
	return NUM_OK;
}

static void foresee(struct outlook *o, double *cell)
{
	int n = model == LITERAL ? (int)filtering.particles : DRAWS;
	double *life = malloc((size_t)n * sizeof *life), longest = horizon / timeunit();
	enum num_status status = life ? draw_lives(o, n, life) : NUM_MEMORY;

	if (status == NUM_MEMORY)
		die(EXIT_RUN, "no memory for %d paths", n);
	if (!(longest > 0))
		longest = fleet_file ? INFINITY : 10 * (o->now.clock - o->now.from);
	if (status == NUM_OK) {
		metric_cut(life, (size_t)n, INFINITY);
		put_draws(o, life, n, longest, cell);
	}
	free(life);
}

static void put_trends(const struct outlook *o, double *cell)
{
	int ready = bank_ready(o->bank);

	for (int k = 0; k < covariates_count(); k++)
		*cell++ = ready ? bank_factor(o->bank, k) : NAN;
	for (int k = 0; weights && k < WEIGHED; k++)
		*cell++ = ready ? bank_weight(o->bank, weighed[k].family) : NAN;
}

static int life_cells(void)
{
	return levels.n + 1 + !isnan(mission) + !isnan(cost_ratio) + (alarms.n > 0);
}

int outlook_cells(void)
{
	return isnan(outlook_threshold)
		       ? 0
		       : life_cells() + covariates_count() + (weights ? WEIGHED : 0);
}

static int is_rescaled(const struct outlook *o)
{
	return o->now.factor != 0 || o->now.range != 0;
}

void outlook_step(struct outlook *o, const struct outlook_row *in,
	const struct adaptive_row *filtered, double *cell)
{
	struct outlook_state *now = &o->now;
	int wanted = in->t >= after / timeunit(), believed;

	if (now->rows == 0)
		now->first = in->clock;
	if (now->direction == 0 && !isnan(in->y)) {
		int up = direction == AUTO ? in->y <= outlook_threshold : direction == UP;

		now->direction = up ? 1 : -1;
		start(o);
	}
	if (now->direction != 0)
		learn(o, in, filtered);
	now->rows++;
	if (!isnan(in->y))
		now->beyond = now->direction * (in->y - outlook_threshold) >= 0
				      ? now->beyond + 1
				      : 0;
	now->failed = now->beyond >= persist;
	now->leapt = now->failed &&
		     (now->leapt || (now->beyond == persist && bank_ready(o->bank) &&
					    bank_held(o->bank) >= persist));
	now->healthy += !isnan(in->y) && now->beyond == 0;
	if (!is_rescaled(o) && !isnan(in->y)) {
		now->factor = rescaled_add(&now->scale, in->y);
		now->range =
			rescaled_range(&now->scale, RESCALED_HALF, outlook_threshold);
		now->rescaled = in->t;
	}
	believed = !is_rescaled(o) && !rescaled_doubtful(&now->scale, outlook_threshold);
	wanted &= believed;
	for (int i = 0; i < life_cells(); i++)
		cell[i] = NAN;
	if (now->failed && believed)
		put_draws(o, (double[]){ 0 }, 1, INFINITY, cell);
	else if (now->direction != 0 && wanted)
		foresee(o, cell);
	now->lives += now->direction != 0 && !now->failed && wanted;
	now->left_out += now->failed || !wanted;
	put_trends(o, cell + life_cells());
}

/* Says so if the first values may have told the wrong direction, because one or two were
 * bad or the threshold had been passed before, and if the trends recede. */
static int check_direction(const struct outlook *o)
{
	if (bank_ready(o->bank) && !o->now.failed && bank_recedes(o->bank)) {
		warn("%sthe values recede from the threshold, and no life ends: "
		     "--direction %s is for the other way",
			o->prefix, directions[o->now.direction > 0 ? DOWN : UP]);
		return 1;
	}
	if (direction != AUTO || !o->now.failed || o->now.healthy > 2)
		return 0;
	warn("%sthe unit fails after value %ld if the threshold is approached from %s, "
	     "as the first value tells: --direction %s is for the other way",
		o->prefix, o->now.healthy, o->now.direction > 0 ? "below" : "above",
		directions[o->now.direction > 0 ? DOWN : UP]);
	return 1;
}

/* 1 if a life of 0 at all levels says more than the trends do: they foresaw none of the
 * values beyond the threshold when the unit failed, or do not have it beyond with 95 %.
 */
static int failed_alone(const struct outlook *o)
{
	return o->now.failed && bank_ready(o->bank) &&
	       (o->now.leapt || bank_beyond(o->bank) < 0.95);
}

/* Outliers, which the bank leaves out, may have been readings of a sensor that fails. */
static int has_ceased(const struct outlook *o)
{
	return (o->bank && bank_ceased(o->bank)) ||
	       plateau_reached(&o->now.course, outlook_threshold, -INFINITY, 0);
}

int outlook_settle(const struct outlook *o)
{
	const char *unit = o->unit;
	unsigned long due;
	int doubtful = !is_rescaled(o) &&
		       rescaled_doubtful(&o->now.scale, outlook_threshold),
	    stuck = o->bank && bank_stuck(o->bank), stopped = !stuck && has_ceased(o),
	    alternates = rescaled_alternates(&o->now.scale),
	    alone = !doubtful && !is_rescaled(o) && failed_alone(o),
	    doubt = check_direction(o) || is_rescaled(o) || doubtful || stuck ||
		    stopped || alternates || alone;

	if (doubtful)
		warn("%sno life is predicted after the last rows: their unit or the gain "
		     "may have changed, or a counter has wrapped",
			o->prefix);
	if (alternates)
		warn("%sthe values alternate between two courses: those of two machines are "
		     "told apart by --unit",
			o->prefix);
	if (stuck)
		warn("%sthe last values are equal: the sensor sticks or is at the end of its "
		     "range, and the lives continue the wear before",
			o->prefix);
	if (alone)
		warn("%sthe last %ld values are beyond the threshold, but the trend may not "
		     "be: the unit has failed at once, or they are noise",
			o->prefix, o->now.beyond);
	if (stopped)
		warn("%sthe values have ceased to approach the threshold: the wear rests, or "
		     "the sensor is at the end of its range",
			o->prefix);
	if (o->now.range > 0)
		warn("%sthe last %d values at time %g go on from 0 where those before "
		     "would have reached %g: no life is predicted since, because a counter "
		     "seems to have wrapped",
			o->prefix, RESCALED_HALF, o->now.rescaled, o->now.range);
	else if (o->now.factor != 0)
		warn("%sthe last %d values at time %g are %.3g times those before, and so "
		     "are their steps: no life is predicted since, because their unit or the "
		     "gain seems to have changed",
			o->prefix, RESCALED_HALF, o->now.rescaled, o->now.factor);

	due = event_list_settle(unit, o->now.heeded, o->now.early);
	if (due <= o->now.events)
		return doubt;
	warn("%s: %lu events%s%s are not after the last row of the saved state and have "
	     "no effect",
		events_file, due - o->now.events, *unit ? " of unit " : "", unit);
	return 1;
}

int outlook_alarm(const struct outlook *o)
{
	return o->now.alarm;
}

void outlook_count(struct outlook *o)
{
	stats_add("lives", (double)o->now.lives);
	stats_add("lives_left_out", (double)o->now.left_out);
	stats_add("rows_skipped", (double)o->now.skipped);
	stats_add("rows_standing", (double)o->now.standing);
	stats_add("events", (double)o->now.events);
	if (o->bank) {
		struct bank_counts c = bank_counts(o->bank);

		stats_add("outliers_of_wear", (double)c.outliers);
		stats_add("shifts", (double)c.shifts);
		stats_add("halts", (double)c.halts);
		stats_add("particles_born", (double)c.births);
	}
}

char *outlook_columns(char *names)
{
	if (isnan(outlook_threshold))
		return names;
	names = levels_columns(names, "rul_q", &levels);
	names = xappend(names, " p_no_crossing");
	if (!isnan(mission))
		names = xappend(names, " p_failure");
	if (!isnan(cost_ratio))
		names = xappend(names, " replace_in");
	if (alarms.n > 0)
		names = xappend(names, " alarm");
	for (int k = 0; k < covariates_count(); k++)
		names = xappend(names, " factor_%s", covariate_name(k));
	for (int k = 0; weights && k < WEIGHED; k++)
		names = xappend(names, " weight_%s", weighed[k].name);
	return names;
}

char *outlook_units(char *units)
{
	for (int i = 0; i < outlook_cells(); i++) {
		int is_time = i < levels.n ||
			      (!isnan(cost_ratio) && i == levels.n + 1 + !isnan(mission));

		units = xappend(units, " %s", is_time ? timeunit_word() : "1");
	}
	return units;
}
