#include "sensor_options.h"
#include "cli/msg.h"
#include <math.h>

static double rate = 10e3, flow = 1e-3, bore = 0.01, exponent = 7, spacing = 0.25;
static double zone = 0.4 / M_PI;       /* 10 ms at 60 L/min in 1 cm */
static double kappa = M_PI / 4 * 1e11; /* 1 V for 100 um there */
static double gain = 1, noise, snr = NAN, corner, common, drift, drift_time = 10;
static double mains_frequency = 50, pump_frequency = 2e3, mains_wander;
static double gain_drift, phase, phase_drift, saturation, event_level = NAN;
static double events[DISTURBANCES]; /* per second */
static int quadrature;
static int profile = PIPE_PLUG, shape;
static struct opt_list lag, mains, pump, coil;
static const char *const profiles[] = { "plug", "laminar", "turbulent", NULL };

struct opt sensors_rows[] = {
	OPT_HEADING("Pipe and sensors"),
	{ 'r', "rate", OPT_NUM, UNIT_FREQUENCY, &rate, 1, 2e9, "F", "sampling rate", 0,
		0 },
	{ 0, "flow", OPT_NUM, UNIT_FLOW, &flow, 1e-12, 1e3, "Q", "volume flow of the oil",
		0, 0 },
	{ 0, "bore", OPT_NUM, UNIT_LENGTH, &bore, 1e-6, 10, "D", "diameter of the pipe",
		0, 0 },
	{ 0, "profile", OPT_WORD, UNIT_NONE, &profile, 0, 0, "plug|laminar|turbulent",
		"velocity profile", profiles, 0 },
	{ 0, "exponent", OPT_NUM, UNIT_NONE, &exponent, 1, 100, "N",
		"exponent N of the turbulent profile (1 - r/R)^(1/N)", 0, 0 },
	{ 0, "spacing", OPT_NUM, UNIT_LENGTH, &spacing, 1e-6, 1e3, "D",
		"distance between the two sensors", 0, 0 },
	{ 0, "lag", OPT_LIST, UNIT_TIME, &lag, 0, 1e6, "A:B",
		"transit time exceeds that of the oil by A to B", 0, 0 },
	{ 0, "pulse", OPT_WORD, UNIT_NONE, &shape, 0, 0, PULSE_WORDS, "pulse shape",
		pulse_names + 1, 0 },
	{ 0, "zone", OPT_NUM, UNIT_LENGTH, &zone, 1e-9, 1e3, "L",
		"length of the sensing zone; duration of a pulse is L over the velocity",
		0, 0 },
	{ 0, "calibration", OPT_NUM, UNIT_NONE, &kappa, 1e-30, 1e30, "K",
		"peak voltage over velocity and diameter cubed, V s/m4", 0, 0 },
	{ 0, "coil", OPT_LIST, UNIT_ANY, &coil, 0, 1e30, "N,ND,I,MUR,L0,LF,AMP",
		"calibration from turns, exciting turns, current, permeability, paths, gain",
		0, 0 },
	{ 0, "gain", OPT_NUM, UNIT_NONE, &gain, 0, 1e9, "G",
		"ratio of the gains of sensor 2 and sensor 1", 0, 0 },
	{ 0, "gain-drift", OPT_NUM, UNIT_FRACTION, &gain_drift, 0, 1, "S",
		"rms relative variation of this gain", 0, 0 },
	{ 0, "phase", OPT_NUM, UNIT_ANGLE, &phase, -10, 10, "A",
		"phase of ferrous particles after demodulation", 0, 0 },
	{ 0, "phase-drift", OPT_NUM, UNIT_ANGLE, &phase_drift, 0, 10, "A",
		"rms variation of this phase", 0, 0 },
	{ 0, "quadrature", OPT_FLAG, UNIT_NONE, &quadrature, 0, 0, 0,
		"write four channels, in phase and in quadrature: I1 Q1 I2 Q2", 0, 0 },
	OPT_HEADING("Noise and interference"),
	{ 0, "noise", OPT_NUM, UNIT_VOLTAGE, &noise, 0, 1e9, "V", "rms noise of a sample",
		0, 0 },
	{ 0, "snr", OPT_NUM, UNIT_DECIBEL, &snr, -100, 400, "S",
		"peak of a 100 um particle over the rms of the noise, in dB", 0, 0 },
	{ 0, "corner", OPT_NUM, UNIT_FREQUENCY, &corner, 0, 1e12, "F",
		"corner frequency of a low-pass of the noise; 0: white", 0, 0 },
	{ 0, "common", OPT_NUM, UNIT_NONE, &common, -1, 1, "R",
		"correlation of the noise of both sensors", 0, 0 },
	{ 0, "drift", OPT_NUM, UNIT_VOLTAGE, &drift, 0, 1e9, "V",
		"rms drift of the base line", 0, 0 },
	{ 0, "drift-time", OPT_NUM, UNIT_TIME, &drift_time, 1e-9, 1e9, "T",
		"correlation time of the drift", 0, 0 },
	{ 0, "mains", OPT_LIST, UNIT_VOLTAGE, &mains, 0, 1e9, "V[,V3[,V5]]",
		"amplitudes of the mains and its odd harmonics", 0, 0 },
	{ 0, "mains-frequency", OPT_NUM, UNIT_FREQUENCY, &mains_frequency, 0, 1e9, "F",
		"mains frequency", 0, 0 },
	{ 0, "mains-wander", OPT_NUM, UNIT_FREQUENCY, &mains_wander, 0, 10, "F",
		"rms variation of the mains frequency", 0, 0 },
	{ 0, "pump", OPT_LIST, UNIT_VOLTAGE, &pump, 0, 1e9, "V[,V2]",
		"amplitudes of the pump line and its harmonics", 0, 0 },
	{ 0, "pump-frequency", OPT_NUM, UNIT_FREQUENCY, &pump_frequency, 0, 1e9, "F",
		"frequency of the pump line", 0, 0 },
	OPT_HEADING("Other events"),
	{ 0, "saturation", OPT_NUM, UNIT_VOLTAGE, &saturation, 0, 1e9, "V",
		"limit of the signal; 0: none", 0, 0 },
	{ 0, "bubbles", OPT_NUM, UNIT_FREQUENCY, &events[DISTURBANCE_BUBBLE], 0, 1e6, "F",
		"rate of air bubbles", 0, 0 },
	{ 0, "shocks", OPT_NUM, UNIT_FREQUENCY, &events[DISTURBANCE_SHOCK], 0, 1e6, "F",
		"rate of shocks to both sensors", 0, 0 },
	{ 0, "impulses", OPT_NUM, UNIT_FREQUENCY, &events[DISTURBANCE_IMPULSE], 0, 1e6,
		"F", "rate of spikes of one sample", 0, 0 },
	{ 0, "transients", OPT_NUM, UNIT_FREQUENCY, &events[DISTURBANCE_TRANSIENT], 0,
		1e6, "F", "rate of decaying steps at one sensor", 0, 0 },
	{ 0, "dropouts", OPT_NUM, UNIT_FREQUENCY, &events[DISTURBANCE_DROPOUT], 0, 1e6,
		"F", "rate of dropouts to zero", 0, 0 },
	{ 0, "event-level", OPT_NUM, UNIT_VOLTAGE, &event_level, 0, 1e9, "V",
		"mean level of these events (default the peak of 100 um)", 0, 0 },
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
	if (opt_given("exponent") && profile != PIPE_TURBULENT)
		die(EXIT_USAGE, "--exponent requires --profile turbulent");
	opt_require("mains", "mains-frequency mains-wander");
	opt_require("pump", "pump-frequency");
	if (coil.n && opt_given("calibration"))
		die(EXIT_USAGE, "--coil and --calibration exclude one another");
	if (coil.n && !(coil.v[3] >= 1 && coil.v[4] > 0 && coil.v[5] > coil.v[4]))
		die(EXIT_USAGE,
			"--coil: want a permeability of at least 1 and paths 0 < L0 < LF");
	if (opt_given("snr") && opt_given("noise"))
		die(EXIT_USAGE, "--noise and --snr exclude one another");
	if (corner > rate / 2)
		die(EXIT_USAGE, "--corner %g Hz is above half the rate, %g Hz", corner,
			rate / 2);
	if (rate * sensors_pulse() < 4)
		warn("--rate %g Hz: a pulse of %.3g s has fewer than four samples", rate,
			sensors_pulse());
	if (noise >= 1 && opt_given_bare("noise") && !coil.n && !opt_given("gain"))
		warn("--noise %g V: numbers without a unit are volts: is %gmV meant?",
			noise, noise);
	if (spacing > 10 && opt_given_bare("spacing"))
		warn("--spacing %g m: numbers without a unit are metres: is %gmm meant?",
			spacing, spacing);
	check_lines("mains", &mains, mains_frequency, 2);
	check_lines("pump", &pump, pump_frequency, 1);
}

