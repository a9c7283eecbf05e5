/* bpfilter - band-pass every channel of a signal */
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "io/signals.h"
#include "io/tables.h"
#include "signal/filter/fir.h"
#include "signal/noise/lines.h"
#include "signal/noise/tones.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static struct opt_list edges = { 2, { 70, 130 } }, removed;
static long order = 200, grid = 501;
static int window, no_scale, zero_phase, response, taps_only, single;
static double attenuation = 60, latency = INFINITY, memory = NAN, rate = 10e3;
static const char *const windows[] = { "hamming", "hann", "blackman", "kaiser", NULL };

static const struct opt opts[] = {
	OPT_HEADING("Filter"),
	{ 'b', "band", OPT_LIST, UNIT_FREQUENCY, &edges, 0, 1e12, "LO:HI",
		"pass band; LO 0 makes a low-pass, HI half the rate a high-pass", 0, 0 },
	{ 0, "order", OPT_INT, UNIT_COUNT, &order, 1, 1e6, "N",
		"number of taps minus one", 0, 0 },
	{ 0, "window", OPT_WORD, UNIT_NONE, &window, 0, 0, "hamming|hann|blackman|kaiser",
		"window that cuts the ideal response", windows, 0 },
	{ 0, "attenuation", OPT_NUM, UNIT_DECIBEL, &attenuation, 0, 300, "A",
		"stop-band attenuation of the Kaiser window", 0, 0 },
	{ 0, "no-scale", OPT_FLAG, UNIT_NONE, &no_scale, 0, 0, 0,
		"do not scale the taps to gain 1 in the band", 0, 0 },
	{ 0, "zero-phase", OPT_FLAG, UNIT_NONE, &zero_phase, 0, 0, 0,
		"compensate the delay of half the order", 0, 0 },
	OPT_HEADING("Interfering lines"),
	{ 0, "lines", OPT_LIST, UNIT_FREQUENCY, &removed, 0, 1e12, "F,F,...",
		"remove narrow lines before the filter, by least squares", 0, 0 },
	{ 0, "line-window", OPT_NUM, UNIT_TIME, &memory, 0, 1e9, "T",
		"window of the least squares (default 2 s, at most 131072 frames)", 0,
		0 },
	OPT_HEADING("Output"),
	{ 0, "latency", OPT_NUM, UNIT_TIME, &latency, 0, 1e9, "T",
		"largest delay of the output by block processing", 0, 0 },
	{ 0, "single", OPT_FLAG, UNIT_NONE, &single, 0, 0, 0, "write 32-bit floats", 0,
		0 },
	OPT_HEADING("The filter itself, instead of a signal"),
	{ 0, "response", OPT_FLAG, UNIT_NONE, &response, 0, 0, 0,
		"print the frequency response as a table and read nothing", 0, 0 },
	{ 0, "taps", OPT_FLAG, UNIT_NONE, &taps_only, 0, 0, 0,
		"print the taps as a table and read nothing", 0, 0 },
	{ 'r', "rate", OPT_NUM, UNIT_FREQUENCY, &rate, 1, 1e12, "F",
		"sampling rate for --response and --taps", 0, 0 },
	{ 0, "grid", OPT_INT, UNIT_COUNT, &grid, 2, 1e7, "N",
		"points of the response from 0 to half the rate", 0, 0 },
	OPT_END,
};

static const struct prog prog = { "bpfilter",
	"Band-pass filter each channel of a signal.", "[file]", "signal",
	"signal, or a table with --response or --taps", opts };

static void check_options(int operands)
{
	if (response && taps_only)
		die(EXIT_USAGE, "--response and --taps exclude one another");
	if ((response || taps_only) && operands)
		die(EXIT_USAGE, "--response and --taps have no input: omit the file");
	if (edges.v[0] >= edges.v[1])
		die(EXIT_USAGE, "--band %g:%g: the first edge must be the lower",
			edges.v[0], edges.v[1]);
	if (zero_phase && order % 2)
		die(EXIT_USAGE,
			"--zero-phase needs an even --order: half of %ld is not an integer number of samples",
			order);
}

static struct fir_band make_band(double fs)
{
	return (struct fir_band){ (int)order, edges.v[0] / fs, edges.v[1] / fs,
		(enum fir_window)window,
		window == FIR_KAISER ? fir_kaiser_beta(attenuation) : 0, !no_scale };
}

static double gain_at(const double *h, double f)
{
	double re, im;

	fir_response(h, (size_t)order + 1, f, 0, &re, &im);
	return hypot(re, im);
}

/* An order of too few taps for the rate makes a low-pass of a band-pass: the gain half,
 * that of an edge, is exceeded where the filter should stop. */
