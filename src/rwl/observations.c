#include "observations.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/non_ferrous.h"
#include "common/time_unit.h"
#include "common/verdicts.h"
#include "io/quantities.h"
#include "life/pair/observed.h"
#include "num/running.h"
#include <math.h>

static const char *const quantities[] = { "auto", "leakage", "gap", "volume", "debris",
	NULL };
static const enum unit units[] = { UNIT_ANY, UNIT_FLOW, UNIT_LENGTH, UNIT_VOLUME,
	UNIT_LENGTH };
/* Beyond these a number is in another unit; those of flow and gap are the limits of the
 * thresholds. */
static const double most[] = { INFINITY, 0.1, 1e-2, 1e-2, 0.1 };
static const double sphere = 0.52359877559829887; /* pi / 6 */

struct state_options state_options;
static int debris;      /* 1: a table of particles has been opened */
static const char *why; /* it is doubtful */

struct opt state_rows[] = { { 0, "quantity", OPT_WORD, UNIT_NONE, &state_options.quantity,
				    0, 0, "auto|leakage|gap|volume|debris",
				    "quantity of the state", quantities, 0 },
	{ 0, "state-unit", OPT_TEXT, UNIT_NONE, &state_options.unit, 0, 0, "UNIT",
		"unit of the state if not SI, such as L/min", 0, 0 },
	{ 0, "state-error", OPT_NUM, UNIT_NONE, &state_options.error, 0, 1e300, "SD",
		"standard error of the state, in its unit", 0, 0 },
	OPT_TABLE(timeunit_rows), OPT_TABLE(verdict_rows), OPT_TABLE(non_ferrous_rows),
	OPT_END };

/* Units of time and value: the table's own, or those of the options, or SI. */
static void settle_units(struct observations *s)
{
	enum unit unit = units[s->quantity];
	double told = table_scale(s->table, s->value_column, unit), asked = NAN;
	double time = table_scale(s->table, s->time_column, UNIT_TIME);

	if (state_options.unit) {
		asked = unit_scale(state_options.unit, unit);
		if (asked <= 0)
			die(EXIT_USAGE, "--state-unit %s: is not a unit of %s, want %s",
				state_options.unit, quantities[s->quantity],
				unit_name(unit));
		if (!isnan(told) && fabs(asked / told - 1) > 1e-9)
			die(EXIT_USAGE, "--state-unit %s contradicts '# units:' of %s",
				state_options.unit, table_name(s->table));
	}
	s->scale = !isnan(told) ? told : !isnan(asked) ? asked : 1;
	if (!isnan(time) && opt_given("time-unit") && fabs(timeunit() / time - 1) > 1e-9)
		die(EXIT_USAGE, "--time-unit contradicts '# units:' of %s",
			table_name(s->table));
	s->time_scale = isnan(time) ? timeunit() : time;
}

void state_open(struct observations *s, const char *file, const struct pair *pair)
{
	static const char *const columns[] = { "", "leakage", "gap", "volume",
		"diameter" };
	struct table_in *t = table_open(file);

	*s = (struct observations){
		.table = t, .quantity = state_options.quantity, .scale = 1, .pair = pair
	};
	s->time_column = table_need(
		t, table_find(t, "t") < 0 && table_find(t, "time1") >= 0 ? "time1" : "t");
	s->value_column = table_find(t, "state");
	for (enum pair_quantity q = PAIR_LEAKAGE;
		q <= PAIR_DEBRIS && s->quantity == PAIR_AUTO && s->value_column < 0; q++)
		if (table_find(t, columns[q]) >= 0)
			s->quantity = q;
	if (s->quantity == PAIR_AUTO)
		s->quantity = PAIR_LEAKAGE;
	s->filtered = s->value_column >= 0 && s->quantity != PAIR_DEBRIS;
	if (!s->filtered)
		s->value_column = table_find(t, columns[s->quantity]);
	if (s->value_column < 0)
		s->value_column = table_need(
			t, table_find(t, "y") < 0 ? columns[s->quantity] : "y");
	s->sources_column = table_find(t, "sources");
	if (s->quantity == PAIR_DEBRIS)
		s->verdict_column = verdict_column(t);
	debris |= s->quantity == PAIR_DEBRIS;
	settle_units(s);
}

/* Volume of all particles so far, with those of the present row. */
static double add_debris(struct observations *s, enum verdict verdict, double diameter)
{
	struct table_in *t = s->table;
	double many = verdict != VERDICT_DOUBTFUL;

	if (verdict == VERDICT_UNRESOLVED && s->sources_column >= 0)
		many = (double)table_whole(t, s->sources_column, 0, 1e15);
	return s->debris += many * sphere * diameter * diameter * diameter;
}

/* Rows from which on second differences tell the noise of volumes. */
enum { KNOWN = 8 };

/* The measured volume of a pair that is nearly new may be below 0, but by no more than
 * five standard deviations of its noise: one with the wrong sign would never fail. */
