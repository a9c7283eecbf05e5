#include "groups.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "cli/unit.h"
#include "num/room.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct group {
	char *name;
	struct classes *classes;
	struct classes *non_ferrous; /* the same particles, if they are; or NULL */
	struct rate_history history;
};

struct groups {
	struct report_par par;
	struct report *report;
	struct group *group;
	size_t n, room;
	double reported; /* end of the last period that was printed */
	double periods;  /* that were printed */
	int doubtful;
};

/* Whether particles of this value may have any other. */
static int is_unclear(const struct group *group)
{
	return strcmp(group->name, "unclear") == 0 || strcmp(group->name, "nan") == 0;
}

static int is_non_ferrous(const struct groups *g, const struct group *group)
{
	return g->par.size && strcmp(group->name, "non-ferrous") == 0;
}

static struct classes *new_classes(const struct groups *g, int non_ferrous)
{
	struct classes_par par = g->par.classes;
	double edge[OPT_LIST_MAX];
	struct classes *c;

	par.size = non_ferrous ? g->par.size : NULL;
	for (int k = 0; k < g->par.edges; k++)
		edge[k] =
			non_ferrous ? g->par.equivalent(g->par.edge[k]) : g->par.edge[k];
	c = classes_new(edge, g->par.edges, &par);
	if (!c)
		die(EXIT_RUN, "out of memory");
	return c;
}

/* The group of this name, made where it is new. */
static struct group *at(struct groups *g, const char *name)
{
	struct group *new;

	for (size_t i = 0; i < g->n; i++)
		if (strcmp(g->group[i].name, name) == 0)
			return &g->group[i];
	if (room_for(&g->group, &g->room, g->n + 1, sizeof *g->group))
		die(EXIT_RUN, "out of memory");
	new = &g->group[g->n++];
	*new = (struct group){ .name = xstrdup(name) };
	new->classes = new_classes(g, is_non_ferrous(g, new));
	if (g->par.size && is_unclear(new))
		new->non_ferrous = new_classes(g, 1);
	return new;
}

struct groups *groups_new(const struct report_par *par)
{
	struct groups *g = xcalloc(1, sizeof *g);

	g->par = *par;
	g->report = report_open(par);
	if (!par->by)
		at(g, "");
	return g;
}

void groups_add(struct groups *g, const char *name, double diameter, int sure)
{
	struct group *group = at(g, name);

	classes_add(group->classes, diameter, sure);
	if (group->non_ferrous)
		classes_add(group->non_ferrous, diameter, sure);
}

void groups_add_stretch(struct groups *g, const char *name, const struct stretch *s)
{
	struct group *group = at(g, name);

	classes_add_stretch(group->classes, s);
	if (group->non_ferrous)
		classes_add_stretch(group->non_ferrous, s);
}

void groups_report(struct groups *g, double begin, double end, int whole)
{
	for (size_t i = 0; i < g->n; i++)
		for (size_t j = 0; !is_unclear(&g->group[i]) && j < g->n; j++)
			if (is_unclear(&g->group[j]))
				classes_add_possible(g->group[i].classes,
					is_non_ferrous(g, &g->group[i])
						? g->group[j].non_ferrous
						: g->group[j].classes);
	for (size_t i = 0; i < g->n; i++) {
		struct group *one = &g->group[i];

		report_period(g->report, &one->history, one->name, one->classes, begin,
			end, whole);
		classes_clear(one->classes);
		if (one->non_ferrous)
			classes_clear(one->non_ferrous);
	}
	report_flush(g->report);
	stats_add("periods", 1);
	g->reported = end;
	g->periods++;
}

double groups_next(const struct groups *g)
{
	double period = g->par.period, duration = g->par.duration;
	double end = isnan(period) ? INFINITY : decimal_multiple(g->periods + 1, period);

	/* a duration that was computed may differ by rounding */
	return fabs(end - duration) < 1e-6 * period ? duration : end;
}

void groups_finish(struct groups *g, double last)
{
	double period = g->par.period, duration = g->par.duration;

	if (isnan(period)) {
		groups_report(g, 0, isnan(duration) ? last : duration, 1);
		return;
	}
	while (groups_next(g) <= duration)
		groups_report(g, g->reported, groups_next(g), 1);
	if (duration > g->reported)
		groups_report(g, g->reported, duration, 0);
	if (!isnan(duration))
		return;
	if (g->reported == 0)
		warn("no period of %g s is complete: the last particle is at %g s; "
		     "specify the end of the record by --duration",
			period, last);
	note("particles after %g s belong to an incomplete period and are left out",
		g->reported);
	stats_set("periods_left_out", 1);
}

void groups_doubtful(struct groups *g, const char *why)
{
	report_doubt(g->report, why);
	g->doubtful = 1;
}

int groups_status(const struct groups *g)
{
	return g->doubtful ? EXIT_NOCONV : EXIT_SUCCESS;
}

int groups_alarm(const struct groups *g)
{
	for (size_t i = 0; i < g->n; i++)
		if (g->group[i].history.alarm)
			return 1;
	return 0;
}

void groups_free(struct groups *g)
{
	report_close(g->report);
	for (size_t i = 0; i < g->n; i++) {
		free(g->group[i].name);
		classes_free(g->group[i].classes);
		classes_free(g->group[i].non_ferrous);
		rate_history_free(&g->group[i].history);
	}
	free(g->group);
	free(g);
}
