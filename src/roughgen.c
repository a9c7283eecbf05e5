/* roughgen - rough surfaces, generated or measured, and their areal parameters */
#include "contact/rough.h"
#include "contact/surface.h"
#include "shell/fields.h"
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/progress.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS_MAX = 65536 };

static const char *const acf_words[] = { "gauss", "exp", NULL };
static const char *const crown_words[] = { "none", "auto", NULL };

static struct opt_list points = { 1, { 256 } };
static struct opt_list length = { 1, { 1e-3 } };
static struct opt_list sq = { 1, { 1e-6 } };
static struct opt_list sa, slope, pair, corr, crop, resample, raw_size, pixel;
static int acf, measure, level, fill;
static double hurst = NAN, rolloff, longest, cutoff, skewness, kurtosis = NAN;
static struct opt_choice crown = { 0, NAN };
static long seed = 1, count = 1, first, threads = 1;

static const struct opt opts[] = {
	/* generated surfaces */
	{ 'n', "points", OPT_LIST, UNIT_COUNT, &points, 1, POINTS_MAX, "N[xM]",
		"points along x and y", NULL, 0 },
	{ 'L', "length", OPT_LIST, UNIT_LENGTH, &length, 1e-12, 1e12, "L[xL]",
		"sides of the area; one: square pixels", NULL, 0 },
	{ 'q', "sq", OPT_LIST, UNIT_LENGTH, &sq, 0, 1e9, "Q[:Q2]",
		"root mean square height, exact or drawn", NULL, 0 },
	{ 'a', "sa", OPT_LIST, UNIT_LENGTH, &sa, 0, 1e9, "Q[:Q2]",
		"mean absolute height instead", NULL, 0 },
	{ 'g', "slope", OPT_LIST, UNIT_NONE, &slope, 0, 1e6, "G[:G2]",
		"root mean square slope instead", NULL, 0 },
	{ 'A', "acf", OPT_WORD, UNIT_NONE, &acf, 0, 0, "gauss|exp",
		"autocorrelation function", acf_words, 0 },
	{ 'l', "corr", OPT_LIST, UNIT_LENGTH, &corr, 1e-18, 1e12, "L[xL]",
		"1/e correlation lengths (default a tenth of the length)", NULL, 0 },
	{ 'H', "hurst", OPT_NUM, UNIT_NONE, &hurst, 0, 2, "H",
		"self-affine spectrum instead of --acf", NULL, 0 },
	{ 'R', "rolloff", OPT_NUM, UNIT_LENGTH, &rolloff, 1e-15, 1e12, "L",
		"longest self-affine wavelength; longer waves alike", NULL, 0 },
	{ 'W', "longest", OPT_NUM, UNIT_LENGTH, &longest, 1e-15, 1e12, "L",
		"leave out longer waves", NULL, 0 },
	{ 'k', "cutoff", OPT_NUM, UNIT_LENGTH, &cutoff, 1e-15, 1e12, "L",
		"leave out shorter waves", NULL, 0 },
	{ 'K', "skewness", OPT_NUM, UNIT_NONE, &skewness, -30, 30, "S",
		"Ssk of the heights", NULL, 0 },
	{ 'Q', "kurtosis", OPT_NUM, UNIT_NONE, &kurtosis, 1, 1000, "K",
		"Sku of the heights (default 3 + 1.5 S^2)", NULL, 0 },
	{ 'p', "pair", OPT_LIST, UNIT_LENGTH, &pair, 0, 1e9, "Q[:Q2]",
		"add a second, independent surface of this roughness", NULL, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e18, "N", "random seed", NULL, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 4294967295.0, "K",
		"number of the first realisation", NULL, 1 },
	{ 'c', "count", OPT_INT, UNIT_COUNT, &count, 1, 4294967295.0, "N",
		"number of realisations", NULL, 1 },
	{ 'j', "threads", OPT_INT, UNIT_COUNT, &threads, 1, 1024, "N", "threads", NULL,
		1 },
	/* measured surfaces */
	{ 'x', "raw", OPT_LIST, UNIT_COUNT, &raw_size, 1, POINTS_MAX, "NXxNY",
		"file is headerless little-endian float64", NULL, 0 },
	{ 'X', "pixel", OPT_LIST, UNIT_LENGTH, &pixel, 1e-15, 1e6, "D[xD]",
		"spacing of --raw", NULL, 0 },
	{ 'w', "crop", OPT_LIST, UNIT_COUNT, &crop, 0, POINTS_MAX, "X:Y:NX:NY",
		"cut NX by NY samples of file from X, Y on", NULL, 0 },
	{ 'i', "fill", OPT_FLAG, UNIT_NONE, &fill, 0, 0, NULL,
		"fill missing samples of file by Laplace's equation", NULL, 0 },
	{ 'z', "level", OPT_FLAG, UNIT_NONE, &level, 0, 0, NULL,
		"subtract the least-squares plane of file", NULL, 0 },
	{ 'r', "resample", OPT_LIST, UNIT_COUNT, &resample, 1, POINTS_MAX, "N[xM]",
		"bring file to this many points", NULL, 0 },
	/* both */
	{ 'C', "crown", OPT_CHOICE, UNIT_LENGTH, &crown, 0, 1e9, "none|auto|DROP",
		"put on a paraboloid, DROP lower at the corners; auto is 4 Sq",
		crown_words, 0 },
	{ 'm', "measure", OPT_FLAG, UNIT_NONE, &measure, 0, 0, NULL,
		"print areal parameters instead of heights", NULL, 0 },
	OPT_END
};

