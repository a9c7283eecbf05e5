#include "outputs.h"
#include "cli/msg.h"
#include "common/contact_options.h"
#include "io/tables.h"
#include "num/grid.h"
#include "num/running.h"
#include "num/student.h"
#include "stress/stress_kernel.h"
#include "surface/surface.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fields of --stress: one word gives one or several. */
enum { MISES = 1, HYDROSTATIC = 2, PRINCIPAL = 4, TENSOR = 8 };
static const char *const stress_words[] = { "von_mises", "hydrostatic", "principal",
	"tensor", NULL };

static int stress_wanted = MISES;
static long stress_layers;
static const char *surface_path, *counter_path, *summary_path, *stress_path;

struct opt worn_rows[] = {
	OPT_HEADING("Further output"),
	{ 0, "surface", OPT_TEXT, UNIT_NONE, &surface_path, 0, 0, "FILE",
		"write the worn surface of every step", NULL, 1 },
	{ 0, "counter-surface", OPT_TEXT, UNIT_NONE, &counter_path, 0, 0, "FILE",
		"write the worn counterface of every step", NULL, 1 },
	{ 0, "summary", OPT_TEXT, UNIT_NONE, &summary_path, 0, 0, "FILE",
		"write a table with one row per step", NULL, 1 },
	{ 0, "stress", OPT_TEXT, UNIT_NONE, &stress_path, 0, 0, "FILE",
		"write the stress below every contact", NULL, 1 },
	{ 0, "fields", OPT_WORDS, UNIT_NONE, &stress_wanted, 0, 0, "NAME,...",
		"fields of --stress: von_mises, hydrostatic, principal, tensor",
		stress_words, 1 },
	{ 0, "stress-layers", OPT_INT, UNIT_COUNT, &stress_layers, 0, 1e6, "N",
		"number of layers of --stress; 0: down to the depth searched for failure",
		NULL, 1 },
	OPT_END,
};

static const char particle_columns[] =
	"realisation step body particle columns volume diameter aspect x y z length width elongation "
	"solidity area azimuth dip x_low x_high y_low y_high z_low z_high";
static const char particle_units[] =
	"1 1 1 1 1 m3 m 1 m m m m m 1 1 m2 rad rad m m m m m m";
static const char summary_columns[] =
	"realisation step distance load contact_fraction max_pressure edge_load volume "
	"particles mean_diameter max_diameter depth relative_roughness max_stress volume_first volume_second "
	"wear_coefficient wear_coefficient_mean wear_coefficient_low "
	"wear_coefficient_high";
static const char summary_units[] = "1 1 m N 1 Pa 1 m3 1 m m m 1 Pa m3 m3 1 1 1 1";

#define GRID_COLUMNS                                                                \
	" volume_2h volume_4h particles_2h particles_4h order volume_extrapolated " \
	"volume_grid_error"
#define GUESS_COLUMNS " volume_low volume_high exact"
#define GUESS_UNITS " m3 m3 1"
#define GRID_UNITS " m3 m3 1 1 1 m3 m3"

/* A stream of records; the last one is kept until it is known whether another one
 * follows. */
struct held_fields {
	struct fields_out *out; /* NULL: not wanted */
	struct record last;     /* without fields: none yet */
};

struct worn {
	struct table_out *particles, *summary;
	struct held_fields surface, counter, stress;
	struct running coefficients; /* Archard's, of the steps of a surface so far */
};

/* Takes ownership of the record. */
static void held_put(struct held_fields *f, const struct record *r)
{
	if (f->last.nfields)
		fields_write(f->out, &f->last, 1);
	record_free(&f->last);
	f->last = *r;
}

