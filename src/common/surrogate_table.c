#include "common/surrogate_table.h"
#include "cli/msg.h"
#include "io/tables.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FEATURES = FOOTPRINT_FEATURES };

/* Names of the two factors of a term. */
static void name_term(int term, const char **first, const char **second)
{
	*first = *second = "1";
	if (term == 0)
		return;
	if (term <= FEATURES) {
		*first = footprint_names[term - 1];
		return;
	}
	term -= FEATURES + 1;
	for (int i = 0; i < FEATURES; i++) {
		if (term < FEATURES - i) {
			*first = footprint_names[i];
			*second = footprint_names[i + term];
			return;
		}
		term -= FEATURES - i;
	}
}

static void put(struct table_out *t, const char *kind, const char *first,
	const char *second, double value)
{
	table_put_text(t, kind);
	table_put_text(t, first);
	table_put_text(t, second);
	table_put(t, value);
	table_end_row(t);
}

static void put_numbered(
	struct table_out *t, const char *kind, const double *value, int count)
{
	char number[16];

	for (int i = 0; i < count; i++) {
		snprintf(number, sizeof number, "%d", i + 1);
		put(t, kind, number, "1", value[i]);
	}
}

void surrogate_write(
	const struct surrogate *s, const struct surrogate_report *report, const char *cmd)
{
	struct table_out *t =
		table_create(NULL, cmd, "1 1 1 1", "kind first second value");

	table_comment(t, "surfaces", "%ld fitted, %ld for the intervals, %ld checked",
		report->fitted, report->calibrated, report->checked);
	table_comment(t, "checked",
		"total volumes differ by %.3g rms, %.3g at most (of the logarithm); "
		"intervals of 90 %% hold %ld of %ld and are +-%.3g wide",
		report->rms, report->most, report->within, report->checked,
		report->width);
	for (int k = 0; k < FEATURES; k++) {
		put(t, "low", footprint_names[k], "1", s->low[k]);
		put(t, "high", footprint_names[k], "1", s->high[k]);
		put(t, "mean", footprint_names[k], "1", s->mean[k]);
		put(t, "scale", footprint_names[k], "1", s->scale[k]);
	}
	for (int k = 0; k < SURROGATE_TERMS; k++) {
		const char *first, *second;

		name_term(k, &first, &second);
		put(t, "coefficient", first, second, s->coefficient[k]);
	}
	put_numbered(t, "deviation", s->deviation, SURROGATE_CLASSES);
	put_numbered(t, "factor", s->factor, SURROGATE_CLASSES);
	for (int k = 0; k < SURROGATE_PROPERTIES; k++) {
		put(t, "least", surrogate_property_names[k], "1", s->least[k]);
		put(t, "most", surrogate_property_names[k], "1", s->most[k]);
	}
	put_numbered(t, "shared", &s->shared, 1);
	put_numbered(t, "particle", s->particle, s->particles);
	put_numbered(t, "total", s->total, s->totals);
	table_done(t);
}

static int feature_of(const struct table_in *t, const char *name)
{
	for (int k = 0; k < FEATURES; k++)
		if (!strcmp(name, footprint_names[k]))
			return k;
	die(EXIT_RUN, "%s: line %ld: '%s' is no feature of a footprint", table_name(t),
		table_line(t), name);
}

static int term_of(const struct table_in *t, const char *first, const char *second)
{
	for (int k = 0; k < SURROGATE_TERMS; k++) {
		const char *a, *b;

		name_term(k, &a, &b);
		if (!strcmp(a, first) && !strcmp(b, second))
			return k;
	}
	die(EXIT_RUN, "%s: line %ld: no coefficient of '%s' and '%s'", table_name(t),
		table_line(t), first, second);
}

/* Where the value of a row belongs; scores must be ascending. */
static double *place_of(const struct table_in *t, struct surrogate *s, const char *kind,
	const char *first, const char *second)
{
	static const char *const kinds[] = { "low", "high", "mean", "scale", NULL };
	double *const of_feature[] = { s->low, s->high, s->mean, s->scale };
	long number = strtol(first, NULL, 10);

	for (int k = 0; kinds[k]; k++)
		if (!strcmp(kind, kinds[k]))
			return of_feature[k] + feature_of(t, first);
	if (!strcmp(kind, "coefficient"))
		return s->coefficient + term_of(t, first, second);
	if (!strcmp(kind, "deviation") && number >= 1 && number <= SURROGATE_CLASSES)
		return s->deviation + number - 1;
	if (!strcmp(kind, "factor") && number >= 1 && number <= SURROGATE_CLASSES)
		return s->factor + number - 1;
	for (int k = 0; k < SURROGATE_PROPERTIES; k++)
		if (!strcmp(first, surrogate_property_names[k]) &&
			(!strcmp(kind, "least") || !strcmp(kind, "most")))
			return (kind[0] == 'l' ? s->least : s->most) + k;
	if (!strcmp(kind, "shared") && number == 1)
		return &s->shared;
	if (!strcmp(kind, "particle") && s->particles < SURROGATE_SCORES)
		return s->particle + s->particles++;
	if (!strcmp(kind, "total") && s->totals < SURROGATE_SCORES)
		return s->total + s->totals++;
	die(EXIT_RUN, "%s: line %ld: '%s %s' is nothing of a surrogate", table_name(t),
		table_line(t), kind, first);
}

static void check_scores(const char *name, const char *kind, const double *score, int n)
{
	for (int i = 1; i < n; i++)
		if (score[i] < score[i - 1])
			die(EXIT_RUN, "%s: scores of %s are not ascending", name, kind);
}

void surrogate_read(const char *path, struct surrogate *s)
{
	struct table_in *t = table_open(path);
	int kind = table_need(t, "kind"), first = table_need(t, "first"),
	    second = table_need(t, "second"), value = table_need(t, "value");
	long rows = 0;

	memset(s, 0, sizeof *s);
	while (table_next(t)) {
		char *k = xstrdup(table_text(t, kind)),
		     *a = xstrdup(table_text(t, first)),
		     *b = xstrdup(table_text(t, second));
		double v = table_number(t, value);

		if (!isfinite(v))
			die(EXIT_RUN, "%s: line %ld: value %g, want a finite number",
				table_name(t), table_line(t), v);
		*place_of(t, s, k, a, b) = v;
		free(k);
		free(a);
		free(b);
		rows++;
	}
	if (rows != 4L * FEATURES + SURROGATE_TERMS + 2L * SURROGATE_CLASSES +
			    2L * SURROGATE_PROPERTIES + 1 + s->particles + s->totals)
		die(EXIT_RUN, "%s: %ld rows: no whole surrogate of debrisfit",
			table_name(t), rows);
	check_scores(table_name(t), "particles", s->particle, s->particles);
	check_scores(table_name(t), "totals", s->total, s->totals);
	table_close(t);
}
