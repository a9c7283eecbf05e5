#include "sensor_options.h"
#include "cli/msg.h"
#include <math.h>

static double rate = 10e3, flow = 1e-3, bore = 0.01, exponent = 7, spacing = 0.25;
static double zone = 0.4 / M_PI;       /* 10 ms at 60 L/min in 1 cm */
static double kappa = M_PI / 4 * 1e11; /* 1 V for 100 um there */
static double gain = 1, noise, snr = NAN, corner, common, drift, drift_time = 10;
static double mains_frequency = 50, pump_frequency = 2e3;
static int profile = PIPE_PLUG, shape;
static struct opt_list lag, mains, pump, coil;
static const char *const profiles[] = { "plug", "laminar", "turbulent", NULL };
static const char *const shapes[] = { "sine", "gauss", "lorentz", NULL };

struct opt sensors_rows[] = {
	{ 'r', "rate", OPT_NUM, UNIT_FREQUENCY, &rate, 1, 2e9, "F", "sampling rate", 0,
		0 },
	{ 0, "flow", OPT_NUM, UNIT_FLOW, &flow, 1e-12, 1e3, "Q", "of the oil", 0, 0 },
	{ 0, "bore", OPT_NUM, UNIT_LENGTH, &bore, 1e-6, 10, "D", "diameter of the pipe",
		0, 0 },
	{ 0, "profile", OPT_WORD, UNIT_NONE, &profile, 0, 0, "plug|laminar|turbulent",
		"velocity profile", profiles, 0 },
	{ 0, "exponent", OPT_NUM, UNIT_NONE, &exponent, 1, 100, "N",
		"of the turbulent profile (1 - r/R)^(1/N)", 0, 0 },
	{ 0, "spacing", OPT_NUM, UNIT_LENGTH, &spacing, 1e-6, 1e3, "D",
		"between the two sensors", 0, 0 },
	{ 0, "lag", OPT_LIST, UNIT_TIME, &lag, 0, 1e6, "A:B",
		"transit takes longer than that of the oil by A to B", 0, 0 },
	{ 0, "pulse", OPT_WORD, UNIT_NONE, &shape, 0, 0, "sine|gauss|lorentz",
		"pulse shape", shapes, 0 },
	{ 0, "zone", OPT_NUM, UNIT_LENGTH, &zone, 1e-9, 1e3, "L",
		"of the sensing zone: a pulse lasts L over the velocity", 0, 0 },
	{ 0, "calibration", OPT_NUM, UNIT_NONE, &kappa, 1e-30, 1e30, "K",
		"peak voltage over velocity and diameter cubed, V s/m4", 0, 0 },
	{ 0, "coil", OPT_LIST, UNIT_ANY, &coil, 0, 1e30, "N,ND,I,MUR,L0,LF,AMP",
		"calibration by turns, exciting turns, current, permeability, paths, gain",
		0, 0 },
	{ 0, "gain", OPT_NUM, UNIT_NONE, &gain, 0, 1e9, "G", "of sensor 2 over sensor 1",
		0, 0 },
	/* disturbances */
	{ 0, "noise", OPT_NUM, UNIT_VOLTAGE, &noise, 0, 1e9, "V", "rms noise of a sample",
		0, 0 },
	{ 0, "snr", OPT_NUM, UNIT_DECIBEL, &snr, -100, 400, "S",
		"noise by the peak of a 100 um particle over its rms", 0, 0 },
	{ 0, "corner", OPT_NUM, UNIT_FREQUENCY, &corner, 0, 1e12, "F",
		"low-pass of the noise; 0: white", 0, 0 },
	{ 0, "common", OPT_NUM, UNIT_NONE, &common, -1, 1, "R",
		"correlation of the noise of both sensors", 0, 0 },
	{ 0, "drift", OPT_NUM, UNIT_VOLTAGE, &drift, 0, 1e9, "V",
		"rms drift of the base line", 0, 0 },
	{ 0, "drift-time", OPT_NUM, UNIT_TIME, &drift_time, 1e-9, 1e9, "T",
		"correlation time of the drift", 0, 0 },
	{ 0, "mains", OPT_LIST, UNIT_VOLTAGE, &mains, 0, 1e9, "V[,V3[,V5]]",
		"amplitudes of the mains and its odd harmonics", 0, 0 },
	{ 0, "mains-frequency", OPT_NUM, UNIT_FREQUENCY, &mains_frequency, 0, 1e9, "F",
		"of the mains", 0, 0 },
	{ 0, "pump", OPT_LIST, UNIT_VOLTAGE, &pump, 0, 1e9, "V[,V2]",
		"amplitudes of the pump line and its harmonics", 0, 0 },
	{ 0, "pump-frequency", OPT_NUM, UNIT_FREQUENCY, &pump_frequency, 0, 1e9, "F",
		"of the pump line", 0, 0 },
	OPT_END,
};