double sensors_rate(void)
{
	return rate;
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

/* Peak voltage over velocity and diameter cubed, V s/m4. */
static double calibration(void)
{
	struct sensor_coil c = { coil.v[0], coil.v[1], coil.v[2], coil.v[3], coil.v[4],
		coil.v[5], zone };

	return coil.n ? coil.v[6] * sensor_kappa(&c, (enum pulse_shape)shape) : kappa;
}

double sensors_pulse(void)
{
	struct pipe pipe = sensors_pipe();

	return zone / pipe_mean_velocity(&pipe);
}

double sensors_drift_time(void)
{
	return drift_time;
}

int sensors_channels(void)
{
	return quadrature ? 4 : 2;
}

/* Peak voltage of 100 um with the oil. */
static double typical_peak(void)
{
	struct pipe pipe = sensors_pipe();

	return sensor_voltage(calibration(), pipe_mean_velocity(&pipe), 100e-6);
}

struct disturbances *sensors_disturbances(
	uint64_t seed, uint32_t realisation, double length)
{
	struct pipe pipe = sensors_pipe();
	double mean = pipe_mean_velocity(&pipe);
	struct disturbances_par par = { .seed = seed,
		.realisation = realisation,
		.level = isnan(event_level) ? typical_peak() : event_level,
		.duration = sensors_pulse(),
		.transit = spacing / mean,
		.sample = 1 / rate };
	struct disturbances *d;
	double any = 0;

	for (int kind = 0; kind < DISTURBANCES; kind++)
		any += par.rate[kind] = events[kind];
	if (any == 0)
		return NULL;
	if (isnan(length))
		die(EXIT_USAGE, "bubbles, shocks and other events require --duration");
	d = disturbances_new(&par);
	if (!d)
		die(EXIT_RUN, "no memory");
	return d;
}

static void add_lines(struct scene_par *par, const struct opt_list *level,
	double frequency, int step, int wanders)
{
	for (int i = 0; i < level->n; i++) {
		if (level->v[i] == 0)
			continue;
		par->line[par->nlines] = frequency * (1 + step * i);
		par->multiple[par->nlines] = wanders ? 1 + step * i : 0;
		par->line_level[par->nlines++] = level->v[i];
	}
}

struct scene *sensors_scene(uint64_t seed, uint32_t realisation)
{
	struct scene_par par = { .rate = rate,
		.shape = (enum pulse_shape)shape,
		.length = zone,
		.kappa = calibration(),
		.gain = gain,
		.seed = seed,
		.realisation = realisation,
		.noise = isnan(snr) ? noise : typical_peak() * pow(10, -snr / 20),
		.corner = corner,
		.common = common,
		.drift = drift,
		.drift_time = drift_time,
		.wander = mains_wander,
		.gain_drift = gain_drift,
		.phase = phase,
		.phase_drift = phase_drift,
		.saturation = saturation,
		.quadrature = quadrature };
	struct scene *scene;

	add_lines(&par, &mains, mains_frequency, 2, 1);
	add_lines(&par, &pump, pump_frequency, 1, 0);
	scene = scene_new(&par);
	if (!scene)
		die(EXIT_RUN, "no memory");
	return scene;
}
