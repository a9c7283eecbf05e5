#include "reports.h"
#include "cli/msg.h"
#include "count/line.h"
#include "io/tables.h"
#include "num/room.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double hour = 3600;

/* Least probability of detection of a size that has a code: codes step by a factor of
 * two, of which a tenth of the particles missed is 0.15. */
static const double SEEN = 0.9;

static double flow = NAN, volume = NAN;
static long window;

struct opt oil_rows[] = {
	{ 0, "flow", OPT_NUM, UNIT_FLOW, &flow, 1e-15, 1, "Q",
		"flow of oil through the sensor, for numbers per volume", NULL, 0 },
	{ 0, "volume", OPT_NUM, UNIT_VOLUME, &volume, 1e-15, 1e6, "V",
		"total volume of oil, in place of --flow", NULL, 0 },
	OPT_END,
};

struct opt report_rows[] = {
	{ 0, "window", OPT_INT, UNIT_COUNT, &window, 3, 1000000000, "N",
		"of --output trend: periods to which the slope is fitted (default all)",
		NULL, 0 },
	OPT_END,
};

struct report {
	struct report_par par;
	struct table_out *table;
};

void report_check(enum report_kind output, int periods)
{
	if (!isnan(flow) && !isnan(volume))
		die(EXIT_USAGE, "specify --flow or --volume, not both");
	if (!isnan(volume) && periods)
		die(EXIT_USAGE, "--volume is the total volume: --period requires --flow");
	if (output == REPORT_CODES && isnan(flow) && isnan(volume))
		die(EXIT_USAGE, "--output codes requires --flow or --volume");
	if (output == REPORT_TREND && !periods)
		die(EXIT_USAGE, "--output trend requires --period");
	if (window && output != REPORT_TREND)
		die(EXIT_USAGE, "--window is for --output trend");
}

struct report *report_open(const struct report_par *par)
{
	static const char *const columns[] = { "low high rows doubtful unresolved number "
					       "number_low number_high per_hour "
					       "per_hour_low per_hour_high per_ml "
					       "kg_per_hour kg_per_hour_low "
					       "kg_per_hour_high alarm",
		"volume iso4406 iso4406_low iso4406_high as4059 as4059_low as4059_high "
		"alarm",
		"per_hour slope slope_low slope_high kg_per_hour kg_slope kg_slope_low "
		"kg_slope_high periods alarm" };
	static const char *const units[] = {
		"m m 1 1 1 1 1 1 1/h 1/h 1/h 1/mL kg/h kg/h kg/h 1", "m3 1 1 1 1 1 1 1",
		"1/h 1/h2 1/h2 1/h2 kg/h kg/h2 kg/h2 kg/h2 1 1"
	};
	struct report *r = xcalloc(1, sizeof *r);
	char *names = xprintf("begin end%s%s %s", par->by ? " " : "",
		par->by ? par->by : "", columns[par->output]);
	char *unit = xprintf("s s%s %s", par->by ? " 1" : "", units[par->output]);

	r->par = *par;
	r->table = table_create(NULL, par->cmd, unit, names);
	free(unit);
	free(names);
	return r;
}

static void begin_row(struct report *r, const char *group, double begin, double end)
{
	table_put(r->table, begin);
	table_put(r->table, end);
	if (r->par.by)
		table_put_text(r->table, *group ? group : "nan");
}

static void put_counted(struct table_out *t, struct counted c, double scale)
{
	table_put(t, c.value * scale);
	table_put(t, c.low * scale);
	table_put(t, c.high * scale);
}

/* Volume of oil in a period, m3; nan if it is not known. */
static double oil(double begin, double end)
{
	if (!isnan(volume))
		return volume;
	return end > begin ? flow * (end - begin) : NAN;
}

static void put_classes(struct report *r, const struct classes *c, const char *group,
	double begin, double end, int alarm)
{
	double per_hour = end > begin ? hour / (end - begin) : NAN;

	for (int k = 0; k < r->par.edges; k++) {
		struct class_count n;

		classes_count(c, k, &n);
		begin_row(r, group, begin, end);
		table_put(r->table, r->par.edge[k]);
		table_put(r->table, k + 1 < r->par.edges ? r->par.edge[k + 1] : INFINITY);
		table_put(r->table, n.sure);
		table_put(r->table, n.doubtful);
		table_put(r->table, n.unresolved);
		put_counted(r->table, n.number, 1);
		put_counted(r->table, n.number, per_hour);
		table_put(r->table, n.number.value / oil(begin, end) * 1e-6);
		put_counted(r->table, n.volume, r->par.density * per_hour);
		table_put(r->table, alarm);
		table_end_row(r->table);
	}
}

/* Below so many counted particles ISO 4406 has the sign ">=" before the scale number. */
static const double FEW = 20;

/* The codes at the value or an end of the interval: sizes that are seen in less than 90 %
 * of cases have none. */
static void put_codes(struct report *r, const struct classes *c,
	const struct class_count *n, double oil_volume, const int *sizes, int count,
	int iso, size_t end)
{
	char text[128] = "";

	for (int k = 0; k < count; k++) {
		const struct class_count *here = &n[sizes[k]];
		double number = (end == 0          ? here->number.value
					: end == 1 ? here->number.low
						   : here->number.high) /
				oil_volume;
		char one[16];

		if (classes_detection(c, sizes[k]) < SEEN)
			snprintf(one, sizeof one, "-");
		else if (iso && iso4406_code(number) < ISO4406_CODES)
			snprintf(one, sizeof one, "%s%d",
				end == 0 && here->sure + here->unresolved < FEW ? ">="
										: "",
				iso4406_code(number));
		else if (iso)
			snprintf(one, sizeof one, ">%d", ISO4406_CODES - 1);
		else
			snprintf(one, sizeof one, "%s%c",
				as4059_name(as4059_class(k, number)), 'A' + k);
		snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s",
			k ? "/" : "", one);
	}
	table_put_text(r->table, text);
}

