/* debrisstat - statistics of wear particles: fits, steps, sizes, shapes */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "cli/unit.h"
#include "common/simulated.h"
#include "io/input.h"
#include "io/quantities.h"
#include "io/reasons.h"
#include "io/tables.h"
#include "stats/estimates.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>

enum output { FITS, STEPS, SIZES, ASPECTS };
static const char *const outputs[] = { "fits", "steps", "sizes", "aspects", NULL };
static const char *const growths[] = { "cumulative", "step", NULL };

static int output, growth, truncated;
static struct opt_list diameters = { 2, { 0, INFINITY } }, range;
static struct opt_list edges = { 8, { 1, 1.25, 1.5, 2, 3, 5, 8, 13 } };
static double bin = 10e-6, confidence = 0.95, depth = 1e-6;
static long realisations, bootstrap, seed = 1;
static const char *summary_path, *other_path;

enum {
	GROUPS = 512,  /* of realisations, for --bootstrap; fewer realisations are a group
			* each.  The width of an interval from 512 is known to 3 %. */
	COMPARED = 400 /* samples of --compare: the share beyond an end of a 90 % interval
			* is then known to sqrt(0.05 * 0.95 / 400) = 1.1 % */
};

static const struct opt opts[] = {
	OPT_HEADING("Output"),
	{ 'o', "output", OPT_WORD, UNIT_NONE, &output, 0, 0, "fits|steps|sizes|aspects",
		"what to print", outputs, 0 },
	{ 0, "diameter", OPT_LIST, UNIT_LENGTH, &diameters, 0, 1e30, "LO:HI",
		"only particles of this equivalent diameter", NULL, 0 },
	OPT_HEADING("Fits"),
	{ 0, "truncated", OPT_FLAG, UNIT_NONE, &truncated, 0, 0, NULL,
		"fit a Weibull distribution truncated at --diameter", NULL, 0 },
	{ 0, "step", OPT_LIST, UNIT_COUNT, &range, 1, 1e9, "A[:B]",
		"use only these steps; default all", NULL, 0 },
	{ 0, "growth", OPT_WORD, UNIT_NONE, &growth, 0, 0, "cumulative|step",
		"fit the power law to all particles so far, or to those of each step",
		growths, 0 },
	{ 0, "bin", OPT_NUM, UNIT_LENGTH, &bin, 1e-30, 1e30, "W",
		"width of the classes of sizes", NULL, 0 },
	{ 0, "aspects", OPT_LIST, UNIT_NONE, &edges, 1, 1e9, "A,A,...",
		"edges of the classes of aspect ratio", NULL, 0 },
	OPT_HEADING("Intervals"),
	{ 0, "confidence", OPT_NUM, UNIT_FRACTION, &confidence, 0.01, 0.9999, "C",
		"confidence level of the intervals", NULL, 0 },
	{ 0, "bootstrap", OPT_INT, UNIT_COUNT, &bootstrap, 0, 1e6, "N",
		"intervals by N bootstrap samples of whole realisations", NULL, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "seed of --bootstrap",
		NULL, 0 },
	{ 0, "realisations", OPT_INT, UNIT_COUNT, &realisations, 0, 1e9, "N",
		"number of realisations, including those without particles", NULL, 0 },
	OPT_HEADING("Further output"),
	{ 0, "compare", OPT_TEXT, UNIT_NONE, &other_path, 0, 0, "FILE",
		"compare with the table of another study: differences and ratios", NULL,
		0 },
	{ 0, "depth", OPT_NUM, UNIT_LENGTH, &depth, 1e-15, 1, "H",
		"of --compare: mean depth of wear that ends the life", NULL, 0 },
	{ 0, "summary", OPT_TEXT, UNIT_NONE, &summary_path, 0, 0, "FILE",
		"summary of debrisgen, which lists steps without particles", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "debrisstat",
	"Fit distributions and growth laws to the wear particles of an ensemble.",
	"[file]", "table: realisation, step, volume, diameter, aspect, from debrisgen",
	"table", opts };

static _Noreturn void no_memory(void)
{
	die(EXIT_RUN, "out of memory");
}

/* Classes of sizes and aspect ratios, which need no ensemble. */
static double *size_count, aspect_count[OPT_LIST_MAX], aspects;
static size_t classes, class_room;

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
		die(EXIT_RUN, "--realisations %ld, but the table has %zu", realisations,
			ensemble_reported(e));
	case ENSEMBLE_MEMORY:
		no_memory();
	}
}

