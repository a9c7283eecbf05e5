#include "arrivals.h"
#include "alignment.h"
#include "cli/msg.h"
#include "cli/stats.h"
#include "example_options.h"
#include "io/signals.h"
#include "io/tables.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *sections_file;
static double duration = NAN, align = NAN;
static long sections, refused;

struct opt arrivals_rows[] = {
	OPT_HEADING("Records"),
	{ 0, "sections", OPT_TEXT, UNIT_NONE, &sections_file, 0, 0, "FILE",
		"apply, pulses: table of sections from duet --sections", NULL, 0 },
	{ 0, "pulse-duration", OPT_NUM, UNIT_TIME, &duration, 1e-12, 1e9, "T",
		"apply, pulses: duration of a pulse of the mean particle", NULL, 0 },
	{ 0, "align", OPT_NUM, UNIT_TIME, &align, 0, 1e9, "T",
		"apply, pulses: time from sensor 1 to sensor 2 of the mean particle",
		NULL, 0 },
	OPT_END,
};

/* The part of the record in memory: frames first to first + n, one array per channel. */
struct stretch {
	struct signal_in *in;
	double *y[2];
	long long first;
	size_t n, room;
	int ended;
};

void arrivals_check(void)
{
	if (!sections_file || isnan(duration) || isnan(align))
		die(EXIT_USAGE, "--task apply --model pulses requires --sections, "
				"--pulse-duration and --align");
}

/* Drops all frames before from and reads up to frame to. */
static void move_stretch(struct stretch *s, long long from, long long to)
{
	enum { BLOCK = 4096 };
	double x[2 * BLOCK];

	while (!s->ended && s->first + (long long)s->n < to) {
		size_t got = signal_read_some(s->in, x, BLOCK), drop = s->n;

		if (from - s->first < (long long)drop)
			drop = from > s->first ? (size_t)(from - s->first) : 0;
		if (s->n - drop + got > s->room) {
			s->room = 2 * (s->n + got);
			for (int c = 0; c < 2; c++)
				s->y[c] = xrealloc(s->y[c], s->room, sizeof *s->y[c]);
		}
		for (int c = 0; c < 2; c++) {
			if (drop && s->n > drop)
				memmove(s->y[c], s->y[c] + drop,
					(s->n - drop) * sizeof *s->y[c]);
			for (size_t i = 0; i < got; i++) {
				if (!isfinite(x[2 * i + (size_t)c]))
					die(EXIT_RUN,
						"%s: channel %d, frame %lld: not a finite "
						"number",
						signal_name(s->in), c + 1,
						s->first + (long long)(s->n + i));
				s->y[c][s->n - drop + i] = x[2 * i + (size_t)c];
			}
		}
		s->first += (long long)drop;
		s->n += got - drop;
		s->ended = got == 0;
	}
}

/* The pulses of frames [from, to) of channel 1 and of as many of channel 2, shift frames
 * later; 0 if they do not suit the network. */
static int find_pulses(struct network *net, struct stretch *s, struct alignment *a,
	long long from, long long to, long long shift, struct cnn_pulse *pulse)
{
	double rate = (double)signal_format(s->in)->rate;
	struct cnn_section section = { .duration = duration * rate,
		.gain = (lessons.gain.v[0] + lessons.gain.v[1]) / 2,
		.middle = align * rate - (double)shift,
		.reach = lessons.reach.v[1] * duration * rate };
	long long end;

	/* A section that is too long is not read in. */
	if ((double)(to - from) * CNN_PER_PULSE > CNN_POINTS * section.duration)
		return 0;
	move_stretch(s, from, from + (long long)alignment_reach(a, (size_t)(to - from)));
	end = s->first + (long long)s->n - shift;
	if (from < s->first || end <= from)
		return 0;
	alignment_add(a, s->y[0] + (from - s->first),
		(size_t)((to < end ? to : end) - from), s->y[1] + (from - s->first),
		(size_t)(s->first + (long long)s->n - from));
	section.n = (size_t)((to < end ? to : end) - from);
	section.y1 = s->y[0] + (from - s->first);
	section.y2 = s->y[1] + (from - s->first) + shift;
	return cnn_apply(
		net, &section, opt_given("sources") ? (int)lessons.sources : 0, pulse);
}

