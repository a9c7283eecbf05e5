/* sensorsim - the signal of wear particles in a pipe past two inductive sensors */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/progress.h"
#include "cli/stats.h"
#include "io/signals.h"
#include "io/tables.h"
#include "material_options.h"
#include "particle_source.h"
#include "sensor_options.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 8192 };

static long seed = 1, first;
static int single;
static const char *truth;

static const struct opt opts[] = {
	OPT_TABLE(source_rows),
	OPT_TABLE(material_rows),
	OPT_TABLE(sensors_rows),
	OPT_HEADING("Output"),
	{ 0, "truth", OPT_TEXT, UNIT_NONE, &truth, 0, 0, "FILE",
		"write a table of the particles and other events", 0, 1 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N",
		"seed of the random numbers", 0, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 4e9, "K",
		"number of the realisation", 0, 0 },
	{ 0, "single", OPT_FLAG, UNIT_NONE, &single, 0, 0, 0, "write 32-bit floats", 0,
		0 },
	OPT_END,
};

static const struct prog prog = { "sensorsim",
	"Simulate the signal of wear particles that pass two inductive sensors.",
	"[file]", "table: diameter [time] [velocity], unless --uniform",
	"signal: two or four channels, V", opts };

/* Particles and other events, in order of time1. */
struct traffic {
	struct source *source;
	struct disturbances *disturbances; /* NULL: none */
	struct scene *scene;
	struct passage particle;
	struct disturbance event;
	int particles, events; /* whether there is a next one */
	double count;
};

static void next_particle(struct traffic *f)
{
	f->particles = source_next(f->source, &f->particle);
}

static void next_event(struct traffic *f)
{
	f->events = f->disturbances && disturbances_next(f->disturbances, &f->event) &&
		    f->event.time[0] < source_duration;
}

static int is_particle_next(const struct traffic *f)
{
	return f->particles && (!f->events || f->particle.time[0] <= f->event.time[0]);
}

static void put_row(struct table_out *t, const double *row, int n, const char *material,
	const char *kind)
{
	for (int i = 0; i < n; i++)
		table_put(t, row[i]);
	table_put_text(t, material);
	table_put_text(t, kind);
	table_end_row(t);
}

static void put_particle(struct table_out *t, struct traffic *f)
{
	const struct passage *p = &f->particle;
	double d = p->diameter, peak[2];
	int saturated = scene_receive(f->scene, p, peak);
	const double row[] = { (double)(source_count(f->source) - 1), p->time[0],
		p->time[1], d, peak[0], p->time[1] - p->time[0], p->velocity,
		M_PI / 6 * d * d * d, p->radius, peak[1], atan2(peak[1], peak[0]),
		saturated };

	put_row(t, row, (int)(sizeof row / sizeof *row), source_material(f->source),
		"particle");
}

static void put_event(struct table_out *t, const struct disturbance *e)
{
	const double row[] = { NAN, e->time[0], e->time[1], NAN, e->level[0],
		e->time[1] - e->time[0], NAN, NAN, NAN, NAN, NAN, NAN };

	put_row(t, row, (int)(sizeof row / sizeof *row), "none",
		disturbance_names[e->kind]);
}

/* Passes the events with a time1 before the given one to the scene, unless only the truth
 * is wanted, and to the truth, unless NULL. */
static void pass_traffic(
	struct traffic *f, double before, int truth_alone, struct table_out *t)
{
	enum num_status status = NUM_OK;

	for (;;) {
		if (is_particle_next(f) && f->particle.time[0] <= before) {
			if (t)
				put_particle(t, f);
			if (!truth_alone)
				status = scene_pass(f->scene, &f->particle);
			f->count++;
			next_particle(f);
		} else if (!is_particle_next(f) && f->events &&
			   f->event.time[0] <= before) {
			if (t)
				put_event(t, &f->event);
			if (!truth_alone)
				status = scene_disturb(f->scene, &f->event);
			next_event(f);
		} else {
			return;
		}
		if (status != NUM_OK)
			die(EXIT_RUN, "no memory");
	}
}

