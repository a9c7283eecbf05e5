/* sensorsim - the signal of wear particles in a pipe past two inductive sensors */
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/signals.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include "signal/passage.h"
#include "signal/scene.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 8192, COIL_VALUES = 7 };

static const double pi = 3.14159265358979323846;

static long seed = 1, first, number = -1, burst;
static double rate = 10e3, flow = 1e-3, bore = 0.01, exponent = 7, spacing = 0.25;
static double zone = 0.4 / 3.14159265358979323846;       /* 10 ms at 60 L/min in 1 cm */
static double kappa = 3.14159265358979323846 / 4 * 1e11; /* 1 V for 100 um there */
static double gain = 1, noise, snr = NAN, corner, common, drift, drift_time = 10;
static double mains_frequency = 50, pump_frequency = 2e3;
static double concentration = NAN, density = 3e3, duration = NAN, start = NAN;
static double span = NAN, gap, period = NAN;
static int profile = PIPE_PLUG, shape, by_volume, single;
static struct opt_list lag, mains, pump, uniform, coil;
static const char *truth;
static const char *const profiles[] = { "plug", "laminar", "turbulent", NULL };
static const char *const shapes[] = { "sine", "gauss", "lorentz", NULL };
static const char *const measures[] = { "diameter", "volume", NULL };