/* Reads the table of sections, and the record up to the end of each. */
static void work_sections(struct network *net, struct stretch *s, struct alignment *a,
	struct table_in *in, struct table_out *out)
{
	int number = table_need(in, "section"), begin = table_need(in, "begin"),
	    end = table_need(in, "end");
	double rate = (double)signal_format(s->in)->rate, last = 0;
	long long shift = llround(align * rate);
	long particles = 0;

	while (table_next(in)) {
		double from = table_number(in, begin), to = table_number(in, end);
		struct cnn_pulse pulse[CNN_SOURCES] = { 0 };
		long long first;
		int m;

		if (!(from >= last) || !(to >= from) || !(to * rate < 1e15))
			die(EXIT_RUN,
				"%s: line %ld: sections must be in order, with begin before end",
				table_name(in), table_line(in));
		last = from;
		first = llround(from * rate);
		m = find_pulses(net, s, a, first, llround(to * rate), shift, pulse);
		for (int k = 0; k < (m ? m : 1); k++) {
			double t = (double)first + pulse[k].t,
			       delay = (double)shift + pulse[k].delta;
			const double row[] = { (double)particles, t / rate,
				(t + delay) / rate, pulse[k].a, delay / rate };

			for (int i = 0; i < 5; i++)
				table_put(out, m ? row[i] : NAN);
			table_put(out, table_number(in, number));
			table_put(out, m);
			table_put_text(out, m ? "guessed" : "refused");
			table_end_row(out);
			particles += m > 0;
		}
		table_flush(out);
		refused += m == 0;
		sections++;
	}
	stats_set("sections", (double)sections);
	stats_set("sections_refused", (double)refused);
}

/* The network tells no delays but those within its reach of --align: 1, with a comment
 * and a warning, where those of the record are others. */
static int is_misaligned(
	const struct alignment *a, const struct stretch *s, struct table_out *out)
{
	double delay = alignment_delay(a) / (double)signal_format(s->in)->rate;
	double reach = lessons.reach.v[1] * duration;
	char *why;

	if (refused == sections || fabs(delay - align) <= reach)
		return 0;
	why = isnan(delay)
		      ? xprintf("the channels have no pulses in common at --align %g s",
				align)
		      : xprintf("sensor 2 follows sensor 1 by %.4g s, outside --align "
				"%g s by more than --reach, %g s",
				delay, align, reach);
	warn("%s: %s: the delays are wrong", signal_name(s->in), why);
	table_comment(out, "doubtful", "%s", why);
	free(why);
	return 1;
}

/* The rest of a pipe is read, so that its writer does not fail. */
static void drain(struct stretch *s)
{
	double x[2];

	while (!s->ended)
		s->ended = signal_read_some(s->in, x, 1) == 0;
}

int arrivals_apply(const char *network, const char *record)
{
	struct netfile file;
	struct network *net = lessons_network(network, &file);
	const char *why[2];
	struct stretch s = { .in = signal_open(record, NULL) };
	double rate = (double)signal_format(s.in)->rate;
	/* Those of sections, which are so long at most, and twice what is expected. */
	struct alignment *a = alignment_new(duration * rate,
		fmax(2 * align, align + duration * CNN_POINTS / CNN_PER_PULSE) * rate);
	struct table_in *in = table_open(sections_file);
	char *cmd = opt_cmd(signal_format(s.in)->cmd, NULL);
	struct table_out *out = table_create(NULL, cmd, "1 s s V s 1 1 1",
		"particle time1 time2 amplitude delay section sources verdict");
	int doubtful;

	if (signal_format(s.in)->channels != 2)
		die(EXIT_RUN, "%s: want 2 channels, got %d", signal_name(s.in),
			signal_format(s.in)->channels);
	work_sections(net, &s, a, in, out);
	drain(&s);
	doubtful = refused > 0;
	doubtful |= is_misaligned(a, &s, out);
	if (refused)
		warn("%ld of %ld sections are outside the range of the network", refused,
			sections);
	why[0] = signal_doubted(s.in);
	why[1] = table_doubted(in);
	for (int k = 0; k < 2; k++)
		if (why[k]) {
			table_comment(out, "doubtful", "%s", why[k]);
			doubtful = 1;
		}
	table_done(out);
	table_close(in);
	signal_close(s.in);
	alignment_free(a);
	free(s.y[0]);
	free(s.y[1]);
	free(cmd);
	free(file.cmd);
	network_free(net);
	return doubtful;
}