static void check_stop(const struct fir_band *band, const double *h, double fs)
{
	double low = band->low > 0 ? gain_at(h, 0) : 0,
	       high = band->high < 0.5 ? gain_at(h, 0.5) : 0,
	       middle = gain_at(h, band->high == 0.5 ? 0.5
				   : band->low > 0   ? (band->low + band->high) / 2
						     : 0);

	if (fmax(low, high) > middle / 2)
		warn("--order %ld is too low for the band at a rate of %g Hz: the gain at %g Hz "
		     "is %.2g times that in the band",
			order, fs, low > high ? 0 : fs / 2, fmax(low, high) / middle);
}

/* Taps for this sampling rate; name is where the rate came from. */
static double *make_taps(double fs, const char *name)
{
	struct fir_band band = make_band(fs);
	double *h = xcalloc((size_t)order + 1, sizeof *h);

	if (band.high > 0.5)
		die(EXIT_RUN, "%s: --band ends at %g Hz, above half the rate of %g Hz",
			name, edges.v[1], fs);
	if (fir_design(&band, h) != NUM_OK)
		die(EXIT_USAGE,
			"a high-pass of odd --order %ld has no gain at half the rate: "
			"use an even order or --no-scale",
			order);
	check_stop(&band, h, fs);
	return h;
}

static void print_response(const double *h)
{
	struct table_out *t = table_create(
		NULL, opt_cmd(NULL, NULL), "Hz 1 dB rad", "frequency gain level phase");
	double shift = zero_phase ? 0.5 * (double)order : 0;

	for (long i = 0; i < grid; i++) {
		double f = 0.5 * (double)i / (double)(grid - 1), re, im, gain;

		fir_response(h, (size_t)order + 1, f, shift, &re, &im);
		gain = hypot(re, im);
		table_put(t, f * rate);
		table_put(t, gain);
		table_put(t, 20 * log10(gain));
		table_put(t, atan2(im, re));
		table_end_row(t);
	}
	table_done(t);
}

static void print_taps(const double *h)
{
	struct table_out *t = table_create(NULL, opt_cmd(NULL, NULL), "s 1", "t tap");

	for (long k = 0; k <= order; k++) {
		table_put(t, ((double)k - (zero_phase ? 0.5 * (double)order : 0)) / rate);
		table_put(t, h[k]);
		table_end_row(t);
	}
	table_done(t);
}

/* Refuses nan, infinity and what would overflow in sums over a block. */
static void check_samples(
	const double *x, size_t nframes, int channels, double frame, const char *name)
{
	enum { LANES = 8 };
	/* Sums in a block exceed the samples by less: there are at most 1e6 taps. */
	const double headroom = 1e20;
	size_t n = nframes * (size_t)channels, i, place;
	double bad[LANES] = { 0 }, sum = 0;

	/* x - x is 0, or nan if x is not finite */
	for (i = 0; i + LANES <= n; i += LANES)
		for (size_t k = 0; k < LANES; k++)
			bad[k] += x[i + k] * headroom - x[i + k] * headroom;
	for (; i < n; i++)
		sum += x[i] * headroom - x[i] * headroom;
	for (size_t k = 0; k < LANES; k++)
		sum += bad[k];
	if (sum == 0)
		return;
	for (i = 0; isfinite(x[i] * headroom); i++)
		;
	place = i / (size_t)channels;
	die(EXIT_RUN, "%s: frame %.0f, channel %zu: sample is %s", name,
		frame + (double)place, i % (size_t)channels + 1,
		isfinite(x[i]) ? "too large to filter" : "not a finite number");
}

/* The steps from input to output: removal of lines, filter, first frames dropped. */
struct chain {
	struct lines *lines; /* NULL: none */
	struct fir *fir;
	size_t step; /* frames to read at a time */
	size_t skip; /* frames still to be dropped */
	size_t channels;
	double *piece; /* a block of the input of the filter */
	struct signal_out *out;
};

/* A window resolves lines that differ by one period within it. */
static void check_lines(double fs, double frames)
{
	double before = 0;

	if (removed.n > TONES_MAX)
		die(EXIT_USAGE, "--lines: %d at most", TONES_MAX);
	for (int i = 0; i < removed.n; i++) {
		double f = removed.v[i];

		if (!(f - before >= fs / frames))
			die(EXIT_USAGE,
				"--lines: %g Hz after %g Hz: a window of %g s needs them "
				"in order and %g Hz apart",
				f, before, frames / fs, fs / frames);
		if (f > fs / 2 - fs / frames)
			die(EXIT_RUN,
				"--lines: %g Hz is not well below half the rate of %g Hz",
				f, fs);
		before = f;
	}
}