static const struct opt opts[] = {
	/* particles */
	{ 'u', "uniform", OPT_LIST, UNIT_LENGTH, &uniform, 1e-9, 1, "A:B",
		"draw particles with diameters from A to B instead of reading a table", 0,
		0 },
	{ 'y', "by", OPT_WORD, UNIT_NONE, &by_volume, 0, 0, "diameter|volume",
		"what --uniform makes uniform", measures, 0 },
	{ 'N', "number", OPT_INT, UNIT_COUNT, &number, 0, 1e15, "N", "particles to draw",
		0, 0 },
	{ 'C', "concentration", OPT_NUM, UNIT_CONCENTRATION, &concentration, 0, 1e4, "C",
		"draw a Poisson number of particles, C of mass in the oil", 0, 0 },
	{ 'D', "density", OPT_NUM, UNIT_DENSITY, &density, 1, 1e5, "RHO",
		"of the particles", 0, 0 },
	/* arrivals */
	{ 'd', "duration", OPT_NUM, UNIT_TIME, &duration, 0, 1e9, "T", "of the record", 0,
		0 },
	{ 'o', "start", OPT_NUM, UNIT_TIME, &start, -1e9, 1e9, "T",
		"when particles begin to arrive", 0, 0 },
	{ 'X', "span", OPT_NUM, UNIT_TIME, &span, 0, 1e9, "T",
		"time within which the particles of a burst arrive", 0, 0 },
	{ 'i', "gap", OPT_NUM, UNIT_TIME, &gap, 0, 1e9, "T",
		"least time between arrivals", 0, 0 },
	{ 'b', "burst", OPT_INT, UNIT_COUNT, &burst, 1, 1e9, "M", "particles of a burst",
		0, 0 },
	{ 't', "period", OPT_NUM, UNIT_TIME, &period, 0, 1e9, "T", "from burst to burst",
		0, 0 },
	/* pipe and sensors */
	{ 'r', "rate", OPT_NUM, UNIT_FREQUENCY, &rate, 1, 2e9, "F", "sampling rate", 0,
		0 },
	{ 'Q', "flow", OPT_NUM, UNIT_FLOW, &flow, 1e-12, 1e3, "Q", "of the oil", 0, 0 },
	{ 'B', "bore", OPT_NUM, UNIT_LENGTH, &bore, 1e-6, 10, "D", "diameter of the pipe",
		0, 0 },
	{ 'p', "profile", OPT_WORD, UNIT_NONE, &profile, 0, 0, "plug|laminar|turbulent",
		"velocity profile", profiles, 0 },
	{ 'e', "exponent", OPT_NUM, UNIT_NONE, &exponent, 1, 100, "N",
		"of the turbulent profile (1 - r/R)^(1/N)", 0, 0 },
	{ 'L', "spacing", OPT_NUM, UNIT_LENGTH, &spacing, 1e-6, 1e3, "D",
		"between the two sensors", 0, 0 },
	{ 'a', "lag", OPT_LIST, UNIT_TIME, &lag, 0, 1e6, "A:B",
		"transit takes longer than that of the oil by A to B", 0, 0 },
	{ 'w', "pulse", OPT_WORD, UNIT_NONE, &shape, 0, 0, "sine|gauss|lorentz",
		"pulse shape", shapes, 0 },
	{ 'l', "zone", OPT_NUM, UNIT_LENGTH, &zone, 1e-9, 1e3, "L",
		"of the sensing zone: a pulse lasts L over the velocity", 0, 0 },
	{ 'K', "calibration", OPT_NUM, UNIT_NONE, &kappa, 1e-30, 1e30, "K",
		"peak voltage over velocity and diameter cubed, V s/m4", 0, 0 },
	{ 'I', "coil", OPT_LIST, UNIT_ANY, &coil, 0, 1e30, "N,ND,I,MUR,L0,LF,AMP",
		"calibration by turns, exciting turns, current, permeability, paths, gain",
		0, 0 },
	{ 'g', "gain", OPT_NUM, UNIT_NONE, &gain, 0, 1e9, "G",
		"of sensor 2 over sensor 1", 0, 0 },
	/* disturbances */
	{ 'n', "noise", OPT_NUM, UNIT_VOLTAGE, &noise, 0, 1e9, "V",
		"rms noise of a sample", 0, 0 },
	{ 'R', "snr", OPT_NUM, UNIT_DECIBEL, &snr, -100, 400, "S",
		"noise by the peak of a 100 um particle over its rms", 0, 0 },
	{ 'k', "corner", OPT_NUM, UNIT_FREQUENCY, &corner, 0, 1e12, "F",
		"low-pass of the noise; 0: white", 0, 0 },
	{ 'q', "common", OPT_NUM, UNIT_NONE, &common, -1, 1, "R",
		"correlation of the noise of both sensors", 0, 0 },
	{ 'z', "drift", OPT_NUM, UNIT_VOLTAGE, &drift, 0, 1e9, "V",
		"rms drift of the base line", 0, 0 },
	{ 'Z', "drift-time", OPT_NUM, UNIT_TIME, &drift_time, 1e-9, 1e9, "T",
		"correlation time of the drift", 0, 0 },
	{ 'm', "mains", OPT_LIST, UNIT_VOLTAGE, &mains, 0, 1e9, "V,V3,V5",
		"amplitudes of the mains and its odd harmonics", 0, 0 },
	{ 'M', "mains-frequency", OPT_NUM, UNIT_FREQUENCY, &mains_frequency, 0, 1e9, "F",
		"of the mains", 0, 0 },
	{ 'P', "pump", OPT_LIST, UNIT_VOLTAGE, &pump, 0, 1e9, "V,V2",
		"amplitudes of the pump line and its harmonics", 0, 0 },
	{ 'U', "pump-frequency", OPT_NUM, UNIT_FREQUENCY, &pump_frequency, 0, 1e9, "F",
		"of the pump line", 0, 0 },
	/* output */
	{ 'T', "truth", OPT_TEXT, UNIT_NONE, &truth, 0, 0, "FILE",
		"write a table of the particles", 0, 0 },
	{ 's', "seed", OPT_INT, UNIT_COUNT, &seed, 0, 9e15, "N", "of the random numbers",
		0, 0 },
	{ 'f', "first", OPT_INT, UNIT_COUNT, &first, 0, 4e9, "K", "realisation to make",
		0, 0 },
	{ 'F', "single", OPT_FLAG, UNIT_NONE, &single, 0, 0, 0, "write 32-bit floats", 0,
		0 },
	OPT_END
};

static const struct prog prog = { "sensorsim",
	"Make the signal of wear particles that pass two inductive sensors.", "[file]",
	"table: diameter [time] [velocity], unless --uniform", "signal: two channels, V",
	opts };

/* Where particles come from: a table, or random numbers. */
struct source {
	struct stream stream;
	struct arrivals *arrivals; /* NULL: times stand in the table */
	struct table_in *table;    /* NULL: all is drawn, or was read into diameters */
	int c_time, c_diameter, c_velocity;
	double *diameters; /* of a table without times */
	uint64_t count;    /* particles handed out */
	char *cmd;         /* pipeline that made the table; NULL: none */
	double slowest;
};

static struct pipe make_pipe(void)
{
	return (struct pipe){ bore, flow, (enum pipe_profile)profile, exponent };
}

