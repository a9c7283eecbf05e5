/* duet - wear particles from the record of two inductive sensors */
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "components.h"
#include "instrument_options.h"
#include "io/input.h"
#include "io/signals.h"
#include "methods.h"
#include "whole_record.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { METHOD_FIT, METHOD_DUET, METHOD_COUNT };

static int method = METHOD_FIT;
static long window = 64, hop, sensor = 1;
static struct opt_choice sources = { 0, 0 };
static double kappa = M_PI / 4 * 1e11; /* as sensorsim(1) */
static double spacing = 0.25, learn = NAN, latency = NAN, floor_height = NAN;
static const char *instrument_file;
static const char *separated, *histogram, *sections, *detectable;
static const char *const methods[] = { "fit", "duet", "count", NULL };
static const char *const automatic[] = { "auto", NULL };

static const struct opt opts[] = { OPT_HEADING("Method"),
	{ 0, "method", OPT_WORD, UNIT_NONE, &method, 0, 0, "fit|duet|count",
		"joint fit of all pulses, time-frequency masks, or counted peaks",
		methods, 0 },
	{ 0, "align", OPT_CHOICE, UNIT_TIME, &instrument.align, 0, 1e9, "auto|T",
		"time from sensor 1 to sensor 2 of the mean particle", automatic, 0 },
	{ 0, "spacing", OPT_NUM, UNIT_LENGTH, &spacing, 1e-6, 1e3, "D",
		"distance between the two sensors", 0, 0 },
	{ 0, "calibration", OPT_NUM, UNIT_NONE, &kappa, 1e-30, 1e30, "K",
		"peak voltage over velocity and diameter cubed, V s/m4", 0, 0 },
	{ 0, "sources", OPT_CHOICE, UNIT_COUNT, &sources, 1, 16, "auto|N",
		"particles in each section", automatic, 0 },
	OPT_TABLE(instrument_rows), OPT_TABLE(component_rows),
	{ 0, "instrument", OPT_TEXT, UNIT_NONE, &instrument_file, 0, 0, "FILE",
		"use the instrument kept in FILE; if there is none, learn and keep it", 0,
		0 },
	OPT_HEADING("Working on the record"),
	{ 0, "learn", OPT_NUM, UNIT_TIME, &learn, 0, 1e9, "T",
		"start of the record that the instrument is learned from", 0, 0 },
	{ 0, "latency", OPT_NUM, UNIT_TIME, &latency, 0, 1e9, "T",
		"hold back no more than T of signal", 0, 0 },
	{ 0, "window", OPT_INT, UNIT_COUNT, &window, 4, 1e6, "N",
		"samples of a Hamming window (duet; more for longer pulses)", 0, 0 },
	{ 0, "hop", OPT_INT, UNIT_COUNT, &hop, 1, 1e6, "N",
		"samples from window to window (duet; half the window)", 0, 0 },
	{ 0, "sensor", OPT_INT, UNIT_COUNT, &sensor, 1, 2, "N",
		"channel to count on (count)", 0, 0 },
	{ 0, "floor", OPT_NUM, UNIT_VOLTAGE, &floor_height, 1e-30, 1e30, "V",
		"lowest peak (count; five deviations of the record)", 0, 0 },
	OPT_HEADING("Further output"),
	{ 0, "separated", OPT_TEXT, UNIT_NONE, &separated, 0, 0, "FILE",
		"write each source of a section as a channel of its own", 0, 1 },
	{ 0, "histogram", OPT_TEXT, UNIT_NONE, &histogram, 0, 0, "FILE",
		"write the weighted histograms as a table (duet)", 0, 1 },
	{ 0, "sections", OPT_TEXT, UNIT_NONE, &sections, 0, 0, "FILE",
		"write one row per section", 0, 1 },
	{ 0, "detectable", OPT_TEXT, UNIT_NONE, &detectable, 0, 0, "FILE",
		"write the probability of detection by amplitude as a table (fit)", 0,
		1 },
	OPT_END };

static const struct prog prog = { "duet",
	"Find the wear particles in the record of two inductive sensors.", "[file]",
	"signal: two channels, V, or four: I1 Q1 I2 Q2", "table: one row per particle",
	opts };

/* Channels aligned already and no pulse to look for: a mixture like that of talkers. */
static int is_mixture(void)
{
	return method == METHOD_DUET && instrument_align() == 0 &&
	       !opt_given("pulse-duration");
}