static void held_done(struct held_fields *f)
{
	if (f->last.nfields)
		fields_write(f->out, &f->last, 0);
	record_free(&f->last);
	if (f->out)
		fields_done(f->out);
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

struct worn *worn_open(const char *upstream, int richardson, int surrogate)
{
	struct worn *w = xcalloc(1, sizeof *w);
	char *cmd = cmd_of(upstream, NULL), *summary = cmd_of(upstream, "--summary");

	{
		char *units =
			xprintf("%s%s", particle_units, surrogate ? GUESS_UNITS : "");
		char *columns =
			xprintf("%s%s", particle_columns, surrogate ? GUESS_COLUMNS : "");

		w->particles = table_create(NULL, cmd, units, columns);
		free(units);
		free(columns);
	}
	if (summary_path) {
		char *units = xprintf("%s%s", summary_units,
			richardson  ? GRID_UNITS
			: surrogate ? GUESS_UNITS
				    : "");
		char *columns = xprintf("%s%s", summary_columns,
			richardson  ? GRID_COLUMNS
			: surrogate ? GUESS_COLUMNS
				    : "");

		w->summary = table_create(summary_path, summary, units, columns);
		free(units);
		free(columns);
	}
	if (surface_path)
		w->surface.out = fields_create(surface_path);
	if (counter_path)
		w->counter.out = fields_create(counter_path);
	if (stress_path)
		w->stress.out = fields_create(stress_path);
	free(cmd);
	free(summary);
	return w;
}

static void table_cmd_for(struct table_out *t, const struct record *r, const char *option)
{
	char *cmd = cmd_of(r->cmd, option);

	table_cmd(t, cmd);
	free(cmd);
}

static void tell(struct table_out *t, const struct worn_conditions *c)
{
	if (!t)
		return;
	table_comment(t, "nominal_area", "%.12g m2", c->area);
	table_comment(t, "nominal_pressure", "%.12g Pa", c->pressure);
	table_comment(t, "friction", "%.12g", c->friction);
	table_comment(t, "step_distance", "%.12g m", c->distance);
}

int worn_takes_heights(void)
{
	return summary_path || surface_path || counter_path || stress_path;
}

void worn_begin(
	struct worn *w, const struct record *r, const struct worn_conditions *conditions)
{
	table_cmd_for(w->particles, r, NULL);
	if (w->summary)
		table_cmd_for(w->summary, r, "--summary");
	w->coefficients = (struct running){ 0 };
	tell(w->particles, conditions);
	tell(w->summary, conditions);
}

static void put_particles(struct table_out *t, long realisation, long step, int body,
	const struct debris_step *lost, const struct quick_volumes *volumes)
{
	for (size_t i = 0; i < lost->count; i++) {
		const struct particle *p = &lost->particle[i];
		double row[] = { (double)realisation, (double)step, body, (double)(i + 1),
			(double)p->columns, p->volume, p->diameter, p->aspect, p->x, p->y,
			p->z, p->length, p->width, p->elongation, p->solidity, p->area,
			p->azimuth, p->dip, p->low[0], p->high[0], p->low[1], p->high[1],
			p->low[2], p->high[2], p->volume, p->volume, 1 };
		enum { GUESS = 3, PLAIN = sizeof(row) / sizeof *row - GUESS };

		if (volumes && !volumes->exact) {
			row[PLAIN] = volumes->particle[i].low;
			row[PLAIN + 1] = volumes->particle[i].high;
			row[PLAIN + 2] = 0;
		}
		table_put_row(t, row, volumes ? PLAIN + GUESS : PLAIN);
	}
	table_flush(t);
}

double worn_roughness(const struct worn_surface *c)
{
	const struct record *r = c->r;
	size_t n = grid_size(r->nx, r->ny);
	double *z = xcalloc(n, sizeof *z), sq;

	memcpy(z, c->h, n * sizeof *z);
	surface_crown(r->nx, r->ny, r->dx, r->dy, -c->crown, z);
	sq = surface_sq(r->nx, r->ny, z);
	free(z);
	return sq;
}

static void put_summary(struct table_out *t, struct running *coefficients,
	const struct worn_surface *c, const struct worn_step *s)
{
	const struct debris_step *first = s->lost;
	const struct debris_step none = { .volume = 0 },
				 *second = s->second ? s->second : &none;
	double particles = (double)(first->count + second->count), sum = 0, most = 0;
	double volume = first->volume + second->volume;
	double coefficient = volume * s->hardness / (first->load * s->length);
	double n, wide = NAN;
	/* a surrogate gives neither depths nor the worn surface */
	int worn = !s->volumes || s->volumes->exact;

	for (size_t i = 0; i < first->count; i++) {
		sum += first->particle[i].diameter;
		most = fmax(most, first->particle[i].diameter);
	}
	for (size_t i = 0; i < second->count; i++) {
		sum += second->particle[i].diameter;
		most = fmax(most, second->particle[i].diameter);
	}
	running_add(coefficients, coefficient);
	n = coefficients->n;
	/* Student's interval of the logarithm: positive values are skewed */
	if (n > 1)
		wide = student_two_sided(0.95, (long)n - 1) *
		       sqrt(running_variance(coefficients) / n);
	wide = exp(wide > 0 ? wide / coefficients->mean : wide);
	double row[] = { (double)c->r->realisation, (double)s->number, s->distance,
		first->load, first->contact, first->max_pressure, first->edge_load,
		volume, particles, particles > 0 ? sum / particles : NAN,
		particles > 0 ? most : NAN,
		worn ? fmax(first->depth, second->depth) : NAN,
		worn ? worn_roughness(c) / c->sq : NAN,
		fmax(first->wear.stress, second->wear.stress), first->volume,
		second->volume, coefficient, coefficients->mean,
		coefficients->mean / wide, coefficients->mean * wide, 0, 0, 0, 0, 0, 0,
		0 };
	enum { GRID = 7, PLAIN = sizeof(row) / sizeof *row - GRID };

	if (s->grid) {
		const struct grid_error *g = s->grid;
		const double more[GRID] = { g->volume[0], g->volume[1], g->particles[0],
			g->particles[1], g->order, g->extrapolated, g->error };

		memcpy(row + PLAIN, more, sizeof more);
	}
	if (s->volumes) {
		int exact = s->volumes->exact;

		row[PLAIN] = exact ? volume : s->volumes->total.low;
		row[PLAIN + 1] = exact ? volume : s->volumes->total.high;
		row[PLAIN + 2] = exact;
	}
	table_put_row(t, row, s->grid ? PLAIN + GRID : s->volumes ? PLAIN + 3 : PLAIN);
	table_flush(t);
}

/* A record like r without its fields, with the keys that stay true of worn surfaces. */
static void bare_record(
	struct record *out, const struct record *r, const char *option, long step)
{
	static const char *const kept[] = { "seed", "sq", "crown", "doubtful", NULL };

	record_init(out, r->nx, r->ny, r->dx, r->dy);
	out->realisation = r->realisation;
	out->cmd = cmd_of(r->cmd, option);
	for (int i = 0; kept[i]; i++)
		if (record_get(r, kept[i]))
			record_set(out, kept[i], "%s", record_get(r, kept[i]));
	record_set(out, "step", "%ld", step);
}

static void put_surface(
	struct held_fields *f, const struct worn_surface *c, const struct worn_step *s)
{
	size_t bytes = grid_size(c->r->nx, c->r->ny) * sizeof *c->h;
	struct contact_par par = press_par(c->r, NULL);
	struct record out = { 0 };

	bare_record(&out, c->r, "--surface", s->number);
	press_record(&out, &par);
	memcpy(record_add(&out, "height", "m"), c->h, bytes);
	/* The next solution starts from it, here as in a pipeline. */
	memcpy(record_add(&out, "pressure", "Pa"), c->p, bytes);
	held_put(f, &out);
}

/* The whole counterface, in its own coordinates. */
static void put_counter(
	struct held_fields *f, const struct worn_surface *c, const struct worn_step *s)
{
	const struct record *r = s->counterface;
	struct record out = { 0 };

	record_init(&out, r->nx, r->ny, r->dx, r->dy);
	out.realisation = c->r->realisation;
	out.cmd = cmd_of(c->r->cmd, "--counter-surface");
	record_set(&out, "step", "%ld", s->number);
	if (record_get(c->r, "doubtful"))
		record_doubt(&out, record_get(c->r, "doubtful"));
	memcpy(record_add(&out, "height", "m"), r->data[record_find(r, "height")],
		(size_t)r->nx * (size_t)r->ny * sizeof(double));
	held_put(f, &out);
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
		memcpy(out + n, t, STRESS_COMPONENTS * sizeof *t);
		n += STRESS_COMPONENTS;
	}
	return n;
}

