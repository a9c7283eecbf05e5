/* duet - wear particles from the record of two inductive sensors */
#include "shell/msg.h"
#include "shell/opt.h"
#include "shell/signals.h"
#include "shell/stats.h"
#include "shell/tables.h"
#include "signal/cnn.h"
#include "signal/count.h"
#include "signal/netfile.h"
#include "signal/robust.h"
#include "signal/separate.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 4096, LEARN = 65536, SOURCES_SHOWN = 8 };
enum { METHOD_FIT, METHOD_DUET, METHOD_CNN, METHOD_COUNT };

static int method = METHOD_FIT;
static long window = 64, hop, sensor = 1;
static struct opt_choice align = { 0, 0 }, sources = { 0, 0 }, gain = { 0, 0 };
static struct opt_choice pulse_duration = { 0, 0 }, spread = { 0, 0 };
static double kappa = 3.14159265358979323846 / 4 * 1e11; /* as sensorsim(1) */
static double spacing = 0.25, false_alarm = 1e-9, learn = NAN, latency = NAN;
static double floor_height = NAN;
static int pulse;
static struct opt_list lines;
static const char *separated, *histogram, *sections, *network_file;
static const char *const methods[] = { "fit", "duet", "cnn", "count", NULL };
static const char *const pulses[] = { "auto", "sine", "gauss", "lorentz", NULL };
static const char *const automatic[] = { "auto", NULL };

static const struct opt opts[] = {
	{ 'm', "method", OPT_WORD, UNIT_NONE, &method, 0, 0, "fit|duet|cnn|count",
		"joint fit of all pulses, time-frequency masks, a network, or counted peaks",
		methods, 0 },
	{ 'a', "align", OPT_CHOICE, UNIT_TIME, &align, 0, 1e9, "auto|T",
		"time from sensor 1 to sensor 2 of the mean particle", automatic, 0 },
	{ 'L', "spacing", OPT_NUM, UNIT_LENGTH, &spacing, 1e-6, 1e3, "D",
		"between the two sensors", 0, 0 },
	{ 'K', "calibration", OPT_NUM, UNIT_NONE, &kappa, 1e-30, 1e30, "K",
		"peak voltage over velocity and diameter cubed, V s/m4", 0, 0 },
	{ 'n', "sources", OPT_CHOICE, UNIT_COUNT, &sources, 1, 16, "auto|N",
		"particles in each section", automatic, 0 },
	{ 'p', "shape", OPT_WORD, UNIT_NONE, &pulse, 0, 0, "auto|sine|gauss|lorentz",
		"shape of a pulse", pulses, 0 },
	{ 't', "pulse-duration", OPT_CHOICE, UNIT_TIME, &pulse_duration, 1e-12, 1e9,
		"auto|T", "duration of a pulse of the mean particle", automatic, 0 },
	{ 'g', "gain", OPT_CHOICE, UNIT_NONE, &gain, 1e-6, 1e6, "auto|G",
		"of sensor 2 over sensor 1", automatic, 0 },
	{ 'l', "lines", OPT_LIST, UNIT_FREQUENCY, &lines, 0, 1e12, "F,F,...",
		"interfering lines to fit (0: none) instead of those found", 0, 0 },
	{ 'A', "false-alarm", OPT_NUM, UNIT_NONE, &false_alarm, 1e-15, 0.01, "P",
		"false particles per sample of noise", 0, 0 },
	{ 'x', "spread", OPT_CHOICE, UNIT_FRACTION, &spread, 0, 0.9, "auto|S",
		"transit times within this share of --align", automatic, 0 },
	{ 'e', "learn", OPT_NUM, UNIT_TIME, &learn, 0, 1e9, "T",
		"start of the record that the instrument is learned from", 0, 0 },
	{ 'y', "latency", OPT_NUM, UNIT_TIME, &latency, 0, 1e9, "T",
		"hold back no more than T of signal", 0, 0 },
	{ 'w', "window", OPT_INT, UNIT_COUNT, &window, 4, 1e6, "N",
		"samples of a Hamming window (duet)", 0, 0 },
	{ 'H', "hop", OPT_INT, UNIT_COUNT, &hop, 1, 1e6, "N",
		"samples from window to window (duet; half the window)", 0, 0 },
	{ 'k', "sensor", OPT_INT, UNIT_COUNT, &sensor, 1, 2, "N",
		"channel to count on (count)", 0, 0 },
	{ 'z', "floor", OPT_NUM, UNIT_VOLTAGE, &floor_height, 1e-30, 1e30, "V",
		"lowest peak (count; five deviations of the record)", 0, 0 },
	{ 'O', "separated", OPT_TEXT, UNIT_NONE, &separated, 0, 0, "FILE",
		"write each source of a section as a channel of its own", 0, 0 },
	{ 'G', "histogram", OPT_TEXT, UNIT_NONE, &histogram, 0, 0, "FILE",
		"write the weighted histograms as a table (duet)", 0, 0 },
	{ 'Z', "sections", OPT_TEXT, UNIT_NONE, &sections, 0, 0, "FILE",
		"write one row per section", 0, 0 },
	{ 'N', "network", OPT_TEXT, UNIT_NONE, &network_file, 0, 0, "FILE",
		"network of delaynet, for cnn or the first guesses of fit", 0, 0 },
	OPT_END
};

