/* debrisgen - wear particles that a contact tears off a rough surface */
#include "contact/debris.h"
#include "contact/solver.h"
#include "contact/stress_kernel.h"
#include "contact/surface.h"
#include "press.h"
#include "shell/fields.h"
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/progress.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const axes[] = { "x", "y", NULL };
static const char *const layers[] = { "top", "mid", NULL };
static const char *const rules[] = { "column", "potential", NULL };

/* Fields of --stress: one word gives one or several. */
enum { MISES = 1, HYDROSTATIC = 2, PRINCIPAL = 4, TENSOR = 8 };
static const char *const stress_words[] = { "von_mises", "hydrostatic", "principal",
	"tensor", NULL };

static double yield = NAN, friction, depth_step = NAN, stop_area = 0.8, amplification = 1;
static int shear, layer, removal, stress_wanted = MISES;
static long steps = 1, stress_layers, memory = 512;
static const char *surface_path, *summary_path, *stress_path;

static const struct opt opts[] = {
	{ 'Y', "yield", OPT_NUM, UNIT_PRESSURE, &yield, 1e-30, 1e30, "Y",
		"yield stress: material under more von Mises stress is lost", NULL, 0 },
	{ 'u', "friction", OPT_NUM, UNIT_NONE, &friction, 0, 1e6, "MU",
		"friction coefficient: shear over pressure", NULL, 0 },
	{ 'z', "depth-step", OPT_NUM, UNIT_LENGTH, &depth_step, 1e-30, 1e30, "H",
		"height of a cell; by default the spacing along x", NULL, 0 },
	{ 'd', "shear", OPT_WORD, UNIT_NONE, &shear, 0, 0, "x|y",
		"direction in which friction drags the worn body", axes, 0 },
	{ 'l', "layer", OPT_WORD, UNIT_NONE, &layer, 0, 0, "top|mid",
		"where in a cell the stress is taken", layers, 0 },
	{ 'r', "removal", OPT_WORD, UNIT_NONE, &removal, 0, 0, "column|potential",
		"what is lost: columns of failed cells from the surface, or every failed cell",
		rules, 0 },
	{ 'T', "steps", OPT_INT, UNIT_COUNT, &steps, 1, 1e6, "N",
		"wear steps; the contact is solved anew from the second on", NULL, 0 },
	{ 'A', "stop-area", OPT_NUM, UNIT_FRACTION, &stop_area, 0, 1, "A",
		"stop where this share of the cells is in contact; 1: never", NULL, 0 },
	{ 'Z', "amplification", OPT_NUM, UNIT_NONE, &amplification, 0, 1e12, "K",
		"sliding distance of a step over the length of the grid", NULL, 0 },
	{ 'O', "surface", OPT_TEXT, UNIT_NONE, &surface_path, 0, 0, "FILE",
		"write the worn surface of every step", NULL, 1 },
	{ 'U', "summary", OPT_TEXT, UNIT_NONE, &summary_path, 0, 0, "FILE",
		"write a table with a row per step", NULL, 1 },
	{ 'G', "stress", OPT_TEXT, UNIT_NONE, &stress_path, 0, 0, "FILE",
		"write the stress below every contact", NULL, 1 },
	{ 'o', "fields", OPT_WORDS, UNIT_NONE, &stress_wanted, 0, 0, "NAME,...",
		"what to write of von_mises, hydrostatic, principal, tensor",
		stress_words, 1 },
	{ 'y', "stress-layers", OPT_INT, UNIT_COUNT, &stress_layers, 0, 1e6, "N",
		"layers of --stress; 0: as many as were searched for failure", NULL, 1 },
	{ 'k', "memory", OPT_INT, UNIT_COUNT, &memory, 0, 1e7, "MB",
		"megabytes for influence coefficients kept; the result is the same", NULL,
		1 },
	OPT_TABLE(press_rows), OPT_END
};

static const struct prog prog = { "debrisgen",
	"Find the wear particles that a rough contact tears off, step by step.", "[file]",
	"fields: height, pressure", "table: one row per wear particle", opts };

static const char particle_columns[] =
	"realisation step particle nodes volume diameter aspect x y z length width elongation "
	"convexity area azimuth dip x_low x_high y_low y_high z_low z_high";
