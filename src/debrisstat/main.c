/* debrisstat - statistics of wear particles: fits, steps, sizes, shapes */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "cli/unit.h"
#include "io/quantities.h"
#include "reports.h"
#include "stats/estimates.h"
#include "study.h"
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

/* Classes of sizes and aspect ratios, which need no ensemble. */
static double *size_count, aspect_count[OPT_LIST_MAX], aspects;
static size_t classes, class_room;

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

static void tell(long done, long draws)
{
	progress("draws", (double)done, (double)draws);
}

static struct study_par what_to_read(void)
{
	const long last = range.n > 0 ? (long)range.v[range.n - 1] : 0;
	const struct ensemble_par ensemble = { .realisations = (double)realisations,
		.first = range.n > 0 ? (long)range.v[0] : 1,
		.last = last,
		.partial = summary_path != NULL,
		.low = diameters.v[0],
		.high = diameters.v[1],
		.truncated = truncated,
		.per_step = growth,
		.confidence = confidence,
		.by_step = output == STEPS,
		.groups = output == FITS && (bootstrap || other_path) ? GROUPS : 0,
		.progress = tell };

	/* The life of --compare is that of one area and step. */
	return (struct study_par){ .ensemble = ensemble,
		.summary = summary_path,
		.last = last,
		.alike = other_path != NULL,
		.row = classify };
}

static void report_sizes(const struct report_par *par, const struct ensemble *e)
{
	struct table_out *t = table_create(
		NULL, par->cmd, "m m 1 1/m 1/m", "low high count density weibull");
	double n = ensemble_diameter(e)->n;
	struct weibull w;
	enum weibull_status fit = estimate_weibull(e, ensemble_diameters(e), &w);

	if (fit == WEIBULL_MEMORY)
		die(EXIT_RUN, "out of memory");
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
	report_end(t, par);
}

static void report_aspects(const struct report_par *par, const struct ensemble *e)
{
	struct table_out *t =
		table_create(NULL, par->cmd, "1 1 1 1", "low high count share");

	(void)e;
	for (int k = 0; k < edges.n; k++)
		table_put_row(t,
			(double[]){ edges.v[k],
				k + 1 < edges.n ? edges.v[k + 1] : INFINITY,
				aspect_count[k],
				aspects > 0 ? aspect_count[k] / aspects : NAN },
			4);
	report_end(t, par);
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
	static void (*const report[])(
		const struct report_par *, const struct ensemble *) = { report_fits,
		report_steps, report_sizes, report_aspects };
	int first = opt_parse(&prog, argc, argv), status;
	struct reasons doubts = { 0 };
	struct study study[2] = { { 0 } };
	struct report_par par;
	const struct ensemble *e;
	struct study_par reading;

	check_options();
	reading = what_to_read();
	study[0] = study_read(&reading, argv[first], &doubts);
	e = study[0].particles;
	if (bootstrap && ensemble_reported(e) < 2)
		die(EXIT_RUN, "--bootstrap requires at least two realisations, got %zu",
			ensemble_reported(e));
	stats_add("particles", ensemble_particles(e));
	stats_add("realisations", ensemble_par(e)->realisations);
	stats_add("diameters_merged",
		ensemble_diameter(e)->n - (double)ensemble_diameters(e)->n);
	if (other_path)
		study[1] = study_read(&reading, other_path, &doubts);
	par = (struct report_par){ .cmd = study[0].cmd,
		.doubt = reasons_text(&doubts),
		.confidence = confidence,
		.bootstrap = bootstrap,
		.seed = (uint64_t)seed,
		.depth = depth };
	if (other_path)
		report_comparison(&par, study);
	else
		report[output](&par, e);
	for (int i = 0; i < 2; i++)
		study_free(&study[i]);
	free(size_count);
	status = par.doubt ? EXIT_NOCONV : EXIT_SUCCESS;
	reasons_free(&doubts);
	return shell_done(status);
}
