/* bemcontact - pressure between rough elastic bodies pressed together */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "common/edge.h"
#include "common/raw_layout.h"
#include "contact/patches.h"
#include "contact/solver.h"
#include "io/fields.h"
#include "tables.h"
#include "task.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum field { HEIGHT, PRESSURE, DISPLACEMENT, GAP, SHEAR, RESIDUAL };
static const char *const field_names[] = { "height", "pressure", "displacement", "gap",
	"shear", "residual", NULL };

static int fields = 1 << HEIGHT | 1 << PRESSURE;
static long sweep = 1;
static struct kernel_coating coating = { .young = NAN, .poisson = 0.3 };
static struct contact_kernel coated;

static const struct opt opts[] = {
	OPT_TABLE(press_rows),
	OPT_HEADING("Coating"),
	{ 0, "coating", OPT_NUM, UNIT_LENGTH, &coating.thickness, 0, 1e6, "T",
		"thickness of a bonded layer on the first body; 0: none", 0, 0 },
	{ 0, "coating-young", OPT_NUM, UNIT_PRESSURE, &coating.young, 1e-6, 1e30, "E",
		"Young's modulus of the layer", 0, 0 },
	{ 0, "coating-poisson", OPT_NUM, UNIT_NONE, &coating.poisson, -0.999, 0.499, "N",
		"Poisson's ratio of the layer", 0, 0 },
	OPT_TABLE(slip_rows),
	OPT_HEADING("Output"),
	{ 0, "fields", OPT_WORDS, UNIT_NONE, &fields, 0, 0, "NAME,...",
		"fields to write: height, pressure, displacement, gap, shear, residual",
		field_names, 0 },
	OPT_TABLE(table_opts),
	{ 0, "sweep", OPT_INT, UNIT_COUNT, &sweep, 1, 1e6, "N",
		"apply the load in N equal steps, each a row of --table", 0, 0 },
	OPT_TABLE(unload_rows),
	OPT_TABLE(raw_rows),
	OPT_END,
};

static const struct prog prog = { "bemcontact",
	"Solve the elastic contact of a rough surface with a flat: pressure and gap.",
	"[file]", "fields: height", "fields: height, pressure", opts };

/* The body below the layer is the first of --young, the other one the last. */
static void set_coating(void)
{
	const struct opt_list *e = &press.young, *nu = &press.poisson;
	double other = nu->v[nu->n - 1];

	if (!e->n || isnan(coating.young))
		die(EXIT_USAGE, "--coating requires --young and --coating-young");
	if (press.boundary != CONTACT_PERIODIC)
		die(EXIT_USAGE, "--coating requires --boundary periodic");
	coating.base_young = e->v[0];
	coating.base_poisson = nu->v[0];
	coating.other = (1 - other * other) / e->v[e->n - 1];
	coated = kernel_coated(&coating);
}

static void check_options(void)
{
	press_check();
	if (isnan(press.load) && isnan(press.pressure) && isnan(press.approach))
		die(EXIT_USAGE, "specify one of --load, --pressure and --approach");
	opt_require("coating", "coating-young coating-poisson");
	opt_require("table", "sweep unload");
	if (coating.thickness > 0)
		set_coating();
	slip_check();
	if (slip_wanted() && coating.thickness > 0)
		die(EXIT_USAGE, "--tangential excludes --coating");
	if (fields & 1 << SHEAR && !slip_wanted())
		die(EXIT_USAGE, "--fields shear requires --tangential and --friction");
}

/* The part of a record's work that the present solution is. */
static struct {
	double from, length;
	int last; /* no record follows */
} part;

static void tell(void *context, double share)
{
	(void)context;
	progress_within(part.from + part.length * share, part.last);
}

/* The solver for a record; the last one is kept while grid and material stay. */
static struct contact *solver_for(const struct record *r, const struct contact_par *par,
	const char *name, long number)
{
	static struct contact *contact;
	static struct contact_par old;

	if (contact && press_same(par, &old))
		return contact;
	contact_free(contact);
	old = *par;
	contact = contact_new(par);
	if (!contact)
		die(EXIT_RUN, "%s: record %ld: %dx%d cells:", name, number, r->nx, r->ny);
	return contact;
}