static const char particle_units[] =
	"1 1 1 1 m3 m 1 m m m m m 1 1 m2 rad rad m m m m m m";
static const char summary_columns[] =
	"realisation step distance load contact_fraction max_pressure edge_load volume "
	"particles mean_diameter max_diameter depth relative_roughness max_von_mises";
static const char summary_units[] = "1 1 m N 1 Pa 1 m3 1 m m m 1 Pa";

/* Where everything goes, and what is kept from record to record. */
struct run {
	struct fields_in *in;
	struct table_out *particles, *summary;
	struct fields_out *surface, *stress;
	struct pool *pool;
	struct debris *debris;
	struct contact *contact;
	struct debris_par par;
	struct contact_par pressing; /* the contact's problem */
	struct stress_work seen;
	int status;
};

static void check_options(void)
{
	press_check();
	if (isnan(yield))
		die(EXIT_USAGE, "want --yield");
	if (press.poisson.v[0] < 0)
		die(EXIT_USAGE, "--poisson %g: want 0 to 0.5 for the worn body",
			press.poisson.v[0]);
}

/* Makes the machinery for grids like that of r, unless it is there already. */
static void prepare(struct run *run, const struct record *r)
{
	struct contact_par pressing = press_par(r, run->pool);

	if (run->debris && press_same(&pressing, &run->pressing))
		return;
	if (steps > 1 && isnan(pressing.estar))
		die(EXIT_USAGE,
			"--steps %ld solves contacts: want --young or --estar, which %s does not tell",
			steps, fields_name(run->in));
	run->pressing = pressing;
	debris_free(run->debris);
	contact_free(run->contact);
	run->contact = NULL;
	run->par = (struct debris_par){ .yield = yield, .rule = (enum wear_rule)removal };
	run->par.stress = (struct stress_par){ .nx = r->nx,
		.ny = r->ny,
		.ax = r->dx,
		.ay = r->dy,
		.dz = isnan(depth_step) ? r->dx : depth_step,
		.offset = layer ? 0.5 : 0,
		.nu = press.poisson.v[0],
		.mu = friction,
		.axis = shear,
		.periodic = pressing.boundary == CONTACT_PERIODIC,
		.memory = (size_t)memory << 20,
		.pool = run->pool };
	memset(&run->seen, 0, sizeof(run->seen));
	run->debris = debris_new(&run->par);
	if (run->debris && steps > 1)
		run->contact = contact_new(&pressing);
	if (!run->debris || (steps > 1 && !run->contact))
		die(EXIT_RUN, "%s: record %ld: %dx%d cells:", fields_name(run->in),
			fields_count(run->in), r->nx, r->ny);
}

/* Presses the worn surface again, from the last pressure. */
static void press_again(struct run *run, const struct record *r, double target, double *h,
	double *p, long step)
{
	enum contact_status status =
		contact_solve(run->contact, h, press_control(), target, p, NULL);
	const struct contact_result *c = contact_result(run->contact);

	if (status != CONTACT_OK && status != CONTACT_NOCONV)
		die(EXIT_RUN, "%s: record %ld, step %ld: no contact at %g %s: %s",
			fields_name(run->in), fields_count(run->in), step, target,
			isnan(press.approach) ? "Pa" : "m",
			status == CONTACT_OVERLOAD   ? "the hardness cannot carry it"
			: status == CONTACT_TOO_DEEP ? "beyond full contact"
						     : "numbers beyond double precision");
	if (status == CONTACT_NOCONV) {
		warn("%s: realisation %ld, step %ld: contact not solved to %g, only to %.2g",
			fields_name(run->in), r->realisation, step, press.tolerance,
			c->certificate);
		run->status = EXIT_NOCONV;
	}
	stats_add("contact_iterations", (double)c->iterations);
	stats_add("contact_transforms", (double)c->transforms);
}

/* The pipeline that prints what went to the file of an option, on standard output; of the
 * particles with option NULL.  Fresh memory. */