static void check_particles(int operands)
{
	if (uniform.n && (uniform.n != 2 || uniform.v[0] > uniform.v[1]))
		die(EXIT_USAGE, "--uniform needs two diameters A:B with A not above B");
	if (uniform.n && uniform.v[1] >= bore)
		die(EXIT_USAGE,
			"--uniform: a particle of %g m does not fit a bore of %g m",
			uniform.v[1], bore);
	if (uniform.n && operands)
		die(EXIT_USAGE, "--uniform draws the particles: no file to read");
	if (uniform.n && (number >= 0) + !isnan(concentration) != 1)
		die(EXIT_USAGE, "--uniform needs --number or --concentration");
	if (!uniform.n && (number >= 0 || !isnan(concentration)))
		die(EXIT_USAGE, "--number and --concentration need --uniform");
	if (burst > 0 && (isnan(span) || isnan(period)))
		die(EXIT_USAGE, "--burst needs --span and --period");
	if (burst > 0 && !isnan(concentration))
		die(EXIT_USAGE, "--burst and --concentration exclude each other");
	if (burst > 0 && period < span + gap)
		die(EXIT_USAGE, "--period %g s is shorter than --span and --gap", period);
	if (lag.n && (lag.n != 2 || lag.v[0] > lag.v[1]))
		die(EXIT_USAGE, "--lag needs two times A:B with A not above B");
}

static void check_sensors(void)
{
	if (rate != floor(rate))
		die(EXIT_USAGE, "--rate: AU wants whole hertz, not %g", rate);
	if (coil.n && coil.n != COIL_VALUES)
		die(EXIT_USAGE, "--coil needs %d values", COIL_VALUES);
	if (coil.n && opt_given('K'))
		die(EXIT_USAGE, "--coil and --calibration exclude each other");
	if (coil.n && !(coil.v[3] >= 1 && coil.v[4] > 0 && coil.v[5] > coil.v[4]))
		die(EXIT_USAGE,
			"--coil: want a permeability of at least 1 and paths 0 < L0 < LF");
	if (opt_given('R') && opt_given('n'))
		die(EXIT_USAGE, "--noise and --snr exclude each other");
	if (corner > rate / 2)
		die(EXIT_USAGE, "--corner %g Hz is above half the rate", corner);
}

/* Time from the first trace of a pulse to its centre. */
static double half_pulse(double velocity)
{
	return pulse_reach((enum pulse_shape)shape) * zone / velocity;
}

static double calibration(void)
{
	struct sensor_coil c = { coil.v[0], coil.v[1], coil.v[2], coil.v[3], coil.v[4],
		coil.v[5], zone };

	return coil.n ? coil.v[6] * sensor_kappa(&c, (enum pulse_shape)shape) : kappa;
}

/* Particles per second: flow times concentration over mean mass. */
static double particle_rate(void)
{
	double a = uniform.v[0], b = uniform.v[1];
	double cube =
		by_volume ? (a * a * a + b * b * b) / 2 : (a + b) * (a * a + b * b) / 4;

	return isnan(concentration) ? 0
				    : flow * concentration / (density * pi / 6 * cube);
}

/* When and how many: the window leaves room for whole pulses at both sensors. */
static void make_arrivals(struct source *s, uint64_t n)
{
	double mean = pipe_mean_velocity(&s->stream.pipe), half = half_pulse(mean);
	double room = half + spacing / mean + s->stream.lag[1];
	double begin = isnan(start) ? half : start;
	double window = isnan(span) ? duration - begin - room : span;
	struct arrivals_par par = { (uint64_t)seed, (uint32_t)first, particle_rate(), n,
		(uint64_t)burst, begin, burst ? period : 0, window, gap };
	double most = burst ? (double)burst : (double)n;

	if (isnan(window))
		die(EXIT_USAGE, "particles without times need --duration or --span");
	if (window < 0 || (par.rate == 0 && most * gap > window + gap * (1 + 1e-9)))
		die(EXIT_USAGE, "%s leaves no room for the particles",
			isnan(span) ? "--duration" : "--span");
	if (par.rate * gap > 1)
		die(EXIT_USAGE,
			"--gap %g s is above the mean time between particles, %g s", gap,
			1 / par.rate);
	s->arrivals = arrivals_new(&par);
	if (!s->arrivals)
		die(EXIT_RUN, "no memory");
}