static void put_results(struct record *r, const struct contact_par *par,
	const struct contact_result *s, int converged)
{
	press_forget(r);
	record_drop_key(r, "hardness");
	record_drop_key(r, "coating");
	press_record(r, par);
	if (par->kernel) {
		/* The key of the contact modulus does not apply to this kernel. */
		record_set(r, "estar", "nan");
		record_set(r, "coating", "%.17g", coating.thickness);
	}
	record_set(r, "load", "%.17g", s->load);
	record_set(r, "mean_pressure", "%.17g", s->pressure);
	record_set(r, "approach", "%.17g", s->approach);
	record_set(r, "indentation", "%.17g", s->indentation);
	record_set(r, "area", "%.17g", s->area);
	if (par->hardness > 0)
		record_set(r, "plastic_area", "%.17g", s->plastic);
	record_set(r, "energy", "%.17g", s->energy);
	record_set(r, "optimality_gap", "%.3g", s->optimality_gap);
	record_set(r, "iterations", "%ld", s->iterations);
	record_set(r, "converged", "%s", converged ? "yes" : "no");
}

void count_work(const struct contact_result *s, int warm)
{
	stats_add("records", 1);
	stats_add("warm_starts", warm);
	stats_add("iterations", (double)s->iterations);
	stats_add("transforms", (double)s->transforms);
	stats_add("transforms_all_grids", s->work);
	stats_max("optimality_gap", s->optimality_gap);
}

enum contact_status press_to(const struct task *t, const double *height,
	enum contact_control control, double target, double *p, double *gap)
{
	enum contact_status status = contact_solve(t->c, height, control, target, p, gap);

	if (status == CONTACT_OVERLOAD)
		die(EXIT_RUN,
			"%s: record %ld: mean pressure %g Pa is not below the hardness",
			t->name, t->number, target);
	if (status == CONTACT_TOO_DEEP)
		die(EXIT_RUN, "%s: record %ld: approach %g m is beyond full contact",
			t->name, t->number, target);
	if (status == CONTACT_NUMBERS)
		die(EXIT_RUN, "%s: record %ld: heights or load beyond double precision",
			t->name, t->number);
	return status;
}

/* A periodic surface in full contact does not approach any further, since the mean of the
 * displacement is zero: what is left of the difference is rounding, of either sign. */
static int is_full(const struct task *t)
{
	const struct contact_result *s = contact_result(t->c);

	return t->par.boundary == CONTACT_PERIODIC && s->area == 1 && s->plastic == 0;
}

/* dF / d approach from loads 1 % less and more; nan if these are not solved.  The central
 * difference of a load F ~ approach^1.5 is wrong by 1e-5. */
static double find_stiffness(
	const struct task *t, const double *height, const double *p, double pressure)
{
	size_t cells = (size_t)t->par.nx * (size_t)t->par.ny;
	double area = t->par.nx * t->par.dx * t->par.ny * t->par.dy, approach[2];
	int full = 1;

	for (int k = 0; k < 2; k++) {
		double target = pressure * (k ? 1.01 : 0.99);

		if (!(target > 0) || (t->par.hardness > 0 && target >= t->par.hardness))
			return NAN;
		memcpy(t->other, p, cells * sizeof *t->other);
		if (press_to(t, height, CONTACT_PRESSURE, target, t->other, NULL) !=
			CONTACT_OK)
			return NAN;
		approach[k] = contact_result(t->c)->approach;
		full &= is_full(t);
		stats_add("stiffness_transforms", contact_result(t->c)->work);
	}
	return full ? INFINITY : 0.02 * pressure * area / (approach[1] - approach[0]);
}

static double highest(const struct task *t)
{
	double h = -INFINITY;

	for (size_t i = 0; i < (size_t)t->par.nx * (size_t)t->par.ny; i++)
		h = fmax(h, t->h[i]);
	return h;
}

