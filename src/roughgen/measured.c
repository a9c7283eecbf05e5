#include "measured.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "common/raw_layout.h"
#include "roughness_options.h"
#include "surface/filter.h"
#include "surface/surface.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SEED = 1 }; /* of a roughness drawn: --seed is for generated surfaces */

static struct opt_list crop, resample;
static int level, fill;
static double s_filter, l_filter;
static int form, ends;
static const char *const forms[] = { "none", "plane", "paraboloid", "poly2", "poly3",
	"poly4", "poly5", "poly6", NULL };
enum { ENDS_CROP = 3, ENDS_PERIODIC };
static const char *const ends_words[] = { "0", "1", "2", "crop", "periodic", NULL };

struct opt measured_rows[] = {
	OPT_HEADING("Measured surfaces"),
	OPT_TABLE(raw_rows),
	{ 0, "crop", OPT_LIST, UNIT_COUNT, &crop, 0, POINTS_MAX, "X:Y:NX:NY",
		"cut out NX by NY samples, the first at column X and row Y", NULL, 0 },
	{ 0, "fill", OPT_FLAG, UNIT_NONE, &fill, 0, 0, NULL,
		"fill missing samples with a solution of Laplace's equation", NULL, 0 },
	{ 0, "level", OPT_FLAG, UNIT_NONE, &level, 0, 0, NULL,
		"subtract the least-squares plane", NULL, 0 },
	{ 0, "s-filter", OPT_NUM, UNIT_LENGTH, &s_filter, 1e-15, 1e6, "L",
		"S-filter: attenuate waves shorter than L (Gaussian)", NULL, 0 },
	{ 0, "form", OPT_WORD, UNIT_NONE, &form, 0, 0, "none|plane|paraboloid|poly2|...",
		"then subtract this least-squares form; up to poly6", forms, 0 },
	{ 0, "l-filter", OPT_NUM, UNIT_LENGTH, &l_filter, 1e-15, 1e6, "L",
		"L-filter: then attenuate waves longer than L", NULL, 0 },
	{ 0, "ends", OPT_WORD, UNIT_NONE, &ends, 0, 0, "0|1|2|crop|periodic",
		"edge treatment of the filters: order of the local fit, cropped, or periodic",
		ends_words, 0 },
	{ 0, "resample", OPT_LIST, UNIT_COUNT, &resample, 1, POINTS_MAX, "N[xM]",
		"resample the same area to this many points", NULL, 0 },
	OPT_END,
};

struct measured {
	struct fields_in *in;
	struct record read; /* the record as read */
	int piped;          /* not a file that the command line could name again */
};

struct measured *measured_open(const char *path)
{
	struct measured *m = xcalloc(1, sizeof *m);

	if (l_filter > 0 && s_filter >= l_filter)
		die(EXIT_USAGE, "--s-filter %g m is not below --l-filter %g m", s_filter,
			l_filter);
	m->in = fields_open(path, raw_given());
	m->piped = strcmp(path, "-") == 0;
	return m;
}

int measured_more(struct measured *m)
{
	return fields_more(m->in);
}

const char *measured_doubted(struct measured *m)
{
	return fields_doubted(m->in);
}

void measured_close(struct measured *m)
{
	record_free(&m->read);
	fields_close(m->in);
	free(m);
}

static void need_memory(enum num_status status)
{
	if (status)
		die(EXIT_RUN, "out of memory for a measured surface");
}

/* A record with an empty height field and the other properties of r. */
static void new_record(
	struct record *s, const struct record *r, int nx, int ny, double dx, double dy)
{
	record_init(s, nx, ny, dx, dy);
	record_add(s, "height", "m");
	record_copy_keys(s, r);
}

/* Moves the cropped heights of r into a record without other fields. */
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
	press_forget(s);
	/* A piece of a periodic surface does not continue itself. */
	if (crop.n)
		record_drop_key(s, "boundary");
	surface_crop(r->nx, z, x, y, nx, ny, s->data[0]);
}

static void fill_holes(const struct fields_in *in, struct record *s)
{
	double *z = record_need(s, "height", !fill, in);
	size_t n = (size_t)s->nx * (size_t)s->ny, missing;
	double residual;
	int steps;

	if (!fill)
		return;
	missing = surface_missing(s->nx, s->ny, z);
	if (missing == n)
		die(EXIT_RUN, "%s: record %ld: every height is missing", fields_name(in),
			fields_count(in));
	need_memory(surface_fill(s->nx, s->ny, s->dx, s->dy, z, &steps, &residual));
	if (!(residual <= SURFACE_FILLED))
		die(EXIT_RUN,
			"%s: record %ld: --fill stopped at a residual of %.2g after %d steps",
			fields_name(in), fields_count(in), residual, steps);
	record_need(s, "height", 1, in);
	stats_add("samples_filled", (double)missing);
	stats_add("iterations", steps);
}

/* Removes the crown of a whole surface and returns its drop; the crown of a cropped piece
 * stays, as part of its heights. */