static void put_code_row(struct report *r, const struct classes *c, const char *group,
	double begin, double end, int alarm)
{
	static const int all[AS4059_SIZES] = { 0, 1, 2, 3, 4, 5 };
	struct class_count n[AS4059_SIZES];
	double v = oil(begin, end);

	if (isnan(v))
		die(EXIT_RUN,
			"the volume of oil is unknown: specify --duration or --volume");
	for (int k = 0; k < AS4059_SIZES; k++)
		classes_count_above(c, k, &n[k]);
	begin_row(r, group, begin, end);
	table_put(r->table, v);
	for (size_t e = 0; e < 3; e++)
		put_codes(r, c, n, v, all, ISO4406_SIZES, 1, e);
	for (size_t e = 0; e < 3; e++)
		put_codes(r, c, n, v, all, AS4059_SIZES, 0, e);
	table_put(r->table, alarm);
	table_end_row(r->table);
}

/* Standard deviation that independent particles cause in the last n rates: one more
 * particle than was seen, as in the upper limits of counts, so that it is not 0 where
 * none was seen. */
static double least_scatter(
	const struct rate_history *h, int q, size_t n, double possible)
{
	double sum = 0, largest = 0;

	for (size_t i = h->n - n; i < h->n; i++) {
		sum += h->column[SQUARES + q][i];
		largest = fmax(largest, h->column[LARGEST + q][i]);
	}
	if (!(largest > 0))
		largest = possible;
	return sqrt((sum + largest * largest) / (double)n);
}

/* possible: the most that one particle adds to either rate. */
static void put_trend(struct report *r, const struct rate_history *h, const char *group,
	double begin, double end, const double possible[2])
{
	size_t n = window && h->n > (size_t)window ? (size_t)window : h->n;

	int unknown = 0;

	for (size_t i = h->n - n; i < h->n; i++)
		unknown |= h->column[UNKNOWN][i] != 0;
	begin_row(r, group, begin, end);
	for (int q = 0; q < 2; q++) {
		double slope = NAN, half = NAN;
		struct line l;

		if (line_fit(h->column[TIME] + h->n - n, h->column[RATE + q] + h->n - n,
			    n, r->par.classes.confidence, &l) == 0 &&
			!isnan(l.slope)) {
			slope = l.slope;
			half = unknown ? INFINITY
				       : line_slope_half(&l,
						 least_scatter(h, q, n, possible[q]),
						 r->par.classes.confidence);
		}
		table_put(r->table, h->column[RATE + q][h->n - 1]);
		table_put(r->table, slope);
		table_put(r->table, slope - half);
		table_put(r->table, slope + half);
	}
	table_put(r->table, (double)n);
	table_put(r->table, h->alarm);
	table_end_row(r->table);
}

/* Remembers a period; only the trend needs more than the last. */
static void remember(
	const struct report *r, struct rate_history *h, const double value[HISTORY])
{
	size_t at = r->par.output == REPORT_TREND ? h->n : 0;

	/* The window slides: its first half is dropped once it is twice as long. */
	if (window && at >= 2 * (size_t)window) {
		for (int i = 0; i < HISTORY; i++)
			memmove(h->column[i], h->column[i] + window,
				(size_t)window * sizeof(double));
		at = (size_t)window;
	}
	for (int i = 0; i < HISTORY; i++) {
		if (room_for(&h->column[i], &h->room[i], at + 1, sizeof(double)))
			die(EXIT_RUN, "out of memory");
		h->column[i][at] = value[i];
	}
	h->n = at + 1;
}

void report_period(struct report *r, struct rate_history *h, const char *group,
	const struct classes *c, double begin, double end, int whole)
{
	double per_hour = end > begin ? hour / (end - begin) : NAN, watched;
	double value[HISTORY] = { 0.5 * (begin + end) / hour }, possible[2];
	struct class_count all;

	classes_count_above(c, 0, &all);
	value[UNKNOWN] = isinf(all.number.high);
	for (int q = 0; q < 2; q++) {
		const struct counted *sum = q ? &all.volume : &all.number;
		double scale = q ? r->par.density * per_hour : per_hour;

		value[RATE + q] = sum->value * scale;
		value[SQUARES + q] = sum->squares * scale * scale;
		value[LARGEST + q] = sum->largest * scale;
		possible[q] = sum->possible * scale;
	}
	/* In an incomplete period a single particle may appear as a high rate, and the
	 * absence of particles is no evidence of a low one. */
	watched = value[RATE + r->par.alarm_mass] *
		  (whole ? 1 : (end - begin) / r->par.period);
	if (watched >= r->par.alarm)
		h->alarm = 1;
	else if (whole && value[UNKNOWN] == 0 && watched < r->par.clear)
		h->alarm = 0;
	if (r->par.output == REPORT_TREND && !whole)
		return;
	remember(r, h, value);
	if (r->par.output == REPORT_CLASSES)
		put_classes(r, c, group, begin, end, h->alarm);
	else if (r->par.output == REPORT_CODES)
		put_code_row(r, c, group, begin, end, h->alarm);
	else
		put_trend(r, h, group, begin, end, possible);
}

void report_doubt(struct report *r, const char *why)
{
	table_comment(r->table, "doubtful", "%s", why);
}

void report_flush(struct report *r)
{
	table_flush(r->table);
}

void report_close(struct report *r)
{
	table_done(r->table);
	free(r);
}

void rate_history_free(struct rate_history *h)
{
	for (int i = 0; i < HISTORY; i++)
		free(h->column[i]);
}