static const struct prog prog = { "duet",
	"Find the wear particles in the record of two inductive sensors.", "[file]",
	"signal: two channels, V", "table: one row per particle", opts };

static const char *const verdicts[] = { "alone", "overlap", "misfit", "unresolved" };

/* Where everything goes. */
struct output {
	struct table_out *particles, *sections, *histogram;
	struct signal_out *separated;
	long rate;
	long count;
	long long drawn; /* frames of separated signals written */
	double *frames;  /* of the separated signals, from frame drawn on */
	size_t held;
};

static void check_options(void)
{
	if (method != METHOD_DUET && (opt_given('w') || opt_given('H') || histogram))
		die(EXIT_USAGE, "--window, --hop and --histogram need --method duet");
	if (method != METHOD_COUNT && (opt_given('k') || opt_given('z')))
		die(EXIT_USAGE, "--sensor and --floor need --method count");
	if (method == METHOD_COUNT && (separated || sections))
		die(EXIT_USAGE, "--method count knows no sections and separates nothing");
	if (method == METHOD_CNN && !network_file)
		die(EXIT_USAGE, "--method cnn wants --network FILE");
	if (network_file && method != METHOD_CNN && method != METHOD_FIT)
		die(EXIT_USAGE, "--network is for --method cnn and fit");
	if (window % 2)
		die(EXIT_USAGE, "--window %ld: want an even number of samples", window);
	if (!opt_given('H'))
		hop = window / 2;
	if (hop > window)
		die(EXIT_USAGE, "--hop %ld is longer than the window", hop);
}

static void put_particle(struct output *out, const struct particle *p)
{
	double rate = (double)out->rate, delay = (p->t2 - p->t1) / rate;
	double delay_se = p->delay_se / rate,
	       velocity = delay > 0 ? spacing / delay : NAN;
	double d = sensor_diameter(kappa, velocity, p->amplitude);
	double ra = p->amplitude_se / p->amplitude, rt = delay_se / delay;
	/* d = (A delay / (kappa D))^(1/3) */
	double d_se = d / 3 * sqrt(ra * ra + rt * rt + 2 * p->correlation * ra * rt);
	int one = p->verdict != SEPARATE_UNRESOLVED;
	const double row[] = { one ? (double)out->count++ : NAN, p->t1 / rate,
		p->t2 / rate, d, p->amplitude, delay, velocity, p->t1_se / rate,
		p->t2_se / rate, d_se, p->amplitude_se, delay_se, velocity * rt,
		(double)p->section, (double)p->sources, p->chi2 };

	for (size_t i = 0; i < sizeof row / sizeof *row; i++)
		table_put(out->particles, row[i]);
	table_put_text(out->particles, verdicts[p->verdict]);
	table_end_row(out->particles);
}

/* Writes silence up to sample upto, then what is held. */
static void draw_until(struct output *out, long long upto)
{
	static const double silence[SOURCES_SHOWN];

	if (out->held)
		signal_write(out->separated, out->frames, out->held);
	out->drawn += (long long)out->held;
	out->held = 0;
	for (; out->drawn < upto; out->drawn++)
		signal_write(out->separated, silence, 1);
}

