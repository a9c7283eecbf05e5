#include "counterface.h"
#include "cli/msg.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WRAP, FRESH };

static const char *const renewals[] = { "wrap", "fresh", NULL };

static const char *path;
static double slide = NAN;
static int renew;

struct opt counterface_rows[] = {
	{ 0, "counterface", OPT_TEXT, UNIT_NONE, &path, 0, 0, "FILE",
		"slide the rough surface of this file over that of the input", NULL, 0 },
	{ 0, "slide", OPT_NUM, UNIT_LENGTH, &slide, 0, 1e12, "D",
		"sliding distance per step; by default the length of the grid", NULL, 0 },
	{ 0, "renew", OPT_WORD, UNIT_NONE, &renew, 0, 0, "wrap|fresh",
		"counterface: periodic, or longer than the grid and used once", renewals,
		0 },
	OPT_END,
};

struct counterface {
	struct fields_in *in;
	int axis;
	struct record record; /* as worn so far */
	double *given;        /* its heights as read */
	double *height;       /* of the record */
	int nx, ny;           /* of the grid below it */
	long cells;           /* sliding distance of a step */
};

int counterface_check(void)
{
	opt_require("counterface", "slide renew counter-surface");
	return path != NULL;
}

double counterface_slide(void)
{
	return slide;
}

struct counterface *counterface_open(int axis)
{
	struct counterface *c = xcalloc(1, sizeof *c);

	c->in = fields_open(path, NULL);
	c->axis = axis;
	return c;
}

void counterface_close(struct counterface *c)
{
	if (!c)
		return;
	record_free(&c->record);
	free(c->given);
	fields_doubted(c->in);
	fields_close(c->in);
	free(c);
}

static size_t samples(const struct record *r)
{
	return (size_t)r->nx * (size_t)r->ny;
}

const struct record *counterface_record(const struct counterface *c)
{
	return &c->record;
}

static void read_next(struct counterface *c)
{
	size_t n;

	if (c->given && !fields_more(c->in)) {
		if (fields_count(c->in) > 1)
			die(EXIT_RUN,
				"%s: %ld records are fewer than those of the input: want one "
				"for each, or one for all",
				fields_name(c->in), fields_count(c->in));
		memcpy(c->height, c->given, samples(&c->record) * sizeof *c->height);
		return;
	}
	if (!fields_read(c->in, &c->record))
		die(EXIT_RUN, "%s: no surface", fields_name(c->in));
	if (c->record.nz != 1)
		die(EXIT_RUN, "%s: record %ld: want plane fields, got %d layers",
			fields_name(c->in), fields_count(c->in), c->record.nz);
	n = samples(&c->record);
	c->height = record_need(&c->record, "height", 1, c->in);
	c->given = xrealloc(c->given, n, sizeof *c->given);
	memcpy(c->given, c->height, n * sizeof *c->given);
}

static int same_spacing(double a, double b)
{
	return fabs(a - b) <= 1e-9 * b;
}

void counterface_next(struct counterface *c, const struct record *r)
{
	const struct record *own = &c->record;
	const char *name = fields_name(c->in);
	int along, across;
	double step = c->axis ? r->dy : r->dx, cells;

	read_next(c);
	c->nx = r->nx;
	c->ny = r->ny;
	along = c->axis ? own->ny - r->ny : own->nx - r->nx;
	across = c->axis ? own->nx - r->nx : own->ny - r->ny;
	if (!same_spacing(own->dx, r->dx) || !same_spacing(own->dy, r->dy))
		die(EXIT_RUN, "%s: record %ld: spacings of %g by %g m, want %g by %g m",
			name, fields_count(c->in), own->dx, own->dy, r->dx, r->dy);
	if (across || (renew == WRAP ? along != 0 : along < 0))
		die(EXIT_RUN, "%s: record %ld: %dx%d cells over %dx%d: want %s", name,
			fields_count(c->in), own->nx, own->ny, r->nx, r->ny,
			renew == WRAP
				? "as many"
				: "as many across and more in the direction of sliding");
	cells = isnan(slide) ? (double)(c->axis ? r->ny : r->nx) : slide / step;
	c->cells = lround(cells);
	if (fabs(cells - (double)c->cells) > 1e-6 * fmax(1, cells))
		die(EXIT_USAGE, "--slide %g m: want a multiple of the cell size %g m",
			slide, step);
}

/* Position of the first cell of the grid on the counterface, which moves along the axis;
 * the window of the grid therefore moves backwards. */
static long start(const struct counterface *c, long step)
{
	const struct record *r = &c->record;
	long own = c->axis ? r->ny : r->nx, grid = c->axis ? c->ny : c->nx;
	long moved = (step - 1) * c->cells;

	if (renew == WRAP)
		return (own - moved % own) % own;
	if (own - grid < moved)
		die(EXIT_RUN,
			"%s: record %ld: %ld cells in the direction of sliding end before step %ld",
			fields_name(c->in), fields_count(c->in), own, step);
	return own - grid - moved;
}

/* Index on the counterface of cell (x, y) of the grid. */
static size_t place(const struct counterface *c, long from, int x, int y)
{
	const struct record *r = &c->record;
	long u = c->axis ? x : (x + from) % r->nx, v = c->axis ? (y + from) % r->ny : y;

	return (size_t)v * (size_t)r->nx + (size_t)u;
}

void counterface_window(const struct counterface *c, long step, double *height)
{
	long from = start(c, step);

	for (int y = 0; y < c->ny; y++)
		for (int x = 0; x < c->nx; x++)
			*height++ = c->height[place(c, from, x, y)];
}

void counterface_return(struct counterface *c, long step, const double *height)
{
	long from = start(c, step);

	for (int y = 0; y < c->ny; y++)
		for (int x = 0; x < c->nx; x++)
			c->height[place(c, from, x, y)] = *height++;
}
