/* debrisfit - fit a surrogate of the debris model to contacts */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "common/contact_options.h"
#include "common/surrogate_table.h"
#include "debris/debris.h"
#include "io/fields.h"
#include "io/reasons.h"
#include "num/checksum.h"
#include "num/room.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct opt_list yield, friction = { 1, { 0 } }, poisson = { 1, { 0.3 } };

static const struct opt opts[] = {
	{ 'Y', "yield", OPT_LIST, UNIT_PRESSURE, &yield, 1e-30, 1e30, "LO[:HI]",
		"yield stress, or range of it", NULL, 0 },
	{ 'u', "friction", OPT_LIST, UNIT_FRACTION, &friction, 0, 1e6, "LO[:HI]",
		"friction coefficient, or range of it", NULL, 0 },
	{ 0, "poisson", OPT_LIST, UNIT_NONE, &poisson, 0, 0.5, "LO[:HI]",
		"Poisson's ratio, or range of it", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "debrisfit",
	"Fit a surrogate of the debris model, for debrisgen --surrogate.", "[file]",
	"fields: pressure, as bemcontact writes", "table: surrogate", opts };

static struct surrogate_sample *sample;
static size_t count, room;
static uint64_t *seen; /* checksums of the pressures so far */
static size_t seen_room;

/* A value of the range for each record: multiples of an irrational step fill it evenly.
 */
static double spread_over(
	const struct opt_list *range, double step, long record, int log_)
{
	double u = (double)record * step, low = range->v[0],
	       high = range->v[range->n - 1];

	u -= floor(u);
	return log_ ? low * pow(high / low, u) : low + (high - low) * u;
}

static struct debris_par par_of(const struct record *r, long record)
{
	/* 1/g, 1/g^2, 1/g^3 of the root g of g^4 = g + 1: Roberts' sequence */
	static const double steps[] = { 0.8191725133961644, 0.6710436067037892,
		0.5497004779019702 };
	struct debris_par par = { .yield = spread_over(&yield, steps[0], record, 1) };

	par.stress = (struct stress_par){ .nx = r->nx,
		.ny = r->ny,
		.dx = r->dx,
		.dy = r->dy,
		.nu = spread_over(&poisson, steps[1], record, 0),
		.mu = spread_over(&friction, steps[2], record, 0) };
	return par;
}

static void add_samples(const struct fields_in *in, long surface, int nx,
	const struct debris_step *step, const struct footprint *list, size_t n,
	const struct surrogate_contact *contact)
{
	if (n != step->count)
		die(EXIT_RUN, "%s: record %ld: %zu footprints of %zu particles",
			fields_name(in), fields_count(in), n, step->count);
	if (room_for(&sample, &room, count + n, sizeof *sample))
		die(EXIT_RUN, "out of memory");
	for (size_t i = 0; i < n; i++)
		for (size_t k = 0; k < n; k++) {
			const struct particle *p = &step->particle[k];

			if ((size_t)p->first[1] * (size_t)nx + (size_t)p->first[0] ==
				list[i].first)
				sample[count++] = (struct surrogate_sample){ surface,
					list[i], p->volume, *contact };
		}
}

/* Intervals hold for surfaces that are independent. */
static void check_new(const struct fields_in *in, const struct record *r,
	const double *pressure, long surface)
{
	uint64_t sum =
		checksum(pressure, record_points(r) * sizeof *pressure, CHECKSUM_START);

	for (long i = 0; i < surface; i++)
		if (seen[i] == sum)
			die(EXIT_RUN,
				"%s: record %ld has the pressure of record %ld: want each surface once",
				fields_name(in), fields_count(in),
				fields_count(in) - surface + i);
	if (room_for(&seen, &seen_room, (size_t)surface + 1, sizeof *seen))
		die(EXIT_RUN, "out of memory");
	seen[surface] = sum;
}

static void take_record(const struct fields_in *in, const struct record *r, long surface)
{
	const double *pressure = record_need(r, "pressure", 1, in);
	struct debris_par par = par_of(r, surface);
	struct debris *d = debris_new(&par);
	struct footprints *f = d ? footprints_new(&par.stress) : NULL;
	double *height = xcalloc((size_t)r->nx * (size_t)r->ny, sizeof *height);
	const struct footprint *list;
	struct debris_step step;
	enum debris_status status;
	struct surrogate_contact contact;
	size_t n;

	check_new(in, r, pressure, surface);
	if (!f)
		die(EXIT_RUN, "%s: record %ld: %dx%d cells:", fields_name(in),
			fields_count(in), r->nx, r->ny);
	status = debris_step(d, height, pressure, &step);
	if (status != DEBRIS_OK)
		die(EXIT_RUN, "%s: record %ld: %s", fields_name(in), fields_count(in),
			status == DEBRIS_DEEP
				? "material fails deeper than ten times the grid is long"
			: status == DEBRIS_MEMORY ? "out of memory"
						  : "pressure below zero or not finite");
	if (footprints_find(f, debris_stress(d), pressure, par.yield, &list, &n) !=
		NUM_OK)
		die(EXIT_RUN, "out of memory");
	contact = surrogate_contact(&par.stress, debris_stress(d), pressure,
		record_get_number(r, "hardness"));
	add_samples(in, surface, r->nx, &step, list, n, &contact);
	footprints_free(f);
	debris_free(d);
	free(height);
}

int main(int argc, char **argv)
{
	int first = opt_parse(&prog, argc, argv);
	struct fields_in *in;
	struct record r = { 0 };
	struct surrogate s;
	struct surrogate_report report;
	enum surrogate_status status;
	long surfaces = 0;
	char *cmd = NULL;
	struct reasons doubts = { 0 };
	const char *why;
	int done = EXIT_SUCCESS;

	if (!yield.n)
		die(EXIT_USAGE, "want --yield");
	in = fields_open(argv[first], NULL);
	while (fields_read(in, &r)) {
		const char *around = record_get(&r, "boundary");

		if (around && !strcmp(around, "periodic"))
			die(EXIT_RUN, "%s: record %ld is periodic: want free surfaces",
				fields_name(in), fields_count(in));
		if (press_given(&r, fields_name(in), fields_count(in)))
			done = EXIT_NOCONV;
		if (!cmd)
			cmd = opt_cmd(r.cmd, NULL);
		progress("surfaces", (double)surfaces, 0);
		take_record(in, &r, surfaces++);
		progress_within(1, 0);
	}
	progress_clear();
	status = surrogate_fit(sample, count, &s, &report);
	if (status == SURROGATE_FEW)
		die(EXIT_RUN,
			"%s: %ld surfaces with %zu particles are too few: want 100 that lose some",
			fields_name(in), surfaces, count);
	if (status == SURROGATE_MEMORY)
		die(EXIT_RUN, "out of memory");
	if (done != EXIT_SUCCESS)
		reasons_add(&doubts, "a contact did not converge");
	why = fields_doubted(in);
	if (why) {
		reasons_add(&doubts, why);
		done = EXIT_NOCONV;
	}
	surrogate_write(&s, &report, cmd, reasons_text(&doubts));
	note("of %ld surfaces held back the 90 %% interval holds the total volume of %ld; it "
	     "is off by %.3g rms",
		report.checked, report.within, report.rms);
	stats_set("surfaces", (double)surfaces);
	stats_set("particles", (double)count);
	stats_set("checked", (double)report.checked);
	stats_set("within", (double)report.within);
	stats_set("rms", report.rms);
	free(sample);
	free(seen);
	free(cmd);
	reasons_free(&doubts);
	record_free(&r);
	fields_close(in);
	return shell_done(done);
}