static double take_crown(struct record *s)
{
	double drop = record_get_number(s, "crown");

	if (crop.n || !(drop > 0) || !isfinite(drop))
		return 0;
	surface_crown(s->nx, s->ny, s->dx, s->dy, -drop, s->data[0]);
	return drop;
}

/* One Gaussian filter: its output or, with high != 0, the residual. */
static void filter_heights(const char *word, double nesting, int high, struct record *s)
{
	enum filter_ends how = ends == ENDS_CROP       ? FILTER_MEAN
			       : ends == ENDS_PERIODIC ? FILTER_PERIODIC
						       : (enum filter_ends)ends;
	double side = fmin(s->nx > 1 ? s->nx * s->dx : INFINITY,
		s->ny > 1 ? s->ny * s->dy : INFINITY);
	double step = fmax(s->nx > 1 ? s->dx : 0, s->ny > 1 ? s->dy : 0), excess = 0;
	double *z = s->data[0];
	size_t n = (size_t)s->nx * (size_t)s->ny;
	double *smooth;

	if (!(nesting > 0))
		return;
	if (high && nesting < fmin(s->dx, s->dy))
		die(EXIT_RUN, "--%s %g m is shorter than a pixel: no height is left",
			word, nesting);
	if (!high && nesting < fmax(s->dx, s->dy))
		warn("--%s %g m is shorter than a pixel and does nothing", word, nesting);
	else if (step > 0)
		need_memory(surface_gauss_excess(step, nesting, how, &excess));
	if (excess > 0.02) /* 0.013 with five samples */
		warn("--%s %g m is less than five samples: of waves of two samples %.0f %% "
		     "more pass than it states",
			word, nesting, 100 * excess);
	if (nesting > side)
		warn("--%s %g m is longer than the surface, %g m", word, nesting, side);
	smooth = xcalloc(n, sizeof *smooth);
	need_memory(surface_gauss(s->nx, s->ny, s->dx, s->dy, z, nesting, how, smooth));
	stats_add("filter_products",
		surface_gauss_products(s->nx, s->ny, s->dx, s->dy, nesting, how));
	for (size_t i = 0; i < n; i++)
		z[i] = high ? z[i] - smooth[i] : smooth[i];
	free(smooth);
}

/* Crops the borders affected by the ends of the filters: half a nesting index. */
static void crop_ends(const struct fields_in *in, struct record *s)
{
	double border = 0.5 * fmax(s_filter, l_filter);
	int cx = (int)fmin(ceil(border / s->dx), s->nx);
	int cy = (int)fmin(ceil(border / s->dy), s->ny);
	struct record t = { 0 };

	if (s->nx - 2 * cx < 1 || s->ny - 2 * cy < 1)
		die(EXIT_RUN,
			"%s: record %ld: --ends crop removes all of %d x %d samples",
			fields_name(in), fields_count(in), s->nx, s->ny);
	new_record(&t, s, s->nx - 2 * cx, s->ny - 2 * cy, s->dx, s->dy);
	record_drop_key(&t, "boundary");
	surface_crop(s->nx, s->data[0], cx, cy, t.nx, t.ny, t.data[0]);
	stats_add("samples_cropped", (double)s->nx * s->ny - (double)t.nx * t.ny);
	record_free(s);
	*s = t;
}

/* ISO 25178-2: S-filter, F-operation, L-filter. */
static void scale_limit(const struct fields_in *in, struct record *s)
{
	enum num_status status = NUM_OK;

	filter_heights("s-filter", s_filter, 0, s);
	if (form > 0)
		status = surface_form(
			s->nx, s->ny, s->dx, s->dy, (enum form)(form - 1), s->data[0]);
	if (status == NUM_DOMAIN)
		die(EXIT_RUN, "%s: record %ld: %d x %d samples are too few for --form %s",
			fields_name(in), fields_count(in), s->nx, s->ny, forms[form]);
	need_memory(status);
	filter_heights("l-filter", l_filter, 1, s);
	if (ends == ENDS_CROP && (s_filter > 0 || l_filter > 0))
		crop_ends(in, s);
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
	struct rough_range wanted = roughness_target();
	double *z = s->data[0];
	double want = rough_draw(&wanted, SEED, (uint32_t)s->realisation, 0);
	double have = roughness_kind() == ROUGH_SA ? surface_sa(s->nx, s->ny, z)
						   : surface_sq(s->nx, s->ny, z);

	if (rough_scale(s->nx, s->ny, z, have, want))
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

int measured_next(struct measured *m, struct record *r, double *crown)
{
	const char *upstream;

	if (!fields_read(m->in, &m->read))
		return 0;
	take_heights(m->in, &m->read, r);
	fill_holes(m->in, r);
	*crown = take_crown(r);
	if (level)
		surface_level(r->nx, r->ny, r->data[0]);
	scale_limit(m->in, r);
	if (resample.n)
		resample_heights(r);
	if (opt_given("sq") || opt_given("sa"))
		scale_heights(m->in, r);
	/* Input through a pipe must be requested. */
	upstream = m->read.cmd;
	r->cmd = opt_cmd(upstream, upstream || m->piped ? "-" : NULL);
	check_heights(m->in, r);
	return 1;
}