/* Adds the sources of a section; sections may overlap by the tails of pulses. */
static void draw_sources(struct output *out, const struct separate_section *s)
{
	size_t n = (size_t)(s->end - s->begin), end, at;

	if (s->begin > out->drawn + (long long)out->held)
		draw_until(out, s->begin);
	at = s->begin > out->drawn ? (size_t)(s->begin - out->drawn) : 0;
	end = at + n;
	if (end > out->held) {
		out->frames = xrealloc(out->frames, end, SOURCES_SHOWN * sizeof(double));
		memset(out->frames + out->held * SOURCES_SHOWN, 0,
			(end - out->held) * SOURCES_SHOWN * sizeof(double));
		out->held = end;
	}
	for (int k = 0; k < s->sources; k++)
		for (size_t i = 0; i < n; i++)
			out->frames[(at + i) * SOURCES_SHOWN +
				    (size_t)(k % SOURCES_SHOWN)] +=
				s->source[(size_t)k * n + i];
}

static void put_section(void *context, const struct separate_section *s)
{
	struct output *out = context;
	double rate = (double)out->rate;

	if (out->sections) {
		table_put(out->sections, (double)s->number);
		table_put(out->sections, (double)s->begin / (double)out->rate);
		table_put(out->sections, (double)s->end / (double)out->rate);
		table_put(out->sections, s->sources);
		table_put(out->sections,
			s->dense ? s->dense->rate_se * (double)(s->end - s->begin) : 0);
		table_put(out->sections, s->dense ? s->dense->amplitude : NAN);
		table_put(out->sections, s->dense ? s->dense->amplitude_se : NAN);
		table_put(out->sections, s->dense ? s->dense->square * rate : NAN);
		table_put(out->sections, s->dense ? s->dense->square_se * rate : NAN);
		table_put(out->sections, s->dense ? s->dense->fourth * rate : NAN);
		table_put(out->sections, s->dense ? s->dense->fourth_se * rate : NAN);
		table_put(out->sections, s->chi2);
		table_put_text(out->sections, verdicts[s->verdict]);
		table_end_row(out->sections);
	}
	if (out->separated && s->source)
		draw_sources(out, s);
	if (!out->histogram || !s->masks)
		return;
	for (int i = 0; i < MASKS_CELLS * MASKS_CELLS; i++) {
		double a, delta;

		masks_cell(s->masks, i / MASKS_CELLS, i % MASKS_CELLS, &a, &delta);
		table_put(out->histogram, (double)s->number);
		table_put(out->histogram, a);
		table_put(out->histogram, delta / (double)out->rate);
		table_put(out->histogram, masks_histogram(s->masks)[i]);
		table_end_row(out->histogram);
	}
}

static size_t to_samples(double time, double rate)
{
	double n = time * rate;

	return n < 1e15 ? (size_t)n : (size_t)1e15;
}

static struct network *read_network(void)
{
	FILE *f = fopen(network_file, "r");
	struct netfile file;
	struct network *net;

	if (!f)
		die(EXIT_RUN, "%s:", network_file);
	net = netfile_read(f, 1, &file);
	if (!net)
		die(EXIT_RUN, "%s: line %ld: %s", network_file, file.line, file.why);
	if (strcmp(file.purpose, "arrivals") != 0 || !cnn_suits(net))
		die(EXIT_RUN, "%s: want a network for arrivals, got one for %s",
			network_file, file.purpose);
	free(file.cmd);
	fclose(f);
	return net;
}

static struct separate_par make_par(struct output *out)
{
	static const enum separate_method of[] = { SEPARATE_FIT, SEPARATE_MASKS,
		SEPARATE_NETWORK };
	double rate = (double)out->rate;
	struct separate_par par = { .method = of[method],
		.network = network_file ? read_network() : NULL,
		.learn = isnan(learn) ? LEARN : to_samples(learn, rate),
		.sources = sources.word < 0 ? (int)sources.value : 0,
		.mask_window = (size_t)window,
		.mask_hop = (size_t)hop,
		.want_sources = separated != NULL,
		.context = out };