static struct lines *make_lines(double fs, int channels, size_t *hop)
{
	double frames = isnan(memory) ? fmin(2 * fs, 131072) : memory * fs;
	double omega[TONES_MAX];
	struct lines *lines;

	check_lines(fs, frames);
	for (int i = 0; i < removed.n; i++)
		omega[i] = 2 * M_PI * removed.v[i] / fs;
	*hop = (size_t)(frames / 2);
	lines = lines_new(removed.n, omega, channels, *hop);
	if (!lines)
		die(EXIT_RUN, "no memory for a window of %g frames", frames);
	return lines;
}

/* The filters passed so far, and this one. */
static char *filters_passed(const char *before, double fs)
{
	struct fir_band band = make_band(fs);
	char text[FIR_TEXT];

	fir_print(&band, fs, text);
	return before ? xprintf("%s | %s", before, text) : xprintf("%s", text);
}

static struct chain make_chain(struct signal_format f, const char *name)
{
	struct chain c = { .skip = zero_phase ? (size_t)order / 2 : 0,
		.channels = (size_t)f.channels };
	double fs = (double)f.rate, hold = latency * fs, *h = make_taps(fs, name);

	c.fir = fir_new(h, (size_t)order + 1, f.channels,
		hold < 1     ? 1
		: hold < 1e6 ? (size_t)hold
			     : 0);
	if (!c.fir)
		die(EXIT_RUN, "no memory for order %ld", order);
	free(h);
	c.step = fir_block(c.fir);
	if (removed.n)
		c.lines = make_lines(fs, f.channels, &c.step);
	c.piece = xcalloc(fir_block(c.fir) * c.channels, sizeof *c.piece);
	f.cmd = opt_cmd(f.cmd, NULL);
	f.single = single;
	f.filter = filters_passed(f.filter, fs);
	c.out = signal_create(NULL, &f);
	free(f.cmd);
	free(f.filter);
	return c;
}

/* Filters and writes n frames, less those still to be dropped; x NULL: silence. */
static void put(struct chain *c, const double *x, size_t n)
{
	size_t block = fir_block(c->fir), m, drop;

	for (; n > 0; n -= m) {
		m = n < block ? n : block;
		if (x)
			memcpy(c->piece, x, m * c->channels * sizeof *x);
		else
			memset(c->piece, 0, m * c->channels * sizeof *x);
		fir_run(c->fir, c->piece, m);
		drop = m < c->skip ? m : c->skip;
		c->skip -= drop;
		signal_write(c->out, c->piece + drop * c->channels, m - drop);
		if (x)
			x += m * c->channels;
	}
}

/* The exit status: 3 if all frames are still within the filter at the end. */
static int run(const char *path)
{
	struct signal_in *in = signal_open(path, NULL);
	struct chain c = make_chain(*signal_format(in), signal_name(in));
	double *x = xcalloc(c.step * c.channels, sizeof *x), frames = 0, left_out;
	size_t n, clean, tail = c.skip;
	int within;

	do {
		const double *y = x;

		n = clean = signal_read(in, x, c.step);
		check_samples(x, n, (int)c.channels, frames, signal_name(in));
		if (c.lines)
			y = lines_run(c.lines, x, n, &clean);
		if (!y)
			die(EXIT_RUN, "no memory to fit the lines");
		put(&c, y, clean);
		if (isfinite(latency))
			signal_flush(c.out);
		frames += (double)n;
	} while (n == c.step);
	if (frames > 0)
		put(&c, NULL, tail);
	signal_done(c.out);
	within = !zero_phase && frames > 0 && 2 * frames <= (double)order;
	if (within)
		warn("%s: the delay of order %ld is longer than the %.0f frames: the output "
		     "shows none of them, as it does with --zero-phase",
			signal_name(in), order, frames);
	stats_add("frames", frames);
	stats_add("channels", (double)c.channels);
	stats_add("points", (double)fir_transform(c.fir));
	stats_add("blocks", fir_blocks(c.fir, &left_out));
	stats_add("blocks_left_out", left_out);
	lines_free(c.lines);
	fir_free(c.fir);
	free(c.piece);
	free(x);
	signal_close(in);
	return within ? EXIT_NOCONV : EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
	int i = opt_parse(&prog, argc, argv), status = EXIT_SUCCESS;

	check_options(argc - i);
	if (response || taps_only) {
		double *h = make_taps(rate, "--rate");

		if (response)
			print_response(h);
		else
			print_taps(h);
	} else {
		status = run(argv[i]);
	}
	return shell_done(status);
}