static const struct prog prog = { "roughgen",
	"Generate rough surfaces, or prepare measured ones, and measure them.", "[file]",
	"nothing, or fields: height", "fields: height; or table: areal parameters",
	opts };

static const char generating[] = "nLgAlHRWkKQpsfc"; /* options no file goes with */
static const char preparing[] = "xXwizr";           /* options that need a file */

static const char columns[] = "realisation sa sq ssk sku sp sv sz sdq sdq_cell sdq_2x2 "
			      "sdq_central sdq_iso7 sdr sal str corr_x corr_y";
static const char units[] = "1 m m 1 1 m m m 1 1 1 1 1 1 m 1 m m";

static struct fields_out *out;
static struct table_out *table;

/* ---- options ---- */

static void refuse(const char *letters, const char *why)
{
	for (const struct opt *o = opts; o->word; o++)
		if (strchr(letters, o->letter) && opt_given(o->letter))
			die(EXIT_USAGE, "--%s: %s", o->word, why);
}

static void check_range(const char *word, const struct opt_list *l)
{
	const double least = 1e-30; /* smaller ones would underflow when squared */

	if (l->n == 2 && l->v[0] > l->v[1])
		die(EXIT_USAGE, "--%s %g:%g: the range runs backwards", word, l->v[0],
			l->v[1]);
	for (int i = 0; i < l->n; i++)
		if (l->v[i] > 0 && l->v[i] < least)
			die(EXIT_USAGE, "--%s %g: want 0, or %g or more", word, l->v[i],
				least);
}

static void check_options(int from_file)
{
	if (from_file)
		refuse(generating, "is for generated surfaces, not for a file");
	else
		refuse(preparing,
			"is for a measured surface: name a file, or - for standard "
			"input");
	if (opt_given('q') + opt_given('a') + opt_given('g') > 1)
		die(EXIT_USAGE, "--sq, --sa and --slope exclude each other");
	if (opt_given('g') && opt_given('p'))
		die(EXIT_USAGE, "--pair is a height and does not go with --slope");
	if (opt_given('H') && (opt_given('A') || opt_given('l')))
		die(EXIT_USAGE, "--hurst excludes --acf and --corr");
	if (!opt_given('H') && (opt_given('R') || opt_given('W')))
		die(EXIT_USAGE, "--rolloff and --longest need --hurst");
	if (rolloff > 0 && longest > 0 && longest < rolloff)
		die(EXIT_USAGE, "--longest %g m is shorter than --rolloff %g m", longest,
			rolloff);
	if (rolloff > 0 && cutoff > rolloff)
		die(EXIT_USAGE, "--cutoff %g m is longer than --rolloff %g m", cutoff,
			rolloff);
	if (raw_size.n != pixel.n && (raw_size.n == 0 || pixel.n == 0))
		die(EXIT_USAGE, "--raw and --pixel go together");
	if (raw_size.n == 1)
		die(EXIT_USAGE, "--raw: want NXxNY");
	if (crop.n && crop.n != 4)
		die(EXIT_USAGE, "--crop: want X:Y:NX:NY");
	if (first + count > 4294967296)
		die(EXIT_USAGE, "--first %ld --count %ld: realisations end at 4294967295",
			first, count);
	check_range("sq", &sq);
	check_range("sa", &sa);
	check_range("slope", &slope);
	check_range("pair", &pair);
}

/* ---- roughness ---- */

static enum rough_kind kind(void)
{
	return slope.n ? ROUGH_SLOPE : sa.n ? ROUGH_SA : ROUGH_SQ;
}

static struct rough_range range(const struct opt_list *l)
{
	return l->n ? (struct rough_range){ l->v[0], l->v[l->n - 1] }
		    : (struct rough_range){ 0, 0 };
}

static struct rough_range target(void)
{
	return range(slope.n ? &slope : sa.n ? &sa : &sq);
}

/* ---- output ---- */