static double read_diameter(const struct source *s)
{
	double d = table_number(s->table, s->c_diameter);

	if (!(d > 0 && d < bore))
		die(EXIT_RUN,
			"%s: line %ld: diameter %g m, want above 0 and below the bore, "
			"%g m",
			table_name(s->table), table_line(s->table), d, bore);
	return d;
}

/* A table without times is read whole; its particles arrive in the order of the rows. */
static void read_diameters(struct source *s)
{
	uint64_t n = 0, room = 0;

	while (table_next(s->table)) {
		if (n == room) {
			room = room ? 2 * room : 1024;
			s->diameters = xrealloc(s->diameters, room, sizeof *s->diameters);
		}
		s->diameters[n++] = read_diameter(s);
	}
	table_close(s->table);
	s->table = NULL;
	make_arrivals(s, n);
}

static void open_source(struct source *s, const char *path)
{
	*s = (struct source){ 0 };
	s->stream = (struct stream){ (uint64_t)seed, (uint32_t)first, make_pipe(),
		spacing, { lag.v[0], lag.v[1] }, { uniform.v[0], uniform.v[1] },
		by_volume };
	s->slowest = passage_slowest(&s->stream);
	if (s->slowest < 0.01 * pipe_mean_velocity(&s->stream.pipe))
		die(EXIT_USAGE, "--lag makes particles slower than 1 %% of the oil");
	if (uniform.n) {
		make_arrivals(s, number >= 0 ? (uint64_t)number : UINT64_MAX);
		return;
	}
	s->table = table_open(path);
	s->cmd = table_key(s->table, "cmd") ? xstrdup(table_key(s->table, "cmd")) : NULL;
	s->c_diameter = table_need(s->table, "diameter");
	s->c_velocity = table_find(s->table, "velocity");
	s->c_time = table_find(s->table, "time");
	if (s->c_time < 0)
		s->c_time = table_find(s->table, "time1");
	if (s->c_velocity >= 0)
		s->slowest = 0.01 * pipe_mean_velocity(&s->stream.pipe);
	if (s->c_time < 0)
		read_diameters(s);
}

static int next_row(struct source *s, struct passage *p)
{
	struct table_in *t = s->table;
	double before = p->time[0];

	if (!table_next(t))
		return 0;
	p->diameter = read_diameter(s);
	p->time[0] = table_number(t, s->c_time);
	if (!(fabs(p->time[0]) <= 1e9) || (s->count && p->time[0] < before))
		die(EXIT_RUN,
			"%s: line %ld: time %g s, want times in order, up to 1e9 s (before: %g s)",
			table_name(t), table_line(t), p->time[0], before);
	passage_carry(&s->stream, s->count, p);
	if (s->c_velocity < 0)
		return 1;
	p->velocity = table_number(t, s->c_velocity);
	if (!(p->velocity >= s->slowest && isfinite(p->velocity)))
		die(EXIT_RUN,
			"%s: line %ld: velocity %g m/s, want at least 1 %% of the oil's, "
			"%g m/s",
			table_name(t), table_line(t), p->velocity, s->slowest);
	p->time[1] = p->time[0] + spacing / p->velocity;
	p->radius = NAN;
	return 1;
}

/* The next particle in order of arrival at sensor 1; 0 at the end. */
static int next_particle(struct source *s, struct passage *p)
{
	if (s->table) {
		if (!next_row(s, p))
			return 0;
	} else if (!arrivals_next(s->arrivals, &p->time[0])) {
		return 0;
	} else if (s->diameters) {
		p->diameter = s->diameters[s->count];
		passage_carry(&s->stream, s->count, p);
	} else {
		passage_draw(&s->stream, s->count, p);
	}
	s->count++;
	return 1;
}

static void close_source(struct source *s)
{
	if (s->table)
		table_close(s->table);
	arrivals_free(s->arrivals);
	free(s->diameters);
}

static void put_truth(
	struct table_out *t, uint64_t particle, const struct passage *p, double k)
{
	const double row[] = { (double)particle, p->time[0], p->time[1], p->diameter,
		sensor_voltage(k, p->velocity, p->diameter), p->time[1] - p->time[0],
		p->velocity, pi / 6 * p->diameter * p->diameter * p->diameter,
		p->radius };