void put_row(const struct task *t, const double *height, const struct contact_result *s,
	double *p, int converged, int last)
{
	double stiffness = NAN;

	if (t->other)
		stiffness = find_stiffness(t, height, p, s->pressure);
	tables_put(t->r, &t->par, s, p, stiffness, converged, last);
}

static struct edge edge;

/* Returns 1 if the contact is mostly beyond the edge of the grid. */
static int note_edge(const struct task *t)
{
	struct patch_grid grid = { t->par.nx, t->par.ny, t->par.dx, t->par.dy,
		t->par.boundary == CONTACT_PERIODIC };
	double share = contact_edge_load(&grid, t->p);

	record_set(t->r, "edge_load", "%.17g", share);
	return edge_load_note(&edge, share, t->r->realisation, sweep);
}

/* One contact and its row; returns 1 if it converged. */
static int solve_step(const struct task *t, double target, int warm, int last,
	struct contact_result *found)
{
	enum contact_status status =
		press_to(t, t->h, press_control(), target, t->p, t->gap);

	part.from += part.length;
	part.length = 0;
	*found = *contact_result(t->c);
	count_work(found, warm);
	note("%s: record %ld: area %.4g, approach %.6g m, optimality gap %.2g, %ld iterations",
		t->name, t->number, found->area, found->approach, found->optimality_gap,
		found->iterations);
	if (status == CONTACT_NOCONV)
		warn("%s: record %ld: not converged: optimality gap %.2g after %ld iterations",
			t->name, t->number, found->optimality_gap, found->iterations);
	if (last)
		put_results(t->r, &t->par, found, status == CONTACT_OK);
	put_row(t, t->h, found, t->p, status == CONTACT_OK, last);
	return status == CONTACT_OK;
}

static double *field_of(struct record *r, enum field f, const char *unit)
{
	return fields & 1 << f ? record_add(r, field_names[f], unit) : NULL;
}

/* Slip and unloading after the contact under the full load; returns 1 if it converged. */
static int solve_after(const struct task *t, const struct contact_result *full)
{
	double *shear = field_of(t->r, SHEAR, "Pa"),
	       *residual = field_of(t->r, RESIDUAL, "m"), *own = NULL;
	int converged = 1;

	if (slip_wanted()) {
		if (!shear)
			shear = own =
				xcalloc((size_t)t->r->nx * (size_t)t->r->ny, sizeof *own);
		converged &= slip_solve(t, full, shear);
		free(own);
	}
	return converged & unload_solve(t, full, residual);
}

/* Contact modulus of what touches: of a soft layer, whatever bears it. */
static double touching_modulus(const struct contact_par *par)
{
	double nu = coating.poisson;

	if (!par->kernel)
		return par->estar;
	return fmin(par->estar, 1 / ((1 - nu * nu) / coating.young + coating.other));
}

/* Warns once of values that are possible but unlikely to be meant.  A number below 1000
 * without its unit may be one of MPa, up to 1 GPa; 1 kPa is the weight of 13 mm of steel.
 * The ideal strength of solids is about a tenth of their modulus. */
static void doubt(const struct contact_par *par, const struct contact_result *found)
{
	double touching = found->pressure / found->area, modulus = touching_modulus(par);
	static int said;

	if (said || !(found->pressure > 0))
		return;
	said = 1;
	if (found->pressure < 1e3 && !isnan(press.pressure))
		warn("--pressure %g Pa is very low: is %gMPa meant?", press.pressure,
			press.pressure);
	else if (touching > 0.1 * modulus)
		warn("the mean pressure where the bodies touch, %.3g GPa, is above a tenth "
		     "of the contact modulus of %.3g GPa: no solid is elastic there%s",
			1e-9 * touching, 1e-9 * modulus,
			par->hardness > 0 ? "" : ", specify --hardness");
	else
		said = 0;
}

/* Written before it is read, and by all threads: see clear_cells() of the solver. */
static void clear_row(void *context, size_t row, int worker)
{
	const struct task *t = context;
	size_t nx = (size_t)t->r->nx;

	(void)worker;
	memset(t->p + row * nx, 0, nx * sizeof *t->p);
}

