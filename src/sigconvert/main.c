/* sigconvert - recordings of other programs into signals, and signals into what they read
 */
#include "channels.h"
#include "cli/files.h"
#include "cli/msg.h"
#include "cli/opt.h"
#include "cli/stats.h"
#include "io/magnitudes.h"
#include "io/signals.h"
#include "moment.h"
#include "recording.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 4096, CHANNELS = TO_FLAC + 1, TABLE };

static const char *const in_words[] = { "auto", "au", "text", "raw", "sound", NULL };
static const char *const out_words[] = { "au", "text", "raw", "wav", "flac", "channels",
	"table", NULL };

static int from, to;
static struct opt_list rate = { 0 };
static long channels, skip;
static double scale = 1;
static const char *columns, *time_column, *start;

static const struct opt opts[] = {
	{ 0, "from", OPT_WORD, UNIT_NONE, &from, 0, 0, "auto|au|text|raw|sound",
		"input format; auto: recognised by the first bytes of a file", in_words,
		0 },
	{ 'o', "output", OPT_WORD, UNIT_NONE, &to, 0, 0,
		"au|text|raw|wav|flac|channels|table",
		"output format; channels: describes them; table: rows at any times",
		out_words, 0 },
	{ 'r', "rate", OPT_LIST, UNIT_FREQUENCY, &rate, RATE_LEAST, RATE_MOST, "F",
		"text and raw: sampling rate (default from the times)", NULL, 0 },
	{ 0, "channels", OPT_INT, UNIT_COUNT, &channels, 1, 1024, "N",
		"raw: number of channels of interleaved little-endian float64", NULL, 0 },
	{ 0, "columns", OPT_TEXT, UNIT_NONE, &columns, 0, 0, "NAME;NAME",
		"text: columns to read, by heading without its unit, or by number; table: NEW=NAME renames",
		NULL, 0 },
	{ 0, "time", OPT_TEXT, UNIT_NONE, &time_column, 0, 0, "NAME",
		"text: column of the times (default time or t)", NULL, 0 },
	{ 0, "start", OPT_TEXT, UNIT_NONE, &start, 0, 0, "TIME",
		"moment of the first sample in ISO 8601, if the input has none", NULL,
		0 },
	{ 0, "skip-lines", OPT_INT, UNIT_COUNT, &skip, 0, 1000000, "N",
		"text: number of lines before the heading", NULL, 0 },
	{ 0, "scale", OPT_NUM, UNIT_NONE, &scale, -1e300, 1e300, "K",
		"factor for all samples, such as volts at full scale", NULL, 0 },
	OPT_END,
};

static const struct prog prog = { "sigconvert",
	"Convert recordings into signals and signals into recordings.", "[file]",
	"signal, or a recording: text, raw, WAV, FLAC, ...",
	"signal, recording (text, raw, WAV, FLAC), or table", opts };

static double clipped;

static void check_options(void)
{
	struct moment moment;

	if (from == FROM_RAW && (!rate.n || !channels))
		die(EXIT_USAGE, "--from raw requires --rate and --channels");
	if (from != FROM_RAW && channels)
		die(EXIT_USAGE, "--channels requires --from raw");
	if (to == TABLE && (rate.n || opt_given("scale") || from == FROM_RAW))
		die(EXIT_USAGE, "--output table converts text: no --%s",
			rate.n             ? "rate"
			: from == FROM_RAW ? "from raw"
					   : "scale");
	if (scale == 0)
		die(EXIT_USAGE, "--scale must not be 0");
	if (start && (!moment_parse(start, &moment) || moment.date))
		die(EXIT_USAGE,
			"--start %s: expected a moment like 2026-11-22T03:04:05.5Z",
			start);
}

static void convert_table(const char *path, const struct recording_par *par)
{
	struct text_in *in = text_open(input_open(path), par);

	stats_set("rows", text_to_table(in, start));
	text_close(in);
}

/* Output of such samples has no end mark, so that what reads it does not take it for a
 * record. */
static void check_type(const struct magnitudes *m)
{
	if (magnitudes_single(m))
		die(EXIT_RUN,
			"the samples look like float32: --from raw wants little-endian "
			"float64");
	if (magnitudes_absurd(m, 1e-100))
		die(EXIT_RUN,
			"%.2g of the samples are above 1e100, and the largest is %.2g: "
			"not little-endian float64?",
			m->huge / m->samples, m->most);
}

/* first: frames before these samples. */
static void scale_all(double *x, size_t n, double first, size_t per_frame)
{
	for (size_t i = 0; i < n; i++) {
		double scaled = scale * x[i];

		if (isinf(scaled) && isfinite(x[i]))
			die(EXIT_RUN,
				"frame %.0f: %g times --scale %g is beyond double precision",
				first + floor((double)i / (double)per_frame), x[i],
				scale);
		x[i] = scaled;
	}
}

int main(int argc, char **argv)
{
	int operand = opt_parse(&prog, argc, argv);
	struct magnitudes magnitudes = { 0 };
	struct recording_par par = { .from = (enum recording_from)from,
		.rate = rate.n ? rate.v[0] : NAN,
		.channels = (int)channels,
		.columns = columns,
		.time = time_column,
		.start = start,
		.skip = skip,
		.table = to == TABLE };
	struct recording *in;
	struct recording_out *out = NULL;
	struct channels *table = NULL;
	struct signal_format format;
	double *x, frames = 0;
	const char *doubt;
	int doubtful;
	size_t n;

	check_options();
	if (to == TABLE) {
		convert_table(argv[operand], &par);
		return shell_done(EXIT_SUCCESS);
	}
	in = recording_open(argv[operand], &par);
	format = *recording_format(in);
	format.cmd = opt_cmd(format.cmd, NULL);
	format.single = 0;
	if (to == CHANNELS)
		table = channels_new(&format);
	else
		out = recording_create((enum recording_to)to, &format);
	x = xcalloc(BLOCK * (size_t)format.channels, sizeof *x);
	while ((n = recording_read(in, x, BLOCK)) > 0) {
		magnitudes_add(&magnitudes, x, n * (size_t)format.channels);
		scale_all(
			x, n * (size_t)format.channels, frames, (size_t)format.channels);
		if (table)
			channels_add(table, x, n);
		else
			clipped += recording_write(out, x, n);
		frames += (double)n;
	}
	if (from == FROM_RAW)
		check_type(&magnitudes);
	doubt = recording_doubt(in);
	doubtful = doubt && !(out && recording_state(out, doubt));
	if (doubtful)
		doubt = recording_doubted(in);
	if (table)
		channels_done(table, doubt);
	else
		recording_done(out);
	recording_close(in);
	stats_set("frames", frames);
	stats_set("samples_clipped", clipped);
	if (clipped > 0)
		warn("%.0f samples exceed full scale and are clipped: see --scale",
			clipped);
	free(x);
	return shell_done(clipped > 0 || doubtful ? EXIT_NOCONV : EXIT_SUCCESS);
}
