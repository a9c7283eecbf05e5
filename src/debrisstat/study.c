#include "study.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "common/simulated.h"
#include "io/input.h"
#include "io/quantities.h"
#include "io/tables.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>

static void check(struct ensemble *e, enum ensemble_status status)
{
	switch (status) {
	case ENSEMBLE_OK:
		return;
	case ENSEMBLE_APART:
		die(EXIT_RUN,
			"the rows of realisation %ld are not contiguous: sort the table by realisation",
			ensemble_culprit(e));
	case ENSEMBLE_CLASH:
		die(EXIT_RUN,
			"realisation %ld stands in two parts of the table; "
			"the numbers of joined ensembles must differ",
			ensemble_culprit(e));
	case ENSEMBLE_MORE:
		die(EXIT_RUN, "--realisations %.0f, but the table has %zu",
			ensemble_par(e)->realisations, ensemble_reported(e));
	case ENSEMBLE_MEMORY:
		die(EXIT_RUN, "out of memory");
	}
}

/* The summary of debrisgen for the particles, row by row. */
struct summary {
	long last;              /* step */
	struct table_in *table; /* NULL: none */
	int realisation, step;  /* columns */
	long at;                /* realisation of the present row */
	int more;
};

static void next_summary(struct summary *s)
{
	s->more = table_next(s->table);
	if (s->more)
		s->at = table_whole(s->table, s->realisation, 0, 1e15);
}

static void open_summary(struct summary *s, const char *path)
{
	*s = (struct summary){ 0 };
	if (!path)
		return;
	s->table = table_open(path);
	s->realisation = table_need(s->table, "realisation");
	s->step = table_need(s->table, "step");
	next_summary(s);
}

/* Reads up to a realisation: the rows of both tables reach the ensemble together. */
static void read_summary(struct summary *s, struct ensemble *e, long realisation)
{
	for (; s->more && s->at <= realisation; next_summary(s)) {
		long step = table_whole(s->table, s->step, 1, 1e6);

		check(e, ensemble_took_place(e, s->at, step));
		s->last = step > s->last ? step : s->last;
	}
}

static struct study study_of(const struct table_in *t)
{
	return (struct study){ .area = table_quantity(t, "nominal_area", UNIT_AREA),
		.distance = table_quantity(t, "step_distance", UNIT_LENGTH) };
}

/* Ends the program where this part of the table is of another area or step. */
static void check_part(const struct table_in *t, const struct study *study)
{
	struct study now = study_of(t);

	if (quantity_differs(now.area, study->area))
		die(EXIT_RUN, "%s: line %ld: surfaces of %g and of %g m2 in one study",
			table_name(t), table_line(t), study->area, now.area);
	if (quantity_differs(now.distance, study->distance))
		die(EXIT_RUN, "%s: line %ld: steps of %g and of %g m in one study",
			table_name(t), table_line(t), study->distance, now.distance);
}

/* A row of the table; columns as in study_read(). */
static struct particle_row read_row(
	struct table_in *t, int realisation, int step, int diameter, int volume)
{
	struct particle_row row = { table_whole(t, realisation, 0, 1e15),
		table_whole(t, step, 1, 1e6), table_diameter(t, diameter),
		table_positive(t, volume), table_part(t) };

	/* A litre: of the largest diameter, in a few times its sphere. */
	if (row.volume > 1e-3)
		die(EXIT_RUN,
			"%s: line %ld: volume is %g m3, want m3 or a '# units:' line above the "
			"header that names the unit",
			table_name(t), table_line(t), row.volume);
	return row;
}

struct study study_read(
	const struct study_par *par, const char *path, struct reasons *doubts)
{
	struct simulated simulated = { 0 };
	struct table_in *t =
		table_with_comments(input_open(path), simulated_comment, &simulated);
	int more = table_next(t);
	const int realisation = table_need(t, "realisation"),
		  step = table_need(t, "step"),
		  diameter = table_need_quantity(t, "diameter", UNIT_LENGTH),
		  volume = table_need_quantity(t, "volume", UNIT_VOLUME),
		  aspect = table_need(t, "aspect");
	struct ensemble *e = ensemble_new(&par->ensemble);
	struct study study = study_of(t);
	long last = 0, part = table_part(t);
	struct summary summary;

	if (!e)
		check(e, ENSEMBLE_MEMORY);
	open_summary(&summary, par->summary);
	for (; more; more = table_next(t)) {
		struct particle_row row =
			read_row(t, realisation, step, diameter, volume);

		if (table_part(t) != part && par->alike)
			check_part(t, &study);
		part = table_part(t);
		read_summary(&summary, e, row.realisation);
		check(e, ensemble_add(e, &row));
		last = row.step > last ? row.step : last;
		/* A particle that is endless on a periodic grid has no shape. */
		par->row(&row,
			isnan(table_number(t, aspect)) ? NAN : table_positive(t, aspect));
	}
	read_summary(&summary, e, LONG_MAX);
	last = summary.last > last ? summary.last : last;
	if (!summary.table) {
		last = simulated.last_step > last ? simulated.last_step : last;
		check(e, ensemble_simulated(e, (double)simulated.count, last));
	}
	/* Steps that did not take place wore nothing off, which is no result. */
	if (par->last > last)
		die(EXIT_RUN, "--step: %s has no step after %ld%s", table_name(t), last,
			summary.table
				? ""
				: ": if later ones wore nothing off, specify --summary");
	if (summary.table)
		table_close(summary.table);
	reasons_add(doubts, table_doubted(t));
	study.cmd = opt_cmd(table_upstream(t), NULL);
	table_close(t);
	check(e, ensemble_close(e));
	study.particles = e;
	return study;
}

void study_free(struct study *study)
{
	ensemble_free(study->particles);
	free(study->cmd);
}