static char *cmd_of(const char *upstream, const char *option)
{
	static const char turn[] = "/dev/fd/3 3>&1 >/dev/null";
	char words[64] = "", *extra = NULL, *cmd;

	for (int k = 0; stress_words[k]; k++)
		if (stress_wanted & 1 << k)
			strcat(strcat(words, *words ? "," : ""), stress_words[k]);
	if (option && strcmp(option, "--stress") == 0)
		extra = xprintf("--fields %s --stress-layers %ld %s %s", words,
			stress_layers, option, turn);
	else if (option)
		extra = xprintf("%s %s", option, turn);
	cmd = opt_cmd(upstream, extra);
	free(extra);
	return cmd;
}

static void table_cmd_for(struct table_out *t, const struct record *r, const char *option)
{
	char *cmd = cmd_of(r->cmd, option);

	table_cmd(t, cmd);
	free(cmd);
}

static void put_particles(
	struct run *run, long realisation, long step, const struct debris_step *s)
{
	struct table_out *t = run->particles;

	for (size_t i = 0; i < s->count; i++) {
		const struct particle *p = &s->particle[i];
		double row[] = { (double)realisation, (double)step, (double)(i + 1),
			p->nodes, p->volume, p->diameter, p->aspect, p->x, p->y, p->z,
			p->length, p->width, p->elongation, p->convexity, p->area,
			p->azimuth, p->dip, p->low[0], p->high[0], p->low[1], p->high[1],
			p->low[2], p->high[2] };

		for (size_t k = 0; k < sizeof(row) / sizeof(*row); k++)
			table_put(t, row[k]);
		table_end_row(t);
	}
	table_flush(t);
}

static void put_summary(struct run *run, const struct record *r, long step,
	const struct debris_step *s, double roughness)
{
	double mean = 0, most = 0, length = shear ? r->ny * r->dy : r->nx * r->dx;

	for (size_t i = 0; i < s->count; i++) {
		mean += s->particle[i].diameter / (double)s->count;
		most = fmax(most, s->particle[i].diameter);
	}
	double row[] = { (double)r->realisation, (double)step,
		(double)step * amplification * length, s->load, s->contact,
		s->max_pressure, s->edge_load, s->volume, (double)s->count,
		s->count ? mean : NAN, s->count ? most : NAN, s->depth, roughness,
		s->wear.mises };

	for (size_t k = 0; k < sizeof(row) / sizeof(*row); k++)
		table_put(run->summary, row[k]);
	table_end_row(run->summary);
	table_flush(run->summary);
}

/* A record like r without its fields, with the keys that stay true of worn surfaces. */
static void bare_record(
	struct record *out, const struct record *r, const char *option, long step)
{
	static const char *const kept[] = { "seed", "sq", "crown", NULL };

	record_init(out, r->nx, r->ny, r->dx, r->dy);
	out->realisation = r->realisation;
	out->cmd = cmd_of(r->cmd, option);
	for (int i = 0; kept[i]; i++)
		if (record_get(r, kept[i]))
			record_set(out, kept[i], "%s", record_get(r, kept[i]));
	record_set(out, "step", "%ld", step);
}

static void put_surface(struct run *run, const struct record *r, long step,
	const double *h, const double *p)
{
	size_t bytes = (size_t)r->nx * r->ny * sizeof(*h);
	struct record out = { 0 };

	bare_record(&out, r, "--surface", step);
	memcpy(record_add(&out, "height", "m"), h, bytes);
	/* The next solution starts from it, here as in a pipeline. */
	memcpy(record_add(&out, "pressure", "Pa"), p, bytes);
	fields_write(run->surface, &out);
	record_free(&out);
}

/* The fields wanted at one point, in the order of their names in put_stress(). */
static int derive(const double t[STRESS_COMPONENTS], double *out)
{
	int n = 0;

	if (stress_wanted & MISES)
		out[n++] = stress_von_mises(t);
	if (stress_wanted & HYDROSTATIC)
		out[n++] = (t[STRESS_XX] + t[STRESS_YY] + t[STRESS_ZZ]) / 3;
	if (stress_wanted & PRINCIPAL) {
		stress_principal(t, out + n);
		n += 3;
	}
	if (stress_wanted & TENSOR) {
		memcpy(out + n, t, STRESS_COMPONENTS * sizeof(*t));
		n += STRESS_COMPONENTS;
	}
	return n;
}

