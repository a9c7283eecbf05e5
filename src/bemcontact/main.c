/* bemcontact - pressure between rough elastic bodies pressed together */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "common/raw_layout.h"
#include "contact/solver.h"
#include "io/fields.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum field { HEIGHT, PRESSURE, DISPLACEMENT, GAP };
static const char *const field_names[] = { "height", "pressure", "displacement", "gap",
	NULL };

static int fields = 1 << HEIGHT | 1 << PRESSURE;

static const struct opt opts[] = {
	OPT_TABLE(press_rows),
	OPT_HEADING("Output"),
	{ 0, "fields", OPT_WORDS, UNIT_NONE, &fields, 0, 0, "NAME,...",
		"what to write of height, pressure, displacement, gap", field_names, 0 },
	OPT_TABLE(raw_rows),
	OPT_END,
};

static const struct prog prog = { "bemcontact",
	"Press a rough surface against a flat: pressure, contact and gap of elastic "
	"bodies.",
	"[file]", "fields: height", "fields: height, pressure", opts };

static void check_options(void)
{
	press_check();
	if (isnan(press.load) && isnan(press.pressure) && isnan(press.approach))
		die(EXIT_USAGE, "want one of --load, --pressure and --approach");
	if (isnan(press.estar))
		die(EXIT_USAGE, "want either --estar or --young and --poisson");
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
	press_record(r, par);
	record_set(r, "load", "%.17g", s->load);
	record_set(r, "mean_pressure", "%.17g", s->pressure);
	record_set(r, "approach", "%.17g", s->approach);
	record_set(r, "indentation", "%.17g", s->indentation);
	record_set(r, "area", "%.17g", s->area);
	if (par->hardness > 0)
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
	struct contact_par par = press_par(r, pool);
	struct contact *c = solver_for(r, &par, name, number);
	double *h = record_need(r, "height", 1, in), *p, *u = NULL, *g = NULL;
	int warm = record_find(r, "pressure") >= 0;
	double target = press_target(r);
	enum contact_status status;

	if (r->nz != 1)
		die(EXIT_RUN, "%s: record %ld: want a plane field, got %d layers", name,
			number, r->nz);
	p = warm ? record_need(r, "pressure", 1, in) : record_add(r, "pressure", "Pa");
	if (fields & 1 << DISPLACEMENT)
		u = record_add(r, "displacement", "m");
	if (fields & 1 << GAP)
		g = record_add(r, "gap", "m");
	status = contact_solve(c, h, press_control(), target, p, g);
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
	put_results(r, &par, contact_result(c), status == CONTACT_OK);
	count_work(contact_result(c), warm);
	note("%s: record %ld: area %.4g, approach %.6g m, certificate %.2g, %ld "
	     "iterations",
		name, number, contact_result(c)->area, contact_result(c)->approach,
		contact_result(c)->certificate, contact_result(c)->iterations);
	if (status == CONTACT_NOCONV)
		warn("%s: record %ld: not converged: certificate %.2g after %ld iterations",
			name, number, contact_result(c)->certificate,
			contact_result(c)->iterations);
	return status == CONTACT_OK;
}

/* Leaves the wanted fields only. */
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

	check_options();
	pool = pool_new((int)press.threads);
	if (!pool)
		die(EXIT_RUN, "cannot start %ld threads:", press.threads);
	in = fields_open(argv[first], raw_given());
	out = fields_create(NULL);
	while (fields_read(in, &r)) {
		char *cmd = opt_cmd(r.cmd, NULL);

		if (!solve_record(&r, in, pool))
			status = EXIT_NOCONV;
		drop_fields(&r);
		free(r.cmd);
		r.cmd = cmd;
		fields_write(out, &r, fields_more(in));
	}
	fields_done(out);
	fields_close(in);
	record_free(&r);
	pool_free(pool);
	return shell_done(status);
}
