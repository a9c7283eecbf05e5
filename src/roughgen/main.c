/* roughgen - rough surfaces, generated or measured, and their areal parameters */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "generated.h"
#include "io/fields.h"
#include "io/tables.h"
#include "measured.h"
#include "roughness_options.h"
#include "surface/areal.h"
#include "surface/filter.h"
#include "surface/ratio.h"
#include "surface/surface.h"
#include <math.h>
#include <stdlib.h>
#include <unistd.h>

static const char *const crown_words[] = { "none", "auto", NULL };

static int measure, spectrum, taper;
static const char *const tapers[] = { "hann", "none", NULL };
static struct opt_choice crown = { 0, 0 };
static long threads = 1;

static const struct opt opts[] = {
	OPT_TABLE(generated_grid_rows),
	OPT_TABLE(roughness_rows),
	OPT_TABLE(generated_rows),
	{ 'j', "threads", OPT_INT, UNIT_COUNT, &threads, 1, 1024, "N", "threads", NULL,
		1 },
	OPT_TABLE(measured_rows),
	OPT_HEADING("All surfaces"),
	{ 0, "crown", OPT_CHOICE, UNIT_LENGTH, &crown, 0, 1e9, "none|auto|DROP",
		"add a paraboloid, DROP lower at the corners; auto is 4 Sq", crown_words,
		0 },
	{ 0, "measure", OPT_FLAG, UNIT_NONE, &measure, 0, 0, NULL,
		"print areal parameters instead of heights", NULL, 0 },
	{ 0, "spectrum", OPT_FLAG, UNIT_NONE, &spectrum, 0, 0, NULL,
		"print the radially averaged power spectrum instead of heights", NULL,
		0 },
	{ 0, "taper", OPT_WORD, UNIT_NONE, &taper, 0, 0, "hann|none",
		"window of --spectrum; none for periodic surfaces", tapers, 0 },
	OPT_END,
};

static const struct prog prog = { "roughgen",
	"Generate rough surfaces, or process measured ones; areal parameters and spectra.",
	"[file]", "nothing, or fields: height",
	"fields: height; or table: areal parameters", opts };

static const char columns[] = "realisation sa sq ssk sku sp sv sz sdq sdq_cell sdq_2x2 "
			      "sdq_central sdq_iso7 sdr sal str corr_x corr_y sk spk "
			      "svk smr1 smr2";
static const char units[] = "1 m m 1 1 m m m 1 1 1 1 1 1 m 1 m m m m m 1 1";

static struct fields_out *out;
static struct table_out *table;

static void refuse(const struct opt *rows, const char *why)
{
	const char *word = opt_any_given(rows);

	if (word)
		die(EXIT_USAGE, "--%s: %s", word, why);
}

static void check_options(int from_file)
{
	static const char no_file[] = "is for generated surfaces, not for a file";

	if (from_file) {
		refuse(generated_grid_rows, no_file);
		refuse(generated_rows, no_file);
	} else {
		refuse(measured_rows,
			"applies to a measured surface only: name a file, or - for standard input");
	}
	if (opt_given("sq") + opt_given("sa") + opt_given("slope") > 1)
		die(EXIT_USAGE, "--sq, --sa and --slope exclude one another");
	if (measure && spectrum)
		die(EXIT_USAGE, "--measure and --spectrum exclude one another");
	opt_require("spectrum", "taper");
	roughness_check();
	generated_check();
}

static void print_parameters(const struct record *r, const double *z)
{
	struct surface_parameters p;
	struct core c;

	if (surface_measure(r->nx, r->ny, r->dx, r->dy, z, &p) ||
		surface_core((size_t)r->nx * (size_t)r->ny, z, &c))
		die(EXIT_RUN, "out of memory measuring %d x %d points", r->nx, r->ny);
	const double row[] = { (double)r->realisation, p.sa, p.sq, p.ssk, p.sku, p.sp,
		p.sv, p.sz, p.sdq, p.sdq_cell, p.sdq_2x2, p.sdq_central, p.sdq_iso7,
		p.sdr, p.sal, p.str, p.corr_x, p.corr_y, c.sk, c.spk, c.svk, c.smr1,
		c.smr2 };
	if (!table)
		table = table_create(NULL, r->cmd, units, columns);
	table_cmd(table, r->cmd);
	table_put_row(table, row, (int)(sizeof row / sizeof *row));
	stats_add("measured", 1);
}

static void print_spectrum(const struct record *r, const double *z)
{
	struct ring *ring = xcalloc((size_t)hypot(r->nx, r->ny) + 3, sizeof *ring);
	int n;

	if (surface_spectrum(r->nx, r->ny, r->dx, r->dy, z, !taper, ring, &n))
		die(EXIT_RUN, "out of memory for the spectrum of %d x %d points", r->nx,
			r->ny);
	if (!table)
		table = table_create(NULL, r->cmd, "1 1/m m m4 1",
			"realisation frequency wavelength power waves");
	table_cmd(table, r->cmd);
	for (int k = 0; k < n; k++)
		if (ring[k].waves > 0)
			table_put_row(table,
				(double[]){ (double)r->realisation, ring[k].frequency,
					1 / ring[k].frequency, ring[k].power,
					ring[k].waves },
				5);
	stats_add("measured", 1);
	free(ring);
}

/* Adds a crown to a surface, on top of the one it had, and writes it; more: another one
 * follows. */
static void finish(struct record *r, double had, int more)
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
	if (measure)
		print_parameters(r, z);
	if (spectrum)
		print_spectrum(r, z);
	if (measure || spectrum)
		return;
	if (!out)
		out = fields_create(NULL);
	fields_write(out, r, more);
}

/* The file to process, NULL if surfaces are generated: without an operand, unless
 * --measure has no options of generated surfaces. */
static const char *file_of(int argc, char **argv, int operand)
{
	if (operand < argc)
		return argv[operand];
	if (!(measure || spectrum) || opt_any_given(generated_grid_rows) ||
		opt_any_given(generated_rows))
		return NULL;
	if (isatty(STDIN_FILENO))
		die(EXIT_USAGE,
			"nothing to measure: name a file, pipe surfaces in, or give --points");
	return "-";
}

int main(int argc, char **argv)
{
	const char *file = file_of(argc, argv, opt_parse(&prog, argc, argv));
	struct record r = { 0 };
	int status = EXIT_SUCCESS;

	check_options(file != NULL);
	if (file) {
		struct measured *surfaces = measured_open(file);
		const char *why;
		double had;

		while (measured_next(surfaces, &r, &had))
			finish(&r, had, measured_more(surfaces));
		why = measured_doubted(surfaces);
		if (why && table)
			table_comment(table, "doubtful", "%s", why);
		if (why)
			status = EXIT_NOCONV;
		measured_close(surfaces);
	} else {
		struct generated *surfaces = generated_open((int)threads);

		while (generated_next(surfaces, &r))
			finish(&r, 0, generated_more(surfaces));
		generated_close(surfaces);
	}
	record_free(&r);
	if (out)
		fields_done(out);
	if (table)
		table_done(table);
	return shell_done(status);
}
