/* bemcontact - pressure between rough elastic bodies pressed together */
#include "contact/kernel.h"
#include "contact/solver.h"
#include "shell/fields.h"
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/stats.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const boundaries[] = { "free", "periodic", NULL };
static const char *const multipliers[] = { "fft", "mlms", NULL };
static const char *const solvers[] = { "bccg", "pk", NULL };
static const char *const field_names[] = { "height", "pressure", "displacement", "gap",
	NULL };
enum field { HEIGHT, PRESSURE, DISPLACEMENT, GAP, FIELDS };

static double load = NAN, pressure = NAN, approach = NAN, estar = NAN;
static double hardness, tolerance = 1e-8, pixel = NAN;
static struct opt_list young, poisson = { 1, { 0.3 } }, raw_size;
static int boundary, solver, multiply;
static long max_iterations = 10000, threads = 1;
static const char *fields = "height,pressure";
static int wanted[FIELDS];

static const struct opt opts[] = { { 'F', "load", OPT_NUM, UNIT_FORCE, &load, 0, 1e30,
					   "F", "normal load", NULL, 0 },
	{ 'P', "pressure", OPT_NUM, UNIT_PRESSURE, &pressure, 0, 1e30, "P",
		"mean pressure, in place of a load", NULL, 0 },
	{ 'D', "approach", OPT_NUM, UNIT_LENGTH, &approach, -1e12, 1e12, "D",
		"how far the flat goes past height 0, in place of a load", NULL, 0 },
	{ 'E', "young", OPT_LIST, UNIT_PRESSURE, &young, 1e-6, 1e30, "E1[,E2]",
		"Young's moduli of the bodies; one for both", NULL, 0 },
	{ 'N', "poisson", OPT_LIST, UNIT_NONE, &poisson, -0.999, 0.5, "N1[,N2]",
		"Poisson's ratios of the bodies; one for both", NULL, 0 },
	{ 'e', "estar", OPT_NUM, UNIT_PRESSURE, &estar, 1e-6, 1e30, "E",
		"contact modulus, in place of --young and --poisson", NULL, 0 },
	{ 'b', "boundary", OPT_WORD, UNIT_NONE, &boundary, 0, 0, "free|periodic",
		"surface around the grid: free of load, or the grid repeated", boundaries,
		0 },
	{ 'K', "hardness", OPT_NUM, UNIT_PRESSURE, &hardness, 0, 1e30, "H",
		"largest pressure; 0: none", NULL, 0 },
	{ 't', "tolerance", OPT_NUM, UNIT_NONE, &tolerance, 1e-16, 1, "T",
		"certificate to reach", NULL, 0 },
	{ 'i', "max-iterations", OPT_INT, UNIT_COUNT, &max_iterations, 1, 1e9, "N",
		"iterations after which to give up", NULL, 0 },
	{ 'o', "fields", OPT_TEXT, UNIT_NONE, &fields, 0, 0, "NAME,...",
		"what to write of height, pressure, displacement, gap", NULL, 0 },
	{ 'm', "solver", OPT_WORD, UNIT_NONE, &solver, 0, 0, "bccg|pk",
		"preconditioned on nested grids, or Polonsky and Keer's", solvers, 0 },
	{ 'M', "multiply", OPT_WORD, UNIT_NONE, &multiply, 0, 0, "fft|mlms",
		"how the half-space is applied: Fourier, or multi-level summation",
		multipliers, 0 },
	{ 'j', "threads", OPT_INT, UNIT_COUNT, &threads, 1, 1024, "N",
		"threads; the result is the same", NULL, 1 },
	{ 'x', "raw", OPT_LIST, UNIT_COUNT, &raw_size, 1, 1e9, "NXxNY",
		"read headerless little-endian float64 heights", NULL, 0 },
	{ 'X', "pixel", OPT_NUM, UNIT_LENGTH, &pixel, 1e-15, 1e12, "D",
		"spacing of --raw", NULL, 0 },
	OPT_END };

static const struct prog prog = { "bemcontact",
	"Press a rough surface against a flat: pressure, contact and gap of elastic "
	"bodies.",
	"[file]", "fields: height", "fields: height, pressure", opts };

static void choose_fields(const char *list)
{
	while (*list) {
		size_t n = strcspn(list, ",");
		int k = 0;

		while (field_names[k] && (strlen(field_names[k]) != n ||
						 strncmp(list, field_names[k], n) != 0))
			k++;
		if (!field_names[k])
			die(EXIT_USAGE,
				"--fields '%.*s': want height, pressure, displacement or "
				"gap",
				(int)n, list);
		wanted[k] = 1;
		list += n + (list[n] == ',');
	}
}

static void check_options(void)
{
	if (!isnan(load) + !isnan(pressure) + !isnan(approach) != 1)
		die(EXIT_USAGE, "want one of --load, --pressure and --approach");
	if (isnan(estar) == (young.n == 0))
		die(EXIT_USAGE, "want either --estar or --young and --poisson");
	if (young.n > 2 || poisson.n > 2)
		die(EXIT_USAGE, "--young and --poisson take one or two values");
	if (multiply && boundary)
		die(EXIT_USAGE,
			"--multiply mlms sums over a free surface: no --boundary periodic");
	if (raw_size.n && (raw_size.n != 2 || isnan(pixel)))
		die(EXIT_USAGE, "--raw wants NXxNY and --pixel");
	if (young.n)
		estar = kernel_modulus(young.v[0], poisson.v[0], young.v[young.n - 1],
			poisson.v[poisson.n - 1]);
	choose_fields(fields);
}