static void put_stress(
	struct held_fields *f, const struct record *r, const struct worn_step *s)
{
	static const char *const names[] = { "von_mises", "hydrostatic", "principal_1",
		"principal_2", "principal_3", "xx", "yy", "zz", "xy", "xz", "yz" };
	static const int part[] = { MISES, HYDROSTATIC, PRINCIPAL, PRINCIPAL, PRINCIPAL,
		TENSOR, TENSOR, TENSOR, TENSOR, TENSOR, TENSOR };
	size_t n = grid_size(r->nx, r->ny);
	/* Down to the depth that was searched. */
	long count = stress_layers ? stress_layers
				   : 1 + (long)ceil(fmax(0, s->lost->wear.depth / s->dz -
								    s->offset));
	double *tensor = xcalloc(n, STRESS_COMPONENTS * sizeof *tensor);
	struct record out = { 0 };

	bare_record(&out, r, "--stress", s->number);
	out.nz = (int)count;
	out.dz = s->dz;
	record_set(&out, "first_depth", "%.17g", s->offset * out.dz);
	for (size_t k = 0; k < sizeof(part) / sizeof *part; k++)
		if (stress_wanted & part[k])
			record_add(&out, names[k], "Pa");
	for (long m = 0; m < count; m++) {
		if (stress_tensor(s->stress, ((double)m + s->offset) * s->dz, tensor))
			die(EXIT_RUN, "no memory for the stress of %ld layers", count);
		for (size_t i = 0; i < n; i++) {
			double t[STRESS_COMPONENTS], v[RECORD_FIELDS_MAX];

			for (int c = 0; c < STRESS_COMPONENTS; c++)
				t[c] = tensor[(size_t)c * n + i];
			derive(t, v);
			for (int k = 0; k < out.nfields; k++)
				out.data[k][(size_t)m * n + i] = v[k];
		}
	}
	held_put(f, &out);
	free(tensor);
}

