/* debrisstat - statistics of wear particles: fits, steps, sizes, shapes */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "io/tables.h"
#include "stats/estimates.h"
#include <math.h>
#include <stdlib.h>

enum output { FITS, STEPS, SIZES, ASPECTS };
static const char *const outputs[] = { "fits", "steps", "sizes", "aspects", NULL };
static const char *const growths[] = { "cumulative", "step", NULL };

static int output, growth, truncated;
static struct opt_list diameters = { 2, { 0, INFINITY } }, range;
static struct opt_list edges = { 8, { 1, 1.25, 1.5, 2, 3, 5, 8, 13 } };
static double bin = 10e-6, confidence = 0.95;
static long realisations, bootstrap, seed = 1;
static const char *summary_path;

static const struct opt opts[] = {
	{ 'o', "output", OPT_WORD, UNIT_NONE, &output, 0, 0, "fits|steps|sizes|aspects",
		"what to print", outputs, 0 },
	{ 0, "diameter", OPT_LIST, UNIT_LENGTH, &diameters, 0, 1e30, "LO:HI",
		"only particles of this equivalent diameter", NULL, 0 },
	{ 0, "truncated", OPT_FLAG, UNIT_NONE, &truncated, 0, 0, NULL,
		"fit the Weibull distribution as cut off at --diameter", NULL, 0 },
	{ 0, "step", OPT_LIST, UNIT_COUNT, &range, 1, 1e9, "A[:B]",
		"only these steps; default all", NULL, 0 },
	{ 0, "growth", OPT_WORD, UNIT_NONE, &growth, 0, 0, "cumulative|step",
		"what the power law follows: all particles so far, or those of a step",
		growths, 0 },
	{ 0, "bin", OPT_NUM, UNIT_LENGTH, &bin, 1e-30, 1e30, "W",
		"width of the classes of sizes", NULL, 0 },
	{ 0, "aspects", OPT_LIST, UNIT_NONE, &edges, 1, 1e9, "A,A,...",
		"edges of the classes of aspect ratio", NULL, 0 },
	{ 0, "confidence", OPT_NUM, UNIT_FRACTION, &confidence, 0.01, 0.9999, "C",
		"of the intervals", NULL, 0 },
	{ 0, "bootstrap", OPT_INT, UNIT_COUNT, &bootstrap, 0, 1e6, "N",
		"intervals by drawing the realisations N times anew", NULL, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "of --bootstrap", NULL,
		0 },
	{ 0, "realisations", OPT_INT, UNIT_COUNT, &realisations, 0, 1e9, "N",
		"realisations there were, with those that gave no particle", NULL, 0 },
	{ 0, "summary", OPT_TEXT, UNIT_NONE, &summary_path, 0, 0, "FILE",
		"summary of debrisgen, to know of steps without particles", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "debrisstat",
	"Fit and count the wear particles of an ensemble.", "[file]",
	"table: realisation, step, volume, diameter, aspect", "table", opts };

static _Noreturn void no_memory(void)
{
	die(EXIT_RUN, "out of memory");
}

static void read_particles(struct ensemble *e, const char *path, char **cmd)
{
	struct table_in *t = table_open(path);
	int more = table_next(t);
	int cr, cs, cd, cv, ca;

	if (table_columns(t) == 0)
		die(EXIT_RUN, "%s: no table", table_name(t));
	cr = table_need(t, "realisation");
	cs = table_need(t, "step");
	cd = table_need(t, "diameter");
	cv = table_need(t, "volume");
	ca = table_need(t, "aspect");
	for (; more; more = table_next(t)) {
		struct shed s = { table_whole(t, cr, 0, 1e15), table_whole(t, cs, 1, 1e6),
			table_positive(t, cd), table_positive(t, cv),
			table_positive(t, ca), table_part(t) };

		if (ensemble_add(e, &s))
			no_memory();
	}
	*cmd = opt_cmd(table_upstream(t), NULL);
	table_close(t);
}

static void read_summary(struct ensemble *e)
{
	struct table_in *t = table_open(summary_path);
	int more = table_next(t), cr = table_need(t, "realisation");
	int cs = table_need(t, "step");

	for (; more; more = table_next(t))
		if (ensemble_took_place(
			    e, table_whole(t, cr, 0, 1e15), table_whole(t, cs, 1, 1e6)))
			no_memory();
	table_close(t);
}

static void close_ensemble(struct ensemble *e)
{
	struct ensemble_par par = { .realisations = (size_t)realisations,
		.first = range.n > 0 ? (long)range.v[0] : 1,
		.last = range.n > 0 ? (long)range.v[range.n - 1] : 0,
		.partial = summary_path != NULL,
		.low = diameters.v[0],
		.high = diameters.v[1],
		.truncated = truncated,
		.per_step = growth,
		.confidence = confidence };

	if (ensemble_sort(e))
		no_memory();
	if (ensemble_clash(e) >= 0)
		die(EXIT_RUN,
			"realisation %ld stands in two parts of the table; "
			"ensembles to be joined want numbers of their own",
			ensemble_clash(e));
	if (realisations && par.realisations < ensemble_told(e))
		die(EXIT_RUN, "--realisations %ld, but the table has %zu", realisations,
			ensemble_told(e));
	if (bootstrap && ensemble_told(e) < 2)
		die(EXIT_RUN, "--bootstrap wants at least two realisations, got %zu",
			ensemble_told(e));
	if (ensemble_close(e, &par))
		no_memory();
}

/* All diameters that count; the caller frees. */
static double *diameters_of(const struct ensemble *e, size_t *n)
{
	const struct ensemble_par *par = ensemble_par(e);
	double *x = ensemble_diameters(e, NULL, par->first, par->last, n);

	if (!x)
		no_memory();
	return x;
}

static void put_quantity(struct table_out *t, const char *name, struct estimate e)
{
	table_put_text(t, name);
	table_put_row(t, (double[]){ e.value, e.low, e.high }, 3);
}

static void print_fits(const struct ensemble *e, const char *cmd)
{
	static const char *const names[] = { "weibull_shape", "weibull_scale",
		"weibull_mean", "ks_distance", "mean_diameter", "power_factor",
		"power_exponent", "power_offset", "volume_per_step" };
	static const char *const counts[] = { "realisations", "steps", "particles" };
	const struct ensemble_par *par = ensemble_par(e);
	struct table_out *t = table_create(NULL, cmd, NULL, "quantity value low high");
	struct estimate out[ESTIMATES];
	size_t n;

	free(diameters_of(e, &n));
	if (estimate_all(e, NULL, out) ||
		(bootstrap && estimate_bootstrap(e, (uint64_t)seed, bootstrap, out)))
		no_memory();
	if (bootstrap)
		stats_add("draws", (double)bootstrap);
	double count[] = { (double)par->realisations,
		(double)(par->last - par->first + 1), (double)n };
	for (int k = 0; k < 3; k++)
		put_quantity(t, counts[k], (struct estimate){ count[k], NAN, NAN });
	for (int q = 0; q < ESTIMATES; q++)
		put_quantity(t, names[q], out[q]);
	table_done(t);
}

static void print_steps(const struct ensemble *e, const char *cmd)
{
	struct table_out *t = table_create(NULL, cmd, "1 1 1 1 1 m3 m3 m3 m3 m 1 m",
		"step realisations particles particles_sd cumulative_particles volume "
		"volume_sd cumulative_volume cumulative_volume_sd mean_diameter "
		"weibull_shape weibull_scale");
	const struct ensemble_par *par = ensemble_par(e);

	for (long s = par->first; s <= par->last; s++) {
		struct step_estimate o;

		if (estimate_step(e, s, &o))
			no_memory();
		table_put_row(t,
			(double[]){ (double)s, o.realisations, o.count, o.count_sd,
				o.all_count, o.volume, o.volume_sd, o.all_volume,
				o.all_volume_sd, o.diameter, o.shape, o.scale },
			12);
	}
	table_done(t);
}

static void print_sizes(const struct ensemble *e, const char *cmd)
{
	struct table_out *t = table_create(
		NULL, cmd, "m m 1 1/m 1/m", "low high count density weibull");
	size_t n, classes = 0;
	double *x = diameters_of(e, &n), *count;
	struct weibull w;
	int fitted = estimate_weibull(e, x, n, &w) == 0;

	for (size_t i = 0; i < n; i++) {
		if (x[i] / bin > 1e6)
			die(EXIT_RUN, "--bin %g m: more than a million classes", bin);
		if ((size_t)(x[i] / bin) + 1 > classes)
			classes = (size_t)(x[i] / bin) + 1;
	}
	count = xcalloc(classes + 1, sizeof(*count));
	for (size_t i = 0; i < n; i++)
		count[(size_t)(x[i] / bin)]++;
	for (size_t i = 0; i < classes; i++) {
		double low = (double)i * bin, high = (double)(i + 1) * bin;
		double density = count[i] / ((double)n * bin);
		double middle = ((double)i + 0.5) * bin;

		table_put_row(t,
			(double[]){ low, high, count[i], density,
				fitted ? weibull_density(&w, middle) : NAN },
			5);
	}
	table_done(t);
	free(count);
	free(x);
}

static void print_aspects(const struct ensemble *e, const char *cmd)
{
	struct table_out *t = table_create(NULL, cmd, "1 1 1 1", "low high count share");
	double count[OPT_LIST_MAX];
	double all = ensemble_aspects(e, edges.v, edges.n, count);

	for (int k = 0; k < edges.n; k++)
		table_put_row(t,
			(double[]){ edges.v[k],
				k + 1 < edges.n ? edges.v[k + 1] : INFINITY, count[k],
				all > 0 ? count[k] / all : NAN },
			4);
	table_done(t);
}

static void check_options(void)
{
	if (diameters.v[0] >= diameters.v[1])
		die(EXIT_USAGE, "--diameter wants LO:HI with LO below HI");
	if (range.n == 2 && range.v[0] > range.v[1])
		die(EXIT_USAGE, "--step wants A or A:B with A not above B");
	for (int k = 1; k < edges.n; k++)
		if (edges.v[k] <= edges.v[k - 1])
			die(EXIT_USAGE, "--aspects: %g does not lie above %g", edges.v[k],
				edges.v[k - 1]);
}

int main(int argc, char **argv)
{
	static void (*const print[])(const struct ensemble *,
		const char *) = { print_fits, print_steps, print_sizes, print_aspects };
	int first = opt_parse(&prog, argc, argv);
	struct ensemble *e = ensemble_new();
	char *cmd;

	check_options();
	if (!e)
		no_memory();
	read_particles(e, argv[first], &cmd);
	if (summary_path)
		read_summary(e);
	close_ensemble(e);
	stats_add("particles", (double)ensemble_particles(e));
	stats_add("realisations", (double)ensemble_par(e)->realisations);
	print[output](e, cmd);
	ensemble_free(e);
	free(cmd);
	return shell_done(EXIT_SUCCESS);
}