/* Solves one record in place; returns 1 if it converged to a contact within the grid. */
static int solve_record(struct record *r, const struct fields_in *in, struct pool *pool)
{
	struct task t = { .r = r, .name = fields_name(in), .number = fields_count(in) };
	size_t cells = (size_t)r->nx * (size_t)r->ny;
	double *u = NULL, *own_gap = NULL, target = press_target(r), from = 0;
	int warm = record_find(r, "pressure") >= 0, converged = 1;
	struct contact_result found = { 0 };

	t.par = press_par(r, pool);
	if (isnan(t.par.estar))
		die(EXIT_USAGE,
			"%s: record %ld states no contact modulus: specify either --estar or --young and --poisson",
			t.name, t.number);
	t.par.progress = tell;
	t.par.kernel = coating.thickness > 0 ? &coated : NULL;
	t.c = solver_for(r, &t.par, t.name, t.number);
	t.h = record_need(r, "height", 1, in);
	if (r->nz != 1)
		die(EXIT_RUN, "%s: record %ld: want a plane field, got %d layers", t.name,
			t.number, r->nz);
	t.p = warm ? record_need(r, "pressure", 1, in) : record_add(r, "pressure", "Pa");
	if (!warm)
		pool_run(pool, (size_t)r->ny, clear_row, &t);
	u = field_of(r, DISPLACEMENT, "m");
	t.gap = field_of(r, GAP, "m");
	if (!t.gap && (unload_wanted() || fields & 1 << RESIDUAL))
		t.gap = own_gap = xcalloc(cells, sizeof *own_gap);
	if (table_wanted())
		t.other = xcalloc(cells, sizeof *t.other);
	if (press_control() == CONTACT_APPROACH)
		from = -highest(&t);
	for (long k = 1; k <= sweep; k++) {
		part.from = (double)(k - 1) / (double)sweep;
		part.length = 1 / (double)sweep;
		converged &= solve_step(&t,
			k < sweep ? from + (target - from) * (double)k / (double)sweep
				  : target,
			warm || k > 1, k == sweep, &found);
	}
	if (u)
		contact_displacement(t.c, t.p, u);
	converged &= solve_after(&t, &found);
	converged &= !note_edge(&t);
	doubt(&t.par, &found);
	free(own_gap);
	free(t.other);
	return converged;
}

/* Keeps only the wanted fields. */
static void drop_fields(struct record *r)
{
	for (int i = r->nfields - 1; i >= 0; i--) {
		int keep = 0;

		for (int k = 0; field_names[k]; k++)
			keep |= fields & 1 << k &&
				strcmp(r->name[i], field_names[k]) == 0;
		if (!keep)
			record_drop(r, r->name[i]);
	}
}

int main(int argc, char **argv)
{
	int first = opt_parse(&prog, argc, argv), status = EXIT_SUCCESS;
	struct record r = { 0 };
	struct fields_in *in;
	struct fields_out *out;
	struct pool *pool;
	const char *why;

	check_options();
	pool = pool_new((int)press.threads);
	if (!pool)
		die(EXIT_RUN, "cannot start %ld threads:", press.threads);
	in = fields_open(argv[first], raw_given());
	out = fields_create(NULL);
	fields_read_with(in, pool);
	fields_write_with(out, pool);
	tables_open(NULL);
	while (fields_read(in, &r)) {
		char *cmd = opt_cmd(r.cmd, NULL);

		part.last = fields_last(in);
		if (!solve_record(&r, in, pool))
			status = EXIT_NOCONV;
		drop_fields(&r);
		free(r.cmd);
		r.cmd = cmd;
		fields_write(out, &r, fields_more(in));
		progress_within(1, part.last);
	}
	edge_load_warn(&edge, fields_name(in));
	why = fields_doubted(in);
	if (why) {
		status = EXIT_NOCONV;
		tables_doubt(why);
	}
	fields_done(out);
	tables_done();
	fields_close(in);
	record_free(&r);
	pool_free(pool);
	return shell_done(status);
}