void worn_put(struct worn *w, const struct worn_surface *c, const struct worn_step *s)
{
	put_particles(w->particles, c->r->realisation, s->number, 1, s->lost, s->volumes);
	if (s->second)
		put_particles(
			w->particles, c->r->realisation, s->number, 2, s->second, NULL);
	if (w->summary)
		put_summary(w->summary, &w->coefficients, c, s);
	if (w->counter.out && s->counterface)
		put_counter(&w->counter, c, s);
	if (w->stress.out)
		put_stress(&w->stress, c->r, s);
	if (w->surface.out)
		put_surface(&w->surface, c, s);
}

void worn_end(struct worn *w, long realisation, long step)
{
	/* all of its steps or the last ones may have no particle */
	table_comment(w->particles, "realisation", "%ld", realisation);
	table_comment(w->particles, "last_step", "%ld", step);
}

void worn_doubt(struct worn *w, const char *why)
{
	table_comment(w->particles, "doubtful", "%s", why);
	if (w->summary)
		table_comment(w->summary, "doubtful", "%s", why);
}

void worn_close(struct worn *w)
{
	table_done(w->particles);
	if (w->summary)
		table_done(w->summary);
	held_done(&w->surface);
	held_done(&w->counter);
	held_done(&w->stress);
	free(w);
}
