/* debrisgen - wear particles that a contact tears off a rough surface */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "common/edge.h"
#include "common/moments.h"
#include "io/fields.h"
#include "num/pages.h"
#include "outputs.h"
#include "quick.h"
#include "wear_steps.h"
#include <math.h>
#include <stdlib.h>

/* What the default model takes on 2048 x 2048 cells; more comes in small pages. */
enum { RESERVE = 256 << 20 };

static long steps = 1;
static double stop_area = 0.8, amplification = 1;

static const struct opt opts[] = {
	OPT_TABLE(wearing_rows),
	OPT_HEADING("Steps"),
	{ 0, "steps", OPT_INT, UNIT_COUNT, &steps, 1, 1e6, "N",
		"number of wear steps; from the second on the contact is solved again",
		NULL, 0 },
	{ 0, "stop-area", OPT_NUM, UNIT_FRACTION, &stop_area, 0, 1, "A",
		"stop when this fraction of the cells is in contact; 1: never", NULL, 0 },
	{ 0, "amplification", OPT_NUM, UNIT_NONE, &amplification, 0, 1e12, "K",
		"sliding distance of a step over the length of the grid, or over --slide",
		NULL, 0 },
	OPT_TABLE(worn_rows),
	OPT_TABLE(press_rows),
	OPT_END,
};

static const struct prog prog = { "debrisgen",
	"Compute the wear particles of a rough contact, step by step.", "[file]",
	"fields: height, pressure, from bemcontact", "table: one row per wear particle",
	opts };

/* The state of a run over all records. */
struct run {
	struct edge edge, border;
	struct fields_in *in;
	struct wearing *wearing;
	struct worn *out; /* NULL before the first record */
	int status;
	struct record *now; /* the present record; its key "doubtful" tells why it is */
	struct moments worn;
	int again; /* an earlier record had a step of a later one */
};

/* The tables and the surfaces say it too, since the exit status is lost in a pipe. */
static void doubt(struct run *run, const char *why)
{
	run->status = EXIT_NOCONV;
	record_doubt(run->now, why);
}

/* One surface during its steps. */
struct scene {
	struct worn_surface now;
	double target; /* mean pressure, or approach */
	long done;     /* steps before the first of this run */
};

static double contact_load(const struct run *run, const struct scene *c)
{
	struct debris_step s;

	wearing_contact(run->wearing, &c->now, &s);
	return s.load;
}

static double choose_target(const struct run *run, const struct scene *c)
{
	const struct record *r = c->now.r;
	double asked = press_target(r), given = record_get_number(r, "mean_pressure");

	if (!isnan(asked))
		return asked;
	return isnan(given) ? contact_load(run, c) / (r->nx * r->dx * r->ny * r->dy)
			    : given;
}

/* Of a first step, which uses the pressure of the input. */
static void compare_target(const struct run *run, const struct scene *c)
{
	const struct record *r = c->now.r;
	const char *name = fields_name(run->in);
	long number = fields_count(run->in);

	if (!isnan(press.approach))
		press_differs(name, number, "an approach", "m", press.approach,
			record_get_number(r, "approach"));
	else if (!isnan(press_target(r)))
		press_differs(name, number, "a mean pressure", "Pa", press_target(r),
			contact_load(run, c) / (r->nx * r->dx * r->ny * r->dy));
}

