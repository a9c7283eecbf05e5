#include "event_list.h"
#include "cli/msg.h"
#include "common/time_unit.h"
#include "io/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct event {
	double t;
	enum bank_event what;
	char *unit; /* NULL: all */
	long line;
	int known, reached, effective; /* for any unit */
} * events;
static int n_events;
static const char *events_name; /* of the table */

void event_list_read(const char *file, const char *unit_column, struct reasons *doubts)
{
	struct table_in *in = table_open(file);
	int t = table_need(in, "t"), what = table_need(in, "event"),
	    unit = table_find(in, unit_column);

	events_name = file;
	/* Events of one unit must not count for all. */
	if (unit < 0 && table_find(in, "unit") >= 0)
		table_need(in, unit_column);
	table_set_scale(in, t, timeunit_ratio(in, t));
	while (table_next(in)) {
		struct event *e;
		const char *word = table_text(in, what);
		int repair = strcmp(word, "repair") == 0;

		if (!repair && strcmp(word, "load") != 0)
			die(EXIT_RUN, "%s: line %ld: event '%s', want repair or load",
				table_name(in), table_line(in), word);
		events = xrealloc(events, (size_t)n_events + 1, sizeof *events);
		e = &events[n_events++];
		*e = (struct event){ table_number(in, t),
			repair ? BANK_REPAIR : BANK_LOAD,
			unit < 0 ? NULL : xstrdup(table_text(in, unit)), table_line(in),
			0, 0, 0 };
		if (!isfinite(e->t))
			die(EXIT_RUN, "%s: line %ld: time is missing or not finite",
				table_name(in), table_line(in));
	}
	reasons_add(doubts, table_doubted(in));
	table_close(in);
}

static int concerns(const struct event *e, const char *unit)
{
	return !e->unit || strcmp(e->unit, unit) == 0;
}

unsigned long event_list_between(
	const char *unit, double after, double until, double last[BANK_LOAD + 1])
{
	unsigned long n = 0;

	last[BANK_REPAIR] = last[BANK_LOAD] = -INFINITY;
	for (int i = 0; i < n_events; i++) {
		const struct event *e = &events[i];

		if (e->t > until || e->t <= after || !concerns(e, unit))
			continue;
		last[e->what] = fmax(last[e->what], e->t);
		n++;
	}
	return n;
}

unsigned long event_list_settle(const char *unit, double heeded, double early)
{
	unsigned long due = 0;

	for (int i = 0; i < n_events; i++) {
		struct event *e = &events[i];

		if (!concerns(e, unit))
			continue;
		e->known = 1;
		e->reached |= e->t <= heeded;
		e->effective |= e->t <= heeded && e->t > early;
		due += e->t <= heeded;
	}
	return due;
}

int event_list_report(void)
{
	const struct event *first = NULL;
	int n = 0;
	char *why, *more;

	for (int i = n_events - 1; i >= 0; i--)
		if (!events[i].effective) {
			first = &events[i];
			n++;
		}
	if (n == 0)
		return 0;
	if (!first->known)
		why = xprintf("the series has no unit '%s'", first->unit);
	else
		why = xprintf("time %g is %s", first->t,
			first->reached ? "not after the third value in use"
				       : "after the last row of the series");
	more = n > 1 ? xprintf("; nor have %d others", n - 1) : xstrdup("");
	warn("%s: line %ld: the event has no effect: %s%s", events_name, first->line, why,
		more);
	free(why);
	free(more);
	return 1;
}

void event_list_free(void)
{
	for (int i = 0; i < n_events; i++)
		free(events[i].unit);
	free(events);
}
