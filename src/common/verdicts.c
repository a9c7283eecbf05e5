#include "verdicts.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/non_ferrous.h"
#include <string.h>

static int doubtful_too;
static double doubtful, unresolved, foreign, non_ferrous, unclear;
static double signs[2]; /* rows of positive and of negative amplitude */
static int class_column = -1, amplitude_column = -1, kind_column = -1;

struct opt verdict_rows[] = {
	{ 0, "doubtful", OPT_FLAG, UNIT_NONE, &doubtful_too, 0, 0, NULL,
		"also use rows whose verdict is neither alone nor overlap", NULL, 0 },
	OPT_END,
};

static int is_event(const char *word)
{
	static const char *const events[] = { "shock", "bubble", "impulse", "transient",
		"dropout" };

	for (size_t i = 0; i < sizeof events / sizeof *events; i++)
		if (strcmp(word, events[i]) == 0)
			return 1;
	return 0;
}

int verdict_column_alone(struct table_in *t)
{
	kind_column = table_find(t, "kind");
	return table_find(t, "verdict");
}

int verdict_column(struct table_in *t)
{
	int column = verdict_column_alone(t);

	class_column =
		non_ferrous_known() ? table_need(t, "class") : table_find(t, "class");
	amplitude_column =
		column >= 0 && class_column < 0 ? table_find(t, "amplitude") : -1;
	return column;
}

static int is_of_class(const struct table_in *t, const char *class)
{
	return class_column >= 0 && strcmp(table_text(t, class_column), class) == 0;
}

enum verdict verdict_of(const struct table_in *t, int column)
{
	const char *word = column < 0 ? "alone" : table_text(t, column);

	if (is_event(word) ||
		(kind_column >= 0 && is_event(table_text(t, kind_column)))) {
		foreign++;
		return VERDICT_FOREIGN;
	}
	non_ferrous += is_of_class(t, "non-ferrous");
	unclear += is_of_class(t, "unclear");
	if (strcmp(word, "alone") == 0 || strcmp(word, "overlap") == 0) {
		if (amplitude_column >= 0)
			signs[table_number(t, amplitude_column) < 0]++;
		return VERDICT_SURE;
	}
	if (strcmp(word, "unresolved") == 0) {
		unresolved++;
		return VERDICT_UNRESOLVED;
	}
	doubtful++;
	return doubtful_too ? VERDICT_SURE : VERDICT_DOUBTFUL;
}

void verdict_report(void)
{
	stats_add("rows_doubtful", doubtful);
	stats_add("rows_unresolved", unresolved);
	stats_add("rows_no_particle", foreign);
	if (doubtful > 0 && !doubtful_too)
		warn("%.0f rows are doubtful by their verdict and left out; --doubtful "
		     "takes them in",
			doubtful);
	if (foreign > 0)
		note("%.0f rows are shocks, bubbles or other events, not particles",
			foreign);
	if (unresolved > 0)
		warn("%.0f rows are sections that are not resolved into particles",
			unresolved);
	doubtful = unresolved = foreign = 0;
}

double verdict_diameter(const struct table_in *t, double diameter)
{
	return diameter > 0 && non_ferrous_known() && is_of_class(t, "non-ferrous")
		       ? non_ferrous_size(diameter)
		       : diameter;
}

int verdict_equivalent(void)
{
	int unknown = non_ferrous > 0 && !non_ferrous_known(),
	    vague = unclear > 0 && !non_ferrous_none(),
	    both = signs[0] > 0 && signs[1] > 0;

	if (unknown)
		warn("%.0f rows are non-ferrous: their diameter is that of a ferrous particle "
		     "with the same pulse, and smaller than theirs",
			non_ferrous);
	if (vague)
		warn("%.0f rows are of unclear class: their diameter is that of ferrous "
		     "particles, and too small if they are not",
			unclear);
	if (both)
		warn("amplitudes of %.0f rows are positive, of %.0f negative: those of one "
		     "sign are non-ferrous, and larger than their diameter",
			signs[0], signs[1]);
	non_ferrous = unclear = signs[0] = signs[1] = 0;
	return unknown || vague || both;
}