struct pipe sensors_pipe(void)
{
	return (struct pipe){ bore, flow, (enum pipe_profile)profile, exponent };
}

/* Lines at a frequency and its multiples, step apart. */
static void check_lines(
	const char *word, const struct opt_list *level, double frequency, int step)
{
	for (int i = 0; i < level->n; i++) {
		double f = frequency * (1 + step * i);

		if (level->v[i] > 0 && f > rate / 2)
			die(EXIT_USAGE,
				"--%s: a line at %g Hz is above half the rate, %g Hz",
				word, f, rate / 2);
	}
}

void sensors_check(void)
{
	if (lag.n && lag.v[0] > lag.v[1])
		die(EXIT_USAGE, "--lag: want A:B with A not above B");
	if (rate != floor(rate))
		die(EXIT_USAGE, "--rate: AU wants whole hertz, not %g", rate);
	if (coil.n && opt_given("calibration"))
		die(EXIT_USAGE, "--coil and --calibration exclude each other");
	if (coil.n && !(coil.v[3] >= 1 && coil.v[4] > 0 && coil.v[5] > coil.v[4]))
		die(EXIT_USAGE,
			"--coil: want a permeability of at least 1 and paths 0 < L0 < LF");
	if (opt_given("snr") && opt_given("noise"))
		die(EXIT_USAGE, "--noise and --snr exclude each other");
	if (corner > rate / 2)
		die(EXIT_USAGE, "--corner %g Hz is above half the rate, %g Hz", corner,
			rate / 2);
	check_lines("mains", &mains, mains_frequency, 2);
	check_lines("pump", &pump, pump_frequency, 1);
}

long sensors_rate(void)
{
	return (long)rate;
}

struct stream sensors_stream(uint64_t seed, uint32_t realisation)
{
	return (struct stream){ .seed = seed,
		.realisation = realisation,
		.pipe = sensors_pipe(),
		.spacing = spacing,
		.lag = { lag.v[0], lag.v[1] } };
}

double sensors_half_pulse(double velocity)
{
	return pulse_reach((enum pulse_shape)shape) * zone / velocity;
}

double sensors_calibration(void)
{
	struct sensor_coil c = { coil.v[0], coil.v[1], coil.v[2], coil.v[3], coil.v[4],
		coil.v[5], zone };

	return coil.n ? coil.v[6] * sensor_kappa(&c, (enum pulse_shape)shape) : kappa;
}

static void add_lines(
	struct scene_par *par, const struct opt_list *level, double frequency, int step)
{
	for (int i = 0; i < level->n; i++) {
		if (level->v[i] == 0)
			continue;
		par->line[par->nlines] = frequency * (1 + step * i);
		par->line_level[par->nlines++] = level->v[i];
	}
}

struct scene *sensors_scene(uint64_t seed, uint32_t realisation)
{
	struct pipe pipe = sensors_pipe();
	double k = sensors_calibration();
	double peak = sensor_voltage(k, pipe_mean_velocity(&pipe), 100e-6);
	struct scene_par par = { .rate = rate,
		.shape = (enum pulse_shape)shape,
		.length = zone,
		.kappa = k,
		.gain = gain,
		.seed = seed,
		.realisation = realisation,
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