/* Frames of the next piece: a complete one, or the rest of the record. */
static size_t piece(const struct scene *scene, double rate, double frames, int more)
{
	int open_ended = isnan(source_duration);
	double end = (open_ended ? scene_end(scene) : source_duration) * rate;
	double left = (open_ended ? ceil(end) : round(end)) - frames;

	if ((open_ended && more) || left > BLOCK)
		return BLOCK;
	return left > 0 ? (size_t)left : 0;
}

static struct table_out *create_truth(const char *cmd)
{
	int alone = strcmp(truth, "-") == 0;
	char *rebuild =
		opt_cmd(cmd, alone ? "--truth -" : "--truth /dev/fd/3 3>&1 >/dev/null");
	struct table_out *t = table_create(alone ? NULL : truth, rebuild,
		"1 s s m V s m/s m3 m V rad 1 1 1",
		"particle time1 time2 diameter amplitude delay velocity volume radius "
		"quadrature phase saturated material kind");

	free(rebuild);
	return t;
}

static void run(struct traffic *f, struct table_out *t, struct signal_out *out)
{
	static double x[4 * BLOCK];
	double rate = sensors_rate(), frames = 0;
	/* An event begins at most this long before its time1. */
	double ahead =
		fmax(sensors_half_pulse(source_slowest(f->source)), 2 * sensors_pulse());
	size_t n;

	do {
		pass_traffic(f, (frames + BLOCK) / rate + ahead, 0, t);
		n = piece(f->scene, rate, frames, f->particles);
		scene_next(f->scene, x, n);
		signal_write(out, x, n);
		frames += (double)n;
		if (!isnan(source_duration))
			progress("s", frames / rate, source_duration);
		stats_max("particles_pending", (double)scene_pending(f->scene));
	} while (n > 0);
	stats_set("frames", frames);
	stats_set("particles", f->count);
	stats_set("pulse_samples", scene_touched(f->scene));
	stats_set("pulse_samples_left_out",
		2 * frames * f->count - scene_touched(f->scene));
}

int main(int argc, char **argv)
{
	int i = opt_parse(&prog, argc, argv);
	struct signal_format format = { .rate = sensors_rate(), .single = single };
	struct traffic f = { 0 };
	struct table_out *table = NULL;
	const char *doubt;

	source_check(argc - i);
	sensors_check();
	material_check();
	f.source = source_open(argv[i], (uint64_t)seed, (uint32_t)first);
	f.scene = sensors_scene((uint64_t)seed, (uint32_t)first);
	f.disturbances =
		sensors_disturbances((uint64_t)seed, (uint32_t)first, source_duration);
	next_particle(&f);
	next_event(&f);
	if (truth)
		table = create_truth(source_cmd(f.source));
	if (truth && strcmp(truth, "-") == 0) {
		pass_traffic(&f, INFINITY, 1, table);
	} else {
		struct signal_out *out;
		char *number, *cmd, *why = NULL;

		format.channels = sensors_channels();
		format.units = format.channels == 4 ? "V V V V" : "V V";
		format.seed = number = xprintf("%ld", seed);
		format.cmd = cmd = opt_cmd(source_cmd(f.source), NULL);
		if (source_doubt(f.source))
			format.doubt = why = xstrdup(source_doubt(f.source));
		out = signal_create(NULL, &format);
		run(&f, table, out);
		signal_done(out);
		free(number);
		free(cmd);
		free(why);
	}
	doubt = source_doubted(f.source);
	if (table && doubt)
		table_comment(table, "doubtful", "%s", doubt);
	if (table)
		table_done(table);
	scene_free(f.scene);
	disturbances_free(f.disturbances);
	source_close(f.source);
	return shell_done(doubt ? EXIT_NOCONV : EXIT_SUCCESS);
}
