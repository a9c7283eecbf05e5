/* sensorsim - the signal of wear particles in a pipe past two inductive sensors */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "io/signals.h"
#include "io/tables.h"
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
	OPT_TABLE(sensors_rows),
	{ 0, "truth", OPT_TEXT, UNIT_NONE, &truth, 0, 0, "FILE",
		"write a table of the particles", 0, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "of the random numbers",
		0, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 4e9, "K", "realisation to make",
		0, 0 },
	{ 0, "single", OPT_FLAG, UNIT_NONE, &single, 0, 0, 0, "write 32-bit floats", 0,
		0 },
	OPT_END,
};

static const struct prog prog = { "sensorsim",
	"Make the signal of wear particles that pass two inductive sensors.", "[file]",
	"table: diameter [time] [velocity], unless --uniform", "signal: two channels, V",
	opts };

static void put_truth(
	struct table_out *t, uint64_t particle, const struct passage *p, double k)
{
	const double row[] = { (double)particle, p->time[0], p->time[1], p->diameter,
		sensor_voltage(k, p->velocity, p->diameter), p->time[1] - p->time[0],
		p->velocity, M_PI / 6 * p->diameter * p->diameter * p->diameter,
		p->radius };

	table_put_row(t, row, (int)(sizeof row / sizeof *row));
}

/* Frames of the next piece: a whole one, or what is left of the record. */
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
	const char *path = strcmp(truth, "-") == 0 ? NULL : truth;

	return table_create(path, opt_cmd(cmd, NULL), "1 s s m V s m/s m3 m",
		"particle time1 time2 diameter amplitude delay velocity volume radius");
}

static void run(struct source *source, struct table_out *t, struct signal_out *out)
{
	static double x[2 * BLOCK];
	double half = sensors_half_pulse(source_slowest(source));
	double rate = (double)sensors_rate(), k = sensors_calibration();
	double frames = 0, particles = 0;
	struct scene *scene = sensors_scene((uint64_t)seed, (uint32_t)first);
	struct passage p = { { 0 }, 0, 0, 0 };
	int more = source_next(source, &p);
	size_t n;

	do {
		for (; more && p.time[0] - half <= (frames + BLOCK) / rate;
			more = source_next(source, &p)) {
			if (!scene_pass(scene, &p))
				die(EXIT_RUN, "no memory");
			if (t)
				put_truth(t, source_count(source) - 1, &p, k);
			particles++;
		}
		n = piece(scene, rate, frames, more);
		scene_next(scene, x, n);
		signal_write(out, x, n);
		frames += (double)n;
		stats_max("particles_pending", (double)scene_pending(scene));
	} while (n > 0);
	stats_set("frames", frames);
	stats_set("particles", particles);
	stats_set("pulse_samples", scene_touched(scene));
	stats_set(
		"pulse_samples_left_out", 2 * frames * particles - scene_touched(scene));
	scene_free(scene);
}

int main(int argc, char **argv)
{
	int i = opt_parse(&prog, argc, argv);
	struct signal_format format = { .rate = sensors_rate(),
		.channels = 2,
		.single = single,
		.units = (char[]){ "V V" } };
	struct passage p = { { 0 }, 0, 0, 0 };
	struct source *source;
	struct table_out *table = NULL;

	source_check(argc - i);
	sensors_check();
	source = source_open(argv[i], (uint64_t)seed, (uint32_t)first);
	if (truth)
		table = create_truth(source_cmd(source));
	if (truth && strcmp(truth, "-") == 0) {
		while (source_next(source, &p))
			put_truth(table, source_count(source) - 1, &p,
				sensors_calibration());
	} else {
		struct signal_out *out;

		format.seed = xprintf("%ld", seed);
		format.cmd = opt_cmd(source_cmd(source), NULL);
		out = signal_create(NULL, &format);
		run(source, table, out);
		signal_done(out);
	}
	if (table)
		table_done(table);
	source_close(source);
	return shell_done(0);
}