static void open_scene(struct run *run, struct record *r, struct scene *c)
{
	double before = record_get_number(r, "step"), crown, sq;
	const char *why = NULL;

	if (r->nz != 1)
		die(EXIT_RUN, "%s: record %ld: want plane fields, got %d layers",
			fields_name(run->in), fields_count(run->in), r->nz);
	if (!wearing_solves(run->wearing, 1))
		why = press_given(r, fields_name(run->in), fields_count(run->in));
	if (why)
		doubt(run, why);
	crown = record_get_number(r, "crown");
	sq = record_get_number(r, "sq");
	if (record_find(r, "pressure") < 0 && wearing_solves(run->wearing, 1))
		record_add(r, "pressure", "Pa");
	c->now = (struct worn_surface){ .r = r,
		.h = record_need(r, "height", 1, run->in),
		.p = record_need(r, "pressure", 1, run->in),
		.crown = isnan(crown) ? 0 : crown,
		.sq = sq };
	c->done = isnan(before) ? 0 : (long)before;
	if (c->now.h && !(sq > 0)) {
		c->now.sq = worn_roughness(&c->now);
		record_set(r, "sq", "%.17g", c->now.sq);
	}
	wearing_prepare(run->wearing, r);
	c->target = choose_target(run, c);
	if (steps == 1 && !wearing_solves(run->wearing, 1))
		compare_target(run, c);
	if (c->target == 0 && wearing_solves(run->wearing, 1) && isnan(press.approach) &&
		contact_load(run, c) == 0)
		die(EXIT_USAGE,
			"%s: record %ld carries no load: specify --load, --pressure or --approach",
			fields_name(run->in), fields_count(run->in));
}

/* 1 if the contact is too large for a further step. */
static int check_contact(struct run *run, struct scene *c, long step)
{
	const char *name = fields_name(run->in);
	struct debris_step s;

	wearing_contact(run->wearing, &c->now, &s);
	if (edge_load_note(&run->edge, s.edge_load, c->now.r->realisation, step))
		doubt(run, "the outermost cells carry most of the load");
	if (s.contact < stop_area || stop_area == 1)
		return 0;
	warn("%s: realisation %ld: stopped before step %ld: %.3g of the cells in contact, "
	     "--stop-area %g",
		name, c->now.r->realisation, step, s.contact, stop_area);
	return 1;
}

/* Particles without end on a periodic grid have no shape. */
static void check_ends(struct run *run, const struct scene *c, const struct worn_step *s)
{
	size_t endless = 0;

	for (size_t i = 0; i < s->lost->count; i++)
		endless += s->lost->particle[i].endless != 0;
	if (endless == 0)
		return;
	warn("%s: realisation %ld, step %ld: %zu of %zu particles connect to themselves across the periodic grid: their shape is nan",
		fields_name(run->in), c->now.r->realisation, s->number, endless,
		s->lost->count);
	doubt(run, "particles connect to themselves across the periodic grid");
	stats_add("particles_endless", (double)endless);
}

/* What either body may lose beyond the border, relative to what it loses within. */
static void check_border(
	struct run *run, const struct scene *c, const struct worn_step *s)
{
	const struct debris_step *body[] = { s->lost, s->second };
	double most = 0;

	for (int k = 0; k < 2; k++)
		if (body[k] && body[k]->volume > 0)
			most = fmax(most, body[k]->beyond / body[k]->volume);
	edge_note(&run->border, most, DEBRIS_BEYOND, c->now.r->realisation, s->number);
	if (most > DEBRIS_BEYOND)
		doubt(run, "particles are cut off at the border of the grid");
}

static void wear_step(struct run *run, const struct scene *c, long step)
{
	double length = amplification * wearing_length(c->now.r);
	int solved;
	struct worn_step s =
		wearing_step(run->wearing, &c->now, c->target, length, step, &solved);

	if (!solved)
		doubt(run, press_not_converged);
	check_ends(run, c, &s);
	check_border(run, c, &s);
	s.length = length;
	s.distance = (double)step * length;
	worn_put(run->out, &c->now, &s);
	note("%s: realisation %ld, step %ld: %zu particles, %.6g m3, %ld layers",
		fields_name(run->in), c->now.r->realisation, step, s.lost->count,
		s.lost->volume, s.lost->wear.layers);
}

/* The nominal pressure is that of the steps, or not one where these keep an approach.
 * Rounded, so that its last digit does not differ between records. */