/* The solver for grids like that of r; the last one is kept while the grid stays. */
static struct contact *solver_for(
	const struct record *r, const char *name, long number, struct pool *pool)
{
	static struct contact *contact;
	static struct contact_par par;

	if (contact && r->nx == par.nx && r->ny == par.ny && r->dx == par.dx &&
		r->dy == par.dy)
		return contact;
	contact_free(contact);
	par = (struct contact_par){ .nx = r->nx,
		.ny = r->ny,
		.dx = r->dx,
		.dy = r->dy,
		.estar = estar,
		.hardness = hardness,
		.boundary = (enum contact_boundary)boundary,
		.solver = (enum contact_solver)solver,
		.multiply = (enum contact_multiply)multiply,
		.tolerance = tolerance,
		.max_iterations = max_iterations,
		.pool = pool };
	contact = contact_new(&par);
	if (!contact)
		die(EXIT_RUN, "%s: record %ld: %dx%d cells:", name, number, r->nx, r->ny);
	return contact;
}

static void put_results(struct record *r, const struct contact_result *s, int converged)
{
	record_set(r, "load", "%.17g", s->load);
	record_set(r, "mean_pressure", "%.17g", s->pressure);
	record_set(r, "approach", "%.17g", s->approach);
	record_set(r, "indentation", "%.17g", s->indentation);
	record_set(r, "area", "%.17g", s->area);
	if (hardness > 0)
		record_set(r, "plastic_area", "%.17g", s->plastic);
	record_set(r, "energy", "%.17g", s->energy);
	record_set(r, "certificate", "%.3g", s->certificate);
	record_set(r, "iterations", "%ld", s->iterations);
	record_set(r, "converged", "%s", converged ? "yes" : "no");
}

static void count_work(const struct contact_result *s, int warm)
{
	stats_add("records", 1);
	stats_add("warm_starts", warm);
	stats_add("iterations", (double)s->iterations);
	stats_add("transforms", (double)s->transforms);
	stats_add("transforms_all_grids", s->work);
	stats_max("certificate", s->certificate);
}

/* Solves one record in place; returns 1 if it converged. */
static int solve_record(struct record *r, const struct fields_in *in, struct pool *pool)
{
	const char *name = fields_name(in);
	long number = fields_count(in);
	struct contact *c = solver_for(r, name, number, pool);
	double *h = record_need(r, "height", 1, in), *p, *u = NULL, *g = NULL;
	int warm = record_find(r, "pressure") >= 0;
	enum contact_control control =
		isnan(approach) ? CONTACT_PRESSURE : CONTACT_APPROACH;
	double target = !isnan(approach)   ? approach
			: !isnan(pressure) ? pressure
					   : load / (r->nx * r->dx * r->ny * r->dy);
	enum contact_status status;

	if (r->nz != 1)
		die(EXIT_RUN, "%s: record %ld: want a plane field, got %d layers", name,
			number, r->nz);
	p = warm ? record_need(r, "pressure", 1, in) : record_add(r, "pressure", "Pa");
	if (wanted[DISPLACEMENT])
		u = record_add(r, "displacement", "m");
	if (wanted[GAP])
		g = record_add(r, "gap", "m");
	status = contact_solve(c, h, control, target, p, g);
	if (status == CONTACT_OVERLOAD)
		die(EXIT_RUN,
			"%s: record %ld: mean pressure %g Pa is not below the hardness",
			name, number, target);
	if (status == CONTACT_TOO_DEEP)
		die(EXIT_RUN, "%s: record %ld: approach %g m is beyond full contact",
			name, number, target);
	if (status == CONTACT_NUMBERS)
		die(EXIT_RUN, "%s: record %ld: heights or load beyond double precision",
			name, number);
	if (u)
		contact_displacement(c, p, u);
	put_results(r, contact_result(c), status == CONTACT_OK);
	count_work(contact_result(c), warm);
	note("%s: record %ld: area %.4g, approach %.6g m, certificate %.2g, %ld "
	     "iterations",
		name, number, contact_result(c)->area, contact_result(c)->approach,
		contact_result(c)->certificate, contact_result(c)->iterations);
	return status == CONTACT_OK;
}

/* Leaves the wanted fields only. */
static void drop_fields(struct record *r)
{
	for (int i = r->nfields - 1; i >= 0; i--) {
		int keep = 0;

		for (int k = 0; k < FIELDS; k++)
			keep |= wanted[k] && strcmp(r->name[i], field_names[k]) == 0;
		if (!keep)
			record_drop(r, r->name[i]);
	}
}

int main(int argc, char **argv)
{
	int first = opt_parse(&prog, argc, argv), status = EXIT_SUCCESS;
	struct raw_layout raw = { 0 };
	struct record r = { 0 };
	struct fields_in *in;
	struct fields_out *out;
	struct pool *pool;

	check_options();
	if (raw_size.n)
		raw = (struct raw_layout){ (int)raw_size.v[0], (int)raw_size.v[1], pixel,
			pixel };
	pool = pool_new((int)threads);
	if (!pool)
		die(EXIT_RUN, "cannot start %ld threads:", threads);
	in = fields_open(argv[first], raw_size.n ? &raw : NULL);
	out = fields_create(NULL);
	while (fields_read(in, &r)) {
		char *cmd = opt_cmd(r.cmd, NULL);

		if (!solve_record(&r, in, pool))
			status = EXIT_NOCONV;
		drop_fields(&r);
		free(r.cmd);
		r.cmd = cmd;
		fields_write(out, &r);
	}
	fields_done(out);
	fields_close(in);
	record_free(&r);
	pool_free(pool);
	return shell_done(status);
}