static void put_stress(
	struct run *run, const struct record *r, long step, const struct debris_step *s)
{
	static const char *const names[] = { "von_mises", "hydrostatic", "principal_1",
		"principal_2", "principal_3", "xx", "yy", "zz", "xy", "xz", "yz" };
	static const int part[] = { MISES, HYDROSTATIC, PRINCIPAL, PRINCIPAL, PRINCIPAL,
		TENSOR, TENSOR, TENSOR, TENSOR, TENSOR, TENSOR };
	size_t n = (size_t)r->nx * r->ny;
	long count = stress_layers        ? stress_layers
		     : s->wear.layers > 0 ? s->wear.layers
					  : 1;
	double *tensor = xcalloc(n, STRESS_COMPONENTS * sizeof(*tensor));
	struct record out = { 0 };

	bare_record(&out, r, "--stress", step);
	out.nz = (int)count;
	out.dz = run->par.stress.dz;
	record_set(&out, "first_depth", "%.17g", run->par.stress.offset * out.dz);
	for (size_t k = 0; k < sizeof(part) / sizeof(*part); k++)
		if (stress_wanted & part[k])
			record_add(&out, names[k], "Pa");
	for (long m = 0; m < count; m++) {
		if (stress_tensor(debris_stress(run->debris), m, tensor))
			die(EXIT_RUN, "no memory for the stress of %ld layers", count);
		for (size_t i = 0; i < n; i++) {
			double t[STRESS_COMPONENTS], v[RECORD_FIELDS_MAX];

			for (int c = 0; c < STRESS_COMPONENTS; c++)
				t[c] = tensor[c * n + i];
			derive(t, v);
			for (int k = 0; k < out.nfields; k++)
				out.data[k][m * n + i] = v[k];
		}
	}
	fields_write(run->stress, &out);
	record_free(&out);
	free(tensor);
}

static void count_work(struct run *run, const struct debris_step *s)
{
	struct stress_work w = stress_work(debris_stress(run->debris));

	stats_add("steps", 1);
	stats_add("particles", (double)s->count);
	stats_add("layers", (double)s->wear.layers);
	stats_add("nodes", s->wear.nodes);
	stats_add("nodes_skipped", s->wear.nodes_skipped);
	stats_add("stress_transforms", w.transforms - run->seen.transforms);
	stats_add("kernel_cells", w.kernel_cells - run->seen.kernel_cells);
	stats_add("layers_direct", w.direct_layers - run->seen.direct_layers);
	stats_add("layers_fourier", w.fourier_layers - run->seen.fourier_layers);
	run->seen = w;
}

/* Root mean square height, the crown taken off. */
static double roughness(const struct record *r, const double *h, double crown)
{
	size_t n = (size_t)r->nx * r->ny;
	double *z = xcalloc(n, sizeof(*z)), sq;

	memcpy(z, h, n * sizeof(*z));
	surface_crown(r->nx, r->ny, r->dx, r->dy, -crown, z);
	sq = surface_sq(r->nx, r->ny, z);
	free(z);
	return sq;
}

static void refuse(const struct run *run, enum debris_status status, long step)
{
	if (status == DEBRIS_OK)
		return;
	die(EXIT_RUN, "%s: record %ld, step %ld: %s", fields_name(run->in),
		fields_count(run->in), step,
		status == DEBRIS_PULL ? "pressure below zero"
		: status == DEBRIS_DEEP
			? "material fails deeper than ten times the grid is long"
			: "out of memory");
}

/* What a step of one surface needs. */
struct scene {
	struct record *r;
	double *h, *p;
	double crown, sq;
	double target; /* mean pressure, or approach */
	long done;     /* steps before the first of this run */
	int warned;    /* of load on the rim, once a surface */
};

static double choose_target(const struct scene *c, double contact_load)
{
	const struct record *r = c->r;
	double asked = press_target(r), given = record_get_number(r, "mean_pressure");

	if (!isnan(asked))
		return asked;
	return isnan(given) ? contact_load / (r->nx * r->dx * r->ny * r->dy) : given;
}