static void print_parameters(const struct record *r, const double *z)
{
	struct surface_parameters p;

	if (!surface_measure(r->nx, r->ny, r->dx, r->dy, z, &p))
		die(EXIT_RUN, "out of memory measuring %d x %d points", r->nx, r->ny);
	const double row[] = { (double)r->realisation, p.sa, p.sq, p.ssk, p.sku, p.sp,
		p.sv, p.sz, p.sdq, p.sdq_cell, p.sdq_2x2, p.sdq_central, p.sdq_iso7,
		p.sdr, p.sal, p.str, p.corr_x, p.corr_y };
	if (!table)
		table = table_create(NULL, r->cmd, units, columns);
	table_cmd(table, r->cmd);
	for (size_t i = 0; i < sizeof row / sizeof *row; i++)
		table_put(table, row[i]);
	table_end_row(table);
	stats_add("measured", 1);
}

/* Crowns a surface, on top of the crown it had, and writes it out. */
static void finish(struct record *r, double had)
{
	double *z = record_need(r, "height", 0, NULL), rms = surface_sq(r->nx, r->ny, z);
	double drop = had;

	if (crown.word < 0)
		drop += crown.value;
	else if (crown.word == 1)
		drop += 4 * rms;
	if (drop > 0)
		surface_crown(r->nx, r->ny, r->dx, r->dy, drop, z);
	record_set(r, "sq", "%.17g", rms);
	record_set(r, "crown", "%.17g", drop);
	note("realisation %ld: Sq %g m, crown %g m", r->realisation, rms, drop);
	stats_add("records", 1);
	if (measure) {
		print_parameters(r, z);
		return;
	}
	if (!out)
		out = fields_create(NULL);
	fields_write(out, r);
}

/* ---- generated surfaces ---- */

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

static struct rough *new_ensemble(struct rough_par *par)
{
	enum rough_status status;
	struct rough *rough;

	par->spectrum = spectrum();
	par->kind = kind();
	par->target = target();
	par->pair = range(&pair);
	par->skewness = skewness;
	par->kurtosis = isnan(kurtosis) ? 3 + 1.5 * skewness * skewness : kurtosis;
	par->seed = (uint64_t)seed;
	par->pool = pool_new((int)threads);
	rough = rough_new(par, &status);
	if (!rough)
		die(status == ROUGH_IMPOSSIBLE ? EXIT_USAGE : EXIT_RUN, "%s",
			problem[status]);
	return rough;
}

static void generate_one(struct rough *rough, struct record *r)
{
	struct rough_work work = { 0, 0, 0 };
	char *extra = xprintf("--first %ld", r->realisation);
	enum rough_status status = rough_surface(
		rough, (uint32_t)r->realisation, record_add(r, "height", "m"), &work);

	if (status != ROUGH_OK)
		die(EXIT_RUN, "%s", problem[status]);
	r->cmd = opt_cmd(NULL, extra);
	record_set(r, "seed", "%ld", seed);
	if (work.spectrum_error > 0)
		record_set(r, "spectrum_error", "%.3g", work.spectrum_error);
	stats_add("transforms", (double)work.transforms);
	stats_add("iterations", (double)work.iterations);
	free(extra);
}

static void generate(void)
{
	struct rough_par par = { .seed = 1 };
	struct rough *rough = new_ensemble(&par);
	const struct spectrum_par *p = &par.spectrum;
	const struct spectrum *waves = rough_spectrum(rough);
	struct record r = { 0 };

	stats_set("waves", waves ? (double)spectrum_waves(waves) : 0);
	stats_set("waves_skipped", waves ? (double)spectrum_waves_skipped(waves) : 0);
	for (long k = 0; k < count; k++) {
		progress("surfaces", (double)k, (double)count);
		record_init(&r, p->nx, p->ny, p->lx / p->nx, p->ly / p->ny);
		r.realisation = first + k;
		generate_one(rough, &r);
		finish(&r, 0);
	}
	record_free(&r);
	rough_free(rough);
	pool_free(par.pool);
}

/* ---- measured surfaces ---- */

static void need_memory(int done)
{
	if (!done)
		die(EXIT_RUN, "out of memory preparing a measured surface");
}

/* A record with an empty height field and what else r knows of itself. */
static void new_record(
	struct record *s, const struct record *r, int nx, int ny, double dx, double dy)
{
	record_init(s, nx, ny, dx, dy);
	record_add(s, "height", "m");
	record_copy_keys(s, r);
}

