#include "generated.h"
#include "cli/msg.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "roughness_options.h"
#include "surface/rough.h"
#include <math.h>
#include <stdlib.h>

static const char *const acf_words[] = { "gauss", "exp", NULL };

static struct opt_list points = { 1, { 256 } };
static struct opt_list length = { 1, { 1e-3 } };
static struct opt_list slope, pair, corr;
static int acf;
static double hurst = NAN, rolloff, longest, cutoff, skewness, kurtosis = NAN;
static long seed = 1, count = 1, first;

struct opt generated_grid_rows[] = {
	OPT_HEADING("Generated surfaces"),
	{ 'n', "points", OPT_LIST, UNIT_COUNT, &points, 1, POINTS_MAX, "N[xM]",
		"points along x and y", NULL, 0 },
	{ 'L', "length", OPT_LIST, UNIT_LENGTH, &length, 1e-12, 1e12, "L[xL]",
		"side lengths of the area; one number: square cells", NULL, 0 },
	OPT_END,
};

struct opt generated_rows[] = {
	{ 0, "slope", OPT_LIST, UNIT_NONE, &slope, 0, 1e6, "G[:G2]",
		"root mean square slope, in place of --sq", NULL, 0 },
	{ 0, "acf", OPT_WORD, UNIT_NONE, &acf, 0, 0, "gauss|exp",
		"autocorrelation function", acf_words, 0 },
	{ 'l', "corr", OPT_LIST, UNIT_LENGTH, &corr, 1e-18, 1e12, "L[xL]",
		"1/e correlation lengths (default a tenth of the length)", NULL, 0 },
	{ 0, "hurst", OPT_NUM, UNIT_NONE, &hurst, 0, 2, "H",
		"self-affine spectrum instead of --acf", NULL, 0 },
	{ 0, "rolloff", OPT_NUM, UNIT_LENGTH, &rolloff, 1e-15, 1e12, "L",
		"roll-off wavelength: the spectrum is constant above it", NULL, 0 },
	{ 0, "longest", OPT_NUM, UNIT_LENGTH, &longest, 1e-15, 1e12, "L",
		"leave out longer waves", NULL, 0 },
	{ 0, "cutoff", OPT_NUM, UNIT_LENGTH, &cutoff, 1e-15, 1e12, "L",
		"leave out shorter waves", NULL, 0 },
	{ 0, "skewness", OPT_NUM, UNIT_NONE, &skewness, -30, 30, "S",
		"Ssk of the heights", NULL, 0 },
	{ 0, "kurtosis", OPT_NUM, UNIT_NONE, &kurtosis, 1, 1000, "K",
		"Sku of the heights (default 3 + 1.5 S^2)", NULL, 0 },
	{ 0, "pair", OPT_LIST, UNIT_LENGTH, &pair, 0, 1e9, "Q[:Q2]",
		"add a second, independent surface of this roughness", NULL, 0 },
	OPT_HEADING("Realisations"),
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e18, "N", "random seed", NULL, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 4294967295.0, "K",
		"number of the first realisation", NULL, 1 },
	{ 'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 4294967295.0, "N",
		"number of realisations", NULL, 1 },
	OPT_END,
};

void generated_check(void)
{
	if (opt_given("slope") && opt_given("pair"))
		die(EXIT_USAGE, "--pair excludes --slope");
	if (opt_given("hurst") && (opt_given("acf") || opt_given("corr")))
		die(EXIT_USAGE, "--hurst excludes --acf and --corr");
	opt_require("hurst", "rolloff longest");
	if (rolloff > 0 && longest > 0 && longest < rolloff)
		die(EXIT_USAGE, "--longest %g m is shorter than --rolloff %g m", longest,
			rolloff);
	if (rolloff > 0 && cutoff > rolloff)
		die(EXIT_USAGE, "--cutoff %g m is longer than --rolloff %g m", cutoff,
			rolloff);
	if (first + count > 4294967296)
		die(EXIT_USAGE, "--first %ld --count %ld: realisations end at 4294967295",
			first, count);
	roughness_check_range("slope", &slope);
	roughness_check_range("pair", &pair);
}

static const char *const problem[] = {
	/* of enum rough_status */
	[ROUGH_MEMORY] = "out of memory: fewer --points would do",
	[ROUGH_DOMAIN] = "the parameters of the spectrum are out of range",
	[ROUGH_TOO_LONG] = "--corr is longer than a side of the area",
	[ROUGH_EMPTY] = "no wave of the grid is within the bounds on wavelength",
	[ROUGH_IMPOSSIBLE] =
		"--kurtosis must exceed --skewness^2 + 1: no heights have these",
	[ROUGH_TOO_FEW] = "--skewness and --kurtosis are out of reach of so few points"
};

struct generated {
	struct rough *rough;
	struct rough_par par;
	long done; /* realisations */
};

static struct spectrum_par spectrum(void)
{
	struct spectrum_par p = { .nx = (int)points.v[0],
		.ny = (int)points.v[points.n - 1] };

