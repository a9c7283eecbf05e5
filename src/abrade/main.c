/* abrade - what hard particles in a gap do to the surfaces that slide on them */
#include "abrasion/particle.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "common/verdicts.h"
#include "io/reasons.h"
#include "io/tables.h"
#include "particles_in.h"
#include "scratches.h"
#include <math.h>
#include <stdlib.h>

enum { CLASSES = 1000 }; /* of the sizes of an oil: errors of 1e-5 in pressure and wear */

static const char *const motions[] = { "moment", "groove", "roll", NULL };
static const char *const mode_names[] = { "free", "rejected", "rolls", "grooves",
	"embeds", "yields", "buried" };

static double gap = NAN, load = NAN, area = NAN, friction = NAN, abrasive = NAN;
static double cutting = 1, slide = 1, inlet = NAN;
static struct opt_list hardness;
static int motion;
static long seed = 1, body = 1;
static const char *summary_path, *particles_path, *surface_path;

static const struct opt opts[] = {
	OPT_HEADING("Gap and bodies"),
	{ 0, "gap", OPT_NUM, UNIT_LENGTH, &gap, 1e-12, 1, "H", "gap between the surfaces",
		NULL, 0 },
	{ 'F', "load", OPT_NUM, UNIT_FORCE, &load, 1e-30, 1e12, "F",
		"load that the particles carry, in place of --gap", NULL, 0 },
	{ 0, "hardness", OPT_LIST, UNIT_PRESSURE, &hardness, 1, 1e15, "H1[,H2]",
		"hardness of the two bodies", NULL, 0 },
	{ 0, "abrasive-hardness", OPT_NUM, UNIT_PRESSURE, &abrasive, 1, 1e15, "H",
		"hardness of the particles (default rigid)", NULL, 0 },
	{ 'u', "friction", OPT_NUM, UNIT_FRACTION, &friction, 0, 10, "MU",
		"friction coefficient between particles and bodies", NULL, 0 },
	OPT_HEADING("Motion"),
	{ 0, "inlet", OPT_NUM, UNIT_LENGTH, &inlet, 1e-9, 1e6, "R",
		"radius of a ball on a flat: larger particles do not enter the gap", NULL,
		0 },
	{ 0, "motion", OPT_WORD, UNIT_NONE, &motion, 0, 0, "moment|groove|roll",
		"whether particles roll or groove: by shape, or all the same", motions,
		0 },
	{ 0, "cutting", OPT_NUM, UNIT_FRACTION, &cutting, 0, 1, "C",
		"share of the volume of a groove that is removed", NULL, 0 },
	{ 0, "slide", OPT_NUM, UNIT_LENGTH, &slide, 0, 1e9, "D", "sliding distance", NULL,
		0 },
	{ 0, "area", OPT_NUM, UNIT_AREA, &area, 1e-18, 1e6, "A",
		"area of the contact: for rates, and for --iso", NULL, 0 },
	OPT_TABLE(particles_rows),
	OPT_TABLE(verdict_rows),
	OPT_HEADING("Output"),
	{ 0, "surface", OPT_TEXT, UNIT_NONE, &surface_path, 0, 0, "FILE",
		"cut the grooves into these heights and write them out", NULL, 0 },
	{ 0, "body", OPT_INT, UNIT_COUNT, &body, 1, 2, "N", "body of --surface: 1 or 2",
		NULL, 0 },
	{ 0, "particles", OPT_TEXT, UNIT_NONE, &particles_path, 0, 0, "FILE",
		"with --surface: write the table of particles to FILE", NULL, 1 },
	{ 0, "summary", OPT_TEXT, UNIT_NONE, &summary_path, 0, 0, "FILE",
		"write one row per gap", NULL, 1 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N",
		"seed of the random numbers", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "abrade",
	"Compute three-body abrasion by hard particles in a gap.", "[file]",
	"table: diameter [aspect] [realisation] [step], unless --iso",
	"table: one row per particle; with --surface fields: height", opts };

static struct table_out *table, *summary;
static const struct population *population; /* of --iso */
static struct population_mean mean = { NAN, { NAN, NAN }, NAN };
static struct reasons doubts;
static int stepped;
static double rolling, yielding, buried; /* particles */

/* The tables and the surfaces say it too, since the exit status is lost in a pipe. */
static void doubt(const char *why)
{
	reasons_add(&doubts, why);
	if (table)
		table_comment(table, "doubtful", "%s", why);
	if (summary)
		table_comment(summary, "doubtful", "%s", why);
}

static struct abrasion_par parameters(void)
{
	return (struct abrasion_par){ .gap = gap,
		.hardness = { hardness.v[0], hardness.v[hardness.n - 1] },
		.abrasive = isnan(abrasive) ? INFINITY : abrasive,
		.friction = friction,
		.inlet = isnan(inlet) ? INFINITY : inlet,
		.motion = (enum abrasion_motion)motion };
}

static void check_options(int operands)
{
	if (isnan(gap) == isnan(load))
		die(EXIT_USAGE, "specify either --gap H or --load F");
	if (gap >= 1e-2)
		warn("--gap %g m: is %gum meant?", gap, gap);
	if (!hardness.n)
		die(EXIT_USAGE, "--hardness is missing: H1[,H2] in Pa");
	for (int i = 0; i < hardness.n; i++)
		if (hardness.v[i] < 1e5)
			warn("--hardness %g Pa is softer than any solid: is %gGPa meant?",
				hardness.v[i], hardness.v[i]);
	if (abrasive < 1e5)
		warn("--abrasive-hardness %g Pa is softer than any solid: is %gGPa meant?",
			abrasive, abrasive);
	if (isnan(friction))
		die(EXIT_USAGE, "--friction is missing");
	opt_require("surface", "body");
	if (particles_path && !surface_path)
		die(EXIT_USAGE, "--particles: the table goes to standard output unless "
				"--surface is given");
	particles_check(operands, area, inlet);
	if (opt_given("seed") && !opt_given("iso") && !surface_path)
		die(EXIT_USAGE,
			"--seed requires --iso or --surface: nothing else is drawn");
}

static void check_rigid(const struct abrasion_par *par)
{
	if (par->abrasive < abrasion_harder * fmin(par->hardness[0], par->hardness[1]))
		die(EXIT_RUN,
			"--abrasive-hardness %g Pa: the particles yield, and the load they carry is unknown",
			par->abrasive);
}

/* Gap at which the particles carry the load. */
static double find_gap(const struct abrasion_par *par, const struct particles_in *in)
{
	double evaluations = 0, carried, found, error;

	check_rigid(par);
	found = abrasion_gap(
		par, in->diameter, in->aspect, (long)in->n, load, &carried, &evaluations);
	stats_add("loads_computed", evaluations);
	if (isnan(found))
		die(EXIT_RUN,
			"realisation %ld: the particles carry at most %g N of %g N: the "
			"surfaces touch",
			in->realisation, carried, load);
	error = carried / load - 1;
	/* The way a particle moves may change at this very gap. */
	if (fabs(error) > 1e-6) {
		warn("realisation %ld: at a gap of %.6g m the load jumps over %g N to %g N",
			in->realisation, found, load, carried);
		doubt("at some gaps the load jumps over the wanted one");
	}
	return found;
}

/* The gap at which the particles of an oil carry the load on average. */
static double mean_gap(const struct abrasion_par *par)
{
	double most, found;

	check_rigid(par);
	found = population_gap(population, par, load / area, CLASSES, &most);
	if (isnan(found))
		die(EXIT_RUN,
			"the particles of the oil carry at most %g Pa of %g Pa: the "
			"surfaces touch",
			most, load / area);
	return found;
}

/* What the particles of an oil do on average, those included that are too rare to be
 * drawn. */
static void find_mean(struct abrasion_par par)
{
	par.gap = gap;
	population_mean(population, &par, CLASSES, &mean);
	if (!(mean.undescribed > 0))
		return;
	warn("%.3g particles per m2 of the oil yield or are buried: the mean wear does not include theirs",
		mean.undescribed);
	doubt("the mean wear does not include particles that yield or are buried");
}

struct totals {
	double load, volume[2], number[ABRASION_MODES];
};

/* The first columns of both tables. */
static void put_gap(struct table_out *t, const struct particles_in *in)
{
	table_put(t, (double)in->realisation);
	if (stepped)
		table_put(t, (double)in->step);
}

static void put_particle(const struct particles_in *in, size_t number,
	const struct abrasion *a, const double volume[2])
{
	put_gap(table, in);
	table_put(table, (double)number);
	table_put(table, in->diameter[number]);
	table_put(table, a->load);
	table_put(table, a->depth[0]);
	table_put(table, a->depth[1]);
	table_put_text(table, mode_names[a->mode]);
	table_put_row(table, volume, 2);
}

static void put_summary(const struct particles_in *in, const struct abrasion_par *par,
	const struct totals *t)
{
	double per_metre = slide > 0 ? 1 / (area * slide) : NAN;

	if (!summary)
		return;
	const double row[] = { par->gap, t->load, t->load / area, (double)in->n,
		t->number[ABRASION_FREE], t->number[ABRASION_REJECTED],
		t->number[ABRASION_ROLLS], t->number[ABRASION_GROOVES],
		t->number[ABRASION_EMBEDS], t->number[ABRASION_YIELDS],
		t->number[ABRASION_BURIED], t->volume[0], t->volume[1],
		t->volume[0] * per_metre, t->volume[1] * per_metre, mean.pressure,
		cutting * mean.section[0], cutting * mean.section[1] };

	put_gap(summary, in);
	table_put_row(summary, row, (int)(sizeof row / sizeof *row));
}

static void run_gap(const struct particles_in *in)
{
	struct abrasion_par par = parameters();
	struct totals t = { 0 };

	if (!population && isnan(gap))
		par.gap = find_gap(&par, in);
	else
		par.gap = gap;
	for (size_t i = 0; i < in->n; i++) {
		struct abrasion a;
		double volume[2];

		abrasion_particle(
			&par, in->diameter[i], in->aspect ? in->aspect[i] : 1, &a);
		for (int k = 0; k < 2; k++) {
			volume[k] = cutting * a.section[k] * slide;
			if (!isnan(volume[k]))
				t.volume[k] += volume[k];
		}
		if (!isnan(a.load))
			t.load += a.load;
		t.number[a.mode]++;
		if (table)
			put_particle(in, i, &a, volume);
		if (surface_path && a.section[body - 1] > 0)
			scratches_add(in->realisation, in->step, in->diameter[i],
				a.groove[body - 1], a.share[body - 1]);
	}
	put_summary(in, &par, &t);
	for (int m = 0; m < ABRASION_MODES; m++)
		if (t.number[m] > 0)
			stats_add(mode_names[m], t.number[m]);
	rolling += t.number[ABRASION_ROLLS];
	yielding += t.number[ABRASION_YIELDS];
	buried += t.number[ABRASION_BURIED];
}

/* A table that begins with the columns of put_gap(). */
static struct table_out *create(
	const char *path, const char *cmd, const char *units, const char *columns)
{
	char *all_units = xprintf("1 %s%s", stepped ? "1 " : "", units);
	char *all = xprintf("realisation %s%s", stepped ? "step " : "", columns);
	struct table_out *t = table_create(path, cmd, all_units, all);

	free(all_units);
	free(all);
	return t;
}

int main(int argc, char **argv)
{
	int operand = opt_parse(&prog, argc, argv);
	struct particles_in in = { 0 };
	struct abrasion_par par;
	struct source *source;
	long gaps = 0;
	const char *upstream;
	char *cmd, *side;
	int doubtful;

	check_options(argc - operand);
	par = parameters();
	population = particles_population(
		abrasion_largest(friction, par.inlet, isnan(gap) ? 0 : gap));
	if (population && isnan(gap))
		gap = mean_gap(&par);
	source = population ? particles_drawn(population, area, gap, (uint64_t)seed)
			    : particles_read(argv[operand]);
	stepped = particles_stepped(source);
	upstream = particles_upstream(source);
	cmd = surface_path ? opt_cmd_side(upstream, "particles")
			   : opt_cmd(upstream, NULL);
	side = opt_cmd_side(upstream, "summary");
	/* read last: what wears the particles off may write it */
	if (surface_path)
		file_claim_input(surface_path);
	if (!surface_path || particles_path)
		table = create(particles_path, cmd, "1 m N m m 1 m3 m3",
			"particle diameter load depth1 depth2 mode volume1 volume2");
	free(cmd);
	cmd = opt_cmd(upstream, NULL);
	if (summary_path)
		summary = create(summary_path, side,
			"m N Pa 1 1 1 1 1 1 1 1 m3 m3 1 1 Pa 1 1",
			"gap load pressure particles free rejected "
			"rolls grooves embeds yields buried volume1 volume2 "
			"depth_rate1 depth_rate2 mean_pressure "
			"mean_depth_rate1 mean_depth_rate2");
	if (summary && population)
		find_mean(par);
	if (population && gap < population->diameter[0]) {
		warn("particles between the gap of %g m and %g m are missing: the code does not count them",
			gap, population->diameter[0]);
		doubt("particles between the gap and 4 um are missing");
	}
	for (; particles_next(source, &in); gaps++)
		run_gap(&in);
	if (!isnan(load) && gaps == 0) {
		warn("no particle carries the load of %g N: the surfaces touch", load);
		doubt("no particle carries the load");
	}
	if (motion == ABRASION_BY_SHAPE && !particles_shaped(source) &&
		(rolling > 0 || population))
		warn("particles without aspect are spheres, which roll and remove nothing; "
		     "--motion groove gives an upper bound of the wear");
	if (yielding + buried > 0) {
		warn("%.0f particles yield and %.0f are buried deeper than their radius: the volumes do not include their wear",
			yielding, buried);
		doubt("the volumes do not include particles that yield or are buried");
	}
	verdict_report();
	if (verdict_equivalent())
		doubt("the diameters of particles that are not ferrous");
	if (particles_doubted(source))
		doubt(particles_doubted(source));
	if (surface_path) {
		char *own;
		size_t again, left = scratches_cut(surface_path, slide, cutting,
				      (uint64_t)seed, particles_apart(source), stepped,
				      cmd, reasons_text(&doubts), &again, &own);

		if (again > 0) {
			warn("%s: %zu records are of the realisation%s of an earlier one: all its grooves are cut into each of them",
				surface_path, again, stepped ? " and step" : "");
			doubt(scratched_again);
		}
		if (left > 0) {
			warn("%zu grooves are left out: %s has no record of their realisation%s",
				left, surface_path, stepped ? " and step" : "");
			doubt("grooves without a surface are left out");
		}
		if (own)
			doubt(own);
		free(own);
	}
	particles_close(source);
	if (table)
		table_done(table);
	if (summary)
		table_done(summary);
	free(cmd);
	free(side);
	doubtful = reasons_text(&doubts) != NULL;
	reasons_free(&doubts);
	return shell_done(doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