static void check_options(void)
{
	if (spacing > 10 && opt_given_bare("spacing"))
		warn("--spacing %g m: numbers without a unit are metres: is %gmm meant?",
			spacing, spacing);
	if (method != METHOD_DUET &&
		(opt_given("window") || opt_given("hop") || histogram))
		die(EXIT_USAGE, "--window, --hop and --histogram require --method duet");
	if (method != METHOD_COUNT && (opt_given("sensor") || opt_given("floor")))
		die(EXIT_USAGE, "--sensor and --floor require --method count");
	if (method == METHOD_COUNT && (separated || sections))
		die(EXIT_USAGE, "--method count excludes --sections and --separated");
	if (method != METHOD_FIT && instrument_file)
		die(EXIT_USAGE, "--instrument requires --method fit");
	if (method != METHOD_FIT && detectable)
		die(EXIT_USAGE, "--detectable requires --method fit");
	if (window % 2)
		die(EXIT_USAGE, "--window %ld: want an even number of samples", window);
	if (!opt_given("hop"))
		hop = window / 2;
	if (hop > window)
		die(EXIT_USAGE, "--hop %ld is longer than the window", hop);
	if (is_mixture() && opt_given("hop") &&
		(!opt_given("window") || hop > window / 2))
		die(EXIT_USAGE,
			"--align 0: --hop requires a --window at least twice as long");
}

static size_t to_samples(double time, double rate)
{
	double n = time * rate;

	return n < 1e15 ? (size_t)n : (size_t)1e15;
}

static size_t learned_samples(double rate)
{
	size_t n = isnan(learn) ? SEPARATE_LEARN : to_samples(learn, rate);

	if (n < SEPARATE_SHORTEST)
		die(EXIT_RUN, "--learn %g s: %zu samples at %g Hz, want at least %d",
			learn, n, rate, SEPARATE_SHORTEST);
	return n;
}

static int most_pulses(void)
{
	size_t most = input_limit("pulses", JOINT_PULSES_MAX);

	return most ? (int)most : 1;
}

static int separate_all(struct signal_in *in, struct found *out)
{
	double rate = (double)out->rate;
	int doubtful;
	struct separate_par par = { .method = method == METHOD_FIT ? SEPARATE_FIT
								   : SEPARATE_MASKS,
		.rate = rate,
		.learn = isnan(learn) ? 0 : learned_samples(rate),
		.sources = sources.word < 0 ? (int)sources.value : 0,
		.most_pulses = most_pulses(),
		.mask_window = opt_given("window") ? (size_t)window : 0,
		.mask_hop = opt_given("hop") ? (size_t)hop : 0,
		.want_sources = separated != NULL,
		.channels = out->components ? 4 : 2,
		.angle = out->components ? components_angle() : 0,
		.context = out };

	par.known = instrument_par(rate, signal_format(in)->filter);
	if (separated || histogram || sections)
		par.on_section = found_section;
	if (!isnan(latency)) {
		par.window = to_samples(latency / 2, rate);
		if (isnan(learn) && par.window < SEPARATE_LEARN)
			par.learn = par.window;
	}
	doubtful = separate_record(in, out, &par, instrument_file);
	free(par.known.filter);
	return doubtful;
}

static void count_all(struct signal_in *in, struct found *out)
{
	struct count_par par = { .sensor = (int)sensor,
		.floor = floor_height,
		.delay = instrument_align(),
		.learn = learned_samples((double)out->rate) };

	count_record(in, out, &par);
}

static int is_doubted(const struct signal_in *in, struct found *out)
{
	const char *why = signal_doubted(in);

	if (why)
		found_doubt(out, why);
	return why != NULL;
}

int main(int argc, char **argv)
{
	int i = opt_parse(&prog, argc, argv);
	struct signal_in *in;
	struct found out = { .separated = separated,
		.histogram = histogram,
		.sections = sections,
		.detectable = detectable,
		.spacing = spacing,
		.kappa = kappa };
	char *cmd;
	int doubtful = 0;

	check_options();
	in = signal_open(argv[i], NULL);
	out.components = method == METHOD_FIT && signal_format(in)->channels == 4;
	if (signal_format(in)->channels != 2 && method != METHOD_COUNT && !out.components)
		die(EXIT_RUN, "%s: want 2 channels%s, got %d", signal_name(in),
			method == METHOD_FIT ? " or 4 (I1 Q1 I2 Q2)" : "",
			signal_format(in)->channels);
	components_check(method == METHOD_FIT ? signal_format(in)->channels : 2);
	if (sensor > signal_format(in)->channels)
		die(EXIT_RUN, "%s: there is no channel %ld", signal_name(in), sensor);
	cmd = opt_cmd(signal_format(in)->cmd, NULL);
	found_open(&out, signal_format(in), cmd);
	if (method == METHOD_COUNT)
		count_all(in, &out);
	else if (is_mixture())
		doubtful =
			whole_record(in, &out, opt_given("window") ? (size_t)window : 0,
				opt_given("hop") ? (size_t)hop : 0,
				sources.word < 0 ? (int)sources.value : 0);
	else
		doubtful = separate_all(in, &out);
	doubtful |= is_doubted(in, &out);
	found_close(&out);
	signal_close(in);
	free(cmd);
	return shell_done(doubtful ? EXIT_NOCONV : 0);
}
