#include "common/surrogate_table.h"
#include "cli/msg.h"
#include "io/tables.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put(struct table_out *t, const char *kind, const char *name, double value)
{
	table_put_text(t, kind);
	table_put_text(t, name);
	table_put(t, value);
	table_end_row(t);
}

static const char *const particle_names[SURROGATE_CLASSES] = { "particle",
	"particle_sampled" },
			 *const total_names[SURROGATE_CLASSES] = { "total",
				 "total_sampled" };

static void put_scores(
	struct table_out *t, const char *kind, const struct surrogate_scores *s)
{
	char number[16];

	for (int i = 0; i < s->count; i++) {
		snprintf(number, sizeof number, "%d", i + 1);
		put(t, kind, number, s->score[i]);
	}
}

void surrogate_write(const struct surrogate *s, const struct surrogate_report *report,
	const char *cmd, const char *doubt)
{
	struct table_out *t = table_create(NULL, cmd, "1 1 1", "kind name value");

	table_comment(t, "surfaces", "%ld fitted, %ld checked", report->fitted,
		report->checked);
	table_comment(t, "checked",
		"total volumes differ by %.3g rms, %.3g at most (of the logarithm); "
		"intervals of 90 %% hold %ld of %ld and are +-%.3g wide",
		report->rms, report->most, report->within, report->checked,
		report->width);
	if (doubt)
		table_comment(t, "doubtful", "%s", doubt);
	for (int k = 0; k < SURROGATE_PROPERTIES; k++) {
		put(t, "least", surrogate_property_names[k], s->least[k]);
		put(t, "most", surrogate_property_names[k], s->most[k]);
	}
	for (int c = 0; c < SURROGATE_CLASSES; c++) {
		put_scores(t, particle_names[c], &s->particle[c]);
		put_scores(t, total_names[c], &s->total[c]);
	}
	table_done(t);
}

/* Where the value of a row belongs; scores must be ascending. */
static double *place_of(
	const struct table_in *t, struct surrogate *s, const char *kind, const char *name)
{
	for (int k = 0; k < SURROGATE_PROPERTIES; k++)
		if (!strcmp(name, surrogate_property_names[k]) &&
			(!strcmp(kind, "least") || !strcmp(kind, "most")))
			return &(kind[0] == 'l' ? s->least : s->most)[k];
	for (int c = 0; c < SURROGATE_CLASSES; c++) {
		struct surrogate_scores *scores =
			!strcmp(kind, particle_names[c]) ? &s->particle[c]
			: !strcmp(kind, total_names[c])  ? &s->total[c]
							 : NULL;

		if (scores && scores->count < SURROGATE_SCORES)
			return scores->score + scores->count++;
	}
	die(EXIT_RUN,
		"%s: line %ld: '%s %s' is not part of a surrogate: fit it anew with debrisfit",
		table_name(t), table_line(t), kind, name);
}

static int check_scores(
	const char *name, const char *kind, const struct surrogate_scores *s)
{
	for (int i = 0; i < s->count; i++)
		if (s->score[i] < (i > 0 ? s->score[i - 1] : 0))
			die(EXIT_RUN, "%s: scores of %s are not ascending from 0 on",
				name, kind);
	return s->count;
}

int surrogate_read(const char *path, struct surrogate *s)
{
	struct table_in *t = table_open(path);
	int kind = table_need(t, "kind"), name = table_need(t, "name"),
	    value = table_need(t, "value");
	long rows = 0, scores = 0;
	int whole = 0, doubted;

	memset(s, 0, sizeof *s);
	while (table_next(t)) {
		char *k = xstrdup(table_text(t, kind)), *a = xstrdup(table_text(t, name));
		double v = table_number(t, value);

		if (!isfinite(v))
			die(EXIT_RUN, "%s: line %ld: value %g, want a finite number",
				table_name(t), table_line(t), v);
		*place_of(t, s, k, a) = v;
		free(k);
		free(a);
		rows++;
	}
	for (int c = 0; c < SURROGATE_CLASSES; c++) {
		int ones = check_scores(
			    table_name(t), particle_names[c], &s->particle[c]),
		    all = check_scores(table_name(t), total_names[c], &s->total[c]);

		scores += ones + all;
		whole = whole || (ones > 0 && all > 0);
	}
	if (rows != 2L * SURROGATE_PROPERTIES + scores || !whole)
		die(EXIT_RUN, "%s: %ld rows: not a complete surrogate of debrisfit",
			table_name(t), rows);
	doubted = table_doubted(t) != NULL;
	table_close(t);
	return doubted;
}