	par.known = (struct calibrate_par){ .lag = align.word < 0 ? align.value * rate
								  : NAN,
		.duration = pulse_duration.word < 0 ? pulse_duration.value * rate : NAN,
		.gain = gain.word < 0 ? gain.value : NAN,
		.pulse = pulse - 1,
		.spread = spread.word < 0 ? spread.value : NAN,
		.false_alarm = false_alarm,
		.tones = CALIBRATE_FIND_TONES };
	if (separated || histogram || sections)
		par.on_section = put_section;
	if (!isnan(latency)) {
		par.window = to_samples(latency / 2, rate);
		if (isnan(learn) && to_samples(latency / 2, rate) < par.learn)
			par.learn = to_samples(latency / 2, rate);
	}
	if (lines.n > TONES_MAX)
		die(EXIT_USAGE, "--lines: at most %d", TONES_MAX);
	if (lines.n)
		par.known.tones = 0;
	for (int i = 0; i < lines.n; i++) {
		if (lines.v[i] > rate / 2)
			die(EXIT_RUN, "--lines: %g Hz is above half the rate, %g Hz",
				lines.v[i], rate / 2);
		if (lines.v[i] > 0)
			par.known.omega[par.known.tones++] =
				2 * acos(-1) * lines.v[i] / rate;
	}
	return par;
}

static void check_status(
	enum separate_status status, const struct separate *s, const char *name)
{
	int channel;
	long long frame = separate_bad_sample(s, &channel);

	switch (status) {
	case SEPARATE_OK:
		return;
	case SEPARATE_MEMORY:
		die(EXIT_RUN, "%s: no memory", name);
	case SEPARATE_SHORT:
		die(EXIT_RUN, "%s: want at least 64 frames to learn from", name);
	case SEPARATE_NOT_FINITE:
		die(EXIT_RUN, "%s: channel %d, frame %lld: not a finite number", name,
			channel + 1, frame);
	case SEPARATE_SILENT_1:
	case SEPARATE_SILENT_2:
		die(EXIT_RUN, "%s: channel %d is constant: a dead sensor", name,
			status == SEPARATE_SILENT_1 ? 1 : 2);
	case SEPARATE_NO_LAG:
		warn("%s: nothing in common of both channels to learn from: no particle, or "
		     "give --align and --pulse-duration",
			name);
		return;
	case SEPARATE_FAST:
		die(EXIT_RUN,
			"%s: no pulse of at least 8 samples found: give --pulse-duration "
			"or sample faster",
			name);
	case SEPARATE_SLOW:
		die(EXIT_RUN, "%s: pulses as long as the record: --learn from more of it",
			name);
	}
}

static void report(const struct separate *s, double rate)
{
	const struct separate_counters *c = separate_counters(s);
	const struct calibration *cal = separate_calibration(s);

	stats_set("samples", c->samples);
	stats_set("samples_passed_over", c->passed_over);
	stats_set("samples_active", c->active);
	stats_set("sections", c->sections);
	stats_set("sections_single", c->singles);
	stats_set("sections_unresolved", c->unresolved);
	stats_set("fits", c->fits);
	stats_set("fit_steps", c->steps);
	stats_set("searches", c->searches);
	stats_set("guesses", c->guesses);
	stats_set("guesses_refused", c->refused);
	stats_set("demixings", c->masks);
	stats_set("demixings_skipped", c->masks_skipped);
	if (!cal)
		return;
	note("align %g s, pulse %s of %g s, gain %g, noise %g and %g V, %d lines, learned from "
	     "%d pulses",
		(double)cal->shift / rate, pulses[cal->pulse + 1], cal->duration / rate,
		cal->gain, cal->noise[0], cal->noise[1], cal->tones, cal->events);
}

static void separate_all(struct signal_in *in, struct output *out)
{
	static double x[2 * BLOCK];
	struct separate_par par = make_par(out);
	struct separate *s = separate_new(&par);
	enum separate_status status = SEPARATE_OK;
	struct particle p;
	size_t n;

	if (!s)
		die(EXIT_RUN, "no memory");
	while ((n = signal_read_some(in, x, BLOCK)) > 0) {
		int any = 0;

		status = separate_push(s, x, n);
		while (separate_next(s, &p)) {
			put_particle(out, &p);
			any = 1;
		}
		check_status(status, s, signal_name(in));
		if (any)
			table_flush(out->particles);
	}
	status = separate_end(s);
	while (separate_next(s, &p))
		put_particle(out, &p);
	check_status(status, s, signal_name(in));
	report(s, (double)out->rate);
	separate_free(s);
	network_free(par.network);
}