static struct worn_conditions conditions_of(const struct scene *c)
{
	const struct record *r = c->now.r;
	int pressed = press_control() == CONTACT_PRESSURE;

	return (struct worn_conditions){ .area = r->nx * r->dx * r->ny * r->dy,
		.pressure = pressed ? (double)(float)c->target : NAN,
		.friction = wearing_friction(),
		.distance = amplification * wearing_length(r) };
}

/* Tables count the particles of two surfaces as those of one. */
static void check_again(struct run *run, long realisation, long step)
{
	struct moment m = { realisation, (double)step };

	if (!moments_again(&run->worn, m))
		return;
	if (!run->again)
		warn("%s: record %ld: realisation %ld, step %ld, as an earlier record: "
		     "joined ensembles need different numbers, roughgen --first",
			fields_name(run->in), fields_count(run->in), realisation, step);
	run->again = 1;
	doubt(run, "more than one surface has this number");
}

/* Wears one surface step by step. */
static void wear_record(struct run *run, struct record *r)
{
	int last = fields_last(run->in);
	struct scene c = { 0 };
	struct worn_conditions conditions;
	const char *why;
	long k;

	run->now = r;
	open_scene(run, r, &c);
	conditions = conditions_of(&c);
	worn_begin(run->out, r, &conditions);
	for (k = 1; k <= steps; k++) {
		progress_within((double)(k - 1) / (double)steps, last);
		if (wearing_solves(run->wearing, k) &&
			!wearing_press(run->wearing, &c.now, c.target, c.done + k))
			doubt(run, press_not_converged);
		if (check_contact(run, &c, c.done + k)) {
			stats_add("steps_skipped", (double)(steps - k + 1));
			if (k == 1)
				doubt(run, "most of the cells are in contact");
			break;
		}
		check_again(run, r->realisation, c.done + k);
		wear_step(run, &c, c.done + k);
	}
	if (k > 1)
		worn_end(run->out, r->realisation, c.done + k - 1);
	why = record_get(r, "doubtful");
	if (why) {
		char *text = xprintf("realisation %ld: %s", r->realisation, why);

		run->status = EXIT_NOCONV;
		worn_doubt(run->out, text);
		free(text);
	}
}

static void warn_of_border(struct run *run)
{
	const struct edge *e = &run->border;

	stats_add("border_steps", (double)e->steps);
	if (!e->steps)
		return;
	warn("%s: %ld steps whose particles are cut off at the border of the grid, where up "
	     "to %.0f %% more volume is lost (realisation %ld, step %ld): use a larger "
	     "area, roughgen --crown auto, or --boundary periodic",
		fields_name(run->in), e->steps, 100 * e->most, e->realisation, e->step);
}

int main(int argc, char **argv)
{
	int first = opt_parse(&prog, argc, argv);
	struct record r = { 0 };
	struct run run = { 0 };

	pages_reserve(RESERVE);
	press_check();
	wearing_check();
	run.in = fields_open(argv[first], NULL);
	run.wearing = wearing_open(run.in, steps);
	if (!wearing_takes_heights(run.wearing) && !worn_takes_heights())
		fields_only_check(run.in, "height");
	while (fields_read(run.in, &r)) {
		if (!run.out)
			run.out = worn_open(r.cmd, wearing_richardson(), quick_asked());
		wear_record(&run, &r);
		progress_within(1, 0);
	}
	progress_clear();
	edge_load_warn(&run.edge, fields_name(run.in));
	warn_of_border(&run);
	if (!wearing_warn(run.wearing)) {
		run.status = EXIT_NOCONV;
		worn_doubt(run.out,
			"the surrogate is of other surfaces, or doubtful itself");
	}
	fields_doubted(run.in);
	worn_close(run.out);
	free(run.worn.of);
	wearing_close(run.wearing);
	fields_close(run.in);
	record_free(&r);
	return shell_done(run.status);
}