	p.lx = length.v[0];
	p.ly = length.n == 2 ? length.v[1] : p.lx / p.nx * p.ny;
	p.kind = !isnan(hurst) ? SPECTRUM_AFFINE
		 : acf == 0    ? SPECTRUM_GAUSS
			       : SPECTRUM_EXP;
	p.corr_x = corr.n ? corr.v[0] : 0.1 * p.lx;
	p.corr_y = corr.n ? corr.v[corr.n - 1] : 0.1 * p.lx;
	p.hurst = hurst;
	p.rolloff = rolloff;
	p.longest = longest;
	p.cutoff = cutoff;
	return p;
}

/* The autocorrelation of the longest wave of a side, its period, falls to 1/e at
 * acos(1/e) / (2 pi) = 0.19 of the side; 1/e lengths of up to this are reached to a
 * tenth. */
static const double LONGEST = 0.2;

/* Warns of values that are possible but unlikely to be meant. */
static void doubt(const struct rough_par *par)
{
	const struct spectrum_par *p = &par->spectrum;
	double shortest = fmin(p->corr_x, p->corr_y);
	double dx = p->lx / p->nx, dy = p->ly / p->ny;

	/* Areal instruments measure no field of 100 mm. */
	if (length.v[0] >= 0.1 && opt_given_bare("length"))
		warn("--length %g m: numbers without a unit are metres: is %gmm meant?",
			length.v[0], length.v[0]);
	if (corr.n && (p->corr_x < dx || p->corr_y < dy))
		warn("--corr %g m is below the spacing of %g m: the heights are hardly "
		     "correlated; use more --points",
			shortest, fmax(dx, dy));
	else if (isnan(hurst) && par->kind != ROUGH_SLOPE && par->target.high > shortest)
		warn("heights of %g m exceed the correlation length of %g m: slopes are "
		     "above 45 degrees, where half-space theory does not hold",
			par->target.high, shortest);
	else if (isnan(hurst) &&
		 (p->corr_x > LONGEST * p->lx || p->corr_y > LONGEST * p->ly))
		warn("--corr %gm is above a fifth of the side of %gm: no wave that fits into "
		     "the area has so long a correlation; use a larger --length",
			p->corr_x > LONGEST * p->lx ? p->corr_x : p->corr_y,
			p->corr_x > LONGEST * p->lx ? p->lx : p->ly);
}

struct generated *generated_open(int threads)
{
	struct generated *g = xcalloc(1, sizeof *g);
	const struct spectrum *waves;
	enum rough_status status;

	g->par = (struct rough_par){ .spectrum = spectrum(),
		.kind = slope.n ? ROUGH_SLOPE : roughness_kind(),
		.target = slope.n ? roughness_range(&slope) : roughness_target(),
		.pair = roughness_range(&pair),
		.skewness = skewness,
		.kurtosis = isnan(kurtosis) ? 3 + 1.5 * skewness * skewness : kurtosis,
		.seed = (uint64_t)seed,
		.pool = pool_new(threads) };
	status = rough_make(&g->par, &g->rough);
	if (!g->rough && status == ROUGH_EMPTY && g->par.spectrum.nx == 1 &&
		g->par.spectrum.ny == 1)
		die(EXIT_USAGE,
			"a single point has no roughness: want --sq 0 or more --points");
	if (!g->rough)
		die(status == ROUGH_IMPOSSIBLE ? EXIT_USAGE : EXIT_RUN, "%s",
			problem[status]);
	doubt(&g->par);
	waves = rough_spectrum(g->rough);
	stats_set("waves", waves ? (double)spectrum_waves(waves) : 0);
	stats_set("waves_skipped", waves ? (double)spectrum_waves_skipped(waves) : 0);
	return g;
}

int generated_next(struct generated *g, struct record *r)
{
	const struct spectrum_par *p = &g->par.spectrum;
	struct rough_work work = { 0, 0, 0 };
	enum rough_status status;
	char *extra;

	if (g->done == count)
		return 0;
	progress("surfaces", (double)g->done, (double)count);
	record_init(r, p->nx, p->ny, p->lx / p->nx, p->ly / p->ny);
	r->realisation = first + g->done++;
	status = rough_surface(
		g->rough, (uint32_t)r->realisation, record_add(r, "height", "m"), &work);
	if (status != ROUGH_OK)
		die(EXIT_RUN, "%s", problem[status]);
	extra = xprintf("--first %ld --count 1", r->realisation);
	r->cmd = opt_cmd(NULL, extra);
	free(extra);
	record_set(r, "seed", "%ld", seed);
	if (work.spectrum_error > 0)
		record_set(r, "spectrum_error", "%.3g", work.spectrum_error);
	stats_add("transforms", (double)work.transforms);
	stats_add("iterations", (double)work.iterations);
	return 1;
}

int generated_more(const struct generated *g)
{
	return g->done < count;
}

void generated_close(struct generated *g)
{
	rough_free(g->rough);
	pool_free(g->par.pool);
	free(g);
}