/* Takes the heights of r, cropped, into a record that holds nothing else. */
static void take_heights(
	const struct fields_in *in, const struct record *r, struct record *s)
{
	const double *z = record_need(r, "height", 0, in);
	int x = 0, y = 0, nx = r->nx, ny = r->ny;

	if (r->nz != 1)
		die(EXIT_RUN, "%s: record %ld: %d layers, want a plane field",
			fields_name(in), fields_count(in), r->nz);
	if (crop.n) {
		x = (int)crop.v[0];
		y = (int)crop.v[1];
		nx = (int)crop.v[2];
		ny = (int)crop.v[3];
		if (nx < 1 || ny < 1 || x + nx > r->nx || y + ny > r->ny)
			die(EXIT_RUN,
				"%s: record %ld: --crop %d:%d:%d:%d is not within %d x %d "
				"samples",
				fields_name(in), fields_count(in), x, y, nx, ny, r->nx,
				r->ny);
		stats_add("samples_cropped", (double)r->nx * r->ny - (double)nx * ny);
	}
	new_record(s, r, nx, ny, r->dx, r->dy);
	surface_crop(r->nx, z, x, y, nx, ny, s->data[0]);
}

static void fill_holes(const struct fields_in *in, struct record *s)
{
	double *z = record_need(s, "height", !fill, in);
	size_t n = (size_t)s->nx * (size_t)s->ny, missing;
	int steps;

	if (!fill)
		return;
	missing = surface_missing(s->nx, s->ny, z);
	if (missing == n)
		die(EXIT_RUN, "%s: record %ld: every height is missing", fields_name(in),
			fields_count(in));
	need_memory(surface_fill(s->nx, s->ny, z, &steps));
	record_need(s, "height", 1, in);
	stats_add("samples_filled", (double)missing);
	stats_add("iterations", steps);
}

/* Puts the crown of a whole surface aside and returns its drop; that of a piece cut
 * out of one stays, as part of its heights. */
static double take_crown(struct record *s)
{
	double drop = record_get_number(s, "crown");

	if (crop.n || !(drop > 0) || !isfinite(drop))
		return 0;
	surface_crown(s->nx, s->ny, s->dx, s->dy, -drop, s->data[0]);
	return drop;
}

static void resample_heights(struct record *s)
{
	int nx = (int)resample.v[0], ny = (int)resample.v[resample.n - 1];
	struct record t = { 0 };

	new_record(&t, s, nx, ny, s->dx * s->nx / nx, s->dy * s->ny / ny);
	need_memory(surface_resample(s->nx, s->ny, s->data[0], nx, ny, t.data[0]));
	record_free(s);
	*s = t;
}

static void scale_heights(const struct fields_in *in, struct record *s)
{
	struct rough_range wanted = target();
	double *z = s->data[0];
	double want = rough_draw(&wanted, (uint64_t)seed, (uint32_t)s->realisation, 0);
	double have = sa.n ? surface_sa(s->nx, s->ny, z) : surface_sq(s->nx, s->ny, z);

	if (!rough_scale(s->nx, s->ny, z, have, want))
		die(EXIT_RUN, "%s: record %ld: a flat surface cannot be scaled to %g m",
			fields_name(in), fields_count(in), want);
}

/* Fourth powers of heights and gradients must not overflow. */
static void check_heights(const struct fields_in *in, const struct record *s)
{
	double limit = 1e60 * fmin(1, fmin(s->dx, s->dy));

	for (size_t i = 0; i < (size_t)s->nx * (size_t)s->ny; i++)
		if (!(fabs(s->data[0][i]) <= limit))
			die(EXIT_RUN, "%s: record %ld: height %g m is too large",
				fields_name(in), fields_count(in), s->data[0][i]);
}

static void prepare(const char *path)
{
	struct raw_layout raw = { (int)raw_size.v[0], (int)raw_size.v[1], pixel.v[0],
		pixel.v[pixel.n ? pixel.n - 1 : 0] };
	struct fields_in *in = fields_open(path, raw_size.n ? &raw : NULL);
	struct record r = { 0 }, s = { 0 };

	while (fields_read(in, &r)) {
		double had;

		take_heights(in, &r, &s);
		fill_holes(in, &s);
		had = take_crown(&s);
		if (level)
			surface_level(s.nx, s.ny, s.data[0]);
		if (resample.n)
			resample_heights(&s);
		if (opt_given('q') || opt_given('a'))
			scale_heights(in, &s);
		/* What comes through a pipe has to be asked for. */
		s.cmd = opt_cmd(r.cmd, r.cmd || strcmp(path, "-") == 0 ? "-" : NULL);
		check_heights(in, &s);
		finish(&s, had);
	}
	if (fields_count(in) == 0)
		die(EXIT_RUN, "%s: no records", fields_name(in));
	record_free(&r);
	record_free(&s);
	fields_close(in);
}

int main(int argc, char **argv)
{
	int operand = opt_parse(&prog, argc, argv);

	check_options(operand < argc);
	if (operand < argc)
		prepare(argv[operand]);
	else
		generate();
	if (out)
		fields_done(out);
	if (table)
		table_done(table);
	return shell_done(EXIT_SUCCESS);
}