static void open_scene(struct run *run, struct record *r, struct scene *c)
{
	double before = record_get_number(r, "step");
	struct debris_step s;

	if (r->nz != 1)
		die(EXIT_RUN, "%s: record %ld: want plane fields, got %d layers",
			fields_name(run->in), fields_count(run->in), r->nz);
	c->r = r;
	c->h = record_need(r, "height", 1, run->in);
	c->p = record_need(r, "pressure", 1, run->in);
	c->crown = record_get_number(r, "crown");
	c->crown = isnan(c->crown) ? 0 : c->crown;
	c->sq = record_get_number(r, "sq");
	c->done = isnan(before) ? 0 : (long)before;
	if (isnan(c->sq) || c->sq <= 0) {
		c->sq = roughness(r, c->h, c->crown);
		record_set(r, "sq", "%.17g", c->sq);
	}
	prepare(run, r);
	debris_contact(run->debris, c->p, &s);
	c->target = choose_target(c, s.load);
}

/* 1 where the contact is too large for a further step. */
static int check_contact(struct run *run, struct scene *c, long step)
{
	const char *name = fields_name(run->in);
	struct debris_step s;

	debris_contact(run->debris, c->p, &s);
	if (s.edge_load > 0.05 && !c->warned++)
		warn("%s: realisation %ld, step %ld: %.0f %% of the load lies on the "
		     "outermost cells",
			name, c->r->realisation, step, 100 * s.edge_load);
	if (s.contact < stop_area || stop_area == 1)
		return 0;
	note("%s: realisation %ld, step %ld: %.3g of the cells in contact: stopped", name,
		c->r->realisation, step, s.contact);
	return 1;
}

static void wear_step(struct run *run, const struct scene *c, long step)
{
	struct debris_step s;

	refuse(run, debris_step(run->debris, c->h, c->p, &s), step);
	count_work(run, &s);
	put_particles(run, c->r->realisation, step, &s);
	if (run->summary)
		put_summary(run, c->r, step, &s, roughness(c->r, c->h, c->crown) / c->sq);
	if (run->stress)
		put_stress(run, c->r, step, &s);
	if (run->surface)
		put_surface(run, c->r, step, c->h, c->p);
	note("%s: realisation %ld, step %ld: %zu particles, %.6g m3, %ld layers",
		fields_name(run->in), c->r->realisation, step, s.count, s.volume,
		s.wear.layers);
}

/* Wears one surface step by step. */
static void wear_record(struct run *run, struct record *r)
{
	struct scene c = { 0 };

	open_scene(run, r, &c);
	table_cmd_for(run->particles, r, NULL);
	if (run->summary)
		table_cmd_for(run->summary, r, "--summary");
	for (long k = 1; k <= steps; k++) {
		progress("steps", (double)(k - 1), (double)steps);
		if (k > 1)
			press_again(run, r, c.target, c.h, c.p, c.done + k);
		if (check_contact(run, &c, c.done + k)) {
			stats_add("steps_skipped", (double)(steps - k + 1));
			break;
		}
		wear_step(run, &c, c.done + k);
	}
}

static void create_outputs(struct run *run, const char *upstream)
{
	char *cmd = cmd_of(upstream, NULL), *summary = cmd_of(upstream, "--summary");

	run->particles = table_create(NULL, cmd, particle_units, particle_columns);
	if (summary_path)
		run->summary = table_create(
			summary_path, summary, summary_units, summary_columns);
	if (surface_path)
		run->surface = fields_create(surface_path);
	if (stress_path)
		run->stress = fields_create(stress_path);
	free(cmd);
	free(summary);
}

int main(int argc, char **argv)
{
	int first = opt_parse(&prog, argc, argv);
	struct record r = { 0 };
	struct run run = { 0 };

	check_options();
	run.pool = pool_new((int)press.threads);
	if (!run.pool)
		die(EXIT_RUN, "cannot start %ld threads:", press.threads);
	run.in = fields_open(argv[first], NULL);
	while (fields_read(run.in, &r)) {
		if (!run.particles)
			create_outputs(&run, r.cmd);
		wear_record(&run, &r);
	}
	progress_clear();
	if (!run.particles)
		create_outputs(&run, NULL);
	table_done(run.particles);
	if (run.summary)
		table_done(run.summary);
	if (run.surface)
		fields_done(run.surface);
	if (run.stress)
		fields_done(run.stress);
	debris_free(run.debris);
	contact_free(run.contact);
	fields_close(run.in);
	record_free(&r);
	pool_free(run.pool);
	return shell_done(run.status);
}