	for (size_t i = 0; i < sizeof row / sizeof *row; i++)
		table_put(t, row[i]);
	table_end_row(t);
}

static void add_lines(
	struct scene_par *par, const struct opt_list *level, double frequency, int step)
{
	for (int i = 0; i < level->n; i++) {
		double f = frequency * (1 + step * i);

		if (level->v[i] == 0)
			continue;
		if (f > rate / 2)
			die(EXIT_USAGE, "a line at %g Hz is above half the rate, %g Hz",
				f, rate);
		if (par->nlines == SCENE_LINES_MAX)
			die(EXIT_USAGE, "more than %d lines", SCENE_LINES_MAX);
		par->line[par->nlines] = f;
		par->line_level[par->nlines++] = level->v[i];
	}
}

static struct scene *make_scene(void)
{
	struct pipe pipe = make_pipe();
	double k = calibration();
	double peak = sensor_voltage(k, pipe_mean_velocity(&pipe), 100e-6);
	struct scene_par par = { .rate = rate,
		.shape = (enum pulse_shape)shape,
		.length = zone,
		.kappa = k,
		.gain = gain,
		.seed = (uint64_t)seed,
		.realisation = (uint32_t)first,
		.noise = isnan(snr) ? noise : peak * pow(10, -snr / 20),
		.corner = corner,
		.common = common,
		.drift = drift,
		.drift_time = drift_time };
	struct scene *scene;

	add_lines(&par, &mains, mains_frequency, 2);
	add_lines(&par, &pump, pump_frequency, 1);
	scene = scene_new(&par);
	if (!scene)
		die(EXIT_RUN, "no memory");
	return scene;
}

/* Frames of the next piece: a whole one, or what is left of the record. */
static size_t piece(const struct scene *scene, double frames, int more)
{
	double left = (isnan(duration) ? scene_end(scene) : duration) * rate;

	left = (isnan(duration) ? ceil(left) : round(left)) - frames;
	if ((isnan(duration) && more) || left > BLOCK)
		return BLOCK;
	return left > 0 ? (size_t)left : 0;
}

static struct table_out *create_truth(const char *cmd)
{
	const char *path = strcmp(truth, "-") == 0 ? NULL : truth;

	return table_create(path, opt_cmd(cmd, NULL), "1 s s m V s m/s m3 m",
		"particle time1 time2 diameter amplitude delay velocity volume radius");
}

/* The next particle whose pulse at sensor 1 begins before the record ends. */
static int next_seen(struct source *s, struct passage *p)
{
	while (next_particle(s, p)) {
		if (isnan(duration) || p->time[0] - half_pulse(p->velocity) < duration)
			return 1;
		if (p->time[0] - half_pulse(s->slowest) >= duration)
			return 0;
	}
	return 0;
}

static void run(struct source *source, struct table_out *t, struct signal_out *out)
{
	static double x[2 * BLOCK];
	double half = half_pulse(source->slowest), frames = 0, k = calibration(),
	       particles = 0;
	struct scene *scene = make_scene();
	struct passage p = { { 0 }, 0, 0, 0 };
	int more = next_seen(source, &p);
	size_t n;

	do {
		for (; more && p.time[0] - half <= (frames + BLOCK) / rate;
			more = next_seen(source, &p)) {
			if (!scene_pass(scene, &p))
				die(EXIT_RUN, "no memory");
			if (t)
				put_truth(t, source->count - 1, &p, k);
			particles++;
		}
		n = piece(scene, frames, more);
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
	struct signal_format format = { .rate = (long)rate,
		.channels = 2,
		.single = single,
		.units = (char[]){ "V V" } };
	struct passage p = { { 0 }, 0, 0, 0 };
	struct source source;
	struct table_out *table = NULL;

	check_particles(argc - i);
	check_sensors();
	open_source(&source, argv[i]);
	if (truth)
		table = create_truth(source.cmd);
	if (truth && strcmp(truth, "-") == 0) {
		while (next_seen(&source, &p))
			put_truth(table, source.count - 1, &p, calibration());
	} else {
		struct signal_out *out;

		format.seed = xprintf("%ld", seed);
		format.cmd = opt_cmd(source.cmd, NULL);
		out = signal_create(NULL, &format);
		run(&source, table, out);
		signal_done(out);
	}
	if (table)
		table_done(table);
	close_source(&source);
	return shell_done(0);
}