static int counts(const struct particle_row *s)
{
	return s->diameter >= diameters.v[0] && s->diameter <= diameters.v[1] &&
	       (range.n == 0 || (s->step >= (long)range.v[0] &&
					s->step <= (long)range.v[range.n - 1]));
}

static void classify(const struct particle_row *s, double aspect)
{
	size_t size;
	int k = 0;

	if (!counts(s))
		return;
	while (k < edges.n && aspect >= edges.v[k])
		k++;
	if (k > 0)
		aspect_count[k - 1]++;
	aspects++;
	if (output != SIZES)
		return;
	if (s->diameter / bin > 1e6)
		die(EXIT_RUN, "--bin %g m: more than a million classes", bin);
	size = (size_t)(s->diameter / bin);
	/* the quotient may be rounded beyond the limit of a class */
	size += s->diameter >= decimal_multiple((double)size + 1, bin);
	size -= s->diameter < decimal_multiple((double)size, bin);
	if (size + 1 > classes)
		classes = size + 1;
	while (classes > class_room) {
		size_t room = class_room ? 2 * class_room : 64;

		size_count = xrealloc(size_count, room, sizeof *size_count);
		for (size_t i = class_room; i < room; i++)
			size_count[i] = 0;
		class_room = room;
	}
	size_count[size]++;
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

static void open_summary(struct summary *s)
{
	*s = (struct summary){ 0 };
	if (!summary_path)
		return;
	s->table = table_open(summary_path);
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

static struct reasons doubts; /* of the input */

/* Ends the output, which is as doubtful as the input. */
static void finish(struct table_out *t)
{
	const char *why = reasons_text(&doubts);

	if (why)
		table_comment(t, "doubtful", "%s", why);
	table_done(t);
}

/* What a table states of its study; nan: nothing. */
struct study {
	double area;     /* nominal, m2 */
	double distance; /* slid in a step, m */
};

static struct study study_of(const struct table_in *t)
{
	return (struct study){ table_quantity(t, "nominal_area", UNIT_AREA),
		table_quantity(t, "step_distance", UNIT_LENGTH) };
}

/* The values may have been rounded in between. */
static int differ(double a, double b)
{
	return fabs(a - b) > 1e-3 * fmax(fabs(a), fabs(b));
}

/* The life of --compare is that of one area and step. */
static void check_study(const struct table_in *t, const struct study *study)
{
	struct study now = study_of(t);

	if (other_path && differ(now.area, study->area))
		die(EXIT_RUN, "%s: line %ld: surfaces of %g and of %g m2 in one study",
			table_name(t), table_line(t), study->area, now.area);
	if (other_path && differ(now.distance, study->distance))
		die(EXIT_RUN, "%s: line %ld: steps of %g and of %g m in one study",
			table_name(t), table_line(t), study->distance, now.distance);
}

static void read_particles(
	struct ensemble *e, const char *path, struct study *study, char **cmd)
{
	struct simulated simulated = { 0 };
	struct table_in *t =
		table_with_comments(input_open(path), simulated_comment, &simulated);
	int more = table_next(t);
	int cr, cs, cd, cv, ca;
	long last = 0, part = table_part(t);
	struct summary summary;
	const char *why;

	cr = table_need(t, "realisation");
	cs = table_need(t, "step");
	cd = table_need_quantity(t, "diameter", UNIT_LENGTH);
	cv = table_need_quantity(t, "volume", UNIT_VOLUME);
	ca = table_need(t, "aspect");
	open_summary(&summary);
	*study = study_of(t);
	for (; more; more = table_next(t)) {
		struct particle_row s = { table_whole(t, cr, 0, 1e15),
			table_whole(t, cs, 1, 1e6), table_diameter(t, cd),
			table_positive(t, cv), table_part(t) };

		/* A litre: of the largest diameter, in a few times its sphere. */
		if (s.volume > 1e-3)
			die(EXIT_RUN,
				"%s: line %ld: volume is %g m3, want m3 or a '# units:' line "
				"above the header that names the unit",
				table_name(t), table_line(t), s.volume);

		if (table_part(t) != part)
			check_study(t, study);
		part = table_part(t);
		read_summary(&summary, e, s.realisation);
		check(e, ensemble_add(e, &s));
		last = s.step > last ? s.step : last;
		/* A particle that is endless on a periodic grid has no shape. */
		classify(&s, isnan(table_number(t, ca)) ? NAN : table_positive(t, ca));
	}
	read_summary(&summary, e, LONG_MAX);
	last = summary.last > last ? summary.last : last;
	if (!summary.table) {
		last = simulated.last_step > last ? simulated.last_step : last;
		check(e, ensemble_simulated(e, (double)simulated.count, last));
	}
	/* Steps that did not take place wore nothing off, which is no result. */
	if (range.n > 0 && range.v[range.n - 1] > (double)last)
		die(EXIT_RUN, "--step: %s has no step after %ld%s", table_name(t), last,
			summary.table
				? ""
				: ": if later ones wore nothing off, specify --summary");
	if (summary.table)
		table_close(summary.table);
	why = table_doubted(t);
	if (why)
		reasons_add(&doubts, why);
	*cmd = opt_cmd(table_upstream(t), NULL);
	table_close(t);
}

static void tell(long done, long draws)
{
	progress("draws", (double)done, (double)draws);
}

static struct ensemble *new_ensemble(void)
{
	struct ensemble_par par = { .realisations = (double)realisations,
		.first = range.n > 0 ? (long)range.v[0] : 1,
		.last = range.n > 0 ? (long)range.v[range.n - 1] : 0,
		.partial = summary_path != NULL,
		.low = diameters.v[0],
		.high = diameters.v[1],
		.truncated = truncated,
		.per_step = growth,
		.confidence = confidence,
		.by_step = output == STEPS,
		.groups = output == FITS && (bootstrap || other_path) ? GROUPS : 0,
		.progress = tell };
	struct ensemble *e = ensemble_new(&par);

	if (!e)
		no_memory();
	return e;
}

static void put_quantity(
	struct table_out *t, const char *name, const char *unit, struct estimate e)
{
	table_put_text(t, name);
	table_put(t, e.value);
	table_put(t, e.low);
	table_put(t, e.high);
	table_put_text(t, unit);
	table_end_row(t);
}

/* Names of enum estimate_quantity. */
static const char *const names[] = { "weibull_shape", "weibull_scale", "weibull_mean",
	"ks_distance", "mean_diameter", "power_factor", "power_exponent", "power_offset",
	"volume_per_step" };
static const char *const units[] = { "1", "m", "m", "1", "m", "1", "1", "1", "m3" };

static void print_fits(const struct ensemble *e, const char *cmd)
{
	static const char *const counts[] = { "realisations", "steps", "particles" };
	const struct ensemble_par *par = ensemble_par(e);
	struct table_out *t = table_create(
		NULL, cmd, "1 unit unit unit 1", "quantity value low high unit");
	struct estimate out[ESTIMATES];

	if (estimate_all(e, out) ||
		(bootstrap && estimate_bootstrap(e, (uint64_t)seed, bootstrap, out)))
		no_memory();
	if (bootstrap)
		stats_add("draws", (double)bootstrap);
	double count[] = { par->realisations, (double)(par->last - par->first + 1),
		ensemble_diameter(e)->n };
	for (int k = 0; k < 3; k++)
		put_quantity(t, counts[k], "1", (struct estimate){ count[k], NAN, NAN });
	for (int q = 0; q < ESTIMATES; q++)
		put_quantity(t, names[q], units[q], out[q]);
	finish(t);
}

/* Reads the other study with the same options. */
static struct ensemble *read_other(struct study *study)
{
	struct ensemble *e = new_ensemble();
	char *cmd;

	read_particles(e, other_path, study, &cmd);
	check(e, ensemble_close(e));
	free(cmd);
	return e;
}

static void put_contrast(struct table_out *t, const char *name, const double value[2],
	const struct estimate_contrast *c, const char *unit)
{
	table_put_text(t, name);
	table_put(t, value[0]);
	table_put(t, value[1]);
	table_put(t, c->difference.value);
	table_put(t, c->difference.low);
	table_put(t, c->difference.high);
	table_put(t, c->ratio.value);
	table_put(t, c->ratio.low);
	table_put(t, c->ratio.high);
	table_put(t, c->realisations);
	table_put_text(t, unit);
	table_end_row(t);
}

/* Sliding distance, or number of steps, in which --depth is worn off the nominal area;
 * where the area is not known, life only has a ratio, that at equal areas and steps. */
static void put_life(struct table_out *t, const struct study study[2],
	const double volume[2], const double log_error[2], const double n[2])
{
	int areas = study[0].area > 0 && study[1].area > 0;
	int distances = areas && study[0].distance > 0 && study[1].distance > 0;
	double life[2], error[2];
	struct estimate_contrast c;

	for (int i = 0; i < 2; i++) {
		life[i] = depth * (areas ? study[i].area : 1) / volume[i];
		life[i] *= distances ? study[i].distance : 1;
		error[i] = life[i] * log_error[i];
	}
	c = estimate_compare(life, error, log_error, n, confidence);
	if (!areas) {
		c.difference = (struct estimate){ NAN, NAN, NAN };
		life[0] = life[1] = NAN;
	}
	put_contrast(t, "life", life, &c, distances ? "m" : "1");
}

static void print_comparison(
	const struct ensemble *e, const struct study *mine, const char *cmd)
{
	static const int shown[] = { ESTIMATE_VOLUME_STEP, ESTIMATE_MEAN_DIAMETER,
		ESTIMATE_SHAPE, ESTIMATE_SCALE, ESTIMATE_WEIBULL_MEAN };
	struct study study[2] = { *mine, { NAN, NAN } };
	struct ensemble *other = read_other(&study[1]);
	const struct ensemble *both[] = { e, other };
	struct table_out *t = table_create(NULL, cmd,
		"1 unit unit unit unit unit 1 1 1 1 1",
		"quantity value other difference difference_low difference_high ratio "
		"ratio_low ratio_high realisations unit");
	double error[2][ESTIMATES], log_error[2][ESTIMATES], n[2];
	struct estimate value[2][ESTIMATES];
	const int worn = ESTIMATE_VOLUME_STEP;

	for (int i = 0; i < 2; i++) {
		n[i] = ensemble_par(both[i])->realisations;
		if (n[i] < 2)
			die(EXIT_RUN,
				"--compare requires at least two realisations of each study, got %g",
				n[i]);
		if (estimate_all(both[i], value[i]) ||
			estimate_errors(both[i], (uint64_t)seed + (uint64_t)i, bootstrap,
				value[i], error[i], log_error[i]))
			no_memory();
	}
	for (size_t k = 0; k < sizeof shown / sizeof *shown; k++) {
		int q = shown[k];
		double v[] = { value[0][q].value, value[1][q].value };
		struct estimate_contrast c = estimate_compare(v,
			(double[]){ error[0][q], error[1][q] },
			(double[]){ log_error[0][q], log_error[1][q] }, n, confidence);

		put_contrast(t, names[q], v, &c, units[q]);
	}
	put_life(t, study, (double[]){ value[0][worn].value, value[1][worn].value },
		(double[]){ log_error[0][worn], log_error[1][worn] }, n);
	finish(t);
	ensemble_free(other);
}

static double mean(const struct running *t)
{
	return t->n > 0 ? t->mean : NAN;
}

static void print_steps(const struct ensemble *e, const char *cmd)
{
	struct table_out *t = table_create(NULL, cmd, "1 1 1 1 1 m3 m3 m3 m3 m 1 m",
		"step realisations particles particles_sd cumulative_particles volume "
		"volume_sd cumulative_volume cumulative_volume_sd mean_diameter "
		"weibull_shape weibull_scale");
	const struct ensemble_par *par = ensemble_par(e);

	for (long s = par->first; s <= par->last; s++) {
		const struct ensemble_step *o = ensemble_step(e, s);
		const struct sketch *x = ensemble_step_diameters(e, s);
		struct running diameter = { 0 };
		struct weibull w = { { NAN, NAN, NAN }, { NAN, NAN, NAN }, NAN, 0, 0 };

		if (estimate_weibull(e, x, &w) == WEIBULL_MEMORY)
			no_memory();
		for (size_t i = 0; i < x->n; i++)
			running_repeat(&diameter, x->value[i], x->weight[i]);
		table_put_row(t,
			(double[]){ (double)s, o->count.n, mean(&o->count),
				sqrt(running_variance(&o->count)), o->total_count,
				mean(&o->volume), sqrt(running_variance(&o->volume)),
				mean(&o->total_volume),
				sqrt(running_variance(&o->total_volume)), mean(&diameter),
				w.shape.value, w.scale.value },
			12);
	}
	finish(t);
}

static void print_sizes(const struct ensemble *e, const char *cmd)
{
	struct table_out *t = table_create(
		NULL, cmd, "m m 1 1/m 1/m", "low high count density weibull");
	double n = ensemble_diameter(e)->n;
	struct weibull w;
	enum weibull_status fit = estimate_weibull(e, ensemble_diameters(e), &w);

	if (fit == WEIBULL_MEMORY)
		no_memory();
	for (size_t i = 0; i < classes; i++) {
		double low = decimal_multiple((double)i, bin),
		       high = decimal_multiple((double)i + 1, bin);
		double density = size_count[i] / (n * bin);
		double middle = ((double)i + 0.5) * bin;

		table_put_row(t,
			(double[]){ low, high, size_count[i], density,
				fit == WEIBULL_OK ? weibull_density(&w, middle) : NAN },
			5);
	}
	finish(t);
}

static void print_aspects(const struct ensemble *e, const char *cmd)
{
	struct table_out *t = table_create(NULL, cmd, "1 1 1 1", "low high count share");

	(void)e;
	for (int k = 0; k < edges.n; k++)
		table_put_row(t,
			(double[]){ edges.v[k],
				k + 1 < edges.n ? edges.v[k + 1] : INFINITY,
				aspect_count[k],
				aspects > 0 ? aspect_count[k] / aspects : NAN },
			4);
	finish(t);
}

/* Dies if an option was given that the output does not depend on. */
static void check_effects(void)
{
	static const struct {
		const char *word;
		int output[4];
	} used[] = { { "truncated", { [FITS] = 1, [STEPS] = 1, [SIZES] = 1 } },
		{ "growth", { [FITS] = 1 } }, { "confidence", { [FITS] = 1 } },
		{ "bootstrap", { [FITS] = 1 } }, { "bin", { [SIZES] = 1 } },
		{ "aspects", { [ASPECTS] = 1 } } };

	for (size_t k = 0; k < sizeof used / sizeof *used; k++)
		if (opt_given(used[k].word) && !used[k].output[output])
			die(EXIT_USAGE, "--%s has no effect with --output %s",
				used[k].word, outputs[output]);
	if (opt_given("seed") && !bootstrap && !other_path)
		die(EXIT_USAGE, "--seed requires --bootstrap or --compare");
}

static void check_options(void)
{
	if (other_path && (output != FITS || summary_path || realisations))
		die(EXIT_USAGE,
			"--compare excludes --output, --summary and --realisations");
	opt_require("compare", "depth");
	opt_require("diameter", "truncated");
	check_effects();
	if (other_path && !bootstrap)
		bootstrap = COMPARED;
	if (other_path && !opt_given("confidence"))
		confidence = 0.9;
	if (diameters.v[0] >= diameters.v[1])
		die(EXIT_USAGE, "--diameter requires LO:HI with LO below HI");
	if (range.n == 2 && range.v[0] > range.v[1])
		die(EXIT_USAGE, "--step requires A or A:B with A not above B");
	for (int k = 1; k < edges.n; k++)
		if (edges.v[k] <= edges.v[k - 1])
			die(EXIT_USAGE, "--aspects: %g is not above %g", edges.v[k],
				edges.v[k - 1]);
}

int main(int argc, char **argv)
{
	static void (*const print[])(const struct ensemble *,
		const char *) = { print_fits, print_steps, print_sizes, print_aspects };
	int first = opt_parse(&prog, argc, argv);
	struct study study;
	struct ensemble *e;
	char *cmd;
	int doubtful;

	check_options();
	e = new_ensemble();
	read_particles(e, argv[first], &study, &cmd);
	check(e, ensemble_close(e));
	if (bootstrap && ensemble_reported(e) < 2)
		die(EXIT_RUN, "--bootstrap requires at least two realisations, got %zu",
			ensemble_reported(e));
	stats_add("particles", ensemble_particles(e));
	stats_add("realisations", ensemble_par(e)->realisations);
	stats_add("diameters_merged",
		ensemble_diameter(e)->n - (double)ensemble_diameters(e)->n);
	if (other_path)
		print_comparison(e, &study, cmd);
	else
		print[output](e, cmd);
	ensemble_free(e);
	free(size_count);
	free(cmd);
	doubtful = reasons_text(&doubts) != NULL;
	reasons_free(&doubts);
	return shell_done(doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