static void check_lowest(const struct observations *s)
{
	double error = state_options.error * s->scale,
	       noise = error > 0 ? error : s->noise.scale;

	if (s->lowest < -5 * noise)
		die(EXIT_RUN,
			"%s: line %ld: a volume of %g m3 is farther below 0 than noise with a "
			"standard deviation of %.3g m3 explains",
			table_name(s->table), s->lowest_line, s->lowest, noise);
}

static void heed_volume(struct observations *s, double value, double gap)
{
	noise_add(&s->noise, value, gap);
	if (value < s->lowest) {
		s->lowest = value;
		s->lowest_line = table_line(s->table);
	}
	if (s->noise.rows >= KNOWN)
		check_lowest(s);
}

int state_next(struct observations *s)
{
	struct table_in *t = s->table;
	double time, value, factor, error = state_options.error * s->scale;
	enum verdict verdict = VERDICT_SURE;
	int more;

	do
		more = table_next(t);
	while (more && s->quantity == PAIR_DEBRIS &&
		(verdict = verdict_of(t, s->verdict_column)) == VERDICT_FOREIGN);
	if (!more) {
		if (s->passed)
			warn("%s: rows ignored because they have no diameter: %ld",
				table_name(t), s->passed);
		if (s->quantity == PAIR_DEBRIS) {
			verdict_report();
			if (verdict_equivalent())
				why = "the diameters of particles that are not ferrous";
		}
		if (table_doubted(t))
			why = "the table of the state says so of itself";
		check_lowest(s);
		return 0;
	}
	table_one_unit(t);
	time = table_number(t, s->time_column) * s->time_scale;
	value = table_number(t, s->value_column) * s->scale;
	if (!isfinite(time))
		die(EXIT_RUN, "%s: line %ld: the time is missing", table_name(t),
			table_line(t));
	if (time < 0 && s->quantity >= PAIR_VOLUME)
		die(EXIT_RUN, "%s: line %ld: time %g s is before the start of the pair",
			table_name(t), table_line(t), time);
	if (s->rows++ > 0 && (s->quantity == PAIR_DEBRIS ? time < s->t : time <= s->t))
		die(EXIT_RUN, "%s: line %ld: time %g s is not ascending", table_name(t),
			table_line(t), time);
	if (value < 0 && s->filtered)
		value = 0; /* the filtered state of an unworn pair may be below 0 */
	if (isinf(value) || (value < 0 && s->quantity != PAIR_VOLUME))
		die(EXIT_RUN, "%s: line %ld: %g is not a %s", table_name(t),
			table_line(t), value, quantities[s->quantity]);
	if (s->quantity == PAIR_VOLUME && !isnan(value))
		heed_volume(s, value, time - s->t);
	if (value > most[s->quantity] && !s->beyond++) {
		why = "the unit of the state";
		warn("%s: line %ld: a %s of %g %s: is another unit meant? --state-unit names it",
			table_name(t), table_line(t), quantities[s->quantity], value,
			unit_name(units[s->quantity]));
	}
	if (s->quantity != PAIR_DEBRIS && !isnan(value) &&
		(factor = rescaled_add(&s->seen, value)) != 0)
		die(EXIT_RUN,
			"%s: line %ld: the last %d values are %.3g times those before, and so are "
			"their steps: their unit or the gain seems to have changed",
			table_name(t), table_line(t), RESCALED_HALF, factor);
	if (s->rows == 1)
		s->first_t = time;
	s->t = time;
	if (s->quantity == PAIR_DEBRIS) {
		s->passed += isnan(value);
		stats_add("particles_without_diameter", isnan(value));
		if (!isnan(value))
			value = add_debris(s, verdict, verdict_diameter(t, value));
	}
	s->value = value;
	s->gap = pair_gap(s->pair, s->quantity, value);
	s->gap_error = (pair_gap(s->pair, s->quantity, value + error) -
			       pair_gap(s->pair, s->quantity, value - error)) /
		       2;
	if (s->quantity != PAIR_DEBRIS && !isnan(s->gap))
		plateau_add(&s->course, time, s->gap);
	return 1;
}

void state_check(void)
{
	const char *option = opt_any_given(verdict_rows);

	if (!option)
		option = opt_any_given(non_ferrous_rows);
	if (option && !debris)
		die(EXIT_USAGE, "--%s requires a state of --quantity debris", option);
}

const char *state_doubt(void)
{
	return why;
}

double state_slope(const char *file, const struct pair *pair, double skip)
{
	struct regression line = { 0 };
	struct observed gaps = { 0 };
	struct observations s;
	double slope;

	state_open(&s, file, pair);
	while (state_next(&s)) {
		if (isnan(s.gap) || s.t - s.first_t < skip)
			continue;
		regression_add(&line, s.t, s.gap);
		observed_add(&gaps, (struct moment){ s.t, s.gap, s.gap_error }, s.value);
	}
	if (observed_falls(&gaps))
		die(EXIT_RUN,
			"%s: the gap falls behind its rate, as after a repair: no calibration by the "
			"whole life",
			file);
	slope = regression_slope(&line);
	if (!(slope > 0) || !isfinite(slope))
		die(EXIT_RUN, "%s: the unit for the calibration does not wear", file);
	table_close(s.table);
	return slope;
}