static void put_peak(struct output *out, const struct peak *p)
{
	double t = p->t / (double)out->rate,
	       v = align.word < 0 ? spacing / align.value : NAN;
	const double row[] = { (double)out->count++, sensor == 1 ? t : NAN,
		sensor == 2 ? t : NAN, sensor_diameter(kappa, v, p->height), p->height,
		align.word < 0 ? align.value : NAN, v };

	for (int i = 0; i < 17; i++)
		if (i < 7)
			table_put(out->particles, row[i]);
		else if (i < 16)
			table_put(out->particles, i == 14 ? 1 : NAN);
		else
			table_put_text(out->particles, "counted");
	table_end_row(out->particles);
}

/* Five robust deviations of the record's beginning. */
static double choose_level(const double *x, size_t n, int channels)
{
	double *copy = xcalloc(n, sizeof *copy), median;

	for (size_t i = 0; i < n; i++)
		copy[i] = x[i * (size_t)channels + (size_t)sensor - 1];
	median = robust_median(copy, n);
	for (size_t i = 0; i < n; i++)
		copy[i] = fabs(copy[i] - median);
	median = 5 * 1.4826 * robust_median(copy, n);
	free(copy);
	return median;
}

static void count_all(struct signal_in *in, struct output *out)
{
	int channels = signal_format(in)->channels;
	size_t most = isnan(learn) ? LEARN : to_samples(learn, (double)out->rate), n;
	double *x = xcalloc(most, sizeof *x * (size_t)channels);
	struct count *c = NULL;
	struct peak p;
	long long frame = 0;

	while ((n = signal_read(in, x, most)) > 0) {
		for (size_t i = 0; i < n; i++, frame++) {
			double y = x[i * (size_t)channels + (size_t)sensor - 1];

			if (!isfinite(y))
				die(EXIT_RUN,
					"%s: channel %ld, frame %lld: not a finite number",
					signal_name(in), sensor, frame);
			if (i == 0 && !c) {
				c = count_new(isnan(floor_height)
						      ? choose_level(x, n, channels)
						      : floor_height);
				if (!c)
					die(EXIT_RUN,
						"%s: channel %ld is constant: give --floor",
						signal_name(in), sensor);
			}
			if (count_sample(c, y, &p))
				put_peak(out, &p);
		}
	}
	if (c && count_end(c, &p))
		put_peak(out, &p);
	stats_set("samples", (double)frame);
	stats_set("peaks", (double)out->count);
	count_free(c);
	free(x);
}

static void open_outputs(
	struct output *out, const struct signal_format *format, const char *cmd)
{
	struct signal_format many = { out->rate, SOURCES_SHOWN, 0, (char *)cmd, NULL,
		NULL };

	out->particles = table_create(NULL, cmd, "1 s s m V s m/s s s m V s m/s 1 1 1 1",
		"particle time1 time2 diameter amplitude delay velocity time1_se time2_se "
		"diameter_se amplitude_se delay_se velocity_se section sources chi2 verdict");
	if (format->seed)
		table_comment(out->particles, "seed", "%s", format->seed);
	if (sections)
		out->sections = table_create(sections, cmd, NULL,
			"section begin end sources sources_se amplitude amplitude_se square square_se "
			"fourth fourth_se chi2 verdict");
	if (histogram)
		out->histogram = table_create(
			histogram, cmd, NULL, "section attenuation delay weight");
	if (separated)
		out->separated = signal_create(separated, &many);
}

static void close_outputs(struct output *out, long long frames)
{
	table_done(out->particles);
	if (out->sections)
		table_done(out->sections);
	if (out->histogram)
		table_done(out->histogram);
	if (out->separated) {
		draw_until(out, frames);
		signal_done(out->separated);
	}
	free(out->frames);
}

int main(int argc, char **argv)
{
	int i = opt_parse(&prog, argc, argv);
	struct signal_in *in;
	struct output out = { 0 };
	char *cmd;

	check_options();
	in = signal_open(argv[i], NULL);
	out.rate = signal_format(in)->rate;
	if (signal_format(in)->channels != 2 && method != METHOD_COUNT)
		die(EXIT_RUN, "%s: want 2 channels, got %d", signal_name(in),
			signal_format(in)->channels);
	if (sensor > signal_format(in)->channels)
		die(EXIT_RUN, "%s: there is no channel %ld", signal_name(in), sensor);
	cmd = opt_cmd(signal_format(in)->cmd, NULL);
	open_outputs(&out, signal_format(in), cmd);
	if (method == METHOD_COUNT)
		count_all(in, &out);
	else
		separate_all(in, &out);
	close_outputs(&out, 0);
	signal_close(in);
	free(cmd);
	return shell_done(0);
}
